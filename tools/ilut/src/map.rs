//! `Map`: the nearest entry for every colour of the cells that a picture has.

use rayon::prelude::*;

use crate::Metric;
use crate::entries::{Ball, Entries, LANES, Lanes, column, square};
use crate::key::{self, CELLS, PLACES, key};
use crate::oklab;

/// The nearest entry for every colour of some cells, in two levels: a cell has a block, and a
/// block an index for each colour of the cell.
///
/// Blocks 0 to 255 have one index throughout, and most cells share them: so a lookup has no
/// branch, and the blocks of a picture of 12 megapixels take 1.2 MB instead of 16.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    block_of: BlockOf,
    blocks: Vec<[u8; PLACES]>,
}

/// The block of each cell. Of few blocks, as nearly always, numbers of half the size are half as
/// much to keep at hand.
#[derive(Clone, Debug)]
pub(crate) enum BlockOf {
    Few(Vec<u16>),
    Many(Vec<u32>),
}

/// What cells of one stretch of keys have: one index throughout, or the next of its blocks.
struct Stretch {
    cells: Vec<Option<u8>>,
    blocks: Vec<[u8; PLACES]>,
}

/// Colours of a cell in the space of the metric.
type CellPlaces = [Lanes<3>; PLACES / LANES];

/// Parents whose cells one thread does at a time.
const CHUNK: usize = 16;

impl Map {
    /// The map of the cells with `keys` (ascending) to opaque `entries`; of no cells where there
    /// are no entries.
    pub(crate) fn new(entries: &Entries<3>, metric: Metric, keys: &[u32]) -> Self {
        let keys = if entries.len() > 0 { keys } else { &[] };
        let parents: Vec<&[u32]> =
            keys.chunk_by(|a, b| key::parent(*a) == key::parent(*b)).collect();
        let stretches = parents.par_chunks(CHUNK).map(|parents| stretch(entries, metric, parents));
        let stretches: Vec<Stretch> = stretches.collect();
        let mut blocks: Vec<[u8; PLACES]> = (0..=u8::MAX).map(|index| [index; PLACES]).collect();
        let own: usize = stretches.iter().map(|stretch| stretch.blocks.len()).sum();
        let first = u32::from(u8::MAX) + 1;
        let block_of = if blocks.len() + own <= 1 << 16 {
            BlockOf::Few(block_of(keys, &stretches, first))
        } else {
            BlockOf::Many(block_of(keys, &stretches, first))
        };
        blocks.reserve_exact(own);
        stretches.iter().for_each(|stretch| blocks.extend(&stretch.blocks));
        Self { block_of, blocks }
    }

    /// The block of each cell.
    pub(crate) fn block_of(&self) -> &BlockOf {
        &self.block_of
    }

    /// Index of the entry nearest to an opaque colour of one of the cells, whose blocks are
    /// `block_of`.
    #[inline(always)]
    pub(crate) fn index<T: Copy + Into<u32>>(&self, block_of: &[T], color: [u8; 4]) -> u8 {
        let key = key(color) as usize;
        let block_of: &[T; CELLS] = block_of.try_into().expect("as many as cells");
        let block = block_of[key / PLACES % CELLS].into() as usize;
        self.blocks.as_flattened()[block * PLACES + key % PLACES]
    }
}

/// The block of each cell, where those of the stretches begin at `next`.
fn block_of<T: Copy + Default + TryFrom<u32>>(
    keys: &[u32],
    stretches: &[Stretch],
    mut next: u32,
) -> Vec<T> {
    let mut block_of = vec![T::default(); CELLS];
    let cells = stretches.iter().flat_map(|stretch| &stretch.cells);
    for (block, &key) in cells.zip(keys) {
        let number = T::try_from(block.map_or(next, u32::from)).ok();
        block_of[key as usize] = number.expect("blocks were counted");
        next += u32::from(block.is_none());
    }
    block_of
}

fn stretch(entries: &Entries<3>, metric: Metric, parents: &[&[u32]]) -> Stretch {
    let mut stretch = Stretch { cells: Vec::new(), blocks: Vec::new() };
    let (mut of_parent, mut of_cell) = (Entries::EMPTY, Entries::EMPTY);
    let mut cells: Vec<(CellPlaces, Ball<3>)> = Vec::new();
    for keys in parents {
        cells.clear();
        cells.extend(keys.iter().map(|&key| places(key, metric)));
        entries.within(&about(&cells), &mut of_parent);
        for (places, ball) in &cells {
            of_parent.within(ball, &mut of_cell);
            let near = of_cell.indices();
            if let [only] = *near {
                stretch.cells.push(Some(only));
                continue;
            }
            let mut block = [0; PLACES];
            for (block, places) in block.chunks_exact_mut(LANES).zip(places) {
                let (positions, _) = of_cell.nearest_lanes(places);
                for (index, position) in block.iter_mut().zip(positions) {
                    *index = near[position as usize];
                }
            }
            if block.iter().all(|&index| index == block[0]) {
                stretch.cells.push(Some(block[0]));
            } else {
                stretch.cells.push(None);
                stretch.blocks.push(block);
            }
        }
    }
    stretch
}

/// Colours of the cell with `key`, and a ball about them.
fn places(key: u32, metric: Metric) -> (CellPlaces, Ball<3>) {
    let base = key::base(key);
    let mut places: CellPlaces = [[[0.0; LANES]; 3]; PLACES / LANES];
    let mut low = (0_u8..64).map(|place| [place >> 4, place >> 2 & 3, place & 3]);
    for lanes in &mut places {
        let colors: [[u8; 3]; LANES] = std::array::from_fn(|_| {
            let low = low.next().unwrap_or_default();
            std::array::from_fn(|channel| base[channel] | low[channel])
        });
        *lanes = match metric {
            Metric::Rgb => transposed(&colors, |color| color.map(f32::from)),
            Metric::Oklab => oklab::lanes_from_linear(&transposed(&colors, oklab::linear)),
        };
    }
    // The box of a cell's corners is the cell in RGB, and close to it in Oklab; any centre is right.
    let last = PLACES / LANES - 1;
    let centre: [f32; 3] =
        std::array::from_fn(|axis| 0.5 * (places[0][axis][0] + places[last][axis][LANES - 1]));
    let mut farthest = [0.0; LANES];
    for lanes in &places {
        for (lane, farthest) in farthest.iter_mut().enumerate() {
            let square = square(column(lanes, lane), centre);
            *farthest = if square > *farthest { square } else { *farthest };
        }
    }
    let radius = farthest.iter().fold(0.0, |most, &d| if d > most { d } else { most }).sqrt();
    (places, Ball { centre, radius })
}

fn transposed(colors: &[[u8; 3]; LANES], place: impl Fn([u8; 3]) -> [f32; 3]) -> [[f32; LANES]; 3] {
    let places = colors.map(place);
    std::array::from_fn(|axis| std::array::from_fn(|lane| places[lane][axis]))
}

/// A ball about the balls of cells.
fn about(cells: &[(CellPlaces, Ball<3>)]) -> Ball<3> {
    let Ball { centre, .. } = Ball::around(cells.iter().map(|(_, ball)| &ball.centre));
    let reach = cells.iter().map(|(_, ball)| square(ball.centre, centre).sqrt() + ball.radius);
    Ball { centre, radius: reach.fold(0.0, |most, d| if d > most { d } else { most }) }
}
