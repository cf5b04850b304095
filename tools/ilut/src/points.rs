//! Weighted places in groups of neighbours.

use std::ops::Range;

use rayon::prelude::*;

use crate::cut::Point;
use crate::entries::{Ball, Entries, LANES, Lanes};

/// Weighted places in groups of neighbours, laid out for the search of the nearest entry.
#[derive(Debug)]
pub(crate) struct Points<const D: usize> {
    pub(crate) blocks: Vec<Block<D>>,
    pub(crate) groups: Vec<Group<D>>,
}

/// Places searched for at once. Lanes of weight 0 repeat a place of the group.
#[derive(Clone, Debug)]
pub(crate) struct Block<const D: usize> {
    pub(crate) places: Lanes<D>,
    pub(crate) weights: [f32; LANES],
}

/// A run of blocks.
#[derive(Clone, Debug)]
pub(crate) struct Group<const D: usize> {
    pub(crate) blocks: Range<usize>,
    pub(crate) ball: Ball<D>,
}

/// Groups that one thread does at a time.
pub(crate) const CHUNK: usize = 64;

/// Most points of a group; finding candidates costs as much as about ten points.
const GROUP: usize = 64;

impl<const D: usize> Points<D> {
    /// Groups neighbours: runs of points of the same parent. `parents` are those of `points`.
    pub(crate) fn new(points: &[Point<D>], parents: &[u32]) -> Self {
        // Each group may have a block that is not full.
        let mut grouped =
            Self { blocks: Vec::with_capacity(points.len() / LANES), groups: Vec::new() };
        let mut rest = points;
        for run in parents.chunk_by(|a, b| a == b) {
            let (points, others) = rest.split_at(run.len());
            for group in points.chunks(GROUP) {
                grouped.push(group);
            }
            rest = others;
        }
        grouped
    }

    /// Index of the entry nearest to each point, in the order of the points.
    pub(crate) fn nearest(&self, entries: &Entries<D>) -> Vec<u8> {
        let chunks = self.groups.par_chunks(CHUNK).flat_map_iter(|groups| {
            let mut near = Entries::EMPTY;
            let mut indices = Vec::new();
            for group in groups {
                entries.within(&group.ball, &mut near);
                for block in &self.blocks[group.blocks.clone()] {
                    let (positions, _) = near.nearest_lanes(&block.places);
                    let points = positions.iter().zip(block.weights).filter(|(_, w)| *w > 0.0);
                    indices.extend(points.map(|(at, _)| near.indices()[*at as usize]));
                }
            }
            indices
        });
        chunks.collect()
    }

    fn push(&mut self, points: &[Point<D>]) {
        let start = self.blocks.len();
        self.blocks.extend(points.chunks(LANES).map(|points| {
            let lane = |lane| points.get(lane).unwrap_or(&points[0]);
            Block {
                places: std::array::from_fn(|axis| std::array::from_fn(|at| lane(at).place[axis])),
                weights: std::array::from_fn(|at| points.get(at).map_or(0.0, |p| p.weight)),
            }
        }));
        let ball = Ball::around(points.iter().map(|point| &point.place));
        self.groups.push(Group { blocks: start..self.blocks.len(), ball });
    }
}
