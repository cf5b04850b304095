//! Names bound to classes, lights and camera put together, and what can be said only of a whole scene.

use std::collections::HashMap;

use glam::DVec3;
use scene::{Camera, ClassId, Frame, FrameId, Light, LightKind, Node, Primitive, Rgb, Solid};

use crate::ast;
use crate::ast::{Spanned, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::extent::{self, Extent};
use crate::parse::Shared;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Symbol, shortened};

/// Classes named so far.
#[derive(Debug, Default)]
pub(crate) struct Classes {
    by_name: HashMap<Symbol, usize>,
    list: Vec<Class>,
}

#[derive(Debug)]
struct Class {
    name: Spanned<Symbol>,
    /// Nothing for a class with errors.
    id: Option<ClassId>,
    extent: Extent,
    used: bool,
    /// An included file offers more than one scene needs.
    included: bool,
}

impl Classes {
    pub(crate) fn contains(&self, name: Symbol) -> bool {
        self.by_name.contains_key(&name)
    }
}

/// Classes looked through for what a misspelt name may have meant.
const COMPARED: usize = 10_000;

/// What has been said so far that a later statement may replace.
#[derive(Debug, Default)]
pub(crate) struct Resolver {
    camera: Option<Spanned<DVec3>>,
    target: Option<Spanned<DVec3>>,
    focal_length_mm: Option<Spanned<f64>>,
    ambient: Option<Spanned<Rgb>>,
    background: Option<Spanned<Rgb>>,
    fog: Option<Spanned<f64>>,
    unknown: Vec<Spanned<Symbol>>,
    /// The class that is being bound.
    current: Option<Symbol>,
    /// A file is missing, and with it any number of classes.
    incomplete: bool,
}

impl Resolver {
    /// Some statements cannot be had.
    pub(crate) fn miss_file(&mut self) {
        self.incomplete = true;
    }

