//! Lazy evaluation of the expression along a ray, without lists and without memory.
//!
//! Two functions, dual to each other: the least t at or after a given one that is inside a solid, and the least that
//! is outside. A union seeks the nearest of its terms through its hierarchy; an intersection lets its factors leap over
//! each other until all agree. Spans are half-open, so a boundary belongs to what follows it.

use glam::DVec3;
use scene::Ray;

use super::Hit;
use super::chain::Active;
use super::scope::{ScopeId, Scopes};
use crate::world::hierarchy::BoxRay;
use crate::world::region::Region;
use crate::world::{Instance, LeafId, MediumId, NodeId, Part, Step, World};

/// A place for the scopes of the ray being traced.
pub(crate) struct Seeker<'w> {
    pub(crate) world: &'w World,
    pub(crate) scopes: Scopes,
    pub(super) room: Room,
}

/// Memory that chains use, kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Room {
    /// Places of the links that a ray meets.
    pub(super) met: Vec<u32>,
    pub(super) spare: Vec<Vec<Active>>,
}

impl Instance {
    pub(crate) fn box_ray(&self, ray: &BoxRay) -> BoxRay {
        BoxRay::new(self.map.ray_inward(&ray.ray))
    }
}

impl<'w> Seeker<'w> {
    pub(crate) fn new(world: &'w World) -> Self {
        Self { world, scopes: Scopes::new(), room: Room::default() }
    }

    /// The next boundary of any part strictly after `from`, before `limit`. `medium` is where the ray is thought to
    /// be: a hint on what to try first.
    pub(crate) fn next(
        &mut self,
        region: &Region,
        ray: &BoxRay,
        from: f64,
        limit: f64,
        medium: MediumId,
    ) -> Option<Hit> {
        let mut best = Hit { t: limit, ..Hit::NONE };
        region.part_boxes.nearest(ray, from, limit, &mut |item, _| {
            let part = region.parts[item as usize];
            let hit = self.boundary(&part, ray, from, best.t, medium);
            if hit.t < best.t {
                best = hit;
            }
            best.t
        });
        (best.leaf != LeafId::MAX).then_some(best)
    }

    /// The next boundary of one part strictly after `from`; at or beyond `limit` it may be anything there.
    #[inline]
    fn boundary(
        &mut self,
        part: &Part,
        ray: &BoxRay,
        from: f64,
        limit: f64,
        medium: MediumId,
    ) -> Hit {
        if let Step::Leaf(leaf) = self.world.node(part.node).step {
            let span = self.world.leaves[leaf as usize].span(&ray.ray, from);
            return if span.from >= span.to || from >= span.to {
                Hit::NONE
            } else if from < span.from {
                Hit { t: span.from, leaf, scope: ScopeId::SCENE, face: span.entered() }
            } else {
                Hit { t: span.to, leaf, scope: ScopeId::SCENE, face: span.left() }
            };
        }
        let start = Hit { t: from, ..Hit::NONE };
        let enter =
            |seeker: &mut Self| seeker.seek_in(part.node, ray, ScopeId::SCENE, start, limit);
        let leave = |seeker: &mut Self| {
            seeker.seek_out(part.node, ray, ScopeId::SCENE, start, f64::INFINITY)
        };
        if part.medium == medium {
            let out = leave(self);
            if out.t > from { out } else { enter(self) }
        } else {
            let inside = enter(self);
            if inside.t > from { inside } else { leave(self) }
        }
    }

