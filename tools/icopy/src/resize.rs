//! Resampling by one table of filters, in linear light multiplied by coverage.

use std::f64::consts::PI;

use idf::{Image, Samples, checked_size};
use rayon::prelude::*;

use crate::CopyError;
use crate::mix::remixed;

/// How a filter weighs the samples about the centre of a new one.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// By the share of the new sample that they cover.
    Area,
    /// By that share where it gets smaller, by nearness where it gets larger.
    AreaOrTent,
    /// By a function of the distance, which is zero from `radius` on. Distances are in samples of
    /// the coarser side; weights are scaled to the sum of one, at the edges too.
    Kernel { radius: f64, weight: fn(f64) -> f64 },
}

/// One row of [`FILTERS`].
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The filter of this row.
    pub filter: Filter,
    /// The word on a command line.
    pub name: &'static str,
    /// What it does, for help texts.
    pub about: &'static str,
    shape: Shape,
}

macro_rules! filters {
    ($($filter:ident $name:literal $about:literal $shape:expr;)*) => {
        /// How samples are mixed; the rows of [`FILTERS`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Filter {
            $(#[doc = $about] $filter,)*
        }

        /// All filters, the default first. A new filter is a new row.
        pub const FILTERS: &[Row] = &[
            $(Row { filter: Filter::$filter, name: $name, about: $about, shape: $shape },)*
        ];
    };
}

filters! {
    Linear "linear" "area average down, bilinear up" Shape::AreaOrTent;
    Box "box" "area average; blocks where it gets larger" Shape::Area;
    Bicubic "bicubic" "cubic through the samples (Catmull and Rom)"
        Shape::Kernel { radius: 2.0, weight: catmull_rom };
    Lanczos "lanczos" "sinc windowed to three lobes; the sharpest, with a slight ring"
        Shape::Kernel { radius: 3.0, weight: lanczos_3 };
}

impl Default for Filter {
    fn default() -> Self {
        FILTERS[0].filter
    }
}

/// Cubic through its samples (Catmull and Rom, "A class of local interpolating splines", 1974;
/// B = 0 and C = 1/2 of Mitchell and Netravali, 1988).
fn catmull_rom(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        (1.5 * x - 2.5) * x * x + 1.0
    } else if x < 2.0 {
        ((2.5 - 0.5 * x) * x - 4.0) * x + 2.0
    } else {
        0.0
    }
}

/// `sinc(x) sinc(x / 3)` up to 3 (Duchon, "Lanczos Filtering in One and Two Dimensions", 1979).
fn lanczos_3(x: f64) -> f64 {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { libm::sin(PI * x) / (PI * x) };
    if x.abs() < 3.0 { sinc(x) * sinc(x / 3.0) } else { 0.0 }
}

/// The picture with other columns and rows, at the top left of a canvas.
///
/// Light is mixed linear and multiplied by coverage, and rounded once. Indices and measured values
/// cannot be mixed; of these the nearest is taken.
///
/// # Errors
///
/// If the size is beyond an image's, or a sample that becomes an integer is not a number.
pub fn resized(
    image: &Image,
    [columns, rows]: [u32; 2],
    filter: Filter,
) -> Result<Image, CopyError> {
    checked_size(columns, rows)?;
    let size = image.size().map(|length| length as usize);
    let to = [columns, rows].map(|length| length as usize);
    let mix = |values: &[f32]| mixed(values, size, to, filter);
    let mut copy = remixed(image, [columns, rows], mix, |samples| nearest(samples, size, to))?;
    copy.properties.origin = [0, 0];
    Ok(copy)
}

/// Values of one plane of `size` columns and rows, mixed to those of `to`.
///
/// # Panics
///
/// If a size is zero, or there are not as many values as `size` says.
pub fn mixed(values: &[f32], size: [usize; 2], to: [usize; 2], filter: Filter) -> Vec<f32> {
    assert_eq!(values.len(), size[0] * size[1], "as many values as pixels");
    // The way with fewer values between the passes.
    let down_first = to[1] * size[0] < to[0] * size[1];
    let axes = if down_first { [1, 0] } else { [0, 1] };
    let mut columns = size[0];
    let mut result: Option<Vec<f32>> = None;
    for axis in axes.into_iter().filter(|&axis| size[axis] != to[axis]) {
        let from = result.as_deref().unwrap_or(values);
        let mixes = mixes(size[axis], to[axis], filter);
        let passed =
            if axis == 0 { across(from, columns, &mixes) } else { down(from, columns, &mixes) };
        result = Some(passed);
        columns = if axis == 0 { to[0] } else { columns };
    }
    result.unwrap_or_else(|| values.to_vec())
}

