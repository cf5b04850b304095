//! Contrast-limited adaptive histogram equalisation.
//!
//! Zuiderveld, "Contrast Limited Adaptive Histogram Equalization", Graphics Gems IV, 1994, with
//! the choices of scikit-image's `exposure.equalize_adapthist`: a tile has the size of the picture
//! over the number of tiles, rounded down; the picture goes on by reflection to a whole number of
//! tiles; values are spread over 2^14 levels before and over the whole range after. Its default
//! `kernel_size`, `clip_limit` and `nbins` are the defaults here.

use idf::Samples;
use rayon::prelude::*;

use crate::count::range;
use crate::light::{Tones, narrow};

/// Levels that the work is done in.
const LEVELS: u16 = 1 << 14;

/// Binary digits of a weight between two tiles.
const WEIGHT_BITS: u32 = 15;

/// A plane as small whole numbers, so that a tile's mapping is a table of few entries.
trait Code: Copy + Send + Sync {
    /// Most codes.
    const COUNT: usize;
    fn index(self) -> usize;
}

impl Code for u8 {
    const COUNT: usize = 256;
    #[inline]
    fn index(self) -> usize {
        usize::from(self)
    }
}

impl Code for u16 {
    const COUNT: usize = 4096;
    #[inline]
    fn index(self) -> usize {
        usize::from(self) % Self::COUNT
    }
}

/// What the parameters of the command line come to.
struct Limits {
    /// Columns and rows of a tile.
    tile: [usize; 2],
    clip: f64,
    bins: usize,
}

/// The mappings of all tiles.
struct Grid {
    tile: [usize; 2],
    /// Tiles across and down.
    tiles: [usize; 2],
    /// For each tile the level of each code.
    maps: Vec<Vec<u16>>,
    /// [`weight`] of each column from the centre of a tile to that of the next.
    weights: Vec<i32>,
}

/// What the interpolation gave: halves of levels, and their least and greatest.
struct Mapped {
    values: Vec<u16>,
    range: [u16; 2],
}

