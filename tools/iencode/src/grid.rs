//! Nearest entry of a table to places between and beyond colours, by cells that are filled when a
//! place in them is first asked for.

use std::sync::{Mutex, PoisonError};

use ilut::{Metric, Table, oklab};

/// Length of a cell's edge, in display steps. With 3 or 6 dithering takes longer.
const EDGE: f32 = 4.0;
/// Entries of a block: as many are compared at once.
const LANES: usize = 8;
/// A coordinate beyond all places, for lanes without an entry.
const NOWHERE: f32 = 1e9;
/// Margin about the colours a display has. A place beyond is moved to its edge.
const MARGIN: f32 = 16.0;

/// Places of a table's opaque entries under a metric, and cells of those that may be nearest.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Place of each entry, in the order of the table; the fourth coordinate is 0.
    places: Vec<[f32; 4]>,
    /// The entries that are looked for.
    wanted: Vec<u8>,
    bounds: Bounds,
    counts: [usize; 3],
    /// For each cell the first block, shifted by [`BLOCK_BITS`], and the number of blocks; 0
    /// where it is not filled yet.
    cells: Vec<u32>,
    blocks: Vec<Block>,
}

/// Grids of one table for several threads. What a cell holds does not depend on when it is filled,
/// so any thread may go on with any grid.
#[derive(Debug)]
pub(crate) struct Grids {
    empty: Grid,
    used: Mutex<Vec<Grid>>,
}

/// The box of places, least and most of each coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) least: [f32; 4],
    pub(crate) most: [f32; 4],
}

/// 256 entries fill at most 32 blocks.
const BLOCK_BITS: u32 = 6;

/// Some entries that may be nearest, each coordinate apart.
#[derive(Clone, Copy, Debug)]
struct Block {
    places: [[f32; LANES]; 3],
    entries: [i32; LANES],
}

impl Bounds {
    /// All that a display shows, with a margin. In Oklab, a runs from -60 to 71 and b from -80
    /// to 51.
    fn of(metric: Metric) -> Self {
        let (least, most) = match metric {
            Metric::Rgb => ([0.0; 3], [255.0; 3]),
            Metric::Oklab => ([0.0, -60.0, -80.0], [255.0, 71.0, 51.0]),
        };
        let fourth = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        Self {
            least: fourth(least.map(|value| value - MARGIN)),
            most: fourth(most.map(|value| value + MARGIN)),
        }
    }

    /// The nearest place in the box.
    #[inline(always)]
    pub(crate) fn clamped(&self, place: [f32; 4]) -> [f32; 4] {
        std::array::from_fn(|axis| place[axis].max(self.least[axis]).min(self.most[axis]))
    }
}

impl Grid {
    /// No cell is filled yet. Only opaque entries are looked for.
    pub(crate) fn new(table: &Table, metric: Metric) -> Self {
        let bounds = Bounds::of(metric);
        let counts =
            std::array::from_fn(|axis| whole((bounds.most[axis] - bounds.least[axis]) / EDGE) + 1);
        let opaque = (0..=u8::MAX).zip(table.colors()).filter(|(_, color)| color[3] == u8::MAX);
        Self {
            places: table.colors().iter().map(|&color| place(color, metric)).collect(),
            wanted: opaque.map(|(entry, _)| entry).collect(),
            bounds,
            counts,
            cells: vec![0; counts.iter().product()],
            // A cell that is not filled is 0, so no cell begins at block 0.
            blocks: vec![Block::NONE],
        }
    }

    /// The box of places.
    pub(crate) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Place of each entry, in the order of the table.
    pub(crate) fn places(&self) -> &[[f32; 4]] {
        &self.places
    }

    /// The opaque entries.
    pub(crate) fn opaque_entries(&self) -> &[u8] {
        &self.wanted
    }

    /// Places of the opaque entries.
    pub(crate) fn opaque_places(&self) -> Vec<[f32; 3]> {
        let place = |&entry: &u8| {
            let [x, y, z, _] = self.places[usize::from(entry)];
            [x, y, z]
        };
        self.wanted.iter().map(place).collect()
    }

    /// How far an opaque entry is from the nearest other one: the median over all; 0 where there is
    /// one or none.
    pub(crate) fn spacing(&self) -> f32 {
        let square = |a: u8, b: u8| -> f32 {
            let [a, b] = [a, b].map(|entry| self.places[usize::from(entry)]);
            a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
        };
        let to_nearest = |&entry: &u8| {
            let others = self.wanted.iter().filter(|&&other| other != entry);
            others.map(|&other| square(entry, other)).fold(f32::MAX, f32::min)
        };
        let mut squares: Vec<f32> = self.wanted.iter().map(to_nearest).collect();
        squares.sort_unstable_by(f32::total_cmp);
        let median = squares.get(squares.len() / 2).filter(|_| squares.len() > 1);
        median.map_or(0.0, |square| square.sqrt())
    }

    /// Whether there is an opaque entry.
    pub(crate) fn has_opaque(&self) -> bool {
        !self.wanted.is_empty()
    }

