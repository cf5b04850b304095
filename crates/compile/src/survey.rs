//! Warnings about a whole scene: what is legal, but shows nothing. Each is given only where it is proved.

mod duplicate;
mod matte;
mod view;

use glam::DVec3;
use scene::{AttributesId, Bounds, LightKind, Map, Node, Primitive, Scene, Solid};

use crate::diagnostic::Diagnostic;
use crate::shared::Shared;
use crate::source::Span;
use duplicate::duplicates;
use matte::Matte;
use view::unseen;

/// Points this much of a primitive's size inside or outside of it are there for certain: matrices and places are rounded
/// at 2⁻⁵³ of the largest number in them, and 2²³ of these roundings do not add up to it.
const MARGIN: f64 = 1e-9;

/// Largest objects that are asked whether others are inside them.
const HIDING: usize = 16;

/// Steps that are taken to find out whether the camera is in a solid.
const STEPS: usize = 100_000;

/// Lights that are looked at.
const LIGHTS: usize = 256;

/// Adds the warnings that a scene without errors deserves; `camera` is where the camera is said.
pub(crate) fn warn(camera: Option<Span>, shared: &mut Shared) {
    let scene = &shared.scene;
    let said = scene.ambient != DVec3::ZERO
        || scene.background != DVec3::ZERO
        || scene.fog_half_distance.is_some()
        || !shared.values.names().is_empty();
    let survey = Survey::new(scene, said);
    let found = survey.all(&shared.object_spans, &shared.light_spans, camera);
    for warning in found {
        shared.diagnostics.push(warning);
    }
}

/// A primitive of an object that hides what is in it.
struct Hiding<'a> {
    object: usize,
    kind: Primitive,
    map: Map,
    bounds: Bounds,
    scene: &'a Scene,
}

struct Survey<'a> {
    scene: &'a Scene,
    classes: Vec<Bounds>,
    objects: Vec<Bounds>,
    /// Of each class, whether light may come through it.
    clear: Vec<bool>,
    hiding: Vec<Hiding<'a>>,
    /// Something was said of the surroundings, or a number named.
    said: bool,
}

impl<'a> Survey<'a> {
    fn new(scene: &'a Scene, said: bool) -> Self {
        let mut survey = Self {
            scene,
            classes: Vec::new(),
            objects: Vec::new(),
            clear: Vec::new(),
            hiding: Vec::new(),
            said,
        };
        for class in &scene.classes {
            let (bounds, clear) = survey.look(&class.solid);
            survey.classes.push(bounds);
            survey.clear.push(clear);
        }
        for (object, scene::Object { solid, .. }) in scene.objects.iter().enumerate() {
            let (bounds, clear) = survey.look(solid);
            survey.objects.push(bounds);
            if !clear {
                survey.hide(object, solid);
            }
        }
        survey
    }

    /// The box of a solid, empty where that is certain, and whether light may come through.
    fn look(&self, solid: &Solid) -> (Bounds, bool) {
        let maps = solid.maps();
        let boxes = solid.node_bounds(&maps, &self.classes);
        let bounds = if self.is_cut_away(solid, &maps, &boxes) {
            Bounds::EMPTY
        } else {
            boxes.last().copied().unwrap_or(Bounds::EMPTY)
        };
        let lets = |id: AttributesId| self.scene.attributes[id.0 as usize].transparency.is_some();
        let clear = solid.frames.iter().any(|frame| lets(frame.attributes))
            || solid.nodes.iter().any(
                |node| matches!(node, Node::Instance { class, .. } if self.clear[class.0 as usize]),
            );
        (bounds, clear)
    }

    /// True for `A - B - …` with A inside one of the primitives that are taken away.
    fn is_cut_away(&self, solid: &Solid, maps: &[Map], boxes: &[Bounds]) -> bool {
        let nodes = &solid.nodes;
        let Some(Node::Intersection(n)) = nodes.last() else { return false };
        // The operands from the last to the first: complements of one primitive each, and then the first.
        let mut end = nodes.len() - 1;
        let mut taken = Vec::new();
        for _ in 1..*n {
            let [.., Node::Primitive { kind, frame }, Node::Complement] = nodes[..end] else {
                return false;
            };
            taken.push((kind, maps[frame.0 as usize]));
            end -= 2;
        }
        // Taken away from itself.
        let whole = match nodes[..end] {
            [Node::Primitive { kind, frame }] => Some((kind, maps[frame.0 as usize])),
            _ => None,
        };
        let held = |(kind, map): &(Primitive, Map)| {
            whole == Some((*kind, *map)) || holds(*kind, map, &boxes[end - 1])
        };
        taken.iter().any(held)
    }