fn nearest(samples: &Samples, size: [usize; 2], to: [usize; 2]) -> Samples {
    let place = |at: usize, axis: usize| (2 * at + 1) * size[axis] / (2 * to[axis]);
    let columns: Vec<usize> = (0..to[0]).map(|column| place(column, 0)).collect();
    samples.gathered((0..to[1]).flat_map(|row| {
        let start = place(row, 1) * size[0];
        columns.iter().map(move |column| start + column)
    }))
}

/// The samples of the original that one sample of the copy is mixed from.
struct Mix {
    first: usize,
    weights: Vec<f32>,
}

/// Rows that are mixed at once, so that one weight serves all: with 12 samples in a mix, a third
/// of the time of one row after the other.
const LANES: usize = 8;

/// Each row mixed by itself.
fn across(values: &[f32], width: usize, mixes: &[Mix]) -> Vec<f32> {
    let mut result = vec![0.0; values.len() / width * mixes.len()];
    let groups = values.par_chunks(width * LANES);
    result.par_chunks_mut(mixes.len() * LANES).zip(groups).for_each_init(
        || vec![[0.0; LANES]; width],
        |columns, (targets, rows)| {
            for (lane, row) in rows.chunks_exact(width).enumerate() {
                columns.iter_mut().zip(row).for_each(|(column, &value)| column[lane] = value);
            }
            for (at, mix) in mixes.iter().enumerate() {
                let mut sums = [0.0_f32; LANES];
                for (weight, column) in mix.weights.iter().zip(&columns[mix.first..]) {
                    sums.iter_mut().zip(column).for_each(|(sum, value)| *sum += weight * value);
                }
                for (target, sum) in targets.chunks_exact_mut(mixes.len()).zip(sums) {
                    target[at] = sum;
                }
            }
        },
    );
    result
}

/// Each column mixed by itself.
fn down(values: &[f32], width: usize, mixes: &[Mix]) -> Vec<f32> {
    let mut result = vec![0.0; width * mixes.len()];
    result.par_chunks_exact_mut(width).zip(mixes).for_each(|(target, mix)| {
        let sources = values[mix.first * width..].chunks_exact(width);
        for (weight, source) in mix.weights.iter().zip(sources) {
            target.iter_mut().zip(source).for_each(|(sum, value)| *sum += weight * value);
        }
    });
    result
}

/// Mixes that make `to` samples from `from`.
fn mixes(from: usize, to: usize, filter: Filter) -> Vec<Mix> {
    let shape = FILTERS[filter as usize].shape;
    let mix = |at: usize| match shape {
        Shape::AreaOrTent if to > from => between(at, from, to),
        Shape::Area | Shape::AreaOrTent => average(at, from, to),
        Shape::Kernel { radius, weight } => weighed(at, from, to, radius, weight),
    };
    (0..to).map(mix).collect()
}

/// Average of what the sample `at` of `to` covers of `from`: with both as `from · to` parts, it
/// covers `from` of them, and each old sample `to`.
fn average(at: usize, from: usize, to: usize) -> Mix {
    let (start, end) = (at * from, (at + 1) * from);
    let first = start / to;
    let weights = (first..end.div_ceil(to))
        .map(|old| narrow(ratio(end.min((old + 1) * to) - start.max(old * to), from)))
        .collect();
    Mix { first, weights }
}

/// The two samples about the centre of the sample `at`, by nearness; one at the edges. In parts
/// of `2 · to` for an old sample, the new centre is at `(2 at + 1) from`, the old ones at odd
/// multiples of `to`.
fn between(at: usize, from: usize, to: usize) -> Mix {
    let centre = (2 * at + 1) * from;
    if centre <= to {
        return Mix { first: 0, weights: vec![1.0] };
    }
    let (first, past) = ((centre - to) / (2 * to), (centre - to) % (2 * to));
    if past == 0 || first + 1 >= from {
        return Mix { first: first.min(from - 1), weights: vec![1.0] };
    }
    let second = narrow(ratio(past, 2 * to));
    Mix { first, weights: vec![1.0 - second, second] }
}