    /// The least t at or after `from` inside of `node`; what lies at or beyond `limit` need not be told apart.
    pub(super) fn seek_in(
        &mut self,
        node: NodeId,
        ray: &BoxRay,
        scope: ScopeId,
        from: Hit,
        limit: f64,
    ) -> Hit {
        let world = self.world;
        match world.node(node).step {
            Step::Leaf(leaf) => {
                let span = world.leaves[leaf as usize].span(&ray.ray, from.t);
                if from.t < span.from {
                    if span.from < span.to {
                        Hit { t: span.from, leaf, scope, face: span.entered() }
                    } else {
                        Hit::NONE
                    }
                } else if from.t < span.to {
                    from
                } else {
                    Hit::NONE
                }
            }
            Step::Instance(number) => {
                let instance = &world.instances[number as usize];
                let inner = self.scopes.enter(scope, number, instance);
                let ray = instance.box_ray(ray);
                let hit = self.seek_in(instance.root, &ray, inner, from, limit);
                Hit { scope: self.scopes.leave(inner, hit.scope), ..hit }
            }
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let mut best = Hit { t: limit, ..Hit::NONE };
                let mut visit = |item: u32, _: f64| {
                    let node = children[item as usize].node;
                    let hit = self.seek_in(node, ray, scope, from, best.t);
                    if hit.t < best.t {
                        best = hit;
                    }
                    best.t
                };
                if let Some(tree) = hierarchy {
                    world.hierarchies[tree as usize].nearest(ray, from.t, limit, &mut visit);
                } else {
                    for item in 0..count {
                        if visit(item, limit) <= from.t {
                            break;
                        }
                    }
                }
                if best.t < limit { best } else { Hit::NONE }
            }
            Step::And { first, count } => {
                let children = world.children(first, count);
                let (mut at, mut agreed, mut k) = (from, 0, 0);
                while agreed < children.len() {
                    if at.t >= limit {
                        return Hit::NONE;
                    }
                    let child = children[k];
                    let next = if child.complemented {
                        self.seek_out(child.node, ray, scope, at, limit)
                    } else {
                        self.seek_in(child.node, ray, scope, at, limit)
                    };
                    if next.t > at.t {
                        at = next;
                        agreed = 1;
                    } else {
                        agreed += 1;
                    }
                    k = if k + 1 == children.len() { 0 } else { k + 1 };
                }
                at
            }
            Step::Chain(number) => {
                let chain = &world.chains[number as usize];
                self.seek_chain(chain, ray, scope, from, limit, true)
            }
        }
    }

    /// The least t at or after `from` outside of `node`; beyond `limit` need not be told apart.
    pub(super) fn seek_out(
        &mut self,
        node: NodeId,
        ray: &BoxRay,
        scope: ScopeId,
        from: Hit,
        limit: f64,
    ) -> Hit {
        let world = self.world;
        match world.node(node).step {
            Step::Leaf(leaf) => {
                let span = world.leaves[leaf as usize].span(&ray.ray, from.t);
                if span.from <= from.t && from.t < span.to {
                    Hit { t: span.to, leaf, scope, face: span.left() }
                } else {
                    from
                }
            }
            Step::Instance(number) => {
                let instance = &world.instances[number as usize];
                let inner = self.scopes.enter(scope, number, instance);
                let ray = instance.box_ray(ray);
                let hit = self.seek_out(instance.root, &ray, inner, from, limit);
                Hit { scope: self.scopes.leave(inner, hit.scope), ..hit }
            }
            Step::And { first, count } => {
                let mut best = Hit::NONE;
                for child in world.children(first, count) {
                    let hit = if child.complemented {
                        self.seek_in(child.node, ray, scope, from, best.t)
                    } else {
                        self.seek_out(child.node, ray, scope, from, best.t)
                    };
                    if hit.t < best.t {
                        best = hit;
                        if best.t <= from.t {
                            break;
                        }
                    }
                }
                best
            }
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let mut at = from;
                // Jump to the end of a term that holds the point, until none does.
                loop {
                    let before = at.t;
                    let mut visit = |item: u32, _: f64| {
                        if at.t < limit {
                            at = self.seek_out(children[item as usize].node, ray, scope, at, limit);
                        }
                        at.t
                    };
                    if let Some(tree) = hierarchy {
                        world.hierarchies[tree as usize].stab(ray, before, &mut visit);
                    } else {
                        for item in 0..count {
                            visit(item, before);
                        }
                    }
                    if at.t <= before || at.t >= limit {
                        return at;
                    }
                }
            }
            Step::Chain(number) => {
                let chain = &world.chains[number as usize];
                self.seek_chain(chain, ray, scope, from, limit, false)
            }
        }
    }
}

