//! Histogram equalisation: a display value becomes the share of the picture that is not above it.
//!
//! Gonzalez and Woods, "Digital Image Processing", 2018, section 3.3; the definition of
//! scikit-image's `exposure.equalize_hist`, with its mask for what is not covered.

use idf::Samples;
use rayon::prelude::*;

use crate::count::{byte_counts, counts, range};
use crate::light::{Tones, narrow};
use crate::point::{through_8, through_16};

/// Bins over the range of floating point; integers have one for each value.
const FLOAT_BINS: usize = 65_536;

/// The share at or below each bin, at evenly spaced centres, with straight lines between.
struct Shares {
    first: f64,
    gap: f64,
    shares: Vec<f64>,
}

/// `tones` spread evenly. What is not covered does not count, and what is covered in part counts
/// in part; where nothing counts, nothing changes. What is not a number stays.
pub(crate) fn equalized(tones: &Tones<'_>, _parameters: &[f64]) -> Samples {
    match tones.samples {
        Samples::U8(samples) => {
            let table = shares_in_steps(&byte_counts(samples, tones.weights), 255);
            let Some(table) = table else { return tones.samples.clone() };
            let byte = |at: usize| u8::try_from(table[at]).expect("at most 255 steps");
            let mut samples = samples.clone();
            through_8(&mut samples, &std::array::from_fn(byte));
            Samples::U8(samples)
        }
        Samples::U16(samples) => {
            let counted = counts(samples, tones.weights, 65_536, |s| Some(usize::from(s)));
            let Some(table) = shares_in_steps(&counted, 65_535) else {
                return tones.samples.clone();
            };
            let mut samples = samples.clone();
            through_16(&mut samples, &table);
            Samples::U16(samples)
        }
        Samples::F32(values) => {
            let Some(shares) = Shares::of(values, tones) else { return tones.samples.clone() };
            Samples::F32(values.par_iter().map(|&v| narrow(shares.at(f64::from(v)))).collect())
        }
    }
}

/// The share at or below each value, in `steps`, rounded to the nearest; nothing for no counts.
fn shares_in_steps(counts: &[u64], steps: u16) -> Option<Vec<u16>> {
    let total = u128::from(counts.iter().sum::<u64>());
    if total == 0 {
        return None;
    }
    let mut below = 0;
    let share = |&count: &u64| {
        below += u128::from(count);
        let rounded = (2 * below * u128::from(steps) + total) / (2 * total);
        u16::try_from(rounded).expect("at most all steps")
    };
    Some(counts.iter().map(share).collect())
}

impl Shares {
    /// Those of floating point: bins about the steps of the image, or over the range of its values
    /// where it has no steps.
    fn of(values: &[f32], tones: &Tones<'_>) -> Option<Self> {
        let (first, gap, bins) = match tones.steps {
            Some(steps) => (0.0, 1.0 / f64::from(steps), usize::from(steps) + 1),
            None => {
                let [least, most] = range(values, tones.weights)?.map(f64::from);
                #[expect(clippy::cast_precision_loss, reason = "a small whole number")]
                let gap = (most - least) / FLOAT_BINS as f64;
                (least + 0.5 * gap, gap, FLOAT_BINS)
            }
        };
        let counted = counts(values, tones.weights, bins, |value| {
            value.is_finite().then(|| nearest((f64::from(value) - first) / gap, bins))
        });
        let total = counted.iter().sum::<u64>();
        let mut below = 0;
        #[expect(clippy::cast_precision_loss, reason = "a share; its error is 2^-53")]
        let share = |count: &u64| {
            below += count;
            below as f64 / total as f64
        };
        let shares = counted.iter().map(share).collect();
        (total > 0).then_some(Self { first, gap, shares })
    }

    fn at(&self, value: f64) -> f64 {
        let last = self.shares.len() - 1;
        let place = (value - self.first) / self.gap;
        if value.is_nan() || self.gap <= 0.0 {
            // A flat picture is at its own highest value.
            return if value.is_nan() { value } else { 1.0 };
        }
        let below = floor(place, last);
        #[expect(clippy::cast_precision_loss, reason = "a small whole number")]
        let past = (place - below as f64).clamp(0.0, 1.0);
        let (low, high) = (self.shares[below], self.shares[(below + 1).min(last)]);
        low + past * (high - low)
    }
}