/// `tones` with each tile spread evenly, as far as the clip limit allows; parameters are tiles,
/// clip limit and bins.
///
/// A pixel counts where it is covered at all, and is a number. A tile where none counts takes the
/// mapping of the nearest one. A flat picture stays as it is.
pub(crate) fn equalized(tones: &Tones<'_>, parameters: &[f64]) -> Samples {
    let limits = limits(tones, parameters);
    let flat = || tones.samples.clone();
    match tones.samples {
        Samples::U8(samples) => {
            let counted = samples.iter().enumerate().filter(|&(at, _)| counts(tones, at));
            let range = counted.fold(None, |range, (_, &sample)| widened(range, sample));
            let Some(range) = range.filter(|[least, most]| least < most) else { return flat() };
            let bin = |code| bin(f64::from(code), range.map(f64::from), limits.bins);
            let bins: Vec<u16> = (0..=u8::MAX).map(bin).collect();
            let Some(mapped) = mapped(samples, tones, &limits, &bins) else { return flat() };
            Samples::U8(mapped.bytes())
        }
        Samples::U16(samples) => {
            let counted = samples.iter().enumerate().filter(|&(at, _)| counts(tones, at));
            let range = counted.fold(None, |range, (_, &sample)| widened(range, sample));
            let Some(range) = range.filter(|[least, most]| least < most) else { return flat() };
            let range = range.map(f64::from);
            let table: Vec<u16> =
                (0..=u16::MAX).map(|v| bin(f64::from(v), range, limits.bins)).collect();
            let codes: Vec<u16> = samples.par_iter().map(|&s| table[usize::from(s)]).collect();
            let Some(mapped) = by_bins(&codes, tones, &limits) else { return flat() };
            Samples::U16(mapped.shares().map(|share| word(65_535.0 * share)).collect())
        }
        Samples::F32(values) => {
            let range = range(values, tones.weights).filter(|[least, most]| least < most);
            let Some(range) = range else { return flat() };
            // What is not a number counts as little as what is not covered.
            let weight = |(at, value): (usize, &f32)| match tones.weights {
                _ if value.is_nan() => 0,
                Some(weights) => weights[at],
                None => u16::MAX,
            };
            let weights: Option<Vec<u16>> = (tones.weights.is_some()
                || values.iter().any(|value| value.is_nan()))
            .then(|| values.iter().enumerate().map(weight).collect());
            let tones = &Tones { weights: weights.as_deref(), ..*tones };
            let range = range.map(f64::from);
            let codes: Vec<u16> =
                values.par_iter().map(|&v| bin(f64::from(v), range, limits.bins)).collect();
            let Some(mapped) = by_bins(&codes, tones, &limits) else { return flat() };
            let shares = mapped.shares().zip(values);
            let kept = |(share, &v): (f64, &f32)| if v.is_nan() { v } else { narrow(share) };
            Samples::F32(shares.map(kept).collect())
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole numbers in the ranges of the table of operations"
)]
fn limits(tones: &Tones<'_>, parameters: &[f64]) -> Limits {
    let [tiles, bins] = [parameters[0] as usize, parameters[2] as usize];
    let rows = tones.samples.len() / tones.columns;
    let tile = [tones.columns, rows].map(|length| (length / tiles).max(1));
    Limits { tile, clip: parameters[1], bins }
}

/// Whether the pixel is covered at all.
fn counts(tones: &Tones<'_>, at: usize) -> bool {
    tones.weights.is_none_or(|weights| weights[at] > 0)
}

fn widened<T: Copy + Ord>(range: Option<[T; 2]>, value: T) -> Option<[T; 2]> {
    let [least, most] = range.unwrap_or([value; 2]);
    Some([least.min(value), most.max(value)])
}

/// The bin of a value; what is not a number gets the first.
fn bin(value: f64, [least, most]: [f64; 2], bins: usize) -> u16 {
    let share = (value.clamp(least, most) - least) / (most - least);
    let level = usize::from(word((f64::from(LEVELS - 1) * share).round_ties_even()));
    let width = 1 + usize::from(LEVELS) / bins;
    u16::try_from(level / width).expect("below the levels")
}

/// A number from 0 to 65535, rounded to the nearest; 0 for what is none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates here")]
fn word(value: f64) -> u16 {
    (value + 0.5) as u16
}

fn by_bins(codes: &[u16], tones: &Tones<'_>, limits: &Limits) -> Option<Mapped> {
    let bins: Vec<u16> =
        (0..=u16::MAX).take(limits.bins).chain(std::iter::repeat(0)).take(u16::COUNT).collect();
    mapped(codes, tones, limits, &bins)
}

/// The picture through the mappings of its tiles; nothing where no pixel counts or all come out
/// alike. `bins` has the bin of each code.
fn mapped<C: Code>(
    codes: &[C],
    tones: &Tones<'_>,
    limits: &Limits,
    bins: &[u16],
) -> Option<Mapped> {
    let columns = tones.columns;
    let grid = Grid::of(codes, tones, limits, bins)?;
    let mut values = vec![0; codes.len()];
    let rows = values.par_chunks_mut(columns).zip(codes.par_chunks(columns)).enumerate();
    let ranges = rows.map_init(Vec::new, |table, (row, (values, codes))| {
        grid.map_row(row, codes, table, values);
        row_range(values, tones.weights.map(|weights| &weights[row * columns..]))
    });
    let range = ranges.reduce(|| [u16::MAX, 0], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    (range[0] < range[1]).then_some(Mapped { values, range })
}

fn row_range(values: &[u16], weights: Option<&[u16]>) -> [u16; 2] {
    let Some(weights) = weights else {
        return values.iter().fold([u16::MAX, 0], |[a, b], &v| [a.min(v), b.max(v)]);
    };
    let covered = values.iter().zip(weights).filter(|(_, weight)| **weight > 0);
    covered.fold([u16::MAX, 0], |[a, b], (&v, _)| [a.min(v), b.max(v)])
}

impl Mapped {
    /// Spread over 0 to 255. The factor has 24 binary places, which is exact to 0.001.
    fn bytes(&self) -> Vec<u8> {
        let [least, most] = self.range;
        let span = u32::from(most - least);
        let factor = ((255 << 24) + span / 2) / span;
        let byte = |&value: &u16| {
            // Those of uncovered pixels may lie outside.
            let past = u32::from(value.clamp(least, most) - least);
            (past.wrapping_mul(factor).saturating_add(1 << 23) >> 24) as u8
        };
        self.values.par_iter().map(byte).collect()
    }

    /// Spread over 0 to 1.
    fn shares(&self) -> impl Iterator<Item = f64> {
        let [least, most] = self.range.map(f64::from);
        self.values.iter().map(move |&v| (f64::from(v).clamp(least, most) - least) / (most - least))
    }
}

impl Grid {
    fn of<C: Code>(codes: &[C], tones: &Tones<'_>, limits: &Limits, bins: &[u16]) -> Option<Self> {
        let [columns, rows] = [tones.columns, codes.len() / tones.columns];
        let [width, height] = limits.tile;
        let tiles = [columns.div_ceil(width), rows.div_ceil(height)];
        let maps = (0..tiles[0] * tiles[1]).into_par_iter().map(|tile| {
            let [x, y] = [tile % tiles[0] * width, tile / tiles[0] * height];
            let mut counts = vec![0_i64; limits.bins];
            for (code, &count) in tile_counts(codes, tones, [x, y], limits.tile).iter().enumerate()
            {
                counts[usize::from(bins[code])] += i64::from(count);
            }
            let levels = mapping(&mut counts, limits.clip)?;
            Some(bins.iter().map(|&bin| levels[usize::from(bin)]).collect())
        });
        let maps = filled(maps.collect(), tiles)?;
        let weights = (0..width).map(|column| weight(column, width)).collect();
        Some(Self { tile: limits.tile, tiles, maps, weights })
    }

    /// One row: each code through the mappings of the four tiles whose centres are around it.
    fn map_row<C: Code>(
        &self,
        row: usize,
        codes: &[C],
        table: &mut Vec<[i32; 2]>,
        values: &mut [u16],
    ) {
        let ([width, height], [across, down]) = (self.tile, self.tiles);
        let place = row + height / 2;
        let below = (place / height).min(down - 1);
        let above = (place / height).saturating_sub(1);
        let weight = weight(place % height, height);
        for column in 0..=across {
            let (left, right) = (column.saturating_sub(1), column.min(across - 1));
            let start = (column * width).saturating_sub(width / 2);
            let end = ((column + 1) * width - width / 2).min(codes.len());
            if start >= end {
                continue;
            }
            let map = |x: usize, y: usize| &self.maps[y * across + x];
            let lefts = map(left, above).iter().zip(map(left, below));
            let rights = map(right, above).iter().zip(map(right, below));
            let between = |(&above, &below): (&u16, &u16)| {
                let (above, below) = (i32::from(above), i32::from(below));
                ((above << WEIGHT_BITS) + (below - above) * weight) >> (WEIGHT_BITS - 1)
            };
            table.clear();
            table.extend(lefts.zip(rights).map(|(l, r)| {
                let (l, r) = (between(l), between(r));
                [l << WEIGHT_BITS, r - l]
            }));
            let table = &table[..C::COUNT];
            let first = start + width / 2 - column * width;
            let weights = &self.weights[first..first + (end - start)];
            let pixels = values[start..end].iter_mut().zip(&codes[start..end]);
            for ((value, code), weight) in pixels.zip(weights) {
                let [base, slope] = table[code.index()];
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "between two halves of levels"
                )]
                let between = ((base + slope * weight) >> WEIGHT_BITS) as u16;
                *value = between;
            }
        }
    }
}