    /// The opaque entry nearest to a place in the box; of those whose squared distances agree in
    /// their 15 highest bits, the first.
    #[inline(always)]
    pub(crate) fn nearest(&mut self, place: [f32; 4]) -> u8 {
        let along = |axis: usize| whole((place[axis] - self.bounds.least[axis]) * (1.0 / EDGE));
        let cell = (along(0) * self.counts[1] + along(1)) * self.counts[2] + along(2);
        let mut filled = self.cells[cell];
        if filled == 0 {
            filled = self.fill(cell);
        }
        let (first, count) = (filled >> BLOCK_BITS, filled & ((1 << BLOCK_BITS) - 1));
        let mut best = [i32::MAX; LANES];
        for block in &self.blocks[first as usize..(first + count) as usize] {
            for (lane, best) in best.iter_mut().enumerate() {
                let [x, y, z]: [f32; 3] =
                    std::array::from_fn(|axis| block.places[axis][lane] - place[axis]);
                let square = x * x + y * y + z * z;
                // The bits of floats that are not negative are in the order of the floats.
                let key = (square.to_bits().cast_signed() & !0xff) | block.entries[lane];
                *best = if key < *best { key } else { *best };
            }
        }
        let halves: [i32; LANES / 2] = std::array::from_fn(|i| best[i].min(best[i + LANES / 2]));
        let least = halves[0].min(halves[1]).min(halves[2].min(halves[3]));
        least.to_le_bytes()[0]
    }

    /// Finds the entries that are nearest to some place of a cell: those that are no farther from
    /// its centre than the nearest one by more than the cell's diagonal.
    #[cold]
    #[inline(never)]
    fn fill(&mut self, cell: usize) -> u32 {
        /// For the rounding of distances.
        const SLACK: f32 = 1.0001;
        let steps = [cell / (self.counts[1] * self.counts[2]), cell / self.counts[2], cell]
            .into_iter()
            .zip(self.counts)
            .map(|(steps, count)| steps % count);
        let mut centre = [0.0; 3];
        for ((centre, steps), least) in centre.iter_mut().zip(steps).zip(self.bounds.least) {
            let steps = u16::try_from(steps).expect("fewer than 256 / EDGE cells on an axis");
            *centre = least + (f32::from(steps) + 0.5) * EDGE;
        }
        let distance = |entry: u8| {
            let place = self.places[usize::from(entry)];
            let square: f32 = place.iter().zip(centre).map(|(a, b)| (a - b) * (a - b)).sum();
            square.sqrt()
        };
        let least = self.wanted.iter().map(|&entry| distance(entry)).fold(f32::MAX, f32::min);
        let most = (least + EDGE * 3.0_f32.sqrt()) * SLACK;
        let near: Vec<u8> =
            self.wanted.iter().copied().filter(|&entry| distance(entry) <= most).collect();
        let first = self.blocks.len();
        for entries in near.chunks(LANES) {
            let mut block = Block::NONE;
            for (lane, &entry) in entries.iter().enumerate() {
                block.entries[lane] = i32::from(entry);
                for axis in 0..3 {
                    block.places[axis][lane] = self.places[usize::from(entry)][axis];
                }
            }
            self.blocks.push(block);
        }
        let count = self.blocks.len() - first;
        let filled = first << BLOCK_BITS | count;
        self.cells[cell] = u32::try_from(filled).expect("fewer than 2^20 cells of 32 blocks");
        self.cells[cell]
    }
}

impl Grids {
    pub(crate) fn of(empty: Grid) -> Self {
        Self { empty, used: Mutex::new(Vec::new()) }
    }

    /// Works with a grid that no other thread has at the time.
    pub(crate) fn with(&self, work: impl FnOnce(&mut Grid)) {
        let used = || self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = used().pop();
        let mut grid = taken.unwrap_or_else(|| self.empty.clone());
        work(&mut grid);
        used().push(grid);
    }
}

impl Block {
    const NONE: Self = Self { places: [[NOWHERE; LANES]; 3], entries: [0; LANES] };
}

/// Place of a colour, its alpha aside.
fn place([red, green, blue, _]: [u8; 4], metric: Metric) -> [f32; 4] {
    let [x, y, z] = match metric {
        Metric::Rgb => [red, green, blue].map(f32::from),
        Metric::Oklab => oklab::from_srgb([red, green, blue]),
    };
    [x, y, z, 0.0]
}

/// Places of a row of colours, their alpha aside: the same bits as one by one, but several at
/// once.
pub(crate) fn places(colors: &[[u8; 4]], metric: Metric, places: &mut [[f32; 4]]) {
    const LANES: usize = 16;
    if metric == Metric::Rgb {
        for (place, &[red, green, blue, _]) in places.iter_mut().zip(colors) {
            *place = [f32::from(red), f32::from(green), f32::from(blue), 0.0];
        }
        return;
    }
    for (places, colors) in places.chunks_mut(LANES).zip(colors.chunks(LANES)) {
        let mut lanes = [[0.0; LANES]; 3];
        for (lane, &[red, green, blue, _]) in colors.iter().enumerate() {
            let light = oklab::linear([red, green, blue]);
            for axis in 0..3 {
                lanes[axis][lane] = light[axis];
            }
        }
        #[expect(clippy::needless_range_loop, reason = "the axes are apart, lane by lane")]
        for lane in 0..LANES {
            let place = oklab::from_linear([lanes[0][lane], lanes[1][lane], lanes[2][lane]]);
            for axis in 0..3 {
                lanes[axis][lane] = place[axis];
            }
        }
        for (lane, place) in places.iter_mut().enumerate() {
            *place = [lanes[0][lane], lanes[1][lane], lanes[2][lane], 0.0];
        }
    }
}

