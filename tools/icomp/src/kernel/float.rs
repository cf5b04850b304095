//! Linear floating point: sums of exact products, rounded once.

use idf::{Image, ImageError, Kind, Samples};

use super::{Target, unexpected};
use crate::operator::{ALL, Share};
use crate::plan::Plan;

/// What lies in 29 bits below a 32-bit sample where a 64-bit value is half way between two.
const HALF_WAY: u32 = 1 << 28;
/// Steps of a 64-bit value that rounding of its shares, products and sum may have moved it: three
/// at most, made a power of two.
const SLACK: u32 = 4;
/// Samples that are worked on together.
const BLOCK: usize = 256;

/// All planes of a composite, in the plan's order, from the pixels of two layers from `start` on.
pub(crate) fn planes(
    plan: &Plan,
    shares: [Share; 2],
    images: &[&Image],
    start: usize,
    targets: &mut [Target<'_>],
) -> Result<(), ImageError> {
    let full = vec![1.0; targets.first().map_or(0, Target::len)];
    let floats = |layer: usize, kind: Option<Kind>| {
        let Some(kind) = kind else { return Ok(&full[..]) };
        match images[layer].needed(kind)? {
            Samples::F32(samples) => Ok(&samples[start..start + full.len()]),
            Samples::U8(_) | Samples::U16(_) => Err(unexpected(kind, images[layer])),
        }
    };
    let covered =
        |layer: usize| floats(layer, plan.layers[layer].coverage.as_ref().map(|plane| plane.0));
    let coverage = [covered(0)?, covered(1)?];
    let left = Left { shares, coverage };
    for (position, target) in targets.iter_mut().enumerate() {
        let Target::F32(out) = target else { continue };
        let plane = |layer: usize| match plan.layers[layer].light.get(position) {
            Some(plane) => floats(layer, plane.as_ref().map(|plane| plane.0)),
            None => Ok(coverage[layer]),
        };
        left.composite([plane(0)?, plane(1)?], out);
        if plan.layers[0].light.get(position).is_none() {
            out.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
        }
    }
    Ok(())
}

/// Two layers' coverage, and what it leaves of the other.
struct Left<'a> {
    shares: [Share; 2],
    coverage: [&'a [f32]; 2],
}

impl Left<'_> {
    /// One plane of a composite.
    ///
    /// In 64 bits the sum of two products of numbers from 0 on has an error of less than [`SLACK`]
    /// steps, so its rounding to 32 bits is that of the exact sum unless it lies as near to half
    /// way. Samples of which that is not sure, negative ones, and sums so small that they have
    /// fewer bits are taken from [`exact`].
    fn composite(&self, [a, b]: [&[f32]; 2], out: &mut [f32]) {
        let [share_a, share_b] = self.shares;
        let whole = |[a, b]: [f64; 2], [in_a, _]: [f32; 2]| a + b * left(share_b, in_a);
        let parts = |[a, b]: [f64; 2], [in_a, in_b]: [f32; 2]| {
            a * left(share_a, in_b) + b * left(share_b, in_a)
        };
        if share_a == ALL {
            self.blocks([a, b], out, whole);
        } else {
            self.blocks([a, b], out, parts);
        }
    }

    #[inline]
    fn blocks(
        &self,
        [a, b]: [&[f32]; 2],
        out: &mut [f32],
        sum: impl Fn([f64; 2], [f32; 2]) -> f64,
    ) {
        let pictures = a.chunks(BLOCK).zip(b.chunks(BLOCK));
        let coverage = self.coverage[0].chunks(BLOCK).zip(self.coverage[1].chunks(BLOCK));
        for ((out, (a, b)), (in_a, in_b)) in out.chunks_mut(BLOCK).zip(pictures).zip(coverage) {
            if sums([a, b], [in_a, in_b], out, &sum) {
                continue;
            }
            for (index, out) in out.iter_mut().enumerate() {
                let pixel = [a[index], b[index]];
                let coverage = [in_a[index], in_b[index]];
                if is_doubtful(pixel, sum(pixel.map(f64::from), coverage)) {
                    *out = exact(self.shares, pixel, coverage);
                }
            }
        }
    }
}

/// What the other picture's coverage leaves, in 64 bits.
#[inline]
fn left(share: Share, other: f32) -> f64 {
    f64::from(share.constant) + f64::from(share.slope) * f64::from(other).clamp(0.0, 1.0)
}