    /// Remembers the primitives of an object that is a union of them, if they are among the largest.
    fn hide(&mut self, object: usize, solid: &Solid) {
        if !solid.nodes.iter().all(|node| matches!(node, Node::Primitive { .. } | Node::Union(_))) {
            return;
        }
        let least = self.hiding.last().map_or(0.0, |last| last.bounds.half_extent());
        if self.hiding.len() == HIDING && self.objects[object].half_extent() <= least {
            return;
        }
        let maps = solid.maps();
        for node in &solid.nodes {
            let Node::Primitive { kind, frame } = *node else { continue };
            let map = maps[frame.0 as usize];
            let bounds = scene::bound::placed(kind, &map);
            let size = bounds.half_extent();
            let place = self.hiding.partition_point(|other| other.bounds.half_extent() >= size);
            if place < HIDING {
                self.hiding.insert(place, Hiding { object, kind, map, bounds, scene: self.scene });
                self.hiding.truncate(HIDING);
            }
        }
    }

    fn all(&self, objects: &[Span], lights: &[Span], camera: Option<Span>) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        for ((i, bounds), &span) in self.objects.iter().enumerate().zip(objects) {
            if bounds.is_empty() {
                let warning = Diagnostic::warning(span, "this object is empty");
                found.push(warning.hint("its parts leave no space, or share none".to_owned()));
            } else if let Some(other) = self.hiding.iter().find(|other| other.hides(i, bounds)) {
                let warning = Diagnostic::warning(span, "this object is hidden inside another");
                found.push(warning.note(objects[other.object], "it is inside this one"));
            }
        }
        if let (Some((object, clear)), Some(camera)) = (self.about_camera(), camera) {
            let what = if clear {
                "the camera is inside a clear solid"
            } else {
                "the camera is inside a solid"
            };
            let warning = Diagnostic::warning(camera, what);
            found.push(warning.note(objects[object], "it is inside this object"));
        }
        self.shapes(objects, &mut found);
        // A file of lights or of classes is for others to include.
        let empty = self.scene.classes.is_empty() && self.scene.lights.is_empty();
        if self.scene.objects.is_empty() && (camera.is_some() || empty && !self.said) {
            let message = "the scene has no objects";
            // The beginning of the main file stands for all of it.
            let warning = Diagnostic::warning(camera.unwrap_or_default(), message);
            found.push(warning.hint("it takes one, as in object is sphere".to_owned()));
        }
        let lit = self.objects.iter().any(|bounds| !bounds.is_empty());
        if lit {
            let all = self.scene.lights.iter().zip(lights).take(LIGHTS);
            for (light, &span) in all {
                if let Some(reason) = self.idle(light) {
                    let warning = Diagnostic::warning(span, "this light lights nothing");
                    found.push(warning.hint(reason.to_owned()));
                }
            }
        }
        found
    }

    /// What is said of whole objects beside others.
    fn shapes(&self, spans: &[Span], found: &mut Vec<Diagnostic>) {
        for (object, first) in duplicates(&self.scene.objects, &self.objects) {
            let message = "this object stands where an equal one stands";
            let warning = Diagnostic::warning(spans[object], message);
            found.push(if spans[object] == spans[first] {
                warning.hint("a turn of its repeat changes nothing".to_owned())
            } else {
                warning.note(spans[first], "this one is seen")
            });
        }
        for object in unseen(self.scene, &self.objects, &self.classes) {
            let warning = Diagnostic::warning(spans[object], "this object is out of view");
            found.push(warning.hint("neither it nor a shadow of it is in the picture".to_owned()));
        }
        let matte = Matte::new(self.scene);
        for (object, &span) in self.scene.objects.iter().zip(spans) {
            if matte.in_solid(self.scene, &object.solid) {
                let message = "the dullest surface lets no light through the clear body in it";
                let hint = "a body with `trans` is `shiniest` where nothing else is said of it";
                found.push(Diagnostic::warning(span, message).hint(hint.to_owned()));
            }
        }
    }

    /// Why a light lights nothing, if that is certain.
    fn idle(&self, light: &scene::Light) -> Option<&'static str> {
        if light.color == DVec3::ZERO {
            return Some("its intensity is 0, or its colour black");
        }
        let (LightKind::Point { at } | LightKind::Spot { at, .. }) = light.kind else {
            return None;
        };
        let point = Bounds { low: at, high: at };
        if light.shadows && self.hiding.iter().any(|body| holds(body.kind, &body.map, &point)) {
            return Some("it stands inside an object that lets no light out");
        }
        let LightKind::Spot { toward, half_angle_degrees, .. } = light.kind else { return None };
        let axis = scene::transform::unit(toward - at);
        let misses = |bounds: &Bounds| {
            bounds.is_empty() || misses(at, axis, half_angle_degrees.to_radians(), bounds)
        };
        self.objects.iter().all(misses).then_some("no object is in its cone")
    }

    /// The object that the camera is inside, if that is certain, and whether light may come through it.
    fn about_camera(&self) -> Option<(usize, bool)> {
        let eye = self.scene.camera?.position;
        let near = |bounds: &Bounds| bounds.contains(eye);
        let candidates = (0..self.objects.len()).filter(|&i| near(&self.objects[i]));
        let mut steps = STEPS;
        for object in candidates {
            let solid = &self.scene.objects[object].solid;
            if self.inside(solid, eye, &mut steps)? {
                let clear = self.look(solid).1;
                // Who looks out of a tank has put something into it.
                return (!clear || self.is_alone(object)).then_some((object, clear));
            }
        }
        None
    }

    /// True if no other object reaches into the box of this one.
    fn is_alone(&self, object: usize) -> bool {
        let others = self.objects.iter().enumerate().filter(|(other, _)| *other != object);
        others.map(|(_, bounds)| bounds.overlap(self.objects[object])).all(|b| b.is_empty())
    }

    /// Whether a point is inside a solid, for certain; nothing when it takes too many steps.
    fn inside(&self, solid: &'a Solid, point: DVec3, steps: &mut usize) -> Option<bool> {
        let mut levels = vec![Level { solid, next: 0, maps: solid.maps(), point }];
        // Of each operand, whether the point is inside; nothing where that is not certain.
        let mut known: Vec<Option<bool>> = Vec::new();
        while let Some(level) = levels.last_mut() {
            let Some(node) = level.solid.nodes.get(level.next) else {
                levels.pop();
                continue;
            };
            level.next += 1;
            *steps = steps.checked_sub(1)?;
            match *node {
                Node::Primitive { kind, frame } => {
                    known.push(side(kind, &level.maps[frame.0 as usize], level.point));
                }
                Node::Form { form, frame } => {
                    let map = &level.maps[frame.0 as usize];
                    let form = level.solid.form(form);
                    known.push(certain(map, level.point, |local| {
                        form.distance(local, |gradient| gradient.length())
                    }));
                }
                Node::Instance { class, frame } => {
                    let map = &level.maps[frame.0 as usize];
                    let bounds = self.classes[class.0 as usize];
                    if !scene::bound::moved(bounds, map).contains(level.point) {
                        known.push(Some(false));
                        continue;
                    }
                    let solid = &self.scene.classes[class.0 as usize].solid;
                    *steps = steps.checked_sub(solid.frames.len())?;
                    let point = map.inward(level.point);
                    levels.push(Level { solid, next: 0, maps: solid.maps(), point });
                }
                Node::Union(n) => join(&mut known, n, true),
                Node::Intersection(n) => join(&mut known, n, false),
                Node::Complement => {
                    let last = known.pop()?;
                    known.push(last.map(|inside| !inside));
                }
            }
        }
        Some(known.pop()? == Some(true))
    }
}

