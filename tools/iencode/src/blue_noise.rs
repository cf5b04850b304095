//! Blue noise: each pixel takes one of the two entries about it, by a threshold of the mask.
//!
//! In place of noise of one size for the whole table, what is mixed is the nearest entry with that
//! of its neighbours which comes closest to the pixel's colour on the way to it. So the noise is
//! as large as the table is coarse there, and a colour of the table stays as it is.

use ilut::{Metric, Pixels, Table};
use rayon::prelude::*;

use crate::dither::nearest;
use crate::grid::{Grid, places};
use crate::hull::Hull;
use crate::{mask, pattern};

/// Neighbours that an entry is mixed with.
const NEIGHBORS: usize = 16;
/// What the square of the noise counts against that of the error of the mean.
const NOISE: f32 = 0.3;

/// The opaque entries nearest to one entry: the ways to them, each coordinate apart.
#[derive(Clone, Debug)]
struct Neighbors {
    ways: [[f32; NEIGHBORS]; 3],
    squares: [f32; NEIGHBORS],
    /// One over the square, or 0 for a lane without an entry or with the same colour.
    inverses: [f32; NEIGHBORS],
    entries: [u8; NEIGHBORS],
}

/// An entry for each pixel.
pub(crate) fn indices(pixels: &Pixels, table: &Table, metric: Metric, strength: f32) -> Vec<u8> {
    let columns = pixels.columns() as usize;
    let mut indices = nearest(pixels, table, metric);
    let grid = Grid::new(table, metric);
    if let Some(hull) = Hull::of(&grid) {
        pattern::dither(pixels, table, metric, strength, (&grid, &hull), &mut indices);
        return indices;
    }
    let entries = grid.places();
    let neighbors: Vec<Neighbors> =
        entries.iter().map(|&place| Neighbors::of(place, table, entries)).collect();
    let rows = indices.par_chunks_mut(columns).zip(pixels.colors().par_chunks(columns));
    rows.enumerate().for_each_init(
        || vec![[0.0; 4]; columns],
        |row_places, (row, (indices, colors))| {
            let thresholds = mask::row(row);
            places(colors, metric, row_places);
            let pixels = indices.iter_mut().zip(&*row_places).zip(colors);
            for (column, ((index, place), color)) in pixels.enumerate() {
                let entry = usize::from(*index);
                if color[3] < u8::MAX || table.colors()[entry][3] < u8::MAX {
                    continue;
                }
                let past: [f32; 3] = std::array::from_fn(|axis| place[axis] - entries[entry][axis]);
                let (other, share) = neighbors[entry].mix(past);
                let threshold = thresholds[column % mask::SIDE];
                if share > 0.5 + strength * (threshold - 0.5) {
                    *index = other;
                }
            }
        },
    );
    indices
}

impl Neighbors {
    fn of(place: [f32; 4], table: &Table, entries: &[[f32; 4]]) -> Self {
        let way = |entry: usize| -> [f32; 3] {
            std::array::from_fn(|axis| entries[entry][axis] - place[axis])
        };
        let square = |entry: usize| way(entry).iter().map(|w| w * w).sum::<f32>();
        let opaque = (0..entries.len()).filter(|&entry| table.colors()[entry][3] == u8::MAX);
        let mut nearest: Vec<usize> = opaque.filter(|&entry| square(entry) > 0.0).collect();
        nearest.sort_by(|&a, &b| square(a).total_cmp(&square(b)));
        let mut neighbors = Self {
            ways: [[0.0; NEIGHBORS]; 3],
            squares: [0.0; NEIGHBORS],
            inverses: [0.0; NEIGHBORS],
            entries: [0; NEIGHBORS],
        };
        for (lane, &entry) in nearest.iter().take(NEIGHBORS).enumerate() {
            for axis in 0..3 {
                neighbors.ways[axis][lane] = way(entry)[axis];
            }
            neighbors.squares[lane] = square(entry);
            neighbors.inverses[lane] = 1.0 / square(entry);
            neighbors.entries[lane] = u8::try_from(entry).expect("at most 256 entries");
        }
        neighbors
    }

    /// The neighbour to mix with where a colour is `past` the entry, and its share, 0 to 1/2.
    #[inline]
    fn mix(&self, past: [f32; 3]) -> (u8, f32) {
        let (mut gains, mut shares) = ([0.0; NEIGHBORS], [0.0; NEIGHBORS]);
        for lane in 0..NEIGHBORS {
            let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| self.ways[axis][lane]);
            let along = x * past[0] + y * past[1] + z * past[2];
            let share = (along * self.inverses[lane]).clamp(0.0, 0.5);
            // By how much the squared error of the mean shrinks, less the noise of the mix.
            let square = self.squares[lane];
            let noise = NOISE * share * (1.0 - share) * square;
            gains[lane] = share * (2.0 * along - share * square) - noise;
            shares[lane] = share;
        }
        let mut best = 0;
        for lane in 1..NEIGHBORS {
            best = if gains[lane] > gains[best] { lane } else { best };
        }
        (self.entries[best], if gains[best] > 0.0 { shares[best] } else { 0.0 })
    }
}