    /// Takes a statement into the scene.
    pub(crate) fn statement(&mut self, statement: Statement, included: bool, shared: &mut Shared) {
        let span = statement.span;
        match statement.kind {
            StatementKind::Include(_) => {}
            StatementKind::Class(class) => self.class(class, span, included, shared),
            StatementKind::Object(object) => {
                if let Some((solid, _)) = self.solid(object.solid, span, shared) {
                    let name = object.name.map(|name| shared.symbols.text(name.value).to_owned());
                    shared.scene.add_object(name, solid);
                }
            }
            StatementKind::Light(light) => {
                if let Some(light) = checked_light(&light, span, shared) {
                    shared.scene.lights.push(light);
                }
            }
            StatementKind::Camera(at) => replace(&mut self.camera, at, span, "camera", shared),
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
    pub(crate) fn finish(mut self, shared: &mut Shared) {
        self.set_camera(shared);
        let value = |color: Option<Spanned<Rgb>>| color.map_or(Rgb::ZERO, |color| color.value);
        shared.scene.ambient = value(self.ambient);
        shared.scene.background = value(self.background);
        shared.scene.fog_half_distance = self.fog.map(|distance| distance.value);
        // What a missing file should have named is not unknown.
        let unknown = if self.incomplete { Vec::new() } else { std::mem::take(&mut self.unknown) };
        for name in unknown {
            let unknown = unknown_class(name, shared);
            shared.diagnostics.push(unknown);
        }
        if shared.diagnostics.has_errors() {
            // What has errors may have used anything.
            return;
        }
        for class in shared.classes.list.iter().filter(|class| !class.used && !class.included) {
            let message =
                format!("class `{}` is never used", shared.symbols.text(class.name.value));
            shared.diagnostics.push(Diagnostic::warning(class.name.span, message));
        }
    }

    fn class(&mut self, class: ast::Class, span: Span, included: bool, shared: &mut Shared) {
        let name = class.name;
        self.current = Some(name.value);
        let solid = class.solid.and_then(|solid| self.solid(solid, span, shared));
        self.current = None;
        if let Some(&first) = shared.classes.by_name.get(&name.value) {
            let message = format!("there is a class `{}` already", shared.symbols.text(name.value));
            let first = shared.classes.list[first].name.span;
            shared
                .diagnostics
                .push(Diagnostic::error(name.span, message).note(first, "first named here"));
            return;
        }
        let (mut id, mut extent) = (None, Extent::NONE);
        if let Some((solid, reach)) = solid {
            let text = shared.symbols.text(name.value).to_owned();
            id = Some(shared.scene.add_class(text, solid));
            extent = reach;
        }
        shared.classes.by_name.insert(name.value, shared.classes.list.len());
        shared.classes.list.push(Class { name, id, extent, used: false, included });
    }

    /// The solid with its names bound, and how far it reaches; nothing if it has errors. `span` is its statement.
    fn solid(
        &mut self,
        solid: ast::Solid,
        span: Span,
        shared: &mut Shared,
    ) -> Option<(Solid, Extent)> {
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
        let mut nodes = Vec::with_capacity(solid.nodes.len());
        for node in solid.nodes {
            nodes.push(match node {
                ast::Node::Primitive { kind, frame } => {
                    reach = reach.with(extents[frame as usize]);
                    Node::Primitive { kind, frame: FrameId(frame) }
                }
                ast::Node::Named { name, span, frame } => {
                    let name = Spanned { value: name, span };
                    let Some((node, inner)) = self.named(name, FrameId(frame), shared) else {
                        complete = false;
                        continue;
                    };
                    reach = reach.with(extents[frame as usize].then(inner));
                    node
                }
                ast::Node::Union(n) => Node::Union(n),
                ast::Node::Intersection(n) => Node::Intersection(n),
                ast::Node::Complement => Node::Complement,
            });
        }
        let reported = reach.is_flat() && shared.diagnostics.has_errors();
        if complete && !reach.is_fit() && !reported {
            let message = format!(
                "expected scales and places that multiply to less than {:e}, found more",
                extent::LIMIT
            );
            shared.diagnostics.push(
                Diagnostic::error(span, message)
                    .hint("scales multiply through groups and classes".to_owned()),
            );
        }
        complete.then_some((Solid { frames, nodes }, reach))
    }

    /// A class, or a solid whose name is not reserved.
    fn named(
        &mut self,
        name: Spanned<Symbol>,
        frame: FrameId,
        shared: &mut Shared,
    ) -> Option<(Node, Extent)> {
        if let Some(&index) = shared.classes.by_name.get(&name.value) {
            let class = &mut shared.classes.list[index];
            class.used = true;
            return class.id.map(|id| (Node::Instance { class: id, frame }, class.extent));
        }
        if let Some(kind) = Primitive::named(shared.symbols.text(name.value)) {
            return Some((Node::Primitive { kind, frame }, Extent::NONE));
        }
        if self.current == Some(name.value) {
            let text = shared.symbols.text(name.value);
            let message = format!("class `{text}` cannot be made of itself");
            shared.diagnostics.push(Diagnostic::error(name.span, message));
        } else {
            self.unknown.push(name);
        }
        None
    }

    fn set_camera(&self, shared: &mut Shared) {
        let Some(camera) = self.camera else { return };
        let target = self.target.map_or(DVec3::ZERO, |target| target.value);
        if !(target - camera.value).is_finite() {
            let message = "the camera is too far from its target for their distance to be a number";
            shared.diagnostics.push(Diagnostic::error(camera.span, message));
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
            shared.diagnostics.push(error);
            return;
        }
        let focal_length_mm =
            self.focal_length_mm.map_or(Camera::FOCAL_LENGTH_MM, |length| length.value);
        shared.scene.camera = Some(Camera { position: camera.value, target, focal_length_mm });
    }
}

fn unknown_class(name: Spanned<Symbol>, shared: &Shared) -> Diagnostic {
    let text = shared.symbols.text(name.value);
    let unknown = Diagnostic::error(name.span, format!("unknown class `{}`", shortened(text)));
    if let Some(&later) = shared.classes.by_name.get(&name.value) {
        return unknown
            .note(shared.classes.list[later].name.span, "it is named only here")
            .hint("a class can be used below the place where it is named".to_owned());
    }
    if !shared.diagnostics.open() {
        return unknown;
    }
    let classes = shared.classes.list.iter().take(COMPARED);
    let names = classes.map(|class| shared.symbols.text(class.name.value));
    let solids = Primitive::ALL.iter().flat_map(|solid| solid.keywords().iter().copied());
    unknown.hint(did_you_mean(closest(text, names.chain(solids))))
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
        shared.diagnostics.push(
            Diagnostic::warning(span, format!("this {what} replaces an earlier one"))
                .note(earlier.span, "this one has no effect"),
        );
    }
}

/// The light, if its clauses fit its kind.
fn checked_light(light: &ast::Light, span: Span, shared: &mut Shared) -> Option<Light> {
    let mut fail = |diagnostic| {
        shared.diagnostics.push(diagnostic);
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
                "`at` and `toward` have to differ; without them a beam has the origin".to_owned(),
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
    Some(Light { kind, color: light.color, shadows: light.shadows })
}
