//! Few entries moved outward, for a dither: it shows what lies between entries, and nothing of what
//! lies beyond them, where means of pixels never reach.

use rayon::prelude::*;

use crate::entries::{LANES, square};
use crate::hull::nearest_in_hull;
use crate::points::Points;

/// Most entries of a table that is spread. More of them have the picture's colours between them
/// already.
pub(crate) const MOST_ENTRIES: usize = 32;
/// What the square of a pixel's distance to its nearest entry counts, which becomes noise, against
/// that of its distance to the nearest mix, which stays as a wrong colour. By SSIMULACRA2 and DSSIM
/// of means of 4 x 4 pixels: less of it is better for 2 and 16 colours, more for 8.
const NOISE: f32 = 0.5;
/// Rounds. Entries move less and less.
const ROUNDS: usize = 20;
/// Steps of the search for a mix.
const STEPS: usize = 20;
/// Groups that one thread does at a time.
const CHUNK: usize = 128;

/// Where an entry is drawn, and by what weight.
#[derive(Clone, Copy, Default)]
struct Pull {
    weight: f64,
    way: [f64; 3],
}

/// Moves the places of `free` so that mixes of all entries, with those of `locked`, come near
/// to the points. `gamut` takes a place to the nearest one that a display can show.
///
/// An entry is drawn by what its mixes lack (as in archetypal analysis; Cutler and Breiman,
/// "Archetypal analysis", 1994), and a little by the pixels that it is nearest to.
pub(crate) fn spread(
    points: &Points<3>,
    locked: &[[f32; 3]],
    free: &mut [[f32; 3]],
    gamut: impl Fn([f32; 3]) -> [f32; 3],
) {
    let means = means(points);
    for _ in 0..ROUNDS {
        let entries: Vec<[f32; 3]> = locked.iter().chain(&*free).copied().collect();
        let chunks: Vec<Vec<Pull>> =
            means.par_chunks(CHUNK).map(|means| pulls(means, &entries)).collect();
        for (place, at) in free.iter_mut().zip(locked.len()..) {
            let (mut weight, mut way) = (0.0, [0.0; 3]);
            for pulls in &chunks {
                weight += pulls[at].weight;
                for (way, more) in way.iter_mut().zip(pulls[at].way) {
                    *way += more;
                }
            }
            if weight > 0.0 {
                let moved = std::array::from_fn(|axis| place[axis] + narrow(way[axis] / weight));
                let shown = gamut(moved);
                // Within a step it is the rounding to bytes.
                *place = if square(moved, shown) > 1.0 { shown } else { moved };
            }
        }
    }
}

/// Weighted means of the groups.
fn means(points: &Points<3>) -> Vec<([f32; 3], f32)> {
    let mean = |blocks: &[crate::points::Block<3>]| {
        let (mut weight, mut place) = (0.0, [0.0; 3]);
        for block in blocks {
            for lane in 0..LANES {
                weight += block.weights[lane];
                for (axis, sum) in place.iter_mut().enumerate() {
                    *sum += block.weights[lane] * block.places[axis][lane];
                }
            }
        }
        (place.map(|sum: f32| sum / weight), weight)
    };
    points.groups.iter().map(|group| mean(&points.blocks[group.blocks.clone()])).collect()
}

fn pulls(means: &[([f32; 3], f32)], entries: &[[f32; 3]]) -> Vec<Pull> {
    let mut pulls = vec![Pull::default(); entries.len()];
    let mut shares = Vec::new();
    for &(place, weight) in means {
        let mix = nearest_in_hull(place, entries, STEPS, &mut shares);
        let mut nearest = (0, f32::MAX);
        for (at, &entry) in entries.iter().enumerate() {
            let far = square(entry, place);
            nearest = if far < nearest.1 { (at, far) } else { nearest };
        }
        for (pull, &share) in pulls.iter_mut().zip(&shares) {
            pull.add(weight * share, place, mix);
        }
        pulls[nearest.0].add(NOISE * weight, place, entries[nearest.0]);
    }
    pulls
}

impl Pull {
    /// Draws from one place to another.
    fn add(&mut self, weight: f32, to: [f32; 3], from: [f32; 3]) {
        self.weight += f64::from(weight);
        for (axis, way) in self.way.iter_mut().enumerate() {
            *way += f64::from(weight * (to[axis] - from[axis]));
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a way between colours")]
fn narrow(way: f64) -> f32 {
    way as f32
}
