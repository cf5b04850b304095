//! The table of metrics: what is measured between two images.

mod flip;
mod max;
mod mean;
mod psnr;
mod rmse;
mod ssim;

use std::fmt;

use idf::Kind;
use rayon::prelude::*;

use crate::pair::{Channel, ONE, Pair};

/// What a figure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A difference of values, where 1 is from black to white; it has 255 display steps.
    Value,
    /// Decibels.
    Decibels,
    /// A number without unit.
    Score,
}

/// One row of [`TABLE`].
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The word on the command line and in JSON.
    pub word: &'static str,
    /// What it is, for the help.
    pub about: &'static str,
    /// What the figure is.
    pub unit: Unit,
    /// Whether more is nearer.
    pub more_is_nearer: bool,
    /// Whether it has a value for each pixel, for a picture.
    pub has_map: bool,
    /// Measures; nothing where the images are too small for it.
    pub measure: fn(&Pair, &Viewing) -> Option<Measured>,
}

/// All metrics. A new metric is a new row and its file.
pub const TABLE: &[Row] = &[
    Row {
        word: "rmse",
        about: "root mean square difference of all channels",
        unit: Unit::Value,
        more_is_nearer: false,
        has_map: false,
        measure: rmse::measured,
    },
    Row {
        word: "psnr",
        about: "peak signal-to-noise ratio: 1 over the root mean square difference",
        unit: Unit::Decibels,
        more_is_nearer: true,
        has_map: false,
        measure: psnr::measured,
    },
    Row {
        word: "mean",
        about: "mean absolute difference of all channels",
        unit: Unit::Value,
        more_is_nearer: false,
        has_map: false,
        measure: mean::measured,
    },
    Row {
        word: "max",
        about: "greatest absolute difference, and where it is",
        unit: Unit::Value,
        more_is_nearer: false,
        has_map: false,
        measure: max::measured,
    },
    Row {
        word: "flip",
        about: "mean of LDR-FLIP, the difference seen when the images alternate, 0 to 1",
        unit: Unit::Score,
        more_is_nearer: false,
        has_map: true,
        measure: flip::measured,
    },
    Row {
        word: "ssim",
        about: "mean structural similarity of luma, 1 for equal images",
        unit: Unit::Score,
        more_is_nearer: true,
        has_map: true,
        measure: ssim::measured,
    },
];

/// How the images are looked at.
#[derive(Clone, Copy, Debug)]
pub struct Viewing {
    /// Pixels in a degree of the visual field.
    pub pixels_per_degree: f64,
}

/// What a metric found.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Of all channels together.
    pub value: f64,
    /// Of each channel by itself, for metrics that take channels apart.
    pub channels: Vec<(Kind, f64)>,
    /// The worst pixel, for metrics that look for it.
    pub worst: Option<Place>,
    /// A value for each pixel, for metrics that have them.
    pub map: Option<Vec<f32>>,
}

/// A pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// From the left.
    pub column: usize,
    /// From the top.
    pub row: usize,
    /// The channel, if it is one.
    pub kind: Option<Kind>,
}

impl Default for Viewing {
    /// 67 pixels per degree: a screen 0.7 m wide with 3840 pixels across, seen from 0.7 m
    /// (Andersson et al. 2020).
    fn default() -> Self {
        Self { pixels_per_degree: 67.0 }
    }
}

impl Row {
    /// The row that `word` names.
    pub fn from_word(word: &str) -> Option<&'static Self> {
        TABLE.iter().find(|row| row.word == word)
    }

    /// Whether `found` is farther than `limit`.
    pub fn is_beyond(&self, found: f64, limit: f64) -> bool {
        if self.more_is_nearer { found < limit } else { found > limit }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word)
    }
}

