//! Integers of any transfer and matte: light weighted by what is left, in 64 bits.
//!
//! A sum is stored by a polynomial that is near to the transfer's curve. Where that is not sure to
//! round as [`Encoder`] does, the pixel is worked out as [`super::plain`] does it.

use idf::{Image, ImageError, Kind, Matte, Samples, Transfer};

use super::{Target, unexpected};
use crate::operator::Share;
use crate::plan::Plan;
use crate::store::{Encoder, full};

/// Buckets for each octave of light.
const PER_OCTAVE: u32 = 64;
/// Octaves below 1 that have buckets; what is darker shares one.
const OCTAVES: u32 = 40;
/// Bits of a 64-bit value below those that number its bucket.
const BELOW: u32 = 52 - PER_OCTAVE.ilog2();
/// The number of the bucket that starts at 2^-[`OCTAVES`].
const FIRST: u32 = (1023 - OCTAVES) * PER_OCTAVE;
/// Steps of the result about half way in which the polynomial does not tell; it is twice as near
/// to the curve.
const NEAR: f64 = 1e-5;
/// Pixels that are worked on together.
const BLOCK: usize = 64;

/// Steps of the result for light from 0 on.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    /// The factors of 1, x, x² and x³ for each bucket, or not numbers where they would be too far
    /// from the curve. The first is for the darkest, the last for all from 1 on.
    cubics: Vec<[f64; 4]>,
}

impl Curve {
    /// The curve of `transfer`, to `most` steps, whose thresholds `encoder` has.
    pub(crate) fn new(transfer: Transfer, encoder: &Encoder, most: f64) -> Self {
        let count = OCTAVES * PER_OCTAVE;
        let start = |bucket: u32| f64::from_bits(u64::from(FIRST + bucket) << BELOW);
        let stored = |light: f64| transfer.encode(light) * most;
        let mut thresholds = encoder.thresholds().iter().map(|t| t / most).zip(0_u16..).peekable();
        let mut cubic = |from: f64, to: f64| {
            let mut inside = Vec::new();
            while let Some(found) = thresholds.next_if(|(light, _)| *light < to) {
                inside.push((found.0, f64::from(found.1) + 0.5));
            }
            if inside.is_empty() && thresholds.peek().is_some_and(|(_, sample)| *sample == 0) {
                return [0.0; 4];
            }
            let cubic = interpolated(stored, from, to);
            let near = |(light, step): (f64, f64)| (value(&cubic, light) - step).abs() < NEAR / 2.0;
            let ends = [from, to].map(|light| (light, stored(light)));
            let rises = [from, f64::midpoint(from, to), to].into_iter().all(|x| {
                let [_, one, two, three] = cubic;
                one + x * (2.0 * two + x * 3.0 * three) >= 0.0
            });
            let sure = rises && inside.into_iter().chain(ends).all(near);
            if sure { cubic } else { [f64::NAN; 4] }
        };
        let darkest = cubic(0.0, start(0));
        let mut cubics = vec![darkest];
        cubics.extend((0..count).map(|bucket| cubic(start(bucket), start(bucket + 1))));
        cubics.push([most, 0.0, 0.0, 0.0]);
        Self { cubics }
    }

    #[inline]
    fn steps(&self, light: &[f64; BLOCK], steps: &mut [f64; BLOCK]) {
        let last = self.cubics.len() - 1;
        let buckets = light.map(|light| {
            // 32 bits are enough: sign, exponent and the first 20 bits.
            let high = (light.to_bits() >> 32) as u32;
            ((high >> (BELOW - 32)) + 1).saturating_sub(FIRST)
        });
        for ((steps, &light), bucket) in steps.iter_mut().zip(light).zip(buckets) {
            *steps = value(&self.cubics[(bucket as usize).min(last)], light);
        }
    }
}

