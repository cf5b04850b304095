//! Reads a compiled scene.

use super::VERSION;
use super::check::{
    ABOVE_ZERO, ANY, APART, Expression, FACTOR, FINITE, HALF_ANGLE, NAME, NOT_BELOW_ZERO, SHARE,
    apart, is_name,
};
use super::derived::{self, Derived};
use super::error::ReadError;
use super::lines::Lines;
use super::paint::{read_image, read_paint};
use crate::camera::{Camera, Lens};
use crate::class::{Attributes, AttributesId, Class, Object, Scene};
use crate::csg::{ClassId, Frame, FrameId, Node, Solid};
use crate::form::{self, Form};
use crate::light::{Light, LightKind};
use crate::optics::{Index, Transparency};
use crate::primitive::Primitive;
use crate::ray::Bounds;
use crate::rectangle::{Extent, Eye};
use crate::transform::Placement;

/// Reads a scene, in one pass; memory grows with the text, whatever numbers stand in it.
///
/// # Errors
///
/// The first place where `text` is not a compiled scene of this version, breaks a promise of the language, or holds a
/// matrix, box or rectangle that does not follow from the rest.
pub fn read(text: &[u8]) -> Result<Scene, ReadError> {
    let mut reader = Reader {
        lines: Lines::new(text),
        scene: Scene::default(),
        classes: Vec::new(),
        expression: Expression::default(),
        frames: Vec::new(),
        nodes: Vec::new(),
        derived: Derived::default(),
    };
    reader.version()?;
    reader.surroundings()?;
    while reader.lines.take("light") {
        let light = reader.light()?;
        reader.scene.lights.push(light);
    }
    while reader.lines.take("image") {
        let image = read_image(&mut reader.lines, reader.scene.images.len())?;
        reader.scene.images.push(image);
    }
    while reader.lines.take("attributes") {
        let attributes = reader.attributes()?;
        reader.scene.attributes.push(attributes);
    }
    while reader.lines.take("class") {
        reader.class()?;
    }
    let eye = reader.scene.camera.as_ref().map(Eye::new);
    while reader.lines.take("object") {
        reader.object(eye.as_ref())?;
    }
    if !reader.lines.take("end") {
        return Err(reader.lines.error(STATEMENTS));
    }
    reader.lines.end_line()?;
    if !reader.lines.is_done() {
        return Err(reader.lines.error("nothing after `end`"));
    }
    Ok(reader.scene)
}

const STATEMENTS: &str = "one of these lines, in this order: `camera`, `lens`, `ambient`, `background`, \
    `fog`, `light`, `image`, `attributes`, `class`, `object`, `end`";

struct Reader<'a> {
    lines: Lines<'a>,
    scene: Scene,
    /// The boxes of the classes so far.
    classes: Vec<Bounds>,
    expression: Expression,
    /// Frames and nodes of the solid that is being read.
    frames: Vec<Frame>,
    nodes: Vec<Node>,
    derived: Derived,
}

