//! Blue noise on a coarse table: each pixel takes one of a pattern of entries whose mean is its
//! colour.
//!
//! Of few entries two rarely have a colour between them. A pattern takes as many as it needs: each
//! of its entries makes up for the error of those before it (Knoll, "Pattern dithering", US patent
//! 6606166, 1999, expired). In order of lightness, a threshold of the mask picks one.
//!
//! Each entry of a pattern waits for the one before it, and among few entries no search is shorter
//! than to try all: so the patterns of several pixels grow side by side.

use ilut::{Metric, Pixels, Table};
use rayon::prelude::*;

use crate::grid::{Grid, places};
use crate::hull::{Hull, MOST_ENTRIES};
use crate::mask;

/// Entries of a pattern. With 8, soft shades show steps; 32 take twice the time.
const LENGTH: u8 = 16;
/// Pixels whose patterns grow side by side: two registers of AVX2, as one would wait for itself.
const LANES: usize = 16;

/// The opaque entries of a table, dark ones first.
struct Ranked {
    places: Vec<[f32; 3]>,
    entries: Vec<u8>,
}

/// Replaces the nearest entries of opaque pixels.
pub(crate) fn dither(
    pixels: &Pixels,
    table: &Table,
    metric: Metric,
    strength: f32,
    (grid, hull): (&Grid, &Hull),
    indices: &mut [u8],
) {
    let columns = pixels.columns() as usize;
    let ranked = Ranked::of(table, grid);
    let rows = indices.par_chunks_mut(columns).zip(pixels.colors().par_chunks(columns));
    rows.enumerate().for_each_init(
        || (vec![[0.0; 4]; columns], Vec::new()),
        |(goals, dithered), (row, (indices, colors))| {
            places(colors, metric, goals);
            let thresholds = mask::row(row);
            dithered.clear();
            dithered.extend((0..columns).filter(|&column| {
                let near = table.colors()[usize::from(indices[column])];
                colors[column][3] == u8::MAX && near[3] == u8::MAX && near != colors[column]
            }));
            for columns in dithered.chunks(LANES) {
                // Lanes without a pixel repeat the first.
                let column = |lane| columns.get(lane).copied().unwrap_or(columns[0]);
                let pulled: [[f32; 4]; LANES] =
                    std::array::from_fn(|lane| hull.pulled(goals[column(lane)]));
                let goals = std::array::from_fn(|axis| pulled.map(|place| place[axis]));
                let places = std::array::from_fn(|lane| {
                    place_in_pattern(thresholds[column(lane) % mask::SIDE])
                });
                for (&column, entry) in columns.iter().zip(ranked.picked(&goals, strength, &places))
                {
                    indices[column] = entry;
                }
            }
        },
    );
}

impl Ranked {
    fn of(table: &Table, grid: &Grid) -> Self {
        let lightness = |entry: u8| {
            let [red, green, blue, _] = table.colors()[usize::from(entry)];
            ilut::oklab::from_srgb([red, green, blue])[0]
        };
        let mut entries = grid.opaque_entries().to_vec();
        entries.sort_by(|&a, &b| lightness(a).total_cmp(&lightness(b)));
        let place = |&entry: &u8| {
            let [x, y, z, _] = grid.places()[usize::from(entry)];
            [x, y, z]
        };
        Self { places: entries.iter().map(place).collect(), entries }
    }

    /// For each of several `goals`, given axis by axis, the entry at one of the `places` of its
    /// pattern in order of lightness.
    fn picked(
        &self,
        goals: &[[f32; LANES]; 3],
        strength: f32,
        places: &[u8; LANES],
    ) -> [u8; LANES] {
        let mut off = [[0.0; LANES]; 3];
        let mut times = [[0_u8; LANES]; MOST_ENTRIES];
        for _ in 0..LENGTH {
            let wanted: [[f32; LANES]; 3] = std::array::from_fn(|axis| {
                std::array::from_fn(|lane| goals[axis][lane] + strength * off[axis][lane])
            });
            for (lane, rank) in self.nearest(&wanted).into_iter().enumerate() {
                let rank = rank as usize;
                times[rank][lane] += 1;
                for axis in 0..3 {
                    off[axis][lane] += goals[axis][lane] - self.places[rank][axis];
                }
            }
        }
        // The rank at a place is the number of ranks that end at or before it.
        let (mut ends, mut ranks) = ([0_u8; LANES], [0_u8; LANES]);
        for times in &times[..self.places.len()] {
            for lane in 0..LANES {
                ends[lane] += times[lane];
                ranks[lane] += u8::from(ends[lane] <= places[lane]);
            }
        }
        ranks.map(|rank| self.entries[usize::from(rank)])
    }