#[inline]
fn value(cubic: &[f64; 4], x: f64) -> f64 {
    cubic[0] + x * (cubic[1] + x * (cubic[2] + x * cubic[3]))
}

/// The cubic that meets `curve` at the four zeros of Chebyshev's polynomial.
fn interpolated(curve: impl Fn(f64) -> f64, from: f64, to: f64) -> [f64; 4] {
    // Cosines of an eighth and three eighths of a half turn.
    const ZEROS: [f64; 4] = [
        -0.923_879_532_511_286_7,
        -0.382_683_432_365_089_8,
        0.382_683_432_365_089_8,
        0.923_879_532_511_286_7,
    ];
    let (middle, half) = (f64::midpoint(from, to), 0.5 * (to - from));
    let x = ZEROS.map(|zero| middle + half * zero);
    // Divided differences, and Newton's form multiplied out.
    let mut differences = x.map(curve);
    for order in 1..4 {
        for at in (order..4).rev() {
            differences[at] = (differences[at] - differences[at - 1]) / (x[at] - x[at - order]);
        }
    }
    let mut cubic = [0.0; 4];
    for at in (0..4).rev() {
        for power in (1..4).rev() {
            cubic[power] = cubic[power - 1] - x[at] * cubic[power];
        }
        cubic[0] = differences[at] - x[at] * cubic[0];
    }
    cubic
}

/// Integers of a plane.
trait Step: Copy + Default + Into<f64> + Into<usize> + PartialOrd + Sync {
    /// How many there are.
    const COUNT: usize;
    fn samples(samples: &Samples) -> Option<&[Self]>;
    fn target<'a>(target: &'a mut Target<'_>) -> Option<&'a mut [Self]>;
    /// The lowest bits.
    fn of(bits: u64) -> Self;
}

macro_rules! step {
    ($type:ident $variant:ident) => {
        impl Step for $type {
            const COUNT: usize = 1 << Self::BITS;

            fn samples(samples: &Samples) -> Option<&[Self]> {
                if let Samples::$variant(samples) = samples { Some(samples) } else { None }
            }

            fn target<'a>(target: &'a mut Target<'_>) -> Option<&'a mut [Self]> {
                if let Target::$variant(samples) = target { Some(samples) } else { None }
            }

            #[inline]
            #[expect(clippy::cast_possible_truncation, reason = "the lowest bits by contract")]
            fn of(bits: u64) -> Self {
                bits as Self
            }
        }
    };
}

step!(u8 U8);
step!(u16 U16);