/// A solid that is being asked.
struct Level<'a> {
    solid: &'a Solid,
    next: usize,
    maps: Vec<Map>,
    /// In the space of the solid.
    point: DVec3,
}

/// Joins the last operands: one that is `decisive` decides, and otherwise one that is not certain.
fn join(known: &mut Vec<Option<bool>>, n: u32, decisive: bool) {
    let start = known.len().saturating_sub(n as usize);
    let operands = &known[start..];
    let joined = if operands.contains(&Some(decisive)) {
        Some(decisive)
    } else if operands.contains(&None) {
        None
    } else {
        Some(!decisive)
    };
    known.truncate(start);
    known.push(joined);
}

impl Hiding<'_> {
    /// True if a box of another object is wholly inside, and the camera is not.
    fn hides(&self, object: usize, bounds: &Bounds) -> bool {
        let outside = |eye: DVec3| side(self.kind, &self.map, eye) == Some(false);
        object != self.object
            && self.bounds.contains(bounds.low)
            && self.bounds.contains(bounds.high)
            // Parallel rays start all over a plane.
            && self.scene.camera.is_none_or(|camera| !camera.parallel && outside(camera.position))
            && holds(self.kind, &self.map, bounds)
    }
}

/// True if a box is inside a primitive for certain. Primitives are convex, so the corners tell.
fn holds(kind: Primitive, map: &Map, bounds: &Bounds) -> bool {
    bounds.corners().into_iter().all(|corner| side(kind, map, corner) == Some(true))
}

/// Whether a point is inside a primitive, if that is certain.
fn side(kind: Primitive, map: &Map, point: DVec3) -> Option<bool> {
    certain(map, point, |local| kind.distance(local, |gradient| gradient.length()))
}

/// Whether a point is inside a solid that stands by `map`, if its distance in the solid's own space makes that certain.
fn certain(map: &Map, point: DVec3, distance: impl Fn(DVec3) -> f64) -> Option<bool> {
    let local = map.inward(point);
    // Rounding of the place, in the primitive's own space, where it has size 1.
    let reach = map.magnitude.max(point.abs().max_element());
    let m = map.inverse;
    let shrink = (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element();
    let margin = MARGIN * (1.0 + local.abs().max_element() + reach * shrink);
    let distance = distance(local);
    if distance < -margin {
        Some(true)
    } else if distance > margin {
        Some(false)
    } else {
        None
    }
}

/// True if a box is outside of a cone from `at` along `axis` for certain: the sphere about it is.
fn misses(at: DVec3, axis: DVec3, half_angle: f64, bounds: &Bounds) -> bool {
    let way = 0.5 * (bounds.low + bounds.high) - at;
    let radius = 0.5 * (bounds.high - bounds.low).length();
    let distance = way.length();
    if distance <= radius {
        return false;
    }
    let off_axis = libm::acos((way.dot(axis) / distance).clamp(-1.0, 1.0));
    off_axis - libm::asin(radius / distance) > half_angle + MARGIN
}
