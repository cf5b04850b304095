//! Names bound to classes, lights and camera put together, and what can be said only of a whole scene.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use scene::form::FORMS;
use scene::{Camera, ClassId, Frame, FrameId, Lens, Light, LightKind, Node, Primitive, Rgb, Solid};

use crate::ast::{self, Definition, Spanned, Statement, StatementKind};
use crate::diagnostic::{Diagnostic, Said};
use crate::extent::{self, Extent};
use crate::habit;
use crate::number_text;
use crate::parse::ARITHMETIC;
use crate::shared::{Shared, Use};
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::survey;
use crate::token::{Soft, Symbol, shortened};

/// Classes named so far.
#[derive(Debug, Default)]
pub(crate) struct Classes {
    by_name: HashMap<Symbol, usize>,
    list: Vec<Class>,
    /// Classes with parameters, by name and the bits of their numbers; the first holds the place of those that are
    /// only checked.
    instances: Vec<Option<(ClassId, Extent)>>,
    by_numbers: HashMap<(Symbol, Box<[u64]>), u32>,
    /// Instances that were made with errors, and one of these.
    failed: HashMap<u32, Said>,
    /// How often such an instance was used again, and what was said of the last.
    again: (usize, Option<Said>),
    /// Names that nothing is called by so far.
    unknown: Vec<Unknown>,
    /// The class that is being bound.
    current: Option<Symbol>,
    /// How many classes each class that is being made can see: those before it.
    seen: Vec<usize>,
}

/// A name that nothing is called by.
#[derive(Debug)]
struct Unknown {
    name: Spanned<Symbol>,
    /// A number is called so.
    number: bool,
}

#[derive(Debug)]
struct Class {
    name: Spanned<Symbol>,
    /// Nothing for a class with errors.
    made: Option<Made>,
    used: bool,
    /// An included file offers more than one scene needs.
    included: bool,
}

/// What a class has come to.
#[derive(Debug)]
enum Made {
    Once(ClassId, Extent),
    /// A class with parameters, made where it is used.
    Parametric(Arc<Definition>),
}

impl Classes {
    pub(crate) fn contains(&self, name: Symbol) -> bool {
        self.find(name).is_some()
    }

    fn find(&self, name: Symbol) -> Option<usize> {
        let seen = self.seen.last().copied().unwrap_or(usize::MAX);
        self.by_name.get(&name).copied().filter(|index| *index < seen)
    }

    /// The class whose solid is being read, or none.
    pub(crate) fn name_current(&mut self, name: Option<Symbol>) {
        self.current = name;
    }

    pub(crate) fn is_current(&self, name: Symbol) -> bool {
        self.current == Some(name)
    }

    /// A class without parameters, and without errors.
    pub(crate) fn is_plain(&self, name: Symbol) -> bool {
        let class = self.find(name).map(|index| &self.list[index]);
        class.is_some_and(|class| matches!(class.made, Some(Made::Once(..))))
    }

    /// How many classes there are.
    pub(crate) fn count(&self) -> usize {
        self.list.len()
    }

    /// A class is made that sees the first `count` classes.
    pub(crate) fn enter(&mut self, count: usize) {
        self.seen.push(count);
    }

    pub(crate) fn leave(&mut self) {
        self.seen.pop();
    }
}

/// Classes looked through for what a misspelt name may have meant.
const COMPARED: usize = 10_000;

/// What has been said so far that a later statement may replace.
#[derive(Debug, Default)]
pub(crate) struct Resolver {
    /// Where the eye is.
    camera: Option<Spanned<DVec3>>,
    parallel: bool,
    lens: Option<ast::Lens>,
    target: Option<Spanned<DVec3>>,
    focal_length_mm: Option<Spanned<f64>>,
    ambient: Option<Spanned<Rgb>>,
    background: Option<Spanned<Rgb>>,
    fog: Option<Spanned<f64>>,
}

