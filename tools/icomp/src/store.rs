//! Light in and out of samples: tables of what a sample stands for, and of where the next begins.

use idf::{Depth, Samples, Transfer};

/// The largest sample of a depth, and so the number that coverage 1 is counted in; 1 for floating
/// point.
pub(crate) fn full(depth: Depth) -> f64 {
    match depth {
        Depth::U8 => 255.0,
        Depth::U16 => 65_535.0,
        Depth::F32 => 1.0,
    }
}

/// What samples of one plane stand for, in units of which `full` make 1. Where they are only
/// scaled, integers stay whole numbers, so that arithmetic on these is exact.
#[derive(Clone, Debug)]
pub(crate) struct Decoder {
    depth: Depth,
    table: Vec<f64>,
    curve: Curve,
    full: f64,
}

/// From values stored in one way to values stored in another; light is [`Transfer::Linear`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curve {
    /// How the values are stored.
    pub(crate) from: Transfer,
    /// How they are wanted.
    pub(crate) to: Transfer,
}

impl Curve {
    fn value(self, stored: f64) -> f64 {
        if self.from == self.to { stored } else { self.to.encode(self.from.decode(stored)) }
    }
}

impl Decoder {
    pub(crate) fn new(depth: Depth, curve: Curve, full: f64) -> Self {
        let most = self::full(depth);
        let steps = match depth {
            Depth::U8 => 0..256_u32,
            Depth::U16 => 0..65_536,
            Depth::F32 => 0..0,
        };
        let value = |step| {
            if curve.from == curve.to {
                f64::from(step) * (full / most)
            } else {
                curve.value(f64::from(step) / most) * full
            }
        };
        Self { depth, table: steps.map(value).collect(), curve, full }
    }

    /// Whether it is one for such samples.
    pub(crate) fn is_for(&self, depth: Depth, curve: Curve) -> bool {
        self.depth == depth && self.curve == curve
    }

    /// The value of each sample; empty for floating point.
    pub(crate) fn table(&self) -> &[f64] {
        &self.table
    }

    /// The depth of the samples.
    pub(crate) fn depth(&self) -> Depth {
        self.depth
    }

    /// Values of the samples from `start` on.
    pub(crate) fn fill(&self, samples: &Samples, start: usize, values: &mut [f64]) {
        match samples {
            Samples::U16(samples) if self.curve.from == self.curve.to => {
                let step = self.full / full(Depth::U16);
                for (value, &sample) in values.iter_mut().zip(&samples[start..]) {
                    *value = f64::from(sample) * step;
                }
            }
            Samples::U8(samples) => {
                for (value, &sample) in values.iter_mut().zip(&samples[start..]) {
                    *value = self.table[usize::from(sample)];
                }
            }
            Samples::U16(samples) => {
                for (value, &sample) in values.iter_mut().zip(&samples[start..]) {
                    *value = self.table[usize::from(sample)];
                }
            }
            Samples::F32(samples) => {
                for (value, &sample) in values.iter_mut().zip(&samples[start..]) {
                    *value = self.curve.value(f64::from(sample)) * self.full;
                }
            }
        }
    }
}

/// The least light that is stored as `sample + 1`, in units of which `most` make 1: where the
/// stored value is half a step above `sample`.
pub(crate) fn threshold(transfer: Transfer, sample: u16, most: f64) -> f64 {
    let stored = f64::from(sample) + 0.5;
    match transfer {
        Transfer::Linear => stored,
        Transfer::Srgb | Transfer::Gamma(_) => transfer.decode(stored / most) * most,
    }
}

/// Light to integers: rounded to the nearest stored value, halves up, within 0 and 1.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    /// The least light of each sample but 0; empty where samples are whole numbers of light.
    thresholds: Vec<f64>,
    /// Sample of the light `index / buckets`, from which a search starts.
    starts: Vec<u16>,
    /// Buckets for each unit of light, of which `most` make 1.
    scale: f64,
    most: f64,
}

