//! Counts and sums of opaque colours in the 2^18 cells of [`crate::key`].

use rayon::prelude::*;

use crate::key::{self, CELLS, PLACES, key};

/// Counts and sums of the opaque colours in each cell.
///
/// A word has the count and the sums of the low two bits of red, green and blue, 16 bits each, so
/// that one addition counts a pixel. A word whose count is beyond [`FULL`] is put aside. Sums of
/// integers are the same in any order.
#[derive(Debug)]
pub(crate) struct Cells {
    words: Vec<u64>,
    aside: Vec<(u32, u64)>,
    /// A bit for each cell that has colours: most have none, and are not looked at again.
    occupied: Vec<u64>,
}

/// Colours of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// Key of the cell: that of its colours without the place.
    pub(crate) key: u32,
    /// Pixels.
    pub(crate) count: u64,
    /// Mean of their colours.
    pub(crate) mean: [f32; 3],
}

/// A word whose count is at most this takes a weight of 8 bits: sums of two bits then stay below 16
/// bits.
const FULL: u64 = 1 << 13;

/// Bits of a word of [`Cells::occupied`].
const BITS: usize = 64;

/// Words of [`Cells::occupied`] that one thread does at a time.
const STRETCH: usize = 1 << 7;

/// What a colour at each place adds to the word of its cell.
const ADDENDS: [u64; PLACES] = {
    let mut addends = [0; PLACES];
    let mut place = 0;
    while place < PLACES {
        let low = place as u64;
        addends[place] = 1 | (low >> 4) << 16 | (low >> 2 & 3) << 32 | (low & 3) << 48;
        place += 1;
    }
    addends
};

impl Cells {
    pub(crate) fn new() -> Self {
        Self { words: vec![0; CELLS], aside: Vec::new(), occupied: vec![0; CELLS / BITS] }
    }

    /// Counts the opaque ones of `colors`, and gives the others to `rest`.
    pub(crate) fn add(&mut self, colors: &[[u8; 4]], mut rest: impl FnMut([u8; 4])) {
        for &color in colors {
            if color[3] == u8::MAX { self.add_one(color) } else { rest(color) }
        }
    }

    /// Counts `colors` as opaque.
    pub(crate) fn add_opaque(&mut self, colors: &[[u8; 4]]) {
        for &color in colors {
            self.add_one(color);
        }
    }

    /// Counts each of the opaque ones of `colors` several `times`, at most 255, and gives the
    /// others to `rest`.
    pub(crate) fn add_weighted(
        &mut self,
        colors: &[[u8; 4]],
        times: &[u8],
        mut rest: impl FnMut([u8; 4], u8),
    ) {
        for (&color, &times) in colors.iter().zip(times) {
            if color[3] == u8::MAX { self.add_times(color, times) } else { rest(color, times) }
        }
    }

    #[inline(always)]
    fn add_one(&mut self, color: [u8; 4]) {
        self.add_times(color, 1);
    }

    #[inline(always)]
    fn add_times(&mut self, color: [u8; 4], times: u8) {
        let key = key(color);
        let cell = key::cell(key) as usize;
        // The remainder lets the compiler leave the check of bounds out.
        let words: &mut [u64; CELLS] =
            self.words.as_mut_slice().try_into().expect("as many words as cells");
        let word = &mut words[cell % CELLS];
        // One look for two rare cases: 0 less 1 has all bits.
        if word.wrapping_sub(1) & FULL != 0 {
            if *word > 0 {
                self.aside.push((key::cell(key), *word));
                *word = 0;
            }
            self.occupied[cell / BITS] |= 1 << (cell % BITS);
        }
        *word += ADDENDS[key as usize % PLACES] * u64::from(times);
    }
}

/// Cells that have colours in any of `shares`, ascending by key.
pub(crate) fn occupied(shares: &[Cells]) -> Vec<Cell> {
    let mut aside: Vec<(u32, u64)> =
        shares.iter().flat_map(|share| share.aside.iter().copied()).collect();
    aside.sort_unstable();
    let stretches = (0..CELLS / BITS).into_par_iter().step_by(STRETCH);
    let stretches = stretches.map(|first| stretch(first, shares, &aside)).collect::<Vec<_>>();
    stretches.concat()
}