impl Resolver {
    /// Takes a statement into the scene.
    pub(crate) fn statement(&mut self, statement: Statement, included: bool, shared: &mut Shared) {
        let span = statement.span;
        match statement.kind {
            StatementKind::Include(_) => {}
            StatementKind::Class(class) => shared.class(class, span, included),
            StatementKind::Object(object) => {
                let solid = shared.bind(object.solid, span);
                if let Some((solid, _)) = solid
                    && shared.checking == 0
                {
                    let name = object.name.map(|name| shared.symbols.text(name.value).to_owned());
                    shared.scene.add_object(name, solid);
                    shared.object_spans.push(span);
                }
            }
            StatementKind::Light(light) => {
                if let Some(light) = checked_light(&light, span, shared)
                    && shared.checking == 0
                {
                    shared.scene.lights.push(light);
                    shared.light_spans.push(span);
                }
            }
            StatementKind::Camera { at, parallel, lens } => {
                replace(&mut self.camera, at, span, "camera", shared);
                self.parallel = parallel;
                self.lens = lens;
            }
            StatementKind::Target(at) => replace(&mut self.target, at, span, "target", shared),
            StatementKind::FocalLength(length) => {
                replace(&mut self.focal_length_mm, length, span, "focal length", shared);
            }
            StatementKind::Ambient(color) => {
                replace(&mut self.ambient, color, span, "ambient light", shared);
            }
            StatementKind::Background(color) => {
                replace(&mut self.background, color, span, "background", shared);
            }
            StatementKind::Fog(distance) => {
                replace(&mut self.fog, distance, span, "fog", shared);
            }
        }
    }

    /// Everything has been read.
    pub(crate) fn finish(self, shared: &mut Shared) {
        self.set_camera(shared);
        let value = |color: Option<Spanned<Rgb>>| color.map_or(Rgb::ZERO, |color| color.value);
        shared.scene.ambient = value(self.ambient);
        shared.scene.background = value(self.background);
        shared.scene.fog_half_distance = self.fog.map(|distance| distance.value);
        // What a missing file should have named is not unknown.
        let unknown = std::mem::take(&mut shared.classes.unknown);
        let unknown = if shared.incomplete { Vec::new() } else { unknown };
        for name in unknown {
            let unknown = unknown_class(&name, shared);
            shared.report(unknown);
        }
        shared.check_definitions();
        if shared.diagnostics.has_errors() {
            // What has errors may have used anything.
            return;
        }
        let Shared { classes, symbols, diagnostics, .. } = shared;
        for class in classes.list.iter().filter(|class| !class.used && !class.included) {
            let message = format!("class `{}` is never used", symbols.text(class.name.value));
            diagnostics.push(Diagnostic::warning(class.name.span, message));
        }
        if shared.cut {
            // Objects are missing.
            return;
        }
        survey::warn(self.camera.map(|camera| camera.span), shared);
        crate::precision::warn(shared);
    }

    fn set_camera(&self, shared: &mut Shared) {
        let Some(camera) = self.camera else { return };
        let target = self.target.map_or(DVec3::ZERO, |target| target.value);
        if !(target - camera.value).is_finite() {
            let message = "the camera is too far from its target for their distance to be a number";
            shared.report(Diagnostic::error(camera.span, message));
            return;
        }
        if camera.value == target {
            let error = match self.target {
                Some(target) => {
                    let (earlier, later) =
                        (camera.span.min(target.span), camera.span.max(target.span));
                    Diagnostic::error(later, "the camera stands at its target")
                        .note(earlier, "camera and target are the same point")
                }
                // The target may be a statement with an error.
                None if shared.diagnostics.has_errors() => return,
                None => {
                    Diagnostic::error(camera.span, "the camera stands at its target, the origin")
                        .hint("without `target at (x, y, z)` it looks at the origin".to_owned())
                }
            };
            shared.report(error);
            return;
        }
        let focal_length_mm =
            self.focal_length_mm.map_or(Camera::FOCAL_LENGTH_MM, |length| length.value);
        let (position, parallel) = (camera.value, self.parallel);
        let camera = Camera { position, target, focal_length_mm, parallel };
        shared.scene.lens = self.lens.and_then(|lens| checked_lens(&lens, &camera, shared));
        shared.scene.camera = Some(camera);
    }
}

/// The lens of a camera, or a report of what is wrong with it.
fn checked_lens(lens: &ast::Lens, camera: &Camera, shared: &mut Shared) -> Option<Lens> {
    if camera.parallel {
        let message = "parallel rays pass through no lens: everything is sharp";
        let error = Diagnostic::error(lens.aperture.span, message);
        shared.report(error.hint("leave out `aperture`, or `parallel`".to_owned()));
        return None;
    }
    let focus = lens.focus.map_or(camera.target, |focus| focus.value);
    let ahead = (focus - camera.position).dot(camera.target - camera.position);
    if !(ahead > 0.0 && ahead.is_finite()) {
        let span = lens.focus.map_or(lens.aperture.span, |focus| focus.span);
        let error = Diagnostic::error(span, "the focus is not in front of the camera");
        shared.report(error.hint("it is a point of what should be sharp".to_owned()));
        return None;
    }
    Some(Lens { aperture: lens.aperture.value, focus })
}

