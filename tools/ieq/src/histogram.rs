//! Histograms of display values, with their figures, as a table of text.

use std::fmt;

use idf::{Image, ImageError, Samples};
use rayon::prelude::*;

use crate::count::{byte_counts, counts};
use crate::light::{Light, Tones, luma, narrow};
use crate::picture::drawn;

/// The percentiles of [`Channel::percentiles`].
pub const PERCENTILES: [u8; 7] = [1, 5, 25, 50, 75, 95, 99];

/// What a weight of one pixel counts as, where there is coverage.
const PIXEL: f64 = 65_535.0;

/// Counts of the display values (sRGB, 0 to 1) of an image's channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Least and greatest value that the bins cover: 0 to 1, or further where floating point goes
    /// further.
    pub range: [f64; 2],
    /// The channels of the light; of a colour also its luma (Rec. 709).
    pub channels: Vec<Channel>,
}

/// One channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `red`, `grn`, `blu`, `grg` or `luma`.
    pub name: &'static str,
    /// Pixels in each bin; a pixel counts as much as it is covered.
    pub counts: Vec<f64>,
    /// Pixels in all bins.
    pub pixels: f64,
    /// Pixels that are infinite or not a number; in no bin and no figure.
    pub not_finite: f64,
    /// Mean; not a number where no pixel counts, as the figures that follow.
    pub mean: f64,
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub greatest: f64,
    /// The least values that at least so much of the picture does not exceed.
    pub percentiles: [f64; PERCENTILES.len()],
}

/// Distinct values in rising order, with how much of the picture has each.
struct Sorted {
    values: Vec<(f64, u64)>,
    not_finite: u64,
}

/// The histogram of the light of `image`, in `bins` bins.
///
/// # Errors
///
/// If there is no light, only a part of a colour, or indices without their table.
///
/// # Panics
///
/// If there are no bins.
pub fn histogram(image: Image, bins: usize) -> Result<Histogram, ImageError> {
    assert!(bins > 0, "a histogram has bins");
    let mut light = Light::of(image)?;
    let weights = light.weights();
    let samples = light.take_display();
    let sorted = |samples| Sorted::of(&light.tones(samples, weights.as_deref()));
    let words = light.planes.iter().map(|plane| plane.kind.word());
    let mut named: Vec<(&'static str, Sorted)> = words.zip(samples.iter().map(sorted)).collect();
    if let [r, g, b] = samples.as_slice() {
        named.push(("luma", sorted(&luma([r, g, b]))));
    }
    let mut limits = [0.0, 1.0];
    for Sorted { values, .. } in named.iter().map(|(_, sorted)| sorted) {
        let [first, last] = [values.first(), values.last()].map(|end| end.map_or(0.5, |v| v.0));
        limits = [
            if first < limits[0] { first } else { limits[0] },
            if last > limits[1] { last } else { limits[1] },
        ];
    }
    let pixel = if weights.is_some() { PIXEL } else { 1.0 };
    let channels =
        named.into_iter().map(|(name, sorted)| sorted.channel(name, bins, limits, pixel));
    Ok(Histogram { range: limits, channels: channels.collect() })
}

impl Sorted {
    fn of(tones: &Tones<'_>) -> Self {
        let steps = f64::from(tones.steps.unwrap_or(1));
        let steps_in = |counts: Vec<u64>| {
            let values = (0_u32..).zip(counts).filter(|(_, count)| *count > 0);
            let values = values.map(|(step, count)| (f64::from(step) / steps, count)).collect();
            Self { values, not_finite: 0 }
        };
        match tones.samples {
            Samples::U8(samples) => steps_in(byte_counts(samples, tones.weights)),
            Samples::U16(samples) => {
                steps_in(counts(samples, tones.weights, 65_536, |s| Some(usize::from(s))))
            }
            Samples::F32(values) => Self::of_floats(values, tones.weights),
        }
    }

    fn of_floats(floats: &[f32], weights: Option<&[u16]>) -> Self {
        let weight = |at: usize| weights.map_or(1, |weights| u64::from(weights[at]));
        let counted = floats.iter().enumerate().map(|(at, &value)| (value, weight(at)));
        let counted = counted.filter(|(_, weight)| *weight > 0);
        let (mut finite, others): (Vec<_>, Vec<_>) =
            counted.partition(|(value, _)| value.is_finite());
        finite.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut values: Vec<(f64, u64)> = Vec::new();
        for (value, weight) in finite {
            let value = f64::from(value);
            match values.last_mut() {
                Some((last, sum)) if *last >= value => *sum += weight,
                _ => values.push((value, weight)),
            }
        }
        Self { values, not_finite: others.iter().map(|(_, weight)| weight).sum() }
    }

    #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
    fn channel(&self, name: &'static str, bins: usize, range: [f64; 2], pixel: f64) -> Channel {
        let mut counts = vec![0_u64; bins];
        let (mut total, mut sum) = (0, 0.0);
        for &(value, count) in &self.values {
            counts[bin(value, range, bins)] += count;
            total += count;
            sum += value * count as f64;
        }
        let end = |end: Option<&(f64, u64)>| end.map_or(f64::NAN, |(value, _)| *value);
        Channel {
            name,
            counts: counts.into_iter().map(|count| count as f64 / pixel).collect(),
            pixels: total as f64 / pixel,
            not_finite: self.not_finite as f64 / pixel,
            mean: sum / total as f64,
            least: end(self.values.first()),
            greatest: end(self.values.last()),
            percentiles: PERCENTILES.map(|percent| self.percentile(percent, total)),
        }
    }

    /// The least value that at least `percent` of `total` do not exceed.
    fn percentile(&self, percent: u8, total: u64) -> f64 {
        let mut below = 0;
        let reaches = |(_, count): &&(f64, u64)| {
            below += u128::from(*count);
            below * 100 >= u128::from(total) * u128::from(percent)
        };
        self.values.iter().find(reaches).map_or(f64::NAN, |(value, _)| *value)
    }
}

/// The bin of a value in `range`; the last bin holds its upper end.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a share of a small whole number"
)]
fn bin(value: f64, [least, most]: [f64; 2], bins: usize) -> usize {
    (((value - least) / (most - least) * bins as f64) as usize).min(bins - 1)
}

