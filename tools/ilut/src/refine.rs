//! Rounds of k-means (Lloyd, "Least squares quantization in PCM", 1982).

use idf::Lut;
use rayon::prelude::*;

use crate::entries::{Entries, LANES, column};
use crate::points::{CHUNK, Group, Points};

/// What the points of some groups add to the entries that they are nearest to.
struct Sums<const D: usize> {
    weights: [f64; Lut::MOST],
    places: [[f64; D]; Lut::MOST],
    /// The point of the largest weighted square, and that square.
    worst: ([f32; D], f32),
}

/// Moves each place of `free` to the mean of the points that it is nearest to, `rounds` times. A
/// point counts by its weight times `emphasis` of its squared distance: a constant lessens the sum
/// of squares. Places of `locked` take part, but stay. A place without points moves to the point
/// that is served worst.
pub(crate) fn refine<const D: usize>(
    points: &Points<D>,
    locked: &[[f32; D]],
    free: &mut [[f32; D]],
    rounds: usize,
    emphasis: impl Fn(f32) -> f32 + Sync,
) {
    if free.is_empty() {
        return;
    }
    for _ in 0..rounds {
        // Sums are added chunk by chunk in order, so that no thread count changes the result.
        let entries = Entries::new((0..=u8::MAX).zip(locked.iter().chain(&*free).copied()));
        let chunks = points.groups.par_chunks(CHUNK);
        let sums: Vec<Sums<D>> =
            chunks.map(|groups| sums(points, groups, &entries, &emphasis)).collect();
        let mut worst: Vec<([f32; D], f32)> = sums.iter().map(|sums| sums.worst).collect();
        worst.sort_by(|a, b| a.1.total_cmp(&b.1));
        let whole = sums.into_iter().reduce(Sums::and).unwrap_or(Sums::NONE);
        for (place, at) in free.iter_mut().zip(locked.len()..) {
            match whole.mean(at) {
                Some(mean) => *place = mean,
                None => *place = worst.pop().map_or(*place, |worst| worst.0),
            }
        }
    }
}

fn sums<const D: usize>(
    points: &Points<D>,
    groups: &[Group<D>],
    entries: &Entries<D>,
    emphasis: impl Fn(f32) -> f32,
) -> Sums<D> {
    let mut sums = Sums::NONE;
    let mut near = Entries::EMPTY;
    for group in groups {
        entries.within(&group.ball, &mut near);
        let indices = near.indices();
        for block in &points.blocks[group.blocks.clone()] {
            let (positions, squares) = near.nearest_lanes(&block.places);
            let weights: [f32; LANES] =
                std::array::from_fn(|lane| block.weights[lane] * emphasis(squares[lane]));
            for lane in 0..LANES {
                let index = usize::from(indices[positions[lane] as usize]);
                let weight = f64::from(weights[lane]);
                sums.weights[index] += weight;
                for axis in 0..D {
                    sums.places[index][axis] += weight * f64::from(block.places[axis][lane]);
                }
                let served = squares[lane] * block.weights[lane];
                if served > sums.worst.1 {
                    sums.worst = (column(&block.places, lane), served);
                }
            }
        }
    }
    sums
}

impl<const D: usize> Sums<D> {
    const NONE: Self =
        Self { weights: [0.0; Lut::MOST], places: [[0.0; D]; Lut::MOST], worst: ([0.0; D], 0.0) };

    /// Those of two sets of groups; the worst point is that of the first.
    fn and(mut self, more: Self) -> Self {
        self.weights.iter_mut().zip(more.weights).for_each(|(sum, more)| *sum += more);
        let places = self.places.as_flattened_mut().iter_mut().zip(more.places.as_flattened());
        places.for_each(|(sum, more)| *sum += more);
        self
    }

    /// Mean of the points nearest to an entry, if there are any.
    #[expect(clippy::cast_possible_truncation, reason = "a mean is in the range of its points")]
    fn mean(&self, at: usize) -> Option<[f32; D]> {
        let weight = self.weights[at];
        (weight > 0.0).then(|| self.places[at].map(|sum| (sum / weight) as f32))
    }
}