/// All planes of a composite, in the plan's order, from the pixels of two layers from `start` on.
/// Without a curve light is stored as it is.
pub(crate) fn planes(
    plan: &Plan,
    curve: Option<&Curve>,
    shares: [Share; 2],
    images: &[&Image],
    start: usize,
    targets: &mut [Target<'_>],
) -> Result<(), ImageError> {
    match targets.first() {
        Some(Target::U8(_)) => of::<u8>(plan, curve, shares, images, start, targets),
        Some(Target::U16(_)) => of::<u16>(plan, curve, shares, images, start, targets),
        Some(Target::F32(_)) | None => Ok(()),
    }
}

fn of<T: Step>(
    plan: &Plan,
    curve: Option<&Curve>,
    shares: [Share; 2],
    images: &[&Image],
    start: usize,
    targets: &mut [Target<'_>],
) -> Result<(), ImageError> {
    let count = targets.first().map_or(0, Target::len);
    let most = T::of(u64::MAX);
    let full = vec![most; count];
    let plane = |layer: usize, kind: Kind| {
        let samples = T::samples(images[layer].needed(kind)?);
        let samples = samples.ok_or_else(|| unexpected(kind, images[layer]))?;
        Ok::<_, ImageError>(&samples[start..start + count])
    };
    let coverage = |layer: usize| match &plan.layers[layer].coverage {
        Some((kind, _)) => plane(layer, *kind),
        None => Ok(&full[..]),
    };
    let coverage = [coverage(0)?, coverage(1)?];
    let mut lights = Vec::new();
    for position in 0..plan.layers[0].light.len() {
        let light = |layer: usize| {
            let Some((kind, decoder)) = &plan.layers[layer].light[position] else {
                return Ok((&full[..0], &[][..]));
            };
            Ok::<_, ImageError>((plane(layer, *kind)?, decoder.table()))
        };
        lights.push([light(0)?, light(1)?]);
    }
    let mut mix = Mix::new(plan, shares);
    for from in (0..count).step_by(BLOCK) {
        let block = from..(from + BLOCK).min(count);
        let coverage = coverage.map(|plane| &plane[block.clone()]);
        mix.weigh(coverage);
        for (position, target) in targets.iter_mut().enumerate() {
            let Some(out) = T::target(target) else { continue };
            let out = &mut out[block.clone()];
            match lights.get(position) {
                Some(planes) => {
                    let samples = planes.map(|(samples, _)| &samples[block.clone()]);
                    let tables = planes.map(|(_, table)| table);
                    mix.light(curve, samples, tables, coverage, out);
                }
                None => mix.covered(out),
            }
        }
    }
    Ok(())
}

/// What is left of two layers in a block of pixels.
struct Mix<'a> {
    plan: &'a Plan,
    shares: [Share; 2],
    straight: [bool; 2],
    full: f64,
    /// Whether layers and result are stored alike.
    same: bool,
    /// Coverage of the result, in units of which the square of `full` make 1.
    covered: [f64; BLOCK],
    /// What each layer's light, of which `full` make 1, adds to the light of the result.
    weights: [[f64; BLOCK]; 2],
    /// The layer of which all samples but those of weight 0 are the result's.
    only: Option<usize>,
}

impl<'a> Mix<'a> {
    fn new(plan: &'a Plan, shares: [Share; 2]) -> Self {
        let straight = [0, 1].map(|layer| plan.layers[layer].is_straight());
        let (covered, weights) = ([0.0; BLOCK], [[0.0; BLOCK]; 2]);
        let same = plan.stored_alike();
        Self { plan, shares, straight, full: full(plan.depth), same, covered, weights, only: None }
    }

    fn weigh<T: Step>(&mut self, samples: [&[T]; 2]) {
        let full = self.full;
        let unit = full * full;
        // All that is chosen is chosen before the loop, and all arrays are of one length.
        let least = if self.plan.matte == Matte::Straight { 0.0 } else { unit };
        let left = self.shares.map(|share| [share.of(0.0, full), f64::from(share.slope)]);
        let by = self.straight.map(|straight| if straight { [0.0, 1.0] } else { [full, 0.0] });
        let mut coverage = [[0.0; BLOCK]; 2];
        for (coverage, samples) in coverage.iter_mut().zip(samples) {
            coverage.iter_mut().zip(samples).for_each(|(value, &sample)| *value = sample.into());
        }
        // Whether of a layer there is a part of a result, and anything at all; of 0 alone all bits
        // are 0.
        let (mut partial_a, mut partial_b, mut any_a, mut any_b) = (0, 0, 0, 0);
        let [weights_a, weights_b] = &mut self.weights;
        let inputs = coverage[0].iter().zip(&coverage[1]);
        let outputs = self.covered.iter_mut().zip(weights_a.iter_mut().zip(weights_b));
        for ((&in_a, &in_b), (covered, (weight_a, weight_b))) in inputs.zip(outputs) {
            let left_a = left[0][0] + left[0][1] * in_b;
            let left_b = left[1][0] + left[1][1] * in_a;
            let sum = in_a * left_a + in_b * left_b;
            let sum = if sum < unit { sum } else { unit };
            let whole = if sum > least { sum } else { least };
            let scale = if whole > 0.0 { 1.0 / (whole * full) } else { 0.0 };
            let a = (by[0][0] + by[0][1] * in_a) * left_a;
            let b = (by[1][0] + by[1][1] * in_b) * left_b;
            *covered = sum;
            *weight_a = a * scale;
            *weight_b = b * scale;
            any_a |= a.to_bits();
            any_b |= b.to_bits();
            partial_a |= (a * (whole - a)).to_bits();
            partial_b |= (b * (whole - b)).to_bits();
        }
        self.only = match [partial_a | any_b, partial_b | any_a] {
            [0, _] if self.same => Some(0),
            [_, 0] if self.same => Some(1),
            _ => None,
        };
    }

    fn covered<T: Step>(&self, out: &mut [T]) {
        // A multiple of 1 / full is never near half way.
        let scale = 1.0 / self.full;
        for (out, &covered) in out.iter_mut().zip(&self.covered) {
            *out = T::of(rounded(covered * scale).0);
        }
    }

    fn light<T: Step>(
        &self,
        curve: Option<&Curve>,
        samples: [&[T]; 2],
        tables: [&[f64]; 2],
        coverage: [&[T]; 2],
        out: &mut [T],
    ) {
        if let Some(layer) = self.only {
            let pixels = samples[layer].iter().zip(&self.weights[layer]);
            for (out, (&sample, &weight)) in out.iter_mut().zip(pixels) {
                *out = if weight > 0.0 { sample } else { T::default() };
            }
            return;
        }
        let mut steps = [0.0; BLOCK];
        let weights = self.weights[0].iter().zip(&self.weights[1]);
        let pixels = samples[0].iter().zip(samples[1]).zip(weights);
        if let Some(curve) = curve {
            let [light_a, light_b] = tables.map(|table| &table[..T::COUNT]);
            // Step by step, as the tables are looked up one by one and the rest is done for several
            // samples at once.
            let [mut sums, mut terms] = [[0.0; BLOCK]; 2];
            for ((a, b), ((sample_a, sample_b), _)) in sums.iter_mut().zip(&mut terms).zip(pixels) {
                let (at_a, at_b): (usize, usize) = ((*sample_a).into(), (*sample_b).into());
                (*a, *b) = (light_a[at_a], light_b[at_b]);
            }
            let weights = self.weights[0].iter().zip(&self.weights[1]);
            for ((sum, term), (weight_a, weight_b)) in sums.iter_mut().zip(terms).zip(weights) {
                *sum = *sum * weight_a + term * weight_b;
            }
            curve.steps(&sums, &mut steps);
        } else {
            for (steps, ((&a, &b), (weight_a, weight_b))) in steps.iter_mut().zip(pixels) {
                let (a, b): (f64, f64) = (a.into(), b.into());
                *steps = ((a * weight_a + b * weight_b) * self.full).min(self.full);
            }
        }
        let mut unsure = 0_u64;
        for (out, &steps) in out.iter_mut().zip(&steps) {
            let (step, sure) = rounded(steps);
            *out = T::of(step);
            unsure |= u64::from(!sure);
        }
        if unsure == 0 {
            return;
        }
        for (at, out) in out.iter_mut().enumerate() {
            if rounded(steps[at]).1 {
                continue;
            }
            let light = [0, 1].map(|layer: usize| {
                let sample: usize = samples[layer][at].into();
                tables[layer][sample]
            });
            let coverage = coverage.map(|plane| plane[at].into());
            let new = self.plan.weighted(self.shares, light, coverage, self.covered[at]);
            *out = T::of(new.into());
        }
    }
}

/// The nearest whole number, and whether that is sure: the curve goes not through a half so near
/// that it may be the other one. What is not a number is not sure.
#[inline]
fn rounded(steps: f64) -> (u64, bool) {
    // Beyond 2^52 there are only whole numbers, and these are the lowest bits.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let sum = steps + WHOLE;
    (sum.to_bits(), (steps - (sum - WHOLE)).abs() <= 0.5 - NEAR)
}
