//! Lazy evaluation of the expression along eight rays at once: the steps of [`super::seek`], lane by lane.
//!
//! The evaluation of one ray never looks at another, and a lane that is done only waits, so each lane has the bits that
//! its ray has alone. Scenes with shared classes are traced one ray at a time.

pub(super) mod crossing;
pub(crate) mod sides;

use std::cell::Cell;

use glam::DVec3;
use scene::{Eight, EightMask, FacedSpan, Lanes, Ray};

use crate::world::hierarchy::{BoxRay, EightBoxRays};
use crate::world::region::Region;
use crate::world::{LeafId, NodeId, Part, Step, World};

use super::Hit;
use super::event::Quest;
use super::scope::{ScopeId, Scopes};
use super::seek::{Room, Seeker};

/// A boundary in each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct EightHits {
    pub(super) t: Eight,
    /// [`LeafId`] as a number; below 0 where there is none.
    leaf: Eight,
    /// Face as a number.
    face: Eight,
}

impl EightHits {
    fn at(t: Eight) -> Self {
        Self { t, leaf: Eight::splat(-1.0), face: Eight::splat(0.0) }
    }

    fn none() -> Self {
        Self::at(Eight::splat(f64::INFINITY))
    }

    fn select(mask: EightMask, yes: Self, no: Self) -> Self {
        Self {
            t: Eight::select(mask, yes.t, no.t),
            leaf: Eight::select(mask, yes.leaf, no.leaf),
            face: Eight::select(mask, yes.face, no.face),
        }
    }
}

/// Leaves whose spans are remembered.
const SLOTS: usize = 16;

/// Spans of the leaves that were asked for last: an expression asks for the same ones again and again.
pub(crate) struct Spans {
    /// Packet and leaf that a span is of.
    tags: [Cell<u64>; SLOTS],
    spans: [Cell<FacedSpan<Eight>>; SLOTS],
    packet: Cell<u64>,
    /// For rays that are sought one after the other.
    room: Cell<Room>,
}

impl Spans {
    pub(crate) fn new() -> Self {
        Self {
            tags: [const { Cell::new(0) }; SLOTS],
            spans: std::array::from_fn(|_| Cell::new(FacedSpan::line())),
            packet: Cell::new(0),
            room: Cell::new(Room::default()),
        }
    }

    #[inline(always)]
    fn of(&self, world: &World, leaf: LeafId, ray: &Ray<Eight>, from: Eight) -> FacedSpan<Eight> {
        let slot = leaf as usize % SLOTS;
        let tag = self.packet.get() << 32 | u64::from(leaf);
        if self.tags[slot].get() != tag {
            let leaf = &world.leaves[leaf as usize];
            self.tags[slot].set(tag);
            // Of a solid that is not convex the next one asked for may be another.
            let forget = || self.tags[slot].set(0);
            self.spans[slot].set(leaf.span_or(ray, from, forget));
        }
        self.spans[slot].get()
    }
}

/// Eight rays and the world they look into.
pub(super) struct EightSeekers<'w, 's> {
    pub(super) world: &'w World,
    spans: &'s Spans,
    pub(super) rays: EightBoxRays,
    /// Boundaries count after this parameter.
    pub(super) start: Eight,
    /// Events count before this parameter.
    pub(super) limit: Eight,
    /// Where each ray is thought to start.
    media: Eight,
}