/// The difference of two values in 255ths; nothing where one is infinite or not a number and the
/// other is not the same.
fn difference(reference: f32, test: f32) -> Option<f64> {
    let difference = f64::from(reference) - f64::from(test);
    if difference.is_finite() {
        return Some(difference);
    }
    let same = reference.is_nan() && test.is_nan()
        || reference.is_infinite() && reference.to_bits() == test.to_bits();
    same.then_some(0.0)
}

impl Pair {
    /// Samples that are infinite or not a number in one image and not the same in the other. They
    /// are in no figure.
    pub fn incomparable(&self) -> usize {
        let channels = self.channels.iter();
        let pairs = channels.map(|channel| {
            let rows = (0..self.rows).into_par_iter().map(|row| {
                let [reference, test] = self.row(channel, row);
                let pairs = reference.iter().zip(&test);
                pairs.filter(|(reference, test)| difference(**reference, **test).is_none()).count()
            });
            rows.sum::<usize>()
        });
        pairs.sum()
    }

    /// The sum of `term` over the comparable samples of a channel, and their number. Rows are
    /// added one by one, and then their sums, so that threads do not matter.
    fn summed(&self, channel: &Channel, term: impl Fn(f64) -> f64 + Sync) -> (f64, f64) {
        let sums: Vec<(f64, f64)> = (0..self.rows)
            .into_par_iter()
            .map(|row| {
                let [reference, test] = self.row(channel, row);
                let pairs = reference.iter().zip(&test);
                let differences = pairs.filter_map(|(&a, &b)| difference(a, b));
                differences.fold((0.0, 0.0), |(sum, count), d| {
                    (sum + term(d / f64::from(ONE)), count + 1.0)
                })
            })
            .collect();
        sums.iter().fold((0.0, 0.0), |(sum, count), row| (sum + row.0, count + row.1))
    }

    /// Figures from the means of `term`: of all channels, and of each.
    fn of_means(
        &self,
        term: impl Fn(f64) -> f64 + Sync,
        figure: impl Fn(f64) -> f64,
    ) -> Option<Measured> {
        let (mut sum, mut count) = (0.0, 0.0);
        let mut channels = Vec::new();
        for channel in &self.channels {
            let own = self.summed(channel, &term);
            channels.push((channel.kind, figure(own.0 / own.1)));
            sum += own.0;
            count += own.1;
        }
        let value = figure(sum / count);
        (count > 0.0).then_some(Measured { value, channels, worst: None, map: None })
    }
}