/// What a number from outside is for.
const GIVEN: &str = "-D gives the number of a `let` another value";

/// A class that is only checked.
const CHECKED: u32 = 0;

impl Shared {
    /// The names of all classes so far, as many as are compared with a misspelt one.
    pub(crate) fn class_names(&self) -> impl Iterator<Item = &str> {
        let classes = self.classes.list.iter().take(COMPARED);
        classes.map(|class| self.symbols.text(class.name.value))
    }

    /// The class of this name, used at `span`, if it has parameters.
    pub(crate) fn parametric(&mut self, name: Symbol, span: Span) -> Option<Arc<Definition>> {
        let index = self.classes.find(name)?;
        let class = &mut self.classes.list[index];
        let Some(Made::Parametric(definition)) = &class.made else { return None };
        class.used = true;
        self.record.refer(span, class.name.span);
        Some(Arc::clone(definition))
    }

    /// The instance of a class with these numbers, if it has been made, or need not be.
    pub(crate) fn made(&self, definition: &Definition, numbers: &[f64]) -> Option<u32> {
        if self.checking > 0 || numbers.iter().any(|number| number.is_nan()) {
            return Some(CHECKED);
        }
        self.classes.by_numbers.get(&key(definition, numbers)).copied()
    }

    /// How often something went wrong, for the first time or again.
    pub(crate) fn failures(&self) -> usize {
        self.diagnostics.errors() + self.classes.again.0
    }

    /// An instance has been made; before, something had gone wrong so often.
    pub(crate) fn remember_failure(&mut self, instance: u32, failures: usize) {
        if self.failures() == failures {
            return;
        }
        let last = self.diagnostics.last_error().or_else(|| self.classes.again.1.clone());
        self.classes.failed.extend(last.map(|said| (instance, said)));
    }

    /// A class is used at `span` with numbers that it has been made with before: what went wrong then, does here.
    pub(crate) fn repeat_failure(&mut self, instance: Option<u32>, name: Symbol, span: Span) {
        let said = instance.and_then(|instance| self.classes.failed.get(&instance)).cloned();
        let Some(said) = said else { return };
        let mut notes = vec![Use::Class { name, span }.note(&self.symbols)];
        notes.extend(self.use_notes());
        self.diagnostics.also(&said, notes);
        self.classes.again = (self.classes.again.0 + 1, Some(said));
    }

    /// What was given from outside has to be the number of a `let`.
    fn check_definitions(&mut self) {
        if self.diagnostics.has_errors() {
            // What could not be read may have named it.
            return;
        }
        let given = self.given.iter().filter(|(_, (_, used))| !used);
        let mut unused: Vec<Symbol> = given.map(|(&name, _)| name).collect();
        unused.sort_unstable();
        for name in unused {
            let text = self.symbols.text(name);
            let names = self.values.names();
            let names = names.iter().map(|&name| self.symbols.text(name));
            let hint = did_you_mean(closest(text, names.chain([Soft::Frame.text()])));
            let hint = hint.unwrap_or_else(|| GIVEN.to_owned());
            let message = format!("-D {0}: the scene has no `let {0}`", shortened(text));
            self.diagnostics.push(Diagnostic::nowhere(message).hint(hint));
        }
    }

    /// The class made of a solid that was read with these numbers, where it is used at `span`.
    pub(crate) fn make(
        &mut self,
        definition: &Definition,
        numbers: &[f64],
        solid: ast::Solid,
        span: Span,
    ) -> u32 {
        let instance = self.bind(solid, span).map(|(solid, extent)| {
            let texts: Vec<String> = numbers.iter().copied().map(number_text).collect();
            let name = format!("{}({})", self.symbols.text(definition.name), texts.join(","));
            (self.scene.add_class(name, solid), extent)
        });
        let instances = &mut self.classes.instances;
        if instances.is_empty() {
            instances.push(None);
        }
        let index = u32::try_from(instances.len()).expect("fewer than 2³² solids are made");
        instances.push(instance);
        self.classes.by_numbers.insert(key(definition, numbers), index);
        index
    }