/// Fills `out`; whether none of it [`is_doubtful`].
#[inline]
fn sums(
    [a, b]: [&[f32]; 2],
    [in_a, in_b]: [&[f32]; 2],
    out: &mut [f32],
    sum: impl Fn([f64; 2], [f32; 2]) -> f64,
) -> bool {
    let (mut nearest, mut least, mut signs) = (u32::MAX, u32::MAX, 0);
    let pixels = a.iter().zip(b).zip(in_a.iter().zip(in_b));
    for (out, ((&a, &b), (&in_a, &in_b))) in out.iter_mut().zip(pixels) {
        let wide = sum([f64::from(a), f64::from(b)], [in_a, in_b]);
        *out = narrowed(wide);
        nearest = nearest.min(from_half_way(wide));
        least = least.min(high_half(wide).wrapping_sub(1));
        signs |= a.to_bits() | b.to_bits();
    }
    nearest >= 2 * SLACK && least >= SMALL - 1 && signs >> 31 == 0
}

/// Upper half of a 64-bit value that is sure to have 24 bits as a sample: 2⁻¹²⁶ and a little. A sum
/// that is not 0 has at least 2⁻²⁹⁸, and so an upper half that is not 0.
const SMALL: u32 = ((1023 - 126) << 20) + 1;

/// Whether the sum of a pixel is near to half way, has a negative term, or is small but not 0.
fn is_doubtful([a, b]: [f32; 2], wide: f64) -> bool {
    (a.to_bits() | b.to_bits()) >> 31 != 0
        || high_half(wide).wrapping_sub(1) < SMALL - 1
        || from_half_way(wide) < 2 * SLACK
}

/// Sign, exponent and the first 20 bits.
#[inline]
fn high_half(wide: f64) -> u32 {
    (wide.to_bits() >> 32) as u32
}

/// Steps from [`SLACK`] below half way on, in 29 bits.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the low half of the bits is looked at")]
fn from_half_way(wide: f64) -> u32 {
    (wide.to_bits() as u32).wrapping_add(SLACK).wrapping_sub(HALF_WAY) & ((1 << 29) - 1)
}

#[inline]
#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn narrowed(wide: f64) -> f32 {
    wide as f32
}

/// The sample nearest to the exact sum. Products of 24 bits are exact in 53, and a sum of four is
/// rounded to odd before it is narrowed, so that it is rounded once (Boldo and Melquiond,
/// "Emulation of FMA and Correctly Rounded Sums", 2008). Coverage is taken within 0 and 1.
pub(crate) fn exact(shares: [Share; 2], [a, b]: [f32; 2], coverage: [f32; 2]) -> f32 {
    let [a, b] = [a, b].map(f64::from);
    let [in_a, in_b] = coverage.map(|value| f64::from(value).clamp(0.0, 1.0));
    let [share_a, share_b] =
        shares.map(|share| (f64::from(share.constant), f64::from(share.slope)));
    narrow(&[share_a.0 * a, share_a.1 * a * in_b, share_b.0 * b, share_b.1 * b * in_a])
}

/// The sum of `terms`, rounded once.
fn narrow(terms: &[f64; 4]) -> f32 {
    let plain: f64 = terms.iter().sum();
    if !plain.is_finite() {
        return narrowed(plain);
    }
    // Parts that do not overlap, smallest first (Shewchuk, "Adaptive Precision Floating-Point
    // Arithmetic", 1997, figure 6).
    let mut parts = [0.0; 4];
    for (count, &term) in terms.iter().enumerate() {
        let mut sum = term;
        for part in &mut parts[..count] {
            (sum, *part) = two_sum(sum, *part);
        }
        parts[count] = sum;
    }
    let mut top = 0.0;
    for part in parts.into_iter().rev() {
        let (sum, rest) = two_sum(top, part);
        top = sum;
        if rest != 0.0 {
            return narrowed(to_odd(top, rest));
        }
    }
    narrowed(top)
}

/// The sum as it is rounded, and what that left out.
fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let from_y = sum - x;
    (sum, (x - (sum - from_y)) + (y - from_y))
}