/// `part / whole` with [`WEIGHT_BITS`] binary places.
#[inline]
fn weight(part: usize, whole: usize) -> i32 {
    i32::try_from((part << WEIGHT_BITS) / whole).expect("a part is below the whole")
}

/// How often each code is in the tile at `[x, y]`, by reflection where it leaves the picture.
fn tile_counts<C: Code>(
    codes: &[C],
    tones: &Tones<'_>,
    [x, y]: [usize; 2],
    [width, height]: [usize; 2],
) -> Vec<u32> {
    let [columns, rows] = [tones.columns, codes.len() / tones.columns];
    // In turn, so that equal neighbours do not wait for each other's sum.
    let mut tables = [(); 4].map(|()| vec![0_u32; C::COUNT]);
    let inside = (x + width).min(columns);
    for row in (y..y + height).map(|row| reflected(row, rows)) {
        let start = row * columns;
        if tones.weights.is_none() {
            let [a, b, c, d] = &mut tables;
            let (a, b, c, d) =
                (&mut a[..C::COUNT], &mut b[..C::COUNT], &mut c[..C::COUNT], &mut d[..C::COUNT]);
            let (fours, rest) = codes[start + x..start + inside].as_chunks::<4>();
            for four in fours {
                a[four[0].index()] += 1;
                b[four[1].index()] += 1;
                c[four[2].index()] += 1;
                d[four[3].index()] += 1;
            }
            rest.iter().for_each(|code| a[code.index()] += 1);
        } else {
            for at in start + x..start + inside {
                tables[0][codes[at].index()] += u32::from(counts(tones, at));
            }
        }
        for at in (inside..x + width).map(|column| start + reflected(column, columns)) {
            tables[1][codes[at].index()] += u32::from(counts(tones, at));
        }
    }
    (0..C::COUNT).map(|code| tables.iter().map(|table| table[code]).sum()).collect()
}