    fn class(&mut self, class: ast::Class, span: Span, included: bool) {
        let name = class.name;
        self.classes.current = Some(name.value);
        self.checking += u32::from(class.definition.is_some());
        let solid = class.solid.and_then(|solid| self.bind(solid, span));
        self.checking -= u32::from(class.definition.is_some());
        self.classes.current = None;
        if let Some(&first) = self.classes.by_name.get(&name.value) {
            let message = format!("there is a class `{}` already", self.symbols.text(name.value));
            let first = self.classes.list[first].name.span;
            self.report(Diagnostic::error(name.span, message).note(first, "first named here"));
            return;
        }
        let made = match (solid, class.definition) {
            (None, _) => None,
            (Some(_), Some(definition)) => Some(Made::Parametric(definition)),
            (Some((solid, extent)), None) => {
                let text = self.symbols.text(name.value).to_owned();
                Some(Made::Once(self.scene.add_class(text, solid), extent))
            }
        };
        self.classes.by_name.insert(name.value, self.classes.list.len());
        self.classes.list.push(Class { name, made, used: false, included });
    }

    /// The solid with its names bound, and how far it reaches; nothing if it has errors. `span` is its statement.
    fn bind(&mut self, solid: ast::Solid, span: Span) -> Option<(Solid, Extent)> {
        let frames: Vec<Frame> = solid
            .frames
            .into_iter()
            .map(|frame| Frame {
                parent: frame.parent.map(FrameId),
                placement: frame.placement,
                attributes: frame.attributes,
            })
            .collect();
        let extents = extent::extents(&frames);
        let mut reach = Extent::NONE;
        let mut complete = true;
        // Whether each part by itself is in range; one that is not has said so.
        let mut parts = frames.iter().all(|frame| Extent::of(&frame.placement).is_fit());
        let mut nodes = Vec::with_capacity(solid.nodes.len());
        let mut forms = Solid::default();
        for node in solid.nodes {
            nodes.push(match node {
                ast::Node::Primitive { kind, frame } => {
                    reach = reach.with(extents[frame as usize]);
                    Node::Primitive { kind, frame: FrameId(frame) }
                }
                ast::Node::Form { form, frame } => {
                    reach = reach.with(extents[frame as usize]);
                    let form = forms.add_form(solid.forms[form as usize].clone());
                    Node::Form { form, frame: FrameId(frame) }
                }
                ast::Node::Named { name, span, frame } => {
                    let name = Spanned { value: name, span };
                    let Some((node, inner)) = self.named(name, FrameId(frame)) else {
                        complete = false;
                        continue;
                    };
                    reach = reach.with(extents[frame as usize].then(inner));
                    parts &= inner.is_fit();
                    node
                }
                ast::Node::Made { instance, frame } => {
                    let made = self.classes.instances.get(instance as usize).copied().flatten();
                    let Some((class, inner)) = made else {
                        // What is only checked goes on; what has errors has said so.
                        complete &= self.checking > 0;
                        nodes.push(Node::Primitive {
                            kind: Primitive::Sphere,
                            frame: FrameId(frame),
                        });
                        continue;
                    };
                    reach = reach.with(extents[frame as usize].then(inner));
                    parts &= inner.is_fit();
                    Node::Instance { class, frame: FrameId(frame) }
                }
                ast::Node::Union(n) => Node::Union(n),
                ast::Node::Intersection(n) => Node::Intersection(n),
                ast::Node::Complement => Node::Complement,
            });
        }
        if complete && parts && self.checking == 0 && !reach.is_fit() {
            let message = format!(
                "expected scales and places that multiply to less than {:e}, found more",
                extent::LIMIT
            );
            let error = Diagnostic::error(span, message);
            self.report(error.hint("scales multiply through groups and classes".to_owned()));
        }
        complete.then_some((Solid { frames, nodes, forms: forms.forms }, reach))
    }

    /// A class, or a solid whose name is not reserved.
    fn named(&mut self, name: Spanned<Symbol>, frame: FrameId) -> Option<(Node, Extent)> {
        if let Some(index) = self.classes.find(name.value) {
            let class = &mut self.classes.list[index];
            class.used = true;
            self.record.refer(name.span, class.name.span);
            let Some(Made::Once(id, extent)) = class.made else { return None };
            return Some((Node::Instance { class: id, frame }, extent));
        }
        if let Some(kind) = Primitive::named(self.symbols.text(name.value)) {
            return Some((Node::Primitive { kind, frame }, Extent::NONE));
        }
        if self.classes.current == Some(name.value) {
            let text = self.symbols.text(name.value);
            let message = format!("class `{text}` cannot be made of itself");
            self.report(Diagnostic::error(name.span, message));
        } else {
            let values = &self.values;
            let number =
                values.get(name.value).is_some() || values.known_inside(name.value).is_some();
            self.classes.unknown.push(Unknown { name, number });
        }
        None
    }
}

