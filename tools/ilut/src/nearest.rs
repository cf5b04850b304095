//! `Nearest`: the entry of a table that is nearest to a colour.

use rayon::prelude::*;

use crate::entries::Entries;
use crate::histogram::key_points;
use crate::key::{CELLS, PLACES, key};
use crate::map::{BlockOf, Map};
use crate::points::Points;
use crate::unique::packed;
use crate::{Metric, Pixels, Table};

/// Finds the nearest entry of a table, exactly under a metric; the lowest index where several
/// are. Opaque colours get opaque entries as long as there are any.
#[derive(Clone, Debug)]
pub struct Nearest {
    metric: Metric,
    opaque: Entries<3>,
    all: Entries<4>,
}

/// Pixels that one thread does at a time.
const CHUNK: usize = 1 << 15;

impl Nearest {
    /// Prepares a table.
    pub fn new(table: &Table, metric: Metric) -> Self {
        let entries = || (0..=u8::MAX).zip(table.colors());
        let opaque = entries().filter(|(_, color)| color[3] == u8::MAX);
        let opaque = opaque.map(|(index, &[r, g, b, _])| (index, metric.place([r, g, b])));
        let all = entries().map(|(index, &color)| (index, metric.place_with_alpha(color)));
        Self { metric, opaque: Entries::new(opaque), all: Entries::new(all) }
    }

    /// Index of the entry nearest to `color` (sRGB bytes, straight, with alpha).
    pub fn index(&self, color: [u8; 4]) -> u8 {
        let [red, green, blue, alpha] = color;
        if alpha == u8::MAX && self.opaque.len() > 0 {
            self.opaque.nearest(self.metric.place([red, green, blue]))
        } else {
            self.all.nearest(self.metric.place_with_alpha(color))
        }
    }

    /// Indices of the entries nearest to the colours of a picture, in parallel.
    pub fn indices(&self, pixels: &Pixels) -> Vec<u8> {
        self.indices_by_map(pixels, &self.map(&occupied(pixels)))
    }

    /// As [`Self::indices`], by a map of all cells that the picture has.
    pub(crate) fn indices_by_map(&self, pixels: &Pixels, map: &Map) -> Vec<u8> {
        match map.block_of() {
            BlockOf::Few(blocks) => self.indices_by(pixels, |color| map.index(blocks, color)),
            BlockOf::Many(blocks) => self.indices_by(pixels, |color| map.index(blocks, color)),
        }
    }

    /// As [`Self::indices`], by one search for each opaque pixel: in order of their keys, so that
    /// neighbours share the entries that can be nearest.
    #[expect(clippy::cast_possible_truncation, reason = "the halves of 64 bits")]
    pub(crate) fn indices_by_color(&self, pixels: &Pixels) -> Vec<u8> {
        let mut indices = self.indices_by(pixels, |_| 0);
        if self.opaque.len() > 0 {
            let colors = pixels.colors().iter().zip(0_u64..);
            let opaque = colors.filter(|(color, _)| color[3] == u8::MAX);
            let mut keyed: Vec<u64> =
                opaque.map(|(&color, at)| u64::from(key(color)) << 32 | at).collect();
            keyed.sort_unstable();
            let keys: Vec<(u32, u32)> =
                keyed.iter().map(|keyed| ((keyed >> 32) as u32, 1)).collect();
            let (points, parents) = key_points(&keys, self.metric);
            let found = Points::new(&points, &parents).nearest(&self.opaque);
            for (keyed, index) in keyed.iter().zip(found) {
                indices[*keyed as u32 as usize] = index;
            }
        }
        indices
    }

    /// The map of opaque colours in the cells with `keys`, ascending.
    pub(crate) fn map(&self, keys: &[u32]) -> Map {
        Map::new(&self.opaque, self.metric, keys)
    }

    /// Opaque entries.
    pub(crate) fn opaque(&self) -> &Entries<3> {
        &self.opaque
    }

    /// Indices of a picture's colours, where `opaque` finds those of opaque ones as long as there
    /// are opaque entries.
    pub(crate) fn indices_by(
        &self,
        pixels: &Pixels,
        opaque: impl Fn([u8; 4]) -> u8 + Sync,
    ) -> Vec<u8> {
        let mut indices = vec![0; pixels.colors().len()];
        let chunks = pixels.colors().par_chunks(CHUNK).zip(indices.par_chunks_mut(CHUNK));
        if pixels.is_opaque() && self.opaque.len() > 0 {
            chunks.for_each(|(colors, indices)| {
                for (index, &color) in indices.iter_mut().zip(colors) {
                    *index = opaque(color);
                }
            });
        } else {
            chunks.for_each(|(colors, indices)| self.mixed(&opaque, colors, indices));
        }
        indices
    }

    /// Opaque colours by `opaque`, the others by search, with a memory of the last ones.
    fn mixed(&self, opaque: impl Fn([u8; 4]) -> u8, colors: &[[u8; 4]], indices: &mut [u8]) {
        const MEMORY: usize = 1 << 10;
        // Alpha 0 is in the memory from the start, so a free place cannot be taken for a colour.
        let mut memory = [(0, self.index([0; 4])); MEMORY];
        for (index, &color) in indices.iter_mut().zip(colors) {
            *index = if color[3] == u8::MAX && self.opaque.len() > 0 {
                opaque(color)
            } else {
                let packed = packed(color);
                let place = &mut memory[(packed.wrapping_mul(0x9e37_79b1) >> 22) as usize % MEMORY];
                if place.0 != packed {
                    *place = (packed, self.index(color));
                }
                place.1
            };
        }
    }
}

/// Keys of the cells that have opaque pixels, ascending.
fn occupied(pixels: &Pixels) -> Vec<u32> {
    const WORDS: usize = CELLS / 64;
    let shares = pixels.colors().par_chunks(CHUNK).fold(
        || Box::new([0_u64; WORDS]),
        |mut cells, colors| {
            for &color in colors.iter().filter(|color| color[3] == u8::MAX) {
                let cell = key(color) as usize / PLACES;
                cells[cell / 64 % WORDS] |= 1 << (cell % 64);
            }
            cells
        },
    );
    let cells = shares.reduce(
        || Box::new([0_u64; WORDS]),
        |mut cells, more| {
            cells.iter_mut().zip(more.iter()).for_each(|(word, more)| *word |= more);
            cells
        },
    );
    let bits = cells.iter().zip(0..).flat_map(|(&word, start)| {
        (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 64 * start + bit)
    });
    bits.collect()
}