/// Those of the cells of [`STRETCH`] words of bits that have colours: their words of each share,
/// and `aside` those that were put aside.
fn stretch(first: usize, shares: &[Cells], aside: &[(u32, u64)]) -> Vec<Cell> {
    let occupied = |at: usize| shares.iter().fold(0, |bits, share| bits | share.occupied[at]);
    let words: Vec<u64> = (first..first + STRETCH).map(occupied).collect();
    let count = words.iter().map(|bits| bits.count_ones() as usize).sum();
    let mut cells = Vec::with_capacity(count);
    let key = |cell: usize| u32::try_from(cell).expect("18 bits");
    let start = aside.partition_point(|(cell, _)| *cell < key(first * BITS));
    let mut aside = aside[start..].iter().peekable();
    for (mut bits, at) in words.into_iter().zip(first..) {
        while bits != 0 {
            let cell = at * BITS + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let mut sums = [0; 4];
            let mut add = |word| {
                for (sum, more) in sums.iter_mut().zip(unpacked(word)) {
                    *sum += more;
                }
            };
            shares.iter().for_each(|share| add(share.words[cell]));
            while let Some((_, word)) = aside.next_if(|(other, _)| *other == key(cell)) {
                add(*word);
            }
            cells.push(Cell::new(key(cell), sums));
        }
    }
    cells
}

fn unpacked(word: u64) -> [u64; 4] {
    [word, word >> 16, word >> 32, word >> 48].map(|field| field & 0xffff)
}

impl Cell {
    /// A cell of its count and sums of low bits.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        reason = "counts are below 2^53, and a mean needs no more than 32 bits"
    )]
    fn new(key: u32, [count, red, green, blue]: [u64; 4]) -> Self {
        let [r, g, b] = key::base(key);
        let mean = [(r, red), (g, green), (b, blue)]
            .map(|(base, sum)| f32::from(base) + (sum as f64 / count as f64) as f32);
        Self { key, count, mean }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn sums_are_exact_however_they_are_shared_out() {
        // One colour often enough to be put aside several times, and a spread of others.
        let mut colors = vec![[255, 254, 7, 255]; 40_000];
        colors.extend((0..50_000_u32).map(|at| {
            let [a, b, c, _] = at.wrapping_mul(2_654_435_761).to_le_bytes();
            [a, b / 4, c, 255]
        }));
        let mut expected: BTreeMap<u32, [u64; 4]> = BTreeMap::new();
        for color in &colors {
            let sums = expected.entry(key::cell(key(*color))).or_default();
            sums[0] += 1;
            for channel in 0..3 {
                sums[channel + 1] += u64::from(color[channel]);
            }
        }
        for share in [5_000, 16_000, 90_000] {
            let shares = colors.chunks(share).map(|colors| {
                let mut cells = Cells::new();
                cells.add(colors, |_| unreachable!("all are opaque"));
                cells
            });
            let cells = occupied(&shares.collect::<Vec<_>>());
            assert_eq!(cells.len(), expected.len());
            for (cell, (&key, sums)) in cells.iter().zip(&expected) {
                assert_eq!((cell.key, cell.count), (key, sums[0]));
                for channel in 0..3 {
                    let mean = sums[channel + 1] as f64 / sums[0] as f64;
                    assert!((f64::from(cell.mean[channel]) - mean).abs() < 1e-4, "{cell:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_opaque_is_left_to_the_caller() {
        let mut rest = Vec::new();
        let mut cells = Cells::new();
        cells.add(&[[1, 2, 3, 254], [0, 0, 0, 0], [4, 5, 6, 255]], |color| rest.push(color));
        assert_eq!(rest, [[1, 2, 3, 254], [0, 0, 0, 0]]);
        let mut weighted = Cells::new();
        let mut rest = Vec::new();
        let colors = [[4, 5, 6, 255], [6, 5, 6, 255], [0, 0, 0, 9], [200, 0, 0, 255]];
        weighted.add_weighted(&colors, &[3, 1, 7, 255], |color, times| rest.push((color, times)));
        assert_eq!(rest, [([0, 0, 0, 9], 7)]);
        let red =
            Cell { key: key::cell(key([200, 0, 0, 255])), count: 255, mean: [200.0, 0.0, 0.0] };
        assert_eq!(occupied(&[weighted]), [Cell { key: 21, count: 4, mean: [4.5, 5.0, 6.0] }, red]);
        assert_eq!(occupied(&[cells]), [Cell { key: 21, count: 1, mean: [4.0, 5.0, 6.0] }]);
    }
}