/// A ray of the scene, ready for box tests.
pub(crate) fn box_ray(origin: DVec3, direction: DVec3) -> BoxRay {
    BoxRay::new(Ray::new(origin, direction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Accel;
    use crate::trace::merge::Lists;
    use scene::form::Row;
    use scene::{Form, Frame, FrameId, Node, Placement, Primitive, Scene, Solid};

    /// A fixed sequence of numbers below `n`.
    struct Numbers(u64);

    impl Numbers {
        fn below(&mut self, n: u32) -> u32 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            u32::try_from(self.0 >> 40).unwrap() % n
        }

        fn lattice(&mut self) -> f64 {
            f64::from(self.below(9)) * 0.5 - 2.0
        }
    }

    fn form(solid: &mut Solid, word: &str, arguments: &[f64], frame: FrameId) -> Node {
        let form = Form::new(Row::named(word).unwrap(), arguments).unwrap();
        Node::Form { form: solid.add_form(form), frame }
    }

    /// A random expression over solids on a half-unit lattice: many faces coincide.
    fn solid(numbers: &mut Numbers, leaves: u32) -> Solid {
        let mut solid = Solid::default();
        let mut open = 0;
        for _ in 0..leaves {
            let placement = Placement {
                scale: DVec3::new(0.5, 1.0, 1.5) * f64::from(1 + numbers.below(2)),
                rotation_degrees: DVec3::splat(90.0 * f64::from(numbers.below(4))),
                place: DVec3::new(numbers.lattice(), numbers.lattice(), numbers.lattice()),
            };
            let attributes = scene::AttributesId::NONE;
            solid.frames.push(Frame { parent: None, placement, attributes });
            let frame = FrameId(u32::try_from(solid.frames.len() - 1).unwrap());
            let node = match numbers.below(7) {
                4 => form(&mut solid, "torus", &[0.5], frame),
                5 => form(&mut solid, "terrain", &[3.0, 0.6, 2.0], frame),
                6 => {
                    let bay = [-1.0, -1.0, 1.0, -1.0, 1.0, 1.0, 0.5, 1.0, 0.0, -0.5, -1.0, 1.0];
                    form(&mut solid, "prism", &bay, frame)
                }
                kind => Node::Primitive { kind: Primitive::ALL[kind as usize], frame },
            };
            solid.nodes.push(node);
            open += 1;
            while open > 1 && numbers.below(3) > 0 {
                match numbers.below(6) {
                    0..=3 => solid.nodes.push(Node::Union(2)),
                    4 => solid.nodes.push(Node::Intersection(2)),
                    _ => solid.nodes.extend([Node::Complement, Node::Intersection(2)]),
                }
                open -= 1;
            }
        }
        if open > 1 {
            solid.nodes.push(Node::Union(open));
        }
        solid
    }

    #[test]
    fn seeking_finds_what_merging_finds() {
        let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
        let mut boundaries = 0;
        for leaves in (2..60).chain(200..204) {
            let mut scene = Scene::default();
            scene.add_object(None, solid(&mut numbers, leaves));
            scene.camera = Some(scene::Camera {
                parallel: false,
                position: DVec3::ZERO,
                target: DVec3::NEG_Z,
                focal_length_mm: 50.0,
            });
            let world = World::load(&scene).unwrap();
            let mut seeker = Seeker::new(&world);
            let ways = [
                Accel::None,
                Accel::Boxes,
                Accel::Flat,
                Accel::Slanted,
                Accel::Coherence,
                Accel::Remembered,
            ];
            let mut lists = ways.map(|accel| Lists::new(&world, accel));
            for _ in 0..100 {
                let mut point =
                    || DVec3::new(numbers.lattice(), numbers.lattice(), numbers.lattice());
                let (from, to) = (point() * 4.0, point() + DVec3::splat(0.01));
                let ray = box_ray(from, (to - from).normalize_or(DVec3::X));
                for list in &mut lists {
                    list.find(&mut seeker, &ray, 0.0);
                }
                let mut at = 0.0;
                loop {
                    let sought = seeker
                        .next(&world.whole, &ray, at, f64::INFINITY, MediumId::AIR)
                        .map(|hit| hit.t.to_bits());
                    for list in &lists {
                        let merged = list.next(at, f64::INFINITY).map(|hit| hit.t.to_bits());
                        assert_eq!(sought, merged, "{leaves} leaves after {at}");
                    }
                    let Some(t) = sought else { break };
                    at = f64::from_bits(t);
                    boundaries += 1;
                }
            }
        }
        assert!(boundaries > 5000, "{boundaries} boundaries say something");
    }
}