/// Samples within `radius` about the centre of the sample `at`, weighed by their distance.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and the number of samples"
)]
fn weighed(at: usize, from: usize, to: usize, radius: f64, weight: fn(f64) -> f64) -> Mix {
    let coarseness = ratio(from, to).max(1.0);
    let centre = ratio((2 * at + 1) * from, 2 * to);
    let reach = radius * coarseness;
    let first = (centre - reach).max(0.0) as usize;
    let end = ((centre + reach).ceil() as usize).min(from);
    let distance = |old: usize| (ratio(2 * old + 1, 2) - centre) / coarseness;
    let weights: Vec<f64> = (first..end).map(|old| weight(distance(old))).collect();
    let sum: f64 = weights.iter().sum();
    Mix { first, weights: weights.iter().map(|weight| narrow(weight / sum)).collect() }
}

#[expect(clippy::cast_precision_loss, reason = "sizes are far below 2^53")]
fn ratio(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

#[expect(clippy::cast_possible_truncation, reason = "its error is far below that of a sample")]
fn narrow(weight: f64) -> f32 {
    weight as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Kind, Matte, Plane};

    fn image(columns: u32, planes: Vec<(Kind, Samples)>) -> Image {
        let rows = u32::try_from(planes[0].1.len()).unwrap() / columns;
        let planes = planes.into_iter().map(|(kind, samples)| Plane { kind, samples });
        Image::new(columns, rows, planes.collect()).unwrap()
    }

    fn floats(columns: u32, values: &[f32], size: [u32; 2], filter: Filter) -> Vec<f32> {
        let original = image(columns, vec![(Kind::Grg, Samples::F32(values.into()))]);
        resized(&original, size, filter).unwrap().decoded(Kind::Grg).unwrap()
    }

    fn assert_near(found: &[f32], expected: &[f64]) {
        let near = |(found, expected): (&f32, &f64)| (f64::from(*found) - expected).abs() < 1e-6;
        let same = found.len() == expected.len() && found.iter().zip(expected).all(near);
        assert!(same, "{found:?}, expected {expected:?}");
    }

    #[test]
    fn rows_are_in_the_order_of_the_filters() {
        for (position, row) in FILTERS.iter().enumerate() {
            assert_eq!(row.filter as usize, position, "{}", row.name);
        }
    }

    #[test]
    fn smaller_is_the_average_of_what_is_covered() {
        for filter in [Filter::Linear, Filter::Box] {
            assert_eq!(floats(4, &[0.0, 1.0, 2.0, 4.0], [2, 1], filter), [0.5, 3.0]);
            // Three samples in two: one and a half each.
            assert_near(&floats(3, &[3.0, 6.0, 9.0], [2, 1], filter), &[4.0, 8.0]);
            assert_eq!(floats(2, &[1.0, 2.0, 3.0, 6.0], [1, 1], filter), [3.0]);
        }
    }

    #[test]
    fn larger_is_bilinear_or_blocks() {
        // Centres at 1/4, 3/4, 5/4, 7/4 between those at 1/2 and 3/2.
        let linear = |columns, values: &[f32], to| floats(columns, values, to, Filter::Linear);
        assert_eq!(linear(2, &[0.0, 4.0], [4, 1]), [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(linear(1, &[0.0, 4.0], [1, 4]), [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(linear(1, &[7.0], [3, 2]), [7.0; 6]);
        let blocks = floats(2, &[0.0, 4.0], [3, 1], Filter::Box);
        assert_near(&blocks, &[0.0, 2.0, 4.0]);
    }

    #[test]
    fn kernels_have_their_values() {
        for (x, cubic) in [(0.0, 1.0), (0.5, 0.5625), (1.0, 0.0), (1.5, -0.0625), (2.0, 0.0)] {
            assert!((catmull_rom(x) - cubic).abs() < 1e-15, "{x}");
            assert!((catmull_rom(-x) - cubic).abs() < 1e-15, "{x}");
        }
        // (2/π)(3/π · 1/2 · 2) = 6/π² at 1/2, (-2/3π)(2/π) = -4/3π² at 3/2.
        let square = PI * PI;
        for (x, sinc) in [(0.0, 1.0), (0.5, 6.0 / square), (1.5, -4.0 / (3.0 * square)), (3.0, 0.0)]
        {
            assert!((lanczos_3(x) - sinc).abs() < 1e-15, "{x}");
        }
    }

    #[test]
    fn twice_as_large_weighs_at_the_quarters() {
        // About the middle of an edge in a long row, at 1/4 from a sample: cubic weights are
        // -9/128, 111/128, 29/128, -3/128 for distances 5/4, 1/4, 3/4, 7/4.
        let row: Vec<f32> = (0_u8..16).map(|at| f32::from(u8::from(at >= 8))).collect();
        let found = floats(16, &row, [32, 1], Filter::Bicubic);
        let sums = [0.0, -3.0, -9.0, 26.0, 102.0, 137.0, 131.0, 128.0].map(|sum| sum / 128.0);
        assert_near(&found[12..20], &sums);
    }

    #[test]
    fn a_level_stays_a_level_and_an_impulse_its_sum() {
        for row in FILTERS {
            for (from, to) in [(7, 3), (3, 7), (10, 20), (20, 10), (64, 5), (1, 4), (5, 1)] {
                let level = floats(from, &vec![0.75; from as usize], [to, 1], row.filter);
                assert_near(&level, &vec![0.75; to as usize]);
            }
            // All that lies on either side of a middle impulse is the same.
            let mut values = vec![0.0; 15 * 15];
            values[7 * 15 + 7] = 1.0;
            let found = floats(15, &values, [9, 9], row.filter);
            let turned: Vec<f64> = found.iter().rev().map(|&value| f64::from(value)).collect();
            assert_near(&found, &turned);
        }
    }

    /// Each sample as the sum over all of the original, weighed in two dimensions at once.
    fn plainly(values: &[f32], size: [usize; 2], to: [usize; 2], filter: Filter) -> Vec<f64> {
        let weights = |axis: usize, at: usize| {
            let mix = mixes(size[axis], to[axis], filter).swap_remove(at);
            let mut all = vec![0.0; size[axis]];
            all[mix.first..mix.first + mix.weights.len()].copy_from_slice(&mix.weights);
            all
        };
        let mut result = Vec::new();
        for row in 0..to[1] {
            for column in 0..to[0] {
                let (across, down) = (weights(0, column), weights(1, row));
                let sum = values.iter().enumerate().map(|(at, &value)| {
                    let weight = across[at % size[0]] * down[at / size[0]];
                    f64::from(weight) * f64::from(value)
                });
                result.push(sum.sum());
            }
        }
        result
    }

    #[test]
    fn two_passes_are_one_sum() {
        for row in FILTERS {
            for (size, to) in [([13, 19], [5, 31]), ([13, 19], [29, 4]), ([9, 17], [9, 6])] {
                let length = size[0] * size[1];
                let values: Vec<f32> = (0..length)
                    .map(|at| f32::from(u16::try_from(at * 37 % 101).unwrap()))
                    .collect();
                let found = mixed(&values, size, to, row.filter);
                let expected = plainly(&values, size, to, row.filter);
                for (found, expected) in found.iter().zip(expected) {
                    let error = (f64::from(*found) - expected).abs();
                    assert!(error < 1e-4, "{}: {found} {expected}", row.name);
                }
            }
        }
    }

    #[test]
    fn the_same_size_is_the_same() {
        let values = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        for row in FILTERS {
            assert_eq!(floats(3, &values, [3, 2], row.filter), values);
        }
    }

    #[test]
    fn bytes_are_mixed_as_light_and_uncovered_color_does_not_count() {
        let planes =
            vec![(Kind::Grg, Samples::U8(vec![255, 0])), (Kind::Enc, Samples::U8(vec![7, 9]))];
        let half = resized(&image(2, planes), [1, 1], Filter::Linear).unwrap();
        assert_eq!(half.plane(Kind::Grg), Some(&Samples::U8(vec![188])));
        assert_eq!(half.plane(Kind::Enc), Some(&Samples::U8(vec![9])));
        let planes =
            vec![(Kind::Grg, Samples::U8(vec![255, 99])), (Kind::Cvg, Samples::U8(vec![255, 0]))];
        let mut straight = image(2, planes);
        straight.properties.matte = Matte::Straight;
        let half = resized(&straight, [1, 1], Filter::Linear).unwrap();
        assert_eq!(half.plane(Kind::Cvg), Some(&Samples::U8(vec![128])));
        assert_eq!(half.plane(Kind::Grg), Some(&Samples::U8(vec![255])));
    }

    #[test]
    fn coverage_stays_in_range() {
        let edge: Vec<f32> = (0_u8..8).map(|at| f32::from(u8::from(at >= 4))).collect();
        let planes = vec![(Kind::Cvg, Samples::F32(edge))];
        let large = resized(&image(8, planes), [21, 1], Filter::Lanczos).unwrap();
        let coverage = large.decoded(Kind::Cvg).unwrap();
        assert!(coverage.iter().all(|value| (0.0..=1.0).contains(value)), "{coverage:?}");
    }
}