/// The mean of a map, row by row.
fn mean_of(map: &[f32], columns: usize) -> f64 {
    let sums: Vec<f64> = map
        .par_chunks(columns)
        .map(|row| row.iter().map(|&value| f64::from(value)).sum::<f64>())
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
    let count = map.len() as f64;
    sums.iter().sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Image, Plane, Samples};

    fn grey(columns: u32, samples: Samples) -> Image {
        let rows = u32::try_from(samples.len()).unwrap() / columns;
        Image::new(columns, rows, vec![Plane { kind: Kind::Grg, samples }]).unwrap()
    }

    fn picture(columns: u32, rows: u32, value: impl Fn(u32, u32) -> u32) -> Image {
        let pixel = |at: u32| u8::try_from(value(at % columns, at / columns)).unwrap();
        grey(columns, Samples::U8((0..columns * rows).map(pixel).collect()))
    }

    #[test]
    fn words_are_distinct() {
        for (position, row) in TABLE.iter().enumerate() {
            assert!(TABLE[..position].iter().all(|other| other.word != row.word), "{row}");
        }
    }

    #[test]
    fn every_metric_finds_equal_images_equal_and_different_ones_not() {
        let first = picture(40, 30, |x, y| (x * 5 + y * 3) % 200);
        let second = picture(40, 30, |x, y| (x * 5 + y * 3) % 200 + 20 * (x % 2));
        let third = picture(40, 30, |x, y| (x * 5 + y * 3) % 200 + 50 * (x % 2));
        for row in TABLE {
            let measure = |test: &Image| {
                let pair = Pair::new(&first, test).unwrap();
                let measured = (row.measure)(&pair, &Viewing::default()).unwrap();
                assert_eq!(measured.map.is_some(), row.has_map, "{row}");
                assert!(measured.map.is_none_or(|map| map.len() == 1200), "{row}");
                measured.value
            };
            let [same, near, far] = [&first, &second, &third].map(measure);
            assert!(
                row.is_beyond(near, same) && row.is_beyond(far, near),
                "{row}: {same} {near} {far}"
            );
            let ideal = match row.word {
                "psnr" => f64::INFINITY,
                "ssim" => 1.0,
                _ => 0.0,
            };
            assert!((same - ideal).abs() < 1e-12 || same >= ideal, "{row}: {same}");
        }
    }

    #[test]
    fn figures_do_not_depend_on_threads() {
        let first = picture(97, 61, |x, y| (x * x + y * 7) % 251);
        let second = picture(97, 61, |x, y| (x * x + y * 7 + x * y) % 253);
        let pair = Pair::new(&first, &second).unwrap();
        for row in TABLE {
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| (row.measure)(&pair, &Viewing::default())).unwrap()
            };
            assert_eq!(on(1), on(5), "{row}");
        }
    }

    #[test]
    fn differences_have_the_values_of_their_definitions() {
        let a = grey(4, Samples::U8(vec![0, 100, 200, 255]));
        let b = grey(4, Samples::U8(vec![3, 100, 196, 255]));
        let pair = Pair::new(&a, &b).unwrap();
        let measure = |word| {
            let row = Row::from_word(word).unwrap();
            (row.measure)(&pair, &Viewing::default()).unwrap()
        };
        // 3 and 4 steps of four samples: mean square 6.25, mean 1.75.
        assert!((measure("rmse").value * 255.0 - 2.5).abs() < 1e-12);
        assert!((measure("mean").value * 255.0 - 1.75).abs() < 1e-12);
        let psnr = 20.0 * libm::log10(255.0 / 2.5);
        assert!((measure("psnr").value - psnr).abs() < 1e-9);
        let max = measure("max");
        assert!((max.value * 255.0 - 4.0).abs() < 1e-12);
        let place = Place { column: 2, row: 0, kind: Some(Kind::Grg) };
        assert_eq!(max.worst, Some(place));
    }

    #[test]
    fn the_whole_is_of_all_channels_and_each_has_its_own() {
        let plane = |kind, value| Plane { kind, samples: Samples::U8(vec![value]) };
        let color = |[r, g, b]: [u8; 3]| {
            let planes = vec![plane(Kind::Red, r), plane(Kind::Grn, g), plane(Kind::Blu, b)];
            Image::new(1, 1, planes).unwrap()
        };
        let pair = Pair::new(&color([0, 0, 0]), &color([51, 0, 102])).unwrap();
        let found = pair.of_means(|d| d * d, f64::sqrt).unwrap();
        let expected = [(Kind::Red, 0.2), (Kind::Grn, 0.0), (Kind::Blu, 0.4)];
        for ((kind, value), expected) in found.channels.iter().zip(expected) {
            assert!(*kind == expected.0 && (value - expected.1).abs() < 1e-12, "{found:?}");
        }
        assert!((found.value - (0.2_f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_a_number_in_one_alone_is_counted_and_left_out() {
        let nan = f32::NAN;
        let a = grey(4, Samples::F32(vec![nan, nan, 1.0, f32::INFINITY]));
        let b = grey(4, Samples::F32(vec![nan, 0.5, 0.5, f32::INFINITY]));
        let pair = Pair::new(&a, &b).unwrap();
        assert_eq!(pair.incomparable(), 1);
        let found = rmse::measured(&pair, &Viewing::default()).unwrap();
        // 0, 0.5 and 0 are left.
        assert!((found.value - (0.25_f64 / 3.0).sqrt()).abs() < 1e-7, "{found:?}");
    }
}