fn key(definition: &Definition, numbers: &[f64]) -> (Symbol, Box<[u64]>) {
    (definition.name, numbers.iter().map(|number| number.to_bits()).collect())
}

fn unknown_class(unknown: &Unknown, shared: &Shared) -> Diagnostic {
    let name = unknown.name;
    let is_number = unknown.number;
    let text = shared.symbols.text(name.value);
    let unknown = Diagnostic::error(name.span, format!("unknown class `{}`", shortened(text)));
    if let Some(&later) = shared.classes.by_name.get(&name.value) {
        return unknown
            .note(shared.classes.list[later].name.span, "it is named only here")
            .hint("a class can be used below the place where it is named".to_owned());
    }
    if is_number {
        let hint = format!("`{text}` is a number; {ARITHMETIC}");
        return unknown.hint(hint);
    }
    if let Some(habit) = habit::hint(text) {
        return unknown.hint(habit.to_owned());
    }
    if !shared.diagnostics.open() {
        return unknown;
    }
    let names = shared.class_names();
    let solids = Primitive::ALL.iter().flat_map(|solid| solid.keywords().iter().copied());
    let forms = FORMS.iter().map(|row| row.keyword);
    unknown.hint(did_you_mean(closest(text, names.chain(solids).chain(forms))))
}

/// Keeps what is said last, and warns that it replaces what was said before.
fn replace<T>(
    place: &mut Option<Spanned<T>>,
    value: T,
    span: Span,
    what: &str,
    shared: &mut Shared,
) {
    if let Some(earlier) = place.replace(Spanned { value, span }) {
        shared.report(
            Diagnostic::warning(span, format!("this {what} replaces an earlier one"))
                .note(earlier.span, "this one has no effect"),
        );
    }
}

/// The light, if its clauses fit its kind.
fn checked_light(light: &ast::Light, span: Span, shared: &mut Shared) -> Option<Light> {
    let mut fail = |diagnostic| {
        shared.report(diagnostic);
        None
    };
    let lacks = |kind: &str, clause: &str| {
        Diagnostic::error(span, format!("expected `{clause}` in a {kind} light, found none"))
            .hint(format!("add `{clause} (x, y, z)`"))
    };
    let aimed = |at: DVec3, toward: DVec3, place: Option<Span>| {
        let place = place.unwrap_or(span);
        if !(toward - at).is_finite() {
            let message = "`at` and `toward` are too far apart for their distance to be a number";
            return Some(Diagnostic::error(place, message));
        }
        (at == toward).then(|| {
            Diagnostic::error(place, "the light is aimed at the point it comes from").hint(
                "`at` and `toward` have to differ; one that is left out is the origin".to_owned(),
            )
        })
    };
    let kind = match light.kind {
        ast::LightKind::Point => {
            if let Some(toward) = light.toward {
                return fail(
                    Diagnostic::error(toward.span, "a point light shines in all directions")
                        .hint("`light beam` and `light spot` have a `toward`".to_owned()),
                );
            }
            match light.at {
                Some(at) => LightKind::Point { at: at.value },
                None => return fail(lacks("point", "at")),
            }
        }
        ast::LightKind::Beam => {
            let value = |end: Option<Spanned<DVec3>>| end.map_or(DVec3::ZERO, |end| end.value);
            let (at, toward) = (value(light.at), value(light.toward));
            if let Some(error) = aimed(at, toward, light.toward.or(light.at).map(|end| end.span)) {
                return fail(error);
            }
            LightKind::Beam { at, toward }
        }
        ast::LightKind::Spot { concentration, half_angle_degrees } => {
            let Some(at) = light.at else { return fail(lacks("spot", "at")) };
            let Some(toward) = light.toward else { return fail(lacks("spot", "toward")) };
            if let Some(error) = aimed(at.value, toward.value, Some(toward.span)) {
                return fail(error);
            }
            let (at, toward) = (at.value, toward.value);
            LightKind::Spot { at, toward, concentration, half_angle_degrees }
        }
    };
    Some(Light { kind, color: light.color, shadows: light.shadows, radius: light.radius })
}
