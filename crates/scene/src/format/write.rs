//! Writes a compiled scene.

use std::io::{self, BufWriter, Write};
use std::ops;

use glam::DVec3;

use super::VERSION;
use super::check::{
    ABOVE_ZERO, ANY, APART, Expression, FACTOR, FINITE, HALF_ANGLE, NAME, NOT_BELOW_ZERO, Range,
    SHARE, apart, is_name,
};
use super::derived::{self, Derived};
use super::lines::ONE;
use super::paint::{write_image, write_paint};
use crate::class::{Attributes, Scene};
use crate::csg::{Frame, Node, Solid};
use crate::light::{Light, LightKind};
use crate::optics::{Index, Transparency};
use crate::ray::Bounds;
use crate::rectangle::{Extent, Eye};
use crate::transform::Placement;

/// Writes `scene`; equal scenes give equal bytes.
///
/// # Errors
///
/// What `out` says, or [`io::ErrorKind::InvalidInput`] for a scene that no reader would take: a value out of its range,
/// a name that is not one word, an expression that is not well formed, a matrix or a box that is not finite.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let mut text = Text { out: BufWriter::new(out), line: 1 };
    write!(text.out, "portray scene {VERSION}")?;
    text.end()?;
    text.surroundings(scene)?;
    text.require(scene.attributes.first().is_some_and(Attributes::is_empty), || {
        "a first set of attributes that is empty".to_owned()
    })?;
    for (i, attributes) in scene.attributes.iter().enumerate().skip(1) {
        text.attributes(i, attributes, scene.images.len())?;
    }
    let mut solids = Solids { attributes: scene.attributes.len(), ..Solids::default() };
    for (i, class) in scene.classes.iter().enumerate() {
        write!(text.out, "class {i}")?;
        text.name(&class.name)?;
        text.end()?;
        text.solid(&class.solid, &mut solids)?;
        solids.classes.push(solids.derived.bounds());
    }
    let eye = scene.camera.as_ref().map(Eye::new);
    for object in &scene.objects {
        text.word("object")?;
        if let Some(name) = &object.name {
            text.name(name)?;
        }
        text.end()?;
        text.solid(&object.solid, &mut solids)?;
        if let Some(eye) = &eye {
            text.extent(solids.derived.extent(&object.solid, &solids.classes, eye))?;
        }
    }
    text.word("end")?;
    text.end()?;
    text.out.flush()
}

/// Writes camera, ambient, background, fog, lights and images, the lines a compiled scene and its expanded form share.
///
/// # Errors
///
/// As [`write()`] does.
pub fn write_surroundings(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let mut text = Text { out: BufWriter::new(out), line: 1 };
    text.surroundings(scene)?;
    text.out.flush()
}

/// What the solids of a scene refer to.
#[derive(Default)]
struct Solids {
    /// How many sets of attributes there are.
    attributes: usize,
    /// The boxes of the classes so far.
    classes: Vec<Bounds>,
    expression: Expression,
    derived: Derived,
}

/// The text so far.
struct Text<W: Write> {
    out: BufWriter<W>,
    line: usize,
}

impl<W: Write> Text<W> {
    fn surroundings(&mut self, scene: &Scene) -> io::Result<()> {
        if let Some(camera) = &scene.camera {
            self.word(if camera.parallel { "camera parallel at" } else { "camera at" })?;
            self.vector(camera.position, &ANY)?;
            self.word(" target")?;
            self.vector(camera.target, &ANY)?;
            self.require(apart(camera.position, camera.target), || APART.to_owned())?;
            self.word(" focal")?;
            self.number(camera.focal_length_mm, &ABOVE_ZERO)?;
            self.end()?;
        }
        if let Some(lens) = scene.lens.filter(|_| scene.camera.is_some()) {
            self.word("lens aperture")?;
            self.number(lens.aperture, &ABOVE_ZERO)?;
            self.word(" focus")?;
            self.vector(lens.focus, &ANY)?;
            self.end()?;
        }
        if !same(scene.ambient, DVec3::ZERO) {
            self.word("ambient")?;
            self.vector(scene.ambient, &ANY)?;
            self.end()?;
        }
        if !same(scene.background, DVec3::ZERO) {
            self.word("background")?;
            self.vector(scene.background, &SHARE)?;
            self.end()?;
        }
        if let Some(half_distance) = scene.fog_half_distance {
            self.word("fog")?;
            self.number(half_distance, &ABOVE_ZERO)?;
            self.end()?;
        }
        scene.lights.iter().try_for_each(|light| self.light(light))?;
        for (number, image) in scene.images.iter().enumerate() {
            write_image(number, image, &mut self.out)?;
            self.end()?;
        }
        Ok(())
    }