/// The opaque colour nearest to a place.
pub(crate) fn color(place: [f32; 3], metric: Metric) -> [u8; 3] {
    match metric {
        Metric::Rgb => place.map(rounded_byte),
        Metric::Oklab => oklab::to_srgb(place),
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 255.5")]
fn rounded_byte(value: f32) -> u8 {
    (value.clamp(0.0, 255.0) + 0.5) as u8
}

/// The whole part of a number of 0 or more.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most the edge of a box, and a negative rounding error becomes 0"
)]
pub(crate) fn whole(value: f32) -> usize {
    // The conversion to i32 is one instruction.
    (value as i32) as usize
}

#[expect(clippy::cast_possible_truncation, reason = "small numbers of the tests")]
#[cfg(test)]
mod tests {
    use super::*;

    fn square(a: [f32; 4], b: [f32; 4]) -> f64 {
        a.iter().zip(b).map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum()
    }

    /// A table in three clumps with repeated and transparent entries.
    fn table(state: &mut u64) -> Table {
        let mut noise = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695);
            (*state >> 56) as u8
        };
        let colors = (0..200_usize).map(|at| {
            let clump = [30, 120, 200][at % 3];
            let alpha = if at % 10 == 3 { 90 } else { 255 };
            [clump + noise() / 6, noise(), clump + noise() / 9, alpha]
        });
        Table::new(colors.chain([[0, 0, 0, 255]; 3]).collect()).unwrap()
    }

    #[test]
    fn the_nearest_opaque_entry_is_found_in_and_about_the_gamut() {
        let mut state = 5;
        for metric in Metric::ALL {
            let table = table(&mut state);
            let mut grid = Grid::new(&table, metric);
            let bounds = grid.bounds();
            for at in 0..20_000_u32 {
                let share = |prime: u32| f64::from(at.wrapping_mul(prime)) / 4_294_967_296.0;
                let place = [share(2_654_435_761), share(2_246_822_519), share(3_266_489_917), 0.0];
                let place: [f32; 4] = std::array::from_fn(|axis| {
                    let [least, most] = [bounds.least[axis], bounds.most[axis]].map(f64::from);
                    (least + (most - least) * place[axis]) as f32
                });
                let found = usize::from(grid.nearest(place));
                let opaque = table.colors().iter().zip(grid.places());
                let best = opaque.filter(|(color, _)| color[3] == 255);
                let best = best.map(|(_, &entry)| square(entry, place)).fold(f64::MAX, f64::min);
                assert_eq!(table.colors()[found][3], 255);
                // The comparison keeps 15 bits of the square.
                let ratio = square(grid.places()[found], place) / best;
                assert!(ratio < 1.0 + 1.0 / 16_384.0, "{metric:?} {place:?}: {ratio}");
            }
        }
    }

    #[test]
    fn an_entry_is_nearest_to_itself_and_the_first_of_equals() {
        let table = table(&mut 9);
        for metric in Metric::ALL {
            let mut grid = Grid::new(&table, metric);
            for (entry, color) in table.colors().iter().enumerate() {
                let first = table.colors().iter().position(|other| other == color);
                if color[3] == 255 {
                    assert_eq!(Some(usize::from(grid.nearest(grid.places()[entry]))), first);
                }
            }
        }
    }

    #[test]
    fn places_of_a_row_are_those_of_its_colors() {
        for metric in Metric::ALL {
            let colors: Vec<[u8; 4]> =
                (0..=255_u8).map(|i| [i, i.wrapping_mul(3), 255 - i, i]).collect();
            for length in [1, 15, 16, 17, 256] {
                let mut row = vec![[9.0; 4]; length];
                places(&colors[..length], metric, &mut row);
                for (found, &color) in row.iter().zip(&colors) {
                    assert_eq!(found.map(f32::to_bits), place(color, metric).map(f32::to_bits));
                }
            }
        }
    }

    #[test]
    fn spacing_is_the_median_way_to_the_next_entry() {
        let table = |colors: &[u8]| {
            Table::new(colors.iter().map(|&grey| [grey, 0, 0, 255]).collect()).unwrap()
        };
        let spacing = |colors: &[u8]| Grid::new(&table(colors), Metric::Rgb).spacing();
        // 10, 10, 20, 40: the third of them.
        assert!((spacing(&[0, 10, 30, 70]) - 20.0).abs() < 1e-6);
        assert!(spacing(&[7]).abs() < 1e-6);
    }
}