/// Of the two values about `top + rest`, the one whose last bit is 1.
fn to_odd(top: f64, rest: f64) -> f64 {
    let bits = top.to_bits();
    if bits & 1 == 1 {
        return top;
    }
    let outward = (rest > 0.0) == (top > 0.0);
    f64::from_bits(if outward { bits + 1 } else { bits - 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::{OPERATORS, OUTSIDE, Rule};

    /// 2 to the power of `exponent`.
    fn power(exponent: i64) -> f64 {
        f64::from_bits(u64::try_from(1023 + exponent).unwrap() << 52)
    }

    #[test]
    fn half_way_and_a_little_is_rounded_by_the_little() {
        // 1 + 2⁻²⁴ is half way between two samples; a tail of 2⁻⁷⁰ decides.
        let (half, tail) = (power(-24), power(-70));
        let above = 1.0 + f32::EPSILON;
        for (terms, expected) in [
            ([1.0, half, 0.0, 0.0], 1.0),
            ([1.0, half, tail, 0.0], above),
            ([tail, half, 1.0, -2.0 * tail], 1.0),
            ([-1.0, -half, -tail, 0.0], -above),
            ([f64::MAX, -f64::MAX, 0.25, 0.0], 0.25),
        ] {
            assert_eq!(narrow(&terms).to_bits(), f32::to_bits(expected), "{terms:?}");
        }
    }

    /// Random bits of a sample in 2^-low .. 1, or an extreme one.
    fn sample(seed: &mut u64, low: u32) -> f32 {
        *seed =
            seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = u32::try_from(*seed >> 33).unwrap();
        match bits % 16 {
            0 => [0.0, 1.0, f32::EPSILON, 0.5, 1.0 - f32::EPSILON / 2.0, 1e-42, 1e-20, 3.0]
                [(bits >> 8) as usize % 8],
            _ => f32::from_bits(((127 - bits % low) << 23) | (bits >> 8) & 0x7f_ffff) / 2.0,
        }
    }

    #[test]
    fn the_fast_way_is_the_exact_one() {
        let mut seed = 3;
        for row in OPERATORS {
            let Rule::Two { a, b } = row.rule else { continue };
            for low in [2, 30, 120] {
                for sign in [1.0, -1.0] {
                    let mut plane =
                        |low| (0..4000).map(|_| sample(&mut seed, low)).collect::<Vec<f32>>();
                    let planes = [plane(low), plane(low)];
                    let coverage = [plane(2), plane(low)].map(|plane| {
                        plane.into_iter().map(|value| value.min(1.0)).collect::<Vec<f32>>()
                    });
                    let a_signed: Vec<f32> = planes[0].iter().map(|v| v * sign).collect();
                    let mut out = vec![0.0; 4000];
                    let left = Left { shares: [a, b], coverage: [&coverage[0], &coverage[1]] };
                    left.composite([&a_signed, &planes[1]], &mut out);
                    for (at, &found) in out.iter().enumerate() {
                        let expected = exact(
                            [a, b],
                            [a_signed[at], planes[1][at]],
                            [coverage[0][at], coverage[1][at]],
                        );
                        assert_eq!(found.to_bits() << 1, expected.to_bits() << 1, "{}", row.name);
                    }
                }
            }
        }
    }

    #[test]
    fn exact_is_exact() {
        // Whole numbers of 2⁻⁴⁸ in 128 bits, rounded to 24 bits, halves to even.
        let mut seed = 7_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            i128::from(seed >> 40)
        };
        for _ in 0..50_000 {
            let [a, b, covered] = [next(), next(), next()];
            let sum = (a << 24) + b * ((1 << 24) - covered);
            let surplus = (128 - sum.leading_zeros()).saturating_sub(24);
            let (whole, rest) = (sum >> surplus, sum & ((1 << surplus) - 1));
            let half = (1_i128 << surplus) / 2;
            let up = rest > half || rest == half && whole & 1 == 1 && surplus > 0;
            let rounded = (whole + i128::from(up)) << surplus;
            let unit = |value: i128, places: i64| narrowed(value as f64 * power(-places));
            let expected = unit(rounded, 48);
            let [a, b, covered] = [a, b, covered].map(|value| unit(value, 24));
            let found = exact([ALL, OUTSIDE], [a, b], [covered, 0.0]);
            assert_eq!(found.to_bits(), expected.to_bits());
        }
    }
}