    /// Rank of the entry nearest to each place, the darkest where several are.
    #[inline(always)]
    fn nearest(&self, wanted: &[[f32; LANES]; 3]) -> [u32; LANES] {
        let mut best = [f32::MAX; LANES];
        let mut ranks = [0; LANES];
        for (place, rank) in self.places.iter().zip(0..) {
            for lane in 0..LANES {
                let [x, y, z]: [f32; 3] =
                    std::array::from_fn(|axis| place[axis] - wanted[axis][lane]);
                let square = x * x + y * y + z * z;
                let nearer = square < best[lane];
                best[lane] = if nearer { square } else { best[lane] };
                ranks[lane] = if nearer { rank } else { ranks[lane] };
            }
        }
        ranks
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "thresholds are between 0 and 1"
)]
fn place_in_pattern(threshold: f32) -> u8 {
    (threshold * f32::from(LENGTH)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The entry for one goal the plain way: the whole pattern, sorted.
    fn plain(ranked: &Ranked, goal: [f32; 3], strength: f32, place: u8) -> u8 {
        let mut off = [0.0; 3];
        let mut pattern: Vec<usize> = (0..LENGTH)
            .map(|_| {
                let square = |at: usize| -> f32 {
                    let way =
                        |axis: usize| ranked.places[at][axis] - (goal[axis] + strength * off[axis]);
                    way(0) * way(0) + way(1) * way(1) + way(2) * way(2)
                };
                let all = 0..ranked.places.len();
                let at = all.min_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap();
                for axis in 0..3 {
                    off[axis] += goal[axis] - ranked.places[at][axis];
                }
                at
            })
            .collect();
        pattern.sort_unstable();
        ranked.entries[pattern[usize::from(place)]]
    }

    #[test]
    fn patterns_side_by_side_are_those_of_each_pixel() {
        let mut state = 7_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24).to_le_bytes()[0]
        };
        for count in [1, 2, 7, 16, MOST_ENTRIES] {
            let colors = (0..count).map(|_| [noise(), noise(), noise(), 255]).collect();
            let table = Table::new(colors).unwrap();
            for metric in Metric::ALL {
                let ranked = Ranked::of(&table, &Grid::new(&table, metric));
                let goals = std::array::from_fn(|_| std::array::from_fn(|_| f32::from(noise())));
                let places = std::array::from_fn(|_| noise() % LENGTH);
                let found = ranked.picked(&goals, 0.9, &places);
                for (lane, found) in found.into_iter().enumerate() {
                    let goal = goals.map(|axis: [f32; LANES]| axis[lane]);
                    assert_eq!(
                        found,
                        plain(&ranked, goal, 0.9, places[lane]),
                        "{count} {metric:?}"
                    );
                }
            }
        }
    }

    /// A third of the way from black to white, a third of all thresholds give white.
    #[test]
    fn shares_are_those_of_the_mean() {
        let table = Table::new(vec![[255; 4], [0, 0, 0, 255]]).unwrap();
        let ranked = Ranked::of(&table, &Grid::new(&table, Metric::Rgb));
        let white = |goal: f32| -> usize {
            let places = std::array::from_fn(|lane| u8::try_from(lane).unwrap());
            let picked = ranked.picked(&[[goal; LANES]; 3], 1.0, &places);
            picked.iter().filter(|&&entry| entry == 0).count()
        };
        assert_eq!([0.0, 51.0, 85.0, 127.0, 255.0].map(white), [0, 3, 5, 8, 16]);
    }
}