/// Two tables with tabs between, and a blank line between them: the figures of each channel, then
/// one line for each bin with its ends.
impl fmt::Display for Histogram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.channels.iter().map(|channel| channel.name).collect();
        writeln!(f, "figure\t{}", names.join("\t"))?;
        let mut row = |name: &str, figure: &dyn Fn(&Channel) -> f64| {
            write!(f, "{name}")?;
            for channel in &self.channels {
                // As many digits as planes hold.
                write!(f, "\t{}", narrow(figure(channel)))?;
            }
            writeln!(f)
        };
        row("pixels", &|channel| channel.pixels)?;
        row("not-finite", &|channel| channel.not_finite)?;
        row("mean", &|channel| channel.mean)?;
        row("min", &|channel| channel.least)?;
        for (at, percent) in PERCENTILES.iter().enumerate() {
            row(&format!("p{percent}"), &|channel| channel.percentiles[at])?;
        }
        row("max", &|channel| channel.greatest)?;
        writeln!(f, "\nfrom\tto\t{}", names.join("\t"))?;
        let bins = self.channels.first().map_or(0, |channel| channel.counts.len());
        for bin in 0..bins {
            write!(f, "{}\t{}", self.edge(bin, bins), self.edge(bin + 1, bins))?;
            for channel in &self.channels {
                write!(f, "\t{}", channel.counts[bin])?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

impl Histogram {
    /// The picture of the histogram: 512 x 256 pixels, its bars over its range.
    ///
    /// Red, green and blue add up where they overlap; all below luma's line is lighter.
    pub fn drawn(&self) -> Image {
        drawn(self)
    }

    #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
    fn edge(&self, bin: usize, bins: usize) -> f64 {
        let [least, most] = self.range;
        least + (most - least) * (bin as f64 / bins as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Kind, Plane};

    fn grey(samples: Samples, coverage: Option<Samples>) -> Image {
        let columns = u32::try_from(samples.len()).unwrap();
        let mut planes = vec![Plane { kind: Kind::Grg, samples }];
        planes.extend(coverage.map(|samples| Plane { kind: Kind::Cvg, samples }));
        Image::new(columns, 1, planes).unwrap()
    }

    #[test]
    fn every_byte_has_its_own_bin_of_256_and_every_word_of_65536() {
        for step in 0..=255_u8 {
            assert_eq!(bin(f64::from(step) / 255.0, [0.0, 1.0], 256), usize::from(step));
        }
        for step in 0..=65_535_u16 {
            assert_eq!(bin(f64::from(step) / 65_535.0, [0.0, 1.0], 65_536), usize::from(step));
        }
    }

    #[test]
    fn figures_are_those_of_the_sorted_values() {
        let image = grey(Samples::U8(vec![51, 0, 255, 51, 102]), None);
        let found = histogram(image, 5).unwrap();
        let channel = &found.channels[0];
        assert_eq!(channel.counts, [1.0, 2.0, 1.0, 0.0, 1.0]);
        assert!((channel.mean - 0.36).abs() < 1e-12, "{}", channel.mean);
        assert_eq!((channel.least, channel.greatest), (0.0, 1.0));
        // Of 5: 1 % and 5 % are the first, 25 % and 50 % the second and third, 75 % the fourth.
        let expected = [0.0_f64, 0.0, 0.2, 0.2, 0.4, 1.0, 1.0];
        assert_eq!(channel.percentiles.map(f64::to_bits), expected.map(f64::to_bits));
    }

    #[test]
    fn a_pixel_counts_as_much_as_it_is_covered() {
        // Straight, so that the values stay; 51 of 255 is a fifth of a pixel.
        let coverage = Samples::U8(vec![51, 0, 255]);
        let mut image = grey(Samples::U8(vec![0, 255, 255]), Some(coverage));
        image.properties.matte = idf::Matte::Straight;
        let found = histogram(image, 2).unwrap();
        assert_eq!(found.channels[0].counts, [0.2, 1.0]);
        assert!((found.channels[0].mean - 1.0 / 1.2).abs() < 1e-12);
    }

    #[test]
    fn the_covered_part_is_counted() {
        // 0.5 stored is 0.214 of light; over half a pixel of coverage that is white.
        let light = idf::srgb8(128.0 / 255.0);
        let image = grey(Samples::U8(vec![light]), Some(Samples::U8(vec![128])));
        let found = histogram(image, 256).unwrap().channels[0].least;
        assert!((found - 1.0).abs() < 0.005, "{found}");
    }

    #[test]
    fn floating_point_widens_the_range_and_what_is_not_finite_is_told() {
        let values = vec![-1.0, 3.0, f32::NAN, f32::INFINITY, 0.0];
        let mut image = grey(Samples::F32(values), None);
        image.properties.transfer = Some(idf::Transfer::Srgb);
        let found = histogram(image, 4).unwrap();
        assert!((found.range[0] + 1.0).abs() < 1e-6 && (found.range[1] - 3.0).abs() < 1e-6);
        let channel = &found.channels[0];
        assert_eq!(channel.counts, [1.0, 1.0, 0.0, 1.0]);
        assert_eq!((channel.pixels, channel.not_finite), (3.0, 2.0));
    }

    #[test]
    fn the_text_is_two_tables() {
        let image = grey(Samples::U8(vec![0, 255]), None);
        let expected = "figure\tgrg\npixels\t2\nnot-finite\t0\nmean\t0.5\nmin\t0\np1\t0\np5\t0\n\
                        p25\t0\np50\t0\np75\t1\np95\t1\np99\t1\nmax\t1\n\n\
                        from\tto\tgrg\n0\t0.5\t1\n0.5\t1\t1\n";
        assert_eq!(histogram(image, 2).unwrap().to_string(), expected);
    }
}