/// The whole number nearest to `place` from 0 to `bins` - 1, halves up.
fn nearest(place: f64, bins: usize) -> usize {
    floor(place + 0.5, bins - 1)
}

/// The whole part of `place`, from 0 to `last`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to small whole numbers"
)]
fn floor(place: f64, last: usize) -> usize {
    place.clamp(0.0, last as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<'a>(samples: &'a Samples, weights: Option<&'a [u16]>) -> Tones<'a> {
        let steps = match samples {
            Samples::U8(_) => Some(255),
            Samples::U16(_) => Some(65_535),
            Samples::F32(_) => None,
        };
        Tones { samples, steps, weights, columns: samples.len() }
    }

    #[test]
    fn a_value_becomes_the_share_at_or_below_it() {
        // Of 8 samples 3, 5, 6 and 8 are at or below: 95.625, 159.375, 191.25 and 255 of 255.
        let samples = Samples::U8(vec![10, 10, 10, 20, 20, 21, 200, 200]);
        let expected = Samples::U8(vec![96, 96, 96, 159, 159, 191, 255, 255]);
        assert_eq!(equalized(&of(&samples, None), &[]), expected);
        let deep = Samples::U16(vec![1, 1, 2, 65_535]);
        let expected = Samples::U16(vec![32_768, 32_768, 49_151, 65_535]);
        assert_eq!(equalized(&of(&deep, None), &[]), expected);
    }

    #[test]
    fn what_is_not_covered_does_not_count() {
        let samples = Samples::U8(vec![0, 10, 20, 30]);
        let halves = [0, 65_535, 65_535, 0];
        let found = equalized(&of(&samples, Some(&halves)), &[]);
        assert_eq!(found, Samples::U8(vec![0, 128, 255, 255]));
        // A quarter and three quarters of a pixel.
        let found = equalized(&of(&samples, Some(&[0, 1000, 3000, 0])), &[]);
        assert_eq!(found, Samples::U8(vec![0, 64, 255, 255]));
        assert_eq!(equalized(&of(&samples, Some(&[0; 4])), &[]), samples);
    }

    #[test]
    fn floating_point_follows_straight_lines_between_bins() {
        // Bins about the bytes: the shares at 0, 1/255 and 2/255 are 1/4, 1/2 and 1.
        let values = [0.0, 1.0 / 255.0, 2.0 / 255.0, 1.6 / 255.0];
        let samples = Samples::F32(values.to_vec());
        let bytes = Tones { steps: Some(255), ..of(&samples, None) };
        let Samples::F32(found) = equalized(&bytes, &[]) else { panic!("not float") };
        for (found, expected) in found.iter().zip([0.25, 0.5, 1.0, 0.8]) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn a_ramp_of_floating_point_stays_a_ramp() {
        let ramp: Vec<f32> = (0..=1000_u16).map(|i| f32::from(i) * 0.004 - 1.0).collect();
        let values = Samples::F32([ramp, vec![f32::NAN, f32::INFINITY]].concat());
        let Samples::F32(found) = equalized(&of(&values, None), &[]) else { panic!("not float") };
        for (at, found) in (0..=1000_u16).zip(&found) {
            assert!((found - f32::from(at + 1) / 1001.0).abs() < 0.001, "{at}: {found}");
        }
        assert!(found[1001].is_nan() && found[1002] >= 1.0, "{:?}", &found[1001..]);
    }

    #[test]
    fn a_flat_picture_is_white() {
        let flat = Samples::F32(vec![0.25; 4]);
        assert_eq!(equalized(&of(&flat, None), &[]), Samples::F32(vec![1.0; 4]));
        let flat = Samples::U8(vec![64; 4]);
        assert_eq!(equalized(&of(&flat, None), &[]), Samples::U8(vec![255; 4]));
    }
}