impl<'w, 's> EightSeekers<'w, 's> {
    /// The first `count` lanes are of matter; the others repeat the last of them.
    pub(super) fn new<'q>(
        world: &'w World,
        spans: &'s Spans,
        count: usize,
        quest: impl Fn(usize) -> &'q Quest,
    ) -> Self {
        spans.packet.set(spans.packet.get() + 1);
        let quests: [&Quest; Eight::LANES] = std::array::from_fn(|lane| quest(lane.min(count - 1)));
        let lanes = |vectors: [DVec3; Eight::LANES]| {
            [
                Eight::new(vectors.map(|v| v.x)),
                Eight::new(vectors.map(|v| v.y)),
                Eight::new(vectors.map(|v| v.z)),
            ]
        };
        let ray = Ray {
            origin: lanes(quests.map(|q| q.origin)),
            direction: lanes(quests.map(|q| q.direction)),
        };
        Self {
            world,
            spans,
            rays: EightBoxRays::new(ray, world.magnitude),
            start: Eight::new(quests.map(|q| q.start)),
            limit: Eight::new(quests.map(|q| q.limit)),
            media: Eight::new(quests.map(|quest| f64::from(quest.medium.0))),
        }
    }

    /// The ray of one lane.
    pub(super) fn lane(&self, lane: usize) -> Ray {
        let pick = |v: [Eight; 3]| v.map(|numbers| numbers.to_array()[lane]);
        Ray { origin: pick(self.rays.ray.origin), direction: pick(self.rays.ray.direction) }
    }

    /// The next boundary of any part strictly after `from`, before the ray's limit; at the limit where there is none.
    pub(super) fn next(&self, region: &Region, from: Eight, active: EightMask) -> EightHits {
        let mut best = EightHits::at(self.limit);
        region.part_boxes.nearest_of_eight(
            &self.rays,
            from,
            self.limit,
            active,
            &mut |item, lanes| {
                let part = &region.parts[item as usize];
                let hit = self.boundary(part, from, best.t, lanes);
                let nearer = Eight::and(lanes, hit.t.less(best.t));
                best = EightHits::select(nearer, hit, best);
                best.t
            },
        );
        best
    }

    #[inline]
    fn boundary(&self, part: &Part, from: Eight, limit: Eight, active: EightMask) -> EightHits {
        let start = EightHits::at(from);
        if let Step::Leaf(leaf) = self.world.node(part.node).step {
            return self.leaf_boundary(leaf, from);
        }
        let inside = self.media.is(f64::from(part.medium.0));
        let (first, second) = (Eight::and(active, inside), Eight::and(active, Eight::not(inside)));
        // Where the first try stays in place, the other one moves.
        let mut hits = EightHits::none();
        let mut entering = second;
        if first.any() {
            let out = self.seek_out(part.node, start, Eight::splat(f64::INFINITY), first);
            let left = Eight::and(first, from.less(out.t));
            hits = EightHits::select(left, out, hits);
            entering = Eight::or(second, Eight::and(first, Eight::not(left)));
        }
        if entering.any() {
            let entered = self.seek_in(part.node, start, limit, entering);
            hits = EightHits::select(entering, entered, hits);
            let stayed = Eight::and(second, entered.t.at_most(from));
            if stayed.any() {
                let out = self.seek_out(part.node, start, Eight::splat(f64::INFINITY), stayed);
                hits = EightHits::select(stayed, out, hits);
            }
        }
        hits
    }

    fn leaf_boundary(&self, leaf: LeafId, from: Eight) -> EightHits {
        let span = self.spans.of(self.world, leaf, &self.rays.ray, from);
        let ahead = Eight::and(span.from.less(span.to), from.less(span.to));
        let enters = from.less(span.from);
        let hit = EightHits {
            t: Eight::select(enters, span.from, span.to),
            leaf: Eight::splat(f64::from(leaf)),
            face: Eight::select(enters, span.from_face, span.to_face),
        };
        EightHits::select(ahead, hit, EightHits::none())
    }

    /// The least t at or after `from` inside of `node`; what lies at or beyond `limit` need not be told apart. What
    /// comes in lanes that are not `active` means nothing.
    fn seek_in(&self, node: NodeId, from: EightHits, limit: Eight, active: EightMask) -> EightHits {
        let world = self.world;
        match world.node(node).step {
            Step::Leaf(leaf) => {
                let span = self.spans.of(world, leaf, &self.rays.ray, from.t);
                let exists = span.from.less(span.to);
                let before = from.t.less(span.from);
                let enters = EightHits {
                    t: span.from,
                    leaf: Eight::splat(f64::from(leaf)),
                    face: span.from_face,
                };
                let hit = EightHits::select(before, enters, from);
                let found = Eight::or(
                    Eight::and(before, exists),
                    Eight::and(Eight::not(before), from.t.less(span.to)),
                );
                EightHits::select(found, hit, EightHits::none())
            }
            Step::Instance(_) => unreachable!("worlds with instances are traced one ray at a time"),
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let mut best = EightHits::at(limit);
                let mut visit = |item: u32, lanes: EightMask| {
                    let hit = self.seek_in(children[item as usize].node, from, best.t, lanes);
                    let nearer = Eight::and(lanes, hit.t.less(best.t));
                    best = EightHits::select(nearer, hit, best);
                    best.t
                };
                if let Some(tree) = hierarchy {
                    let tree = &world.hierarchies[tree as usize];
                    tree.nearest_of_eight(&self.rays, from.t, limit, active, &mut visit);
                } else {
                    let mut open = active;
                    for item in 0..count {
                        let to = visit(item, open);
                        open = Eight::and(open, from.t.less(to));
                        if !open.any() {
                            break;
                        }
                    }
                }
                EightHits::select(best.t.less(limit), best, EightHits::none())
            }
            Step::And { first, count } => self.seek_in_all((first, count), from, limit, active),
            Step::Chain(_) => self.alone(from, active, |seeker, ray, from, lane| {
                seeker.seek_in(node, ray, ScopeId::SCENE, from, limit.to_array()[lane])
            }),
        }
    }

    /// Factors leap over each other until all agree; in step, as each lane would alone.
    fn seek_in_all(
        &self,
        (first, count): (u32, u32),
        from: EightHits,
        limit: Eight,
        active: EightMask,
    ) -> EightHits {
        let children = self.world.children(first, count);
        let (one, all) = (Eight::splat(1.0), Eight::splat(f64::from(count)));
        let (mut at, mut agreed, mut found) = (from, Eight::splat(0.0), EightHits::none());
        let mut open = active;
        for child in children.iter().cycle() {
            open = Eight::and(open, at.t.less(limit));
            if !open.any() {
                break;
            }
            let next = if child.complemented {
                self.seek_out(child.node, at, limit, open)
            } else {
                self.seek_in(child.node, at, limit, open)
            };
            let moved = at.t.less(next.t);
            at = EightHits::select(Eight::and(open, moved), next, at);
            agreed = Eight::select(moved, one, agreed + one);
            let done = Eight::and(open, all.at_most(agreed));
            found = EightHits::select(done, at, found);
            open = Eight::and(open, Eight::not(done));
        }
        found
    }

    /// The least t at or after `from` outside of `node`; beyond `limit` need not be told apart.
    fn seek_out(
        &self,
        node: NodeId,
        from: EightHits,
        limit: Eight,
        active: EightMask,
    ) -> EightHits {
        let world = self.world;
        match world.node(node).step {
            Step::Leaf(leaf) => {
                let span = self.spans.of(world, leaf, &self.rays.ray, from.t);
                let inside = Eight::and(span.from.at_most(from.t), from.t.less(span.to));
                let leaves = EightHits {
                    t: span.to,
                    leaf: Eight::splat(f64::from(leaf)),
                    face: span.to_face,
                };
                EightHits::select(inside, leaves, from)
            }
            Step::Instance(_) => unreachable!("worlds with instances are traced one ray at a time"),
            Step::And { first, count } => {
                let mut best = EightHits::none();
                let mut open = active;
                for child in world.children(first, count) {
                    let hit = if child.complemented {
                        self.seek_in(child.node, from, best.t, open)
                    } else {
                        self.seek_out(child.node, from, best.t, open)
                    };
                    let nearer = Eight::and(open, hit.t.less(best.t));
                    best = EightHits::select(nearer, hit, best);
                    open = Eight::and(open, from.t.less(best.t));
                    if !open.any() {
                        break;
                    }
                }
                best
            }
            Step::Or { first, count, hierarchy } => {
                self.seek_out_all((first, count, hierarchy), from, limit, active)
            }
            Step::Chain(_) => self.alone(from, active, |seeker, ray, from, lane| {
                seeker.seek_out(node, ray, ScopeId::SCENE, from, limit.to_array()[lane])
            }),
        }
    }

    /// Seeks along one ray after the other.
    fn alone(
        &self,
        from: EightHits,
        active: EightMask,
        seek: impl Fn(&mut Seeker<'_>, &BoxRay, Hit, usize) -> Hit,
    ) -> EightHits {
        let room = self.spans.room.take();
        let mut seeker = Seeker { world: self.world, scopes: Scopes::empty(), room };
        let from_t = from.t.to_array();
        let (mut t, mut leaf, mut face) = (from_t, from.leaf.to_array(), from.face.to_array());
        for lane in (0..Eight::LANES).filter(|lane| active.bits() >> lane & 1 == 1) {
            let start = Hit { t: from_t[lane], ..Hit::NONE };
            let hit = seek(&mut seeker, &BoxRay::new(self.lane(lane)), start, lane);
            t[lane] = hit.t;
            if hit.t > from_t[lane] {
                (leaf[lane], face[lane]) = (f64::from(hit.leaf), hit.face.number());
            }
        }
        self.spans.room.set(seeker.room);
        EightHits { t: Eight::new(t), leaf: Eight::new(leaf), face: Eight::new(face) }
    }

    /// Jumps to the end of a term that holds the point, until none does.
    fn seek_out_all(
        &self,
        (first, count, hierarchy): (u32, u32, Option<u32>),
        from: EightHits,
        limit: Eight,
        active: EightMask,
    ) -> EightHits {
        let children = self.world.children(first, count);
        let mut at = from;
        let mut open = active;
        loop {
            let before = at.t;
            let mut visit = |item: u32, lanes: EightMask| {
                let lanes = Eight::and(lanes, at.t.less(limit));
                if lanes.any() {
                    let out = self.seek_out(children[item as usize].node, at, limit, lanes);
                    at = EightHits::select(lanes, out, at);
                }
                at.t
            };
            if let Some(tree) = hierarchy {
                let tree = &self.world.hierarchies[tree as usize];
                tree.stab_eight(&self.rays, before, open, &mut visit);
            } else {
                (0..count).for_each(|item| {
                    visit(item, open);
                });
            }
            let on = Eight::and(before.less(at.t), at.t.less(limit));
            open = Eight::and(open, on);
            if !open.any() {
                return at;
            }
        }
    }
}
