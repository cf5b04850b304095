//! Bounding volume coherence, the paper's: a ray most likely meets what the ray before it met, so the boxes of that are
//! not tested again. And rays of the picture are tested against rectangles in the picture.
//!
//! A box remembers in which tree of rays its content was last met, for each place in the tree. If that was the tree
//! before, it is taken as met; if its content turns out not to be met, it is forgotten and tested the next time. Whatever
//! is remembered, nothing that a ray meets is passed over.

use glam::DVec3;
use scene::rectangle::{Extent, Eye};
use scene::{Bounds, Camera, Map, Ray, View};

use super::scope::ScopeId;
use crate::world::hierarchy::Hierarchy;
use crate::world::{Node, World};

/// Memory of boxes at all places: as much as there are of both, or so much that they share. What is lost only costs a test.
const MOST_SLOTS: usize = 1 << 20;
/// Places in the tree of rays that are told apart.
const PLACES: u32 = 64;
/// The place of the first light's rays.
const LIGHTS: u32 = 32;

/// All boxes of a world, numbered: those of nodes first, then those of trees over the terms of unions, and that over the
/// scene.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    /// The first of each tree.
    trees: Vec<u32>,
    /// The first of the tree over the scene.
    scene: u32,
    count: u32,
}

impl Numbers {
    pub(super) fn of(world: &World) -> Self {
        let mut count = u32::try_from(world.nodes.len()).expect("nodes are numbered by u32");
        let mut next = |tree: &Hierarchy| {
            let first = count;
            count = count.saturating_add(tree.box_count());
            first
        };
        let trees = world.hierarchies.iter().map(&mut next).collect();
        let scene = next(&world.whole.part_boxes);
        Self { trees, scene, count }
    }

    /// The tree over the terms of a union, or over the scene, with the number of its first box.
    pub(super) fn tree<'w>(&self, world: &'w World, tree: Option<u32>) -> (&'w Hierarchy, u32) {
        match tree {
            Some(tree) => (&world.hierarchies[tree as usize], self.trees[tree as usize]),
            None => (&world.whole.part_boxes, self.scene),
        }
    }
}

/// What rays of one thread have met.
#[derive(Debug, Default)]
pub(crate) struct Coherence {
    /// For each box at each place the number of the last tree of rays in which it was met.
    stamps: Vec<u32>,
    /// Number of the tree of rays at each place.
    trees: Vec<u32>,
    place: u32,
    boxes: u32,
    /// Where each box of the scene's own space is seen.
    extents: Vec<Extent>,
    /// The eye and how it looks, where its rays start from one point.
    eye: Option<(DVec3, View)>,
    /// Where the ray is seen, if it is one of the picture.
    seen: Option<(f64, f64)>,
}

impl Coherence {
    pub(super) fn new(world: &World, numbers: &Numbers) -> Self {
        let from = world.view_from;
        let target = world.eye + (from.target - from.position);
        let eye = Eye::new(&Camera { position: world.eye, target, ..from });
        let extent = |bounds: &Bounds| eye.moved(bounds, &Map::IDENTITY);
        let mut extents: Vec<Extent> =
            world.nodes.iter().map(|node: &Node| extent(&node.bounds())).collect();
        let trees = world.hierarchies.iter().chain([&*world.whole.part_boxes]);
        for tree in trees {
            extents.extend((0..tree.box_count()).map(|number| extent(&tree.numbered(number))));
        }
        let eye = (!from.parallel).then(|| (world.eye, from.view(1, 1)));
        Self { extents, eye, ..Self::without_rectangles(numbers) }
    }

    /// Boxes are remembered, and no ray is tested against rectangles.
    pub(super) fn without_rectangles(numbers: &Numbers) -> Self {
        let all = (numbers.count as usize).saturating_mul(PLACES as usize);
        Self {
            // None was met in the tree before the first.
            stamps: vec![u32::MAX; all.clamp(1, MOST_SLOTS).next_power_of_two()],
            trees: vec![0; PLACES as usize],
            place: 0,
            boxes: numbers.count,
            extents: Vec::new(),
            eye: None,
            seen: None,
        }
    }

    /// The rays to come are at this level of their trees.
    pub(super) fn at_level(&mut self, level: u32) {
        self.place = level % LIGHTS;
    }

    /// The rays to come go to this light.
    pub(super) fn at_light(&mut self, light: usize) {
        let light = u32::try_from(light).unwrap_or(u32::MAX);
        self.place = LIGHTS + light % (PLACES - LIGHTS);
    }

    /// Another ray at the place.
    pub(super) fn start(&mut self, ray: &Ray) {
        let Some(tree) = self.trees.get_mut(self.place as usize) else { return };
        *tree = tree.wrapping_add(1);
        self.seen = None;
        let (0, Some((eye, view))) = (self.place, &self.eye) else { return };
        if ray.origin.map(f64::to_bits) == eye.to_array().map(f64::to_bits) {
            let direction = DVec3::from_array(ray.direction);
            let ahead = direction.dot(view.forward);
            self.seen = Some((direction.dot(view.right) / ahead, direction.dot(view.up) / ahead));
        }
    }

    /// Whether the ray passes by a box, if that is known without a look at it.
    pub(super) fn passes_by(&self, number: u32, scope: ScopeId) -> Option<bool> {
        if let (Some((x, y)), ScopeId::SCENE) = (self.seen, scope) {
            // Both sides of the comparison are rounded, and the eye is beside where it should be.
            const SLACK: f64 = 1e-9;
            match self.extents[number as usize] {
                Extent::None => return Some(true),
                Extent::Part(part) => {
                    let beyond = |low: f64, at: f64, high: f64| {
                        let slack = SLACK * (1.0 + at.abs());
                        at < low - slack || at > high + slack
                    };
                    let (low, high) = (part.low, part.high);
                    return Some(beyond(low.x, x, high.x) || beyond(low.y, y, high.y));
                }
                Extent::Whole => {}
            }
        }
        if scope != ScopeId::SCENE {
            // A box of a class stands in many places: that one of them was met says nothing of the others.
            return None;
        }
        let before = self.trees[self.place as usize].wrapping_sub(1);
        (self.stamps[self.slot(number)] == before).then_some(false)
    }

    /// The ray has met what is in a box.
    pub(super) fn hit(&mut self, number: u32) {
        if self.stamps.is_empty() {
            return;
        }
        let slot = self.slot(number);
        self.stamps[slot] = self.trees[self.place as usize];
    }

    fn slot(&self, number: u32) -> usize {
        // Boxes of one place lie together: a ray asks about many of them.
        self.place.wrapping_mul(self.boxes).wrapping_add(number) as usize & (self.stamps.len() - 1)
    }
}
