//! Bounding volume coherence, the paper's: a ray most likely meets what the ray before it met, so the boxes of that are
//! not tested again. And rays of the picture are tested against rectangles in the picture.
//!
//! A box remembers in which tree of rays its content was last met, for each place in the tree. If that was the tree
//! before, it is taken as met; if its content turns out not to be met, it is forgotten and tested the next time. Whatever
//! is remembered, nothing that a ray meets is passed over.

use scene::rectangle::{Extent, Eye};
use scene::{Camera, Map, Ray};

use super::scope::ScopeId;
use crate::world::{NodeId, World};

/// Memory of boxes, shared by all of them: what is lost only costs a test.
const SLOTS: usize = 1 << 14;
/// Places in the tree of rays that are told apart.
const PLACES: u32 = 64;
/// The place of the first light's rays.
const LIGHTS: u32 = 32;

/// What rays of one thread have met.
#[derive(Debug, Default)]
pub(crate) struct Coherence {
    /// Box and place, and the number of the last tree in which it was met.
    stamps: Vec<(u32, u32)>,
    /// Number of the tree of rays at each place.
    trees: Vec<u32>,
    place: u32,
    /// Where each node of the scene's own space is seen.
    extents: Vec<Extent>,
    /// Where the ray is seen, if it is one of the picture.
    seen: Option<(f64, f64)>,
}

impl Coherence {
    pub(super) fn new(world: &World) -> Self {
        let from = world.view_from;
        let target = world.eye + (from.target - from.position);
        let eye = Eye::new(&Camera { position: world.eye, target, ..from });
        let extent = |node: &crate::world::Node| eye.moved(&node.bounds(), &Map::IDENTITY);
        Self { extents: world.nodes.iter().map(extent).collect(), ..Self::without_rectangles() }
    }

    /// Boxes are remembered, and no ray is tested against rectangles.
    pub(super) fn without_rectangles() -> Self {
        Self {
            stamps: vec![(u32::MAX, 0); SLOTS],
            trees: vec![0; PLACES as usize],
            place: 0,
            extents: Vec::new(),
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
    pub(super) fn start(&mut self, world: &World, ray: &Ray) {
        let Some(tree) = self.trees.get_mut(self.place as usize) else { return };
        *tree = tree.wrapping_add(1);
        let from = world.view_from;
        let bits = |point: [f64; 3]| point.map(f64::to_bits);
        let from_eye = bits(ray.origin) == bits(world.eye.to_array());
        let of_picture = self.place == 0 && from_eye && !from.parallel && !self.extents.is_empty();
        self.seen = of_picture.then(|| {
            let view = from.view(1, 1);
            let direction = glam::DVec3::from_array(ray.direction);
            let ahead = direction.dot(view.forward);
            (direction.dot(view.right) / ahead, direction.dot(view.up) / ahead)
        });
    }

    /// Whether the ray passes by a node, if that is known without a look at its box.
    pub(super) fn passes_by(&self, node: NodeId, scope: ScopeId) -> Option<bool> {
        if let (Some((x, y)), ScopeId::SCENE) = (self.seen, scope) {
            // Both sides of the comparison are rounded, and the eye is beside where it should be.
            const SLACK: f64 = 1e-9;
            match self.extents[node as usize] {
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
        let (tag, slot) = self.slot(node);
        (self.stamps[slot] == (tag, self.trees[self.place as usize].wrapping_sub(1)))
            .then_some(false)
    }

    /// The ray has met what is in the box of a node.
    pub(super) fn hit(&mut self, node: NodeId) {
        if self.stamps.is_empty() {
            return;
        }
        let (tag, slot) = self.slot(node);
        self.stamps[slot] = (tag, self.trees[self.place as usize]);
    }

    fn slot(&self, node: NodeId) -> (u32, usize) {
        let tag = node.wrapping_mul(PLACES).wrapping_add(self.place);
        // Multiplicative hashing (Knuth, The Art of Computer Programming, 6.4).
        (tag, (tag.wrapping_mul(0x9E37_79B1) >> 18) as usize % SLOTS)
    }
}