impl Encoder {
    pub(crate) fn new(depth: Depth, transfer: Transfer) -> Self {
        let most = full(depth);
        // From the nearest start a search takes at most two steps over the linear part of sRGB.
        let (samples, buckets) = match depth {
            Depth::U8 => (0..255_u16, 1_u32 << 12),
            Depth::U16 | Depth::F32 => (0..u16::MAX, 1 << 16),
        };
        let scale = f64::from(buckets) / most;
        if transfer == Transfer::Linear {
            return Self { thresholds: Vec::new(), starts: Vec::new(), scale, most };
        }
        let thresholds: Vec<f64> = samples.map(|s| threshold(transfer, s, most)).collect();
        let mut start = 0;
        let starts = (0..=buckets)
            .map(|bucket| {
                let light = f64::from(bucket) / scale;
                while thresholds.get(start).is_some_and(|&t| t <= light) {
                    start += 1;
                }
                u16::try_from(start).unwrap_or(u16::MAX)
            })
            .collect();
        Self { thresholds, starts, scale, most }
    }

    /// The least light of each sample but 0, in units of which the largest sample make 1; empty
    /// where samples are whole numbers of light.
    pub(crate) fn thresholds(&self) -> &[f64] {
        &self.thresholds
    }

    /// The sample for light of `value / weight`, 0 where the weight is 0. The comparison is of
    /// `value` with a threshold times `weight`, so whole numbers are not divided.
    #[inline]
    pub(crate) fn sample(&self, value: f64, weight: f64) -> u16 {
        if weight == 0.0 {
            return 0;
        }
        let light = value / weight;
        if self.starts.is_empty() {
            let below = index(light, self.most);
            let sample = f64::from(below);
            return below + u16::from(sample < self.most && (sample + 0.5) * weight <= value);
        }
        let bucket = index(light * self.scale, self.scale * self.most);
        let mut sample = self.starts[usize::from(bucket)];
        while self.thresholds.get(usize::from(sample)).is_some_and(|t| t * weight <= value) {
            sample += 1;
        }
        while sample > 0 && self.thresholds[usize::from(sample) - 1] * weight > value {
            sample -= 1;
        }
        sample
    }
}

/// The whole number below `value`, from 0 to `most`; 0 where it is not a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is between 0 and 65535, or not a number, which becomes 0"
)]
fn index(value: f64, most: f64) -> u16 {
    value.clamp(0.0, most.min(65_535.0)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::transfer::{rounded_8, rounded_16};

    const TRANSFERS: [Transfer; 4] =
        [Transfer::Srgb, Transfer::Linear, Transfer::Gamma(2.2), Transfer::Gamma(10.0)];

    #[test]
    fn samples_are_those_of_the_formula() {
        for transfer in TRANSFERS {
            let (bytes, words) =
                (Encoder::new(Depth::U8, transfer), Encoder::new(Depth::U16, transfer));
            let mut seed = 1_u64;
            for _ in 0..20_000 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let unit = f64::from(u32::try_from(seed >> 32).unwrap()) / 4_294_967_296.0;
                for light in [unit, unit * unit * unit, 4.0 * unit - 2.0] {
                    for weight in [1.0, 0.3, 12_345.0] {
                        let byte = bytes.sample(light * 255.0 * weight, weight);
                        assert_eq!(byte, rounded_8(transfer, light).into(), "{transfer} {light}");
                        let word = words.sample(light * 65_535.0 * weight, weight);
                        assert_eq!(word, rounded_16(transfer, light), "{transfer} {light}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_half_is_rounded_up_and_nothing_is_nothing() {
        let bytes = Encoder::new(Depth::U8, Transfer::Linear);
        for (value, weight, expected) in
            [(7.0, 2.0, 4), (6.9, 2.0, 3), (0.0, 0.0, 0), (-1.0, 1.0, 0), (999.0, 1.0, 255)]
        {
            assert_eq!(bytes.sample(value, weight), expected, "{value} / {weight}");
        }
    }

    #[test]
    fn every_sample_comes_back() {
        for transfer in TRANSFERS {
            for (depth, samples) in [
                (Depth::U8, Samples::U8((0..=255).collect())),
                (Depth::U16, Samples::U16((0..=u16::MAX).collect())),
            ] {
                let mut values = vec![0.0; samples.len()];
                let curve = Curve { from: transfer, to: Transfer::Linear };
                Decoder::new(depth, curve, full(depth)).fill(&samples, 0, &mut values);
                let encoder = Encoder::new(depth, transfer);
                let back: Vec<usize> =
                    values.iter().map(|&v| encoder.sample(v, 1.0).into()).collect();
                assert!(back.into_iter().eq(0..samples.len()), "{transfer} {depth:?}");
            }
        }
    }
}