/// `at` mirrored into `length` about its last sample.
fn reflected(at: usize, length: usize) -> usize {
    if at < length { at } else { (2 * (length - 1)).saturating_sub(at) }
}

/// The level of each bin: the share at or below it, after what exceeds the clip limit is spread
/// over all bins. Nothing for an empty tile.
fn mapping(counts: &mut [i64], clip: f64) -> Option<Vec<u16>> {
    let total = u32::try_from(counts.iter().sum::<i64>()).expect("pixels of one image");
    if total == 0 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "a share of a small number")]
    let limit =
        if clip > 0.0 { (clip * f64::from(total)).max(1.0) as i64 } else { i64::from(total) };
    spread_excess(counts, limit);
    let scale = f64::from(LEVELS - 1) / f64::from(total);
    let mut below = 0_i64;
    let level = |&count: &i64| {
        below += count;
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let level = (below as f64 * scale).min(f64::from(LEVELS - 1));
        word(level.floor())
    };
    Some(counts.iter().map(level).collect())
}

/// Cuts counts at `limit`, and gives what was cut to the bins below it: as much to each as all
/// could take, then one at a time to evenly spaced bins.
///
/// As in scikit-image, a bin that its share brings within another share of the limit is filled up
/// to it, so the sum may come out above that of before.
fn spread_excess(counts: &mut [i64], limit: i64) {
    let bins = i64::try_from(counts.len()).expect("at most 4096 bins");
    let cut = |count: &mut i64| {
        let excess = (*count - limit).max(0);
        *count -= excess;
        excess
    };
    let mut excess: i64 = counts.iter_mut().map(cut).sum();
    let each = excess / bins;
    let upper = limit - each;
    for count in counts.iter_mut() {
        if *count < upper {
            *count += each;
            excess -= each;
        }
        if *count >= upper {
            excess -= limit - *count;
            *count = limit;
        }
    }
    while excess > 0 {
        let before = excess;
        for first in 0..counts.len() {
            let open = counts.iter().filter(|&&count| count < limit).count();
            if open == 0 || excess <= 0 {
                return;
            }
            let step = usize::try_from(excess).map_or(1, |excess| (open / excess).max(1));
            for count in counts.iter_mut().skip(first).step_by(step).filter(|c| **c < limit) {
                *count += 1;
                excess -= 1;
            }
        }
        if before == excess {
            return;
        }
    }
}

/// Every tile with a mapping: its own or, of those that have one, the nearest's.
fn filled(maps: Vec<Option<Vec<u16>>>, [across, _]: [usize; 2]) -> Option<Vec<Vec<u16>>> {
    let full: Vec<usize> = (0..maps.len()).filter(|&tile| maps[tile].is_some()).collect();
    let nearest = |tile: usize| {
        let distance = |&other: &usize| {
            let x = (other % across).abs_diff(tile % across);
            let y = (other / across).abs_diff(tile / across);
            x * x + y * y
        };
        full.iter().min_by_key(|&other| distance(other)).and_then(|&other| maps[other].clone())
    };
    if full.len() == maps.len() {
        return maps.into_iter().collect();
    }
    maps.iter().enumerate().map(|(tile, map)| map.clone().or_else(|| nearest(tile))).collect()
}

#[cfg(test)]
mod tests;