impl Reader<'_> {
    fn version(&mut self) -> Result<(), ReadError> {
        let other = |error| ReadError { hint: Some("this is not a compiled scene"), ..error };
        self.lines.expect("portray").map_err(other)?;
        self.lines.expect("scene").map_err(other)?;
        let parse = |word: &str| (word.parse() == Ok(VERSION)).then_some(());
        self.lines.parsed(&format!("version {VERSION}"), parse).map_err(|error| ReadError {
            hint: Some("compile the scene again with the programs of this version"),
            ..error
        })?;
        self.lines.end_line()
    }

    fn surroundings(&mut self) -> Result<(), ReadError> {
        let lines = &mut self.lines;
        if lines.take("camera") {
            let parallel = lines.take("parallel");
            lines.expect("at")?;
            let position = lines.vector(&ANY)?;
            lines.expect("target")?;
            let mark = lines.mark();
            let target = lines.vector(&ANY)?;
            if !apart(position, target) {
                return Err(lines.error_at(mark, APART));
            }
            lines.expect("focal")?;
            let focal_length_mm = lines.number(&ABOVE_ZERO)?;
            lines.end_line()?;
            self.scene.camera = Some(Camera { position, target, focal_length_mm, parallel });
        }
        if self.scene.camera.is_some() && lines.take("lens") {
            lines.expect("aperture")?;
            let aperture = lines.number(&ABOVE_ZERO)?;
            lines.expect("focus")?;
            let focus = lines.vector(&ANY)?;
            lines.end_line()?;
            self.scene.lens = Some(Lens { aperture, focus });
        }
        if lines.take("ambient") {
            self.scene.ambient = lines.vector(&ANY)?;
            lines.end_line()?;
        }
        if lines.take("background") {
            self.scene.background = lines.vector(&SHARE)?;
            lines.end_line()?;
        }
        if lines.take("fog") {
            self.scene.fog_half_distance = Some(lines.number(&ABOVE_ZERO)?);
            lines.end_line()?;
        }
        Ok(())
    }

    fn light(&mut self) -> Result<Light, ReadError> {
        let lines = &mut self.lines;
        let kind = if lines.take("point") {
            lines.expect("at")?;
            LightKind::Point { at: lines.vector(&ANY)? }
        } else {
            let spot = lines.take("spot");
            if !spot && !lines.take("beam") {
                return Err(lines.error("`point`, `beam` or `spot`"));
            }
            lines.expect("at")?;
            let at = lines.vector(&ANY)?;
            lines.expect("toward")?;
            let mark = lines.mark();
            let toward = lines.vector(&ANY)?;
            if !apart(at, toward) {
                return Err(lines.error_at(mark, APART));
            }
            if spot {
                lines.expect("concentration")?;
                let concentration = lines.number(&NOT_BELOW_ZERO)?;
                lines.expect("angle")?;
                let half_angle_degrees = lines.number(&HALF_ANGLE)?;
                LightKind::Spot { at, toward, concentration, half_angle_degrees }
            } else {
                LightKind::Beam { at, toward }
            }
        };
        lines.expect("color")?;
        let color = lines.vector(&ANY)?;
        let shadows = !lines.take("unshadowed");
        let radius = if lines.take("radius") { lines.number(&ABOVE_ZERO)? } else { 0.0 };
        lines.end_line()?;
        Ok(Light { kind, color, shadows, radius })
    }

    fn attributes(&mut self) -> Result<Attributes, ReadError> {
        let lines = &mut self.lines;
        lines.ordinal(self.scene.attributes.len())?;
        let mut attributes = Attributes::default();
        if lines.take("color") {
            attributes.color = Some(lines.vector(&SHARE)?);
        }
        if lines.take("shininess") {
            attributes.shininess = Some(lines.number(&SHARE)?);
        }
        if lines.take("smoothness") {
            attributes.smoothness = Some(lines.number(&SHARE)?);
        }
        if lines.take("pure") {
            attributes.pure = Some(true);
        } else if lines.take("composite") {
            attributes.pure = Some(false);
        }
        if lines.take("trans") {
            let half_distance = lines.number(&ABOVE_ZERO)?;
            let index = if lines.take("fake") {
                Index::Fake
            } else {
                Index::Refractive(lines.number(&ABOVE_ZERO)?)
            };
            attributes.transparency = Some(Transparency { half_distance, index });
        }
        if lines.take("priority") {
            attributes.priority = Some(lines.parsed("a whole number", |word| word.parse().ok())?);
        }
        lines.end_line()?;
        while self.lines.take("paint") {
            let coat = read_paint(&mut self.lines, self.scene.images.len())?;
            attributes.paint.push(coat);
        }
        Ok(attributes)
    }

    fn class(&mut self) -> Result<(), ReadError> {
        self.lines.ordinal(self.scene.classes.len())?;
        let name = self.name()?;
        self.lines.end_line()?;
        let solid = self.solid()?;
        self.classes.push(self.derived.bounds());
        self.scene.classes.push(Class { name, solid });
        Ok(())
    }

    fn object(&mut self, eye: Option<&Eye>) -> Result<(), ReadError> {
        let name = if self.lines.peek().is_empty() { None } else { Some(self.name()?) };
        self.lines.end_line()?;
        let solid = self.solid()?;
        if let Some(eye) = eye {
            let extent = self.derived.extent(&solid, &self.classes, eye);
            extent_line(&mut self.lines, extent)?;
        }
        self.scene.objects.push(Object { name, solid });
        Ok(())
    }

    fn name(&mut self) -> Result<String, ReadError> {
        self.lines.parsed(NAME, |word| is_name(word).then(|| word.to_owned()))
    }

    fn solid(&mut self) -> Result<Solid, ReadError> {
        self.frames.clear();
        self.nodes.clear();
        self.expression.clear();
        let mut solid = Solid::default();
        while !self.lines.is_at("box") {
            if self.lines.take("frame") {
                self.lines.ordinal(self.frames.len())?;
                self.frame()?;
            } else {
                self.node(&mut solid)?;
            }
            self.lines.end_line()?;
        }
        // No more memory than there are of them.
        (solid.frames, solid.nodes) = (self.frames.to_vec(), self.nodes.to_vec());
        self.expression.finish().map_err(|expected| self.lines.error(expected))?;
        self.derived.derive(&solid, &self.classes);
        if !self.derived.is_finite() {
            return Err(self.lines.error(FINITE));
        }
        bounds_line(&mut self.lines, &self.derived.bounds())?;
        Ok(solid)
    }

    /// The rest of the line of a frame, which gets the next number.
    fn frame(&mut self) -> Result<FrameId, ReadError> {
        let lines = &mut self.lines;
        let number = self.frames.len();
        let parent =
            if lines.take("in") { Some(FrameId(lines.index("a frame", number)?)) } else { None };
        let mut placement = Placement::default();
        if lines.take("scale") {
            placement.scale = lines.vector(&FACTOR)?;
        }
        if lines.take("rotate") {
            placement.rotation_degrees = lines.vector(&ANY)?;
        }
        if lines.take("at") {
            placement.place = lines.vector(&ANY)?;
        }
        let mut attributes = AttributesId::NONE;
        if lines.take("attributes") {
            let sets = self.scene.attributes.len();
            attributes = AttributesId(lines.index("a set of attributes", sets)?);
        }
        let id = u32::try_from(number).map_err(|_| lines.error("fewer than 2³² frames"))?;
        self.frames.push(Frame { parent, placement, attributes });
        Ok(FrameId(id))
    }

    /// The frame that a leaf stands in: one that is there, or its own, which the rest of its line says.
    fn frame_of_leaf(&mut self) -> Result<FrameId, ReadError> {
        if !self.lines.take("frame") {
            return self.frame();
        }
        Ok(FrameId(self.lines.index("a frame", self.frames.len())?))
    }

    /// A node; the arguments of a solid that has any go to `solid`.
    fn node(&mut self, solid: &mut Solid) -> Result<(), ReadError> {
        let mut mark = self.lines.mark();
        let word = std::str::from_utf8(self.lines.peek()).unwrap_or_default();
        let node = if let Some(kind) = Primitive::named(word) {
            self.lines.expect(word)?;
            Node::Primitive { kind, frame: self.frame_of_leaf()? }
        } else if self.lines.take("instance") {
            let class = ClassId(self.lines.index("a class", self.classes.len())?);
            Node::Instance { class, frame: self.frame_of_leaf()? }
        } else if self.lines.take("complement") {
            Node::Complement
        } else if let Some(row) = form::Row::named(word) {
            let form = solid.add_form(Self::form(&mut self.lines, row)?);
            Node::Form { form, frame: self.frame_of_leaf()? }
        } else {
            let union = self.lines.take("union");
            if !union && !self.lines.take("intersection") {
                return Err(self.lines.error(
                    "a solid, `instance`, `union`, `intersection`, `complement`, `frame` or `box`",
                ));
            }
            mark = self.lines.mark();
            let n = self.lines.parsed("a number of operands", |word| word.parse().ok())?;
            if union { Node::Union(n) } else { Node::Intersection(n) }
        };
        let Self { lines, expression, .. } = self;
        expression.push(&node).map_err(|expected| lines.error_at(mark, expected))?;
        self.nodes.push(node);
        Ok(())
    }

    /// A solid with its arguments, which go on to a word or the end of the line.
    fn form(lines: &mut Lines<'_>, row: &'static form::Row) -> Result<Form, ReadError> {
        lines.expect(row.keyword)?;
        let (mut arguments, mut marks) = (Vec::new(), Vec::new());
        while !matches!(lines.peek(), [] | [b'a'..=b'z', ..]) {
            marks.push(lines.mark());
            arguments.push(lines.number(&ANY)?);
        }
        marks.push(lines.mark());
        Form::new(row, &arguments).map_err(|error| {
            let mark = marks[error.argument.min(marks.len() - 1)];
            lines.error_at(mark, error.expected)
        })
    }
}

/// A line of numbers that have to be `values`.
fn numbers(lines: &mut Lines<'_>, word: &str, values: &[f64]) -> Result<(), ReadError> {
    lines.same_word(word)?;
    values.iter().try_for_each(|value| lines.same(*value))?;
    lines.end_line()
}

fn bounds_line(lines: &mut Lines<'_>, bounds: &Bounds) -> Result<(), ReadError> {
    if let Some(corners) = derived::corners(bounds) {
        return numbers(lines, "box", &corners);
    }
    lines.same_word("box")?;
    lines.same_word("none")?;
    lines.end_line()
}

fn extent_line(lines: &mut Lines<'_>, extent: Extent) -> Result<(), ReadError> {
    if let Extent::Part(rectangle) = &extent {
        return numbers(lines, "rectangle", &derived::rectangle(rectangle));
    }
    lines.same_word("rectangle")?;
    lines.same_word(if extent == Extent::None { "none" } else { "whole" })?;
    lines.end_line()
}