    fn light(&mut self, light: &Light) -> io::Result<()> {
        match light.kind {
            LightKind::Point { at } => {
                self.word("light point at")?;
                self.vector(at, &ANY)?;
            }
            LightKind::Beam { at, toward } => {
                self.word("light beam")?;
                self.aim(at, toward)?;
            }
            LightKind::Spot { at, toward, concentration, half_angle_degrees } => {
                self.word("light spot")?;
                self.aim(at, toward)?;
                self.word(" concentration")?;
                self.number(concentration, &NOT_BELOW_ZERO)?;
                self.word(" angle")?;
                self.number(half_angle_degrees, &HALF_ANGLE)?;
            }
        }
        self.word(" color")?;
        self.vector(light.color, &ANY)?;
        if !light.shadows {
            self.word(" unshadowed")?;
        }
        if light.radius != 0.0 {
            self.word(" radius")?;
            self.number(light.radius, &ABOVE_ZERO)?;
        }
        self.end()
    }

    fn aim(&mut self, at: DVec3, toward: DVec3) -> io::Result<()> {
        self.word(" at")?;
        self.vector(at, &ANY)?;
        self.word(" toward")?;
        self.vector(toward, &ANY)?;
        self.require(apart(at, toward), || APART.to_owned())
    }

    fn attributes(
        &mut self,
        number: usize,
        attributes: &Attributes,
        images: usize,
    ) -> io::Result<()> {
        let Attributes { color, shininess, smoothness, pure, transparency, priority, paint } =
            attributes;
        write!(self.out, "attributes {number}")?;
        if let Some(color) = color {
            self.word(" color")?;
            self.vector(*color, &SHARE)?;
        }
        if let Some(shininess) = shininess {
            self.word(" shininess")?;
            self.number(*shininess, &SHARE)?;
        }
        if let Some(smoothness) = smoothness {
            self.word(" smoothness")?;
            self.number(*smoothness, &SHARE)?;
        }
        if let Some(pure) = pure {
            self.word(if *pure { " pure" } else { " composite" })?;
        }
        if let Some(Transparency { half_distance, index }) = transparency {
            self.word(" trans")?;
            self.number(*half_distance, &ABOVE_ZERO)?;
            match index {
                Index::Refractive(index) => self.number(*index, &ABOVE_ZERO)?,
                Index::Fake => self.word(" fake")?,
            }
        }
        if let Some(priority) = priority {
            write!(self.out, " priority {priority}")?;
        }
        self.end()?;
        for coat in paint {
            self.word("  ")?;
            write_paint(coat, images, &mut self.out)?;
            self.end()?;
        }
        Ok(())
    }

    fn solid(&mut self, solid: &Solid, solids: &mut Solids) -> io::Result<()> {
        solids.expression.clear();
        // Frames that stand in the text.
        let mut written = 0;
        for node in &solid.nodes {
            if let Node::Primitive { frame, .. }
            | Node::Form { frame, .. }
            | Node::Instance { frame, .. } = node
            {
                self.refer("frame", frame.0 as usize, solid.frames.len())?;
                self.frames(solid, written..frame.0 as usize, solids.attributes)?;
                written = written.max(frame.0 as usize);
            }
            self.node(node, solid, &mut written, solids)?;
        }
        self.frames(solid, written..solid.frames.len(), solids.attributes)?;
        solids.expression.finish().or_else(|expected| self.require(false, || expected))?;
        solids.derived.derive(solid, &solids.classes);
        self.require(solids.derived.is_finite(), || FINITE.to_owned())?;
        self.bounds(&solids.derived.bounds())
    }

    /// Frames of a range, each in a line of its own.
    fn frames(
        &mut self,
        solid: &Solid,
        range: ops::Range<usize>,
        attributes: usize,
    ) -> io::Result<()> {
        for number in range {
            write!(self.out, "  frame {number}")?;
            self.frame(number, &solid.frames[number], attributes)?;
            self.end()?;
        }
        Ok(())
    }

    fn frame(&mut self, number: usize, frame: &Frame, attributes: usize) -> io::Result<()> {
        if let Some(parent) = frame.parent_index() {
            write!(self.out, " in {parent}")?;
            self.refer("frame", parent, number)?;
        }
        let Placement { scale, rotation_degrees, place } = frame.placement;
        if !same(scale, DVec3::ONE) {
            self.word(" scale")?;
            self.vector(scale, &FACTOR)?;
        }
        if !same(rotation_degrees, DVec3::ZERO) {
            self.word(" rotate")?;
            self.vector(rotation_degrees, &ANY)?;
        }
        if !same(place, DVec3::ZERO) {
            self.word(" at")?;
            self.vector(place, &ANY)?;
        }
        if frame.attributes.0 != 0 {
            write!(self.out, " attributes {}", frame.attributes.0)?;
            self.refer("set of attributes", frame.attributes.0 as usize, attributes)?;
        }
        Ok(())
    }

    /// A node; the frame of a leaf stands in its line if that is the next, and it is `written` then.
    fn node(
        &mut self,
        node: &Node,
        solid: &Solid,
        written: &mut usize,
        solids: &mut Solids,
    ) -> io::Result<()> {
        let frame = match *node {
            Node::Primitive { kind, frame } => {
                write!(self.out, "  {}", kind.keywords()[0])?;
                Some(frame)
            }
            Node::Form { form, frame } => {
                self.refer("solid with arguments", form.0 as usize, solid.forms.len())?;
                let form = solid.form(form);
                write!(self.out, "  {}", form.row().keyword)?;
                form.arguments().iter().try_for_each(|value| self.number(*value, &ANY))?;
                Some(frame)
            }
            Node::Instance { class, frame } => {
                write!(self.out, "  instance {}", class.0)?;
                self.refer("class", class.0 as usize, solids.classes.len())?;
                Some(frame)
            }
            Node::Union(n) => {
                write!(self.out, "  union {n}")?;
                None
            }
            Node::Intersection(n) => {
                write!(self.out, "  intersection {n}")?;
                None
            }
            Node::Complement => {
                self.word("  complement")?;
                None
            }
        };
        match frame.map(|frame| frame.0 as usize) {
            Some(number) if number == *written => {
                self.frame(number, &solid.frames[number], solids.attributes)?;
                *written += 1;
            }
            Some(number) => write!(self.out, " frame {number}")?,
            None => {}
        }
        solids.expression.push(node).or_else(|expected| self.require(false, || expected))?;
        self.end()
    }

    fn bounds(&mut self, bounds: &Bounds) -> io::Result<()> {
        match derived::corners(bounds) {
            Some(corners) => {
                self.word("  box")?;
                self.numbers(&corners)
            }
            None => {
                self.word("  box none")?;
                self.end()
            }
        }
    }

    fn extent(&mut self, extent: Extent) -> io::Result<()> {
        self.word("  rectangle")?;
        match extent {
            Extent::None => self.word(" none")?,
            Extent::Whole => self.word(" whole")?,
            Extent::Part(rectangle) => return self.numbers(&derived::rectangle(&rectangle)),
        }
        self.end()
    }

    fn word(&mut self, word: &str) -> io::Result<()> {
        self.out.write_all(word.as_bytes())
    }

    fn name(&mut self, name: &str) -> io::Result<()> {
        write!(self.out, " {name}")?;
        self.require(is_name(name), || format!("{NAME}, found {name:?}"))
    }

    fn number(&mut self, value: f64, range: &Range) -> io::Result<()> {
        // Many numbers are 0 or 1, and formatting is most of the work.
        match value.to_bits() {
            0 => self.out.write_all(b" 0.0")?,
            ONE => self.out.write_all(b" 1.0")?,
            // The form of `{value:?}` in a sixth of the time; other numbers have another form there.
            _ if value.abs() < 1e16 && !(1e-5..1e-4).contains(&value.abs()) => {
                self.out.write_all(b" ")?;
                self.out.write_all(zmij::Buffer::new().format_finite(value).as_bytes())?;
            }
            _ => write!(self.out, " {value:?}")?,
        }
        self.require(range.allows(value), || format!("{}, found {value:?}", range.words))
    }

    fn vector(&mut self, vector: DVec3, range: &Range) -> io::Result<()> {
        vector.to_array().into_iter().try_for_each(|value| self.number(value, range))
    }

    /// Numbers to the end of the line.
    fn numbers(&mut self, values: &[f64]) -> io::Result<()> {
        values.iter().try_for_each(|value| self.number(*value, &ANY))?;
        self.end()
    }

    fn end(&mut self) -> io::Result<()> {
        self.line += 1;
        self.out.write_all(b"\n")
    }

    fn refer(&self, what: &str, index: usize, end: usize) -> io::Result<()> {
        self.require(index < end, || format!("an earlier {what}, found {index} of {end}"))
    }

    /// Refuses the scene unless a condition holds.
    fn require(&self, holds: bool, expected: impl FnOnce() -> String) -> io::Result<()> {
        if holds {
            return Ok(());
        }
        let message = format!("line {} of the compiled scene: expected {}", self.line, expected());
        Err(io::Error::new(io::ErrorKind::InvalidInput, message))
    }
}

/// True if both have the same bits, so that −0 is written.
fn same(a: DVec3, b: DVec3) -> bool {
    a.to_array().map(f64::to_bits) == b.to_array().map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_form_that_the_standard_library_gives_them() {
        let mut state = 1_u64;
        for i in 0..200_000_u32 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Every other number of a common size, where the form changes from one to the other.
            let common = (state >> 12) | ((1000 + u64::from(i % 80)) << 52);
            let bits = if i % 2 == 0 { state ^ (state >> 31) } else { common };
            let value = f64::from_bits(bits);
            if value.is_finite() {
                let mut text = Text { out: BufWriter::new(Vec::new()), line: 1 };
                text.number(value, &ANY).unwrap();
                let found = String::from_utf8(text.out.into_inner().unwrap()).unwrap();
                let read: f64 = found[1..].parse().unwrap();
                assert_eq!(read.to_bits(), bits, "{found}");
                // The last digit of two that are equally near may be another.
                let form = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "0");
                assert_eq!(form(&found), form(&format!(" {value:?}")), "{found}");
            }
        }
    }
}
