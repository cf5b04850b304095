//! Transfer: how linear light is stored.

use std::fmt;
use std::sync::LazyLock;

/// How stored values, 0 to 1, relate to linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// The curve of IEC 61966-2-1.
    Srgb,
    /// Stored values are light.
    Linear,
    /// Light is the stored value to this power; in [`Transfer::GAMMAS`].
    Gamma(f64),
}

impl Transfer {
    /// Exponents that a description may give. Beyond them 8 bits hold fewer than 20 tones.
    pub const GAMMAS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

    /// Stored value of linear light. Negative light is mirrored, and nothing is clamped.
    pub fn encode(self, linear: f64) -> f64 {
        let light = linear.abs();
        let stored = match self {
            Self::Linear => light,
            Self::Srgb if light <= 0.003_130_8 => 12.92 * light,
            Self::Srgb => 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055,
            Self::Gamma(gamma) => libm::pow(light, 1.0 / gamma),
        };
        stored.copysign(linear)
    }

    /// Linear light of a stored value; the reverse of [`Transfer::encode`].
    pub fn decode(self, stored: f64) -> f64 {
        let value = stored.abs();
        let light = match self {
            Self::Linear => value,
            Self::Srgb if value <= 0.040_45 => value / 12.92,
            Self::Srgb => libm::pow((value + 0.055) / 1.055, 2.4),
            Self::Gamma(gamma) => libm::pow(value, gamma),
        };
        light.copysign(stored)
    }
}

impl fmt::Display for Transfer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Srgb => f.write_str("srgb"),
            Self::Linear => f.write_str("linear"),
            Self::Gamma(gamma) => write!(f, "gamma {gamma}"),
        }
    }
}

/// Linear light to 8 bits: the stored value times 255, rounded to the nearest, halves up.
///
/// A table of the least light that reaches each byte, so no power is taken for a sample: 2 ns
/// against 33 ns for [`rounded_8`], with the same result (`benches/planes.rs`).
#[derive(Clone)]
pub struct Quantizer {
    /// `least[k]` is the least light that is stored as `k + 1`.
    least: [f64; 255],
    /// Byte of the light `index / BUCKETS`, from which a search starts.
    start: Vec<u8>,
    /// For each bucket its first byte above the bits of the 32-bit light where the next begins;
    /// none where two begin in one bucket.
    entries: Option<Box<[u64; ENTRIES]>>,
}

/// Enough that the search takes at most two steps: the sRGB thresholds nearest to each other are
/// 1 / (255 · 12.92) apart.
const BUCKETS: u16 = 4096;

impl Quantizer {
    /// The table of `transfer`.
    pub fn new(transfer: Transfer) -> Self {
        let mut least = [0.0; 255];
        for (light, below) in least.iter_mut().zip(0..=254) {
            *light = least_above(transfer, below);
        }
        let start = (0..=BUCKETS)
            .map(|bucket| {
                let light = f64::from(bucket) / f64::from(BUCKETS);
                u8::try_from(least.partition_point(|&l| l <= light)).unwrap_or(u8::MAX)
            })
            .collect();
        let entries = entries(&least);
        Self { least, start, entries }
    }

    /// The byte for `linear` light. Below 0 and not a number give 0, above 1 gives 255.
    #[inline]
    pub fn byte(&self, linear: f64) -> u8 {
        let mut byte = self.start[bucket(linear)];
        while self.least.get(usize::from(byte)).is_some_and(|&least| least <= linear) {
            byte += 1;
        }
        byte
    }

    /// The bytes for linear light, as [`Quantizer::byte`] has them, without a search: each is one
    /// entry of a table and a comparison.
    pub fn fill(&self, linear: &[f32], bytes: &mut [u8]) {
        let Some(entries) = &self.entries else {
            let pairs = bytes.iter_mut().zip(linear);
            return pairs.for_each(|(byte, &linear)| *byte = self.byte(f64::from(linear)));
        };
        for (bytes, linear) in bytes.chunks_mut(BLOCK).zip(linear.chunks(BLOCK)) {
            let mut light = [0.0; BLOCK];
            for (light, &linear) in light.iter_mut().zip(linear) {
                let some = if linear > 0.0 { linear } else { 0.0 };
                *light = if some < 1.0 { some } else { 1.0 };
            }
            // The last place of a sum with 2^11 is 2^-12, so its lowest bits are the nearest bucket.
            let buckets = light.map(|light| (light + 2048.0).to_bits() & 0x1fff);
            let mut found = [0; BLOCK];
            for (entry, bucket) in found.iter_mut().zip(buckets) {
                *entry = entries[bucket as usize];
            }
            for (byte, (entry, light)) in bytes.iter_mut().zip(found.iter().zip(light)) {
                // Of positive numbers the order is that of their bits.
                let above = u64::from(light.to_bits()) >= entry & u64::from(u32::MAX);
                *byte = ((entry >> 32) + u64::from(above)).to_le_bytes()[0];
            }
        }
    }
}

/// Values that are worked on together.
const BLOCK: usize = 64;

/// Entries of [`Quantizer::fill`]: a power of two, so that an index needs no check.
const ENTRIES: usize = 1 << 13;

/// See [`Quantizer`]; the bucket of an entry lies about `index / BUCKETS`.
fn entries(least: &[f64; 255]) -> Option<Box<[u64; ENTRIES]>> {
    let mut entries = vec![0; ENTRIES];
    for (bucket, entry) in (0..=BUCKETS).zip(&mut entries) {
        let [start, end] = [-0.5, 0.5].map(|half| (f64::from(bucket) + half) / f64::from(BUCKETS));
        let byte = least.partition_point(|&light| light <= start);
        let begins = |byte: usize| least.get(byte).filter(|&&light| light <= end);
        let light = match (begins(byte), begins(byte + 1)) {
            (_, Some(_)) => return None,
            (Some(&least), None) => least_sample(least),
            (None, None) => f32::INFINITY,
        };
        *entry = (byte as u64) << 32 | u64::from(light.to_bits());
    }
    entries.into_boxed_slice().try_into().ok()
}

/// The least 32-bit number that is not below `value`.
#[expect(clippy::cast_possible_truncation, reason = "rounded up to 32 bits by contract")]
fn least_sample(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

impl fmt::Debug for Quantizer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Quantizer").field("least", &self.least).finish_non_exhaustive()
    }
}

/// Linear light to an sRGB byte; [`Quantizer::byte`] with a shared table.
#[inline]
pub fn srgb8(linear: f64) -> u8 {
    static TABLE: LazyLock<Quantizer> = LazyLock::new(|| Quantizer::new(Transfer::Srgb));
    TABLE.byte(linear)
}

/// Linear light to 8 bits by the plain formula.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is between 0 and 255.5, or not a number, which becomes 0"
)]
pub fn rounded_8(transfer: Transfer, linear: f64) -> u8 {
    (transfer.encode(linear).clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Linear light to 16 bits, rounded to the nearest, halves up.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is between 0 and 65535.5, or not a number, which becomes 0"
)]
pub fn rounded_16(transfer: Transfer, linear: f64) -> u16 {
    (transfer.encode(linear).clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16
}

/// The least light stored above `byte`, by bisection over the ordered bits of positive numbers.
fn least_above(transfer: Transfer, byte: u8) -> f64 {
    let mut below = 0;
    let mut above = 1.0_f64.to_bits();
    while above - below > 1 {
        let middle = u64::midpoint(below, above);
        if rounded_8(transfer, f64::from_bits(middle)) > byte {
            above = middle;
        } else {
            below = middle;
        }
    }
    f64::from_bits(above)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is between 0 and the bucket count, or not a number, which becomes 0"
)]
fn bucket(linear: f64) -> usize {
    (linear.clamp(0.0, 1.0) * f64::from(BUCKETS)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRANSFERS: [Transfer; 5] = [
        Transfer::Srgb,
        Transfer::Linear,
        Transfer::Gamma(2.2),
        Transfer::Gamma(0.1),
        Transfer::Gamma(10.0),
    ];

    #[test]
    fn srgb_has_the_values_of_the_standard() {
        for (linear, stored) in [
            (0.0, 0.0),
            (0.001, 0.01292),
            (0.214_041_140_482_232_55, 0.5),
            (0.5, 0.735_356_983_052_449_2),
            (1.0, 1.0),
            (-0.5, -0.735_356_983_052_449_2),
        ] {
            assert!((Transfer::Srgb.encode(linear) - stored).abs() < 1e-12, "{linear}");
            assert!((Transfer::Srgb.decode(stored) - linear).abs() < 1e-12, "{stored}");
        }
        assert!((Transfer::Gamma(2.0).decode(0.5) - 0.25).abs() < 1e-15);
    }

    #[test]
    fn the_table_agrees_with_the_formula_about_every_threshold() {
        for transfer in TRANSFERS {
            let quantizer = Quantizer::new(transfer);
            for &least in &quantizer.least {
                let bits = least.to_bits();
                for near in bits.saturating_sub(300)..=bits + 300 {
                    let light = f64::from_bits(near);
                    let plain = rounded_8(transfer, light);
                    assert_eq!(quantizer.byte(light), plain, "{transfer} {light:e}");
                }
            }
        }
    }

    #[test]
    fn slices_are_as_single_values() {
        for transfer in TRANSFERS {
            let quantizer = Quantizer::new(transfer);
            let mut light = vec![0.0, -0.0, -1.0, 1.0, 2.0, f32::INFINITY, f32::NAN, 1e-40];
            for &least in &quantizer.least {
                let mut near = least_sample(least);
                light.push(near);
                (0..3).for_each(|_| near = near.next_down());
                light.extend([near, near.next_up(), near.next_up().next_up()]);
            }
            for bucket in 0..=BUCKETS {
                for half in [0.0, 0.5] {
                    let start = (f32::from(bucket) + half) / f32::from(BUCKETS);
                    light.extend([start, start.next_up(), start.next_down()]);
                }
            }
            let mut bytes = vec![7; light.len()];
            quantizer.fill(&light, &mut bytes);
            for (&light, &byte) in light.iter().zip(&bytes) {
                assert_eq!(byte, quantizer.byte(f64::from(light)), "{transfer} {light:e}");
            }
        }
        assert!(Quantizer::new(Transfer::Srgb).entries.is_some(), "the usual one has a table");
    }

    #[test]
    fn the_table_agrees_with_the_formula_everywhere() {
        let mut seed = 1_u64;
        for _ in 0..200_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Any bits at all: every sign, exponent, infinity and not-a-number.
            let light = f64::from_bits(seed ^ (seed >> 29));
            let unit = f64::from(u32::try_from(seed >> 32).unwrap()) / 4_294_967_296.0;
            for value in [light, unit] {
                assert_eq!(srgb8(value), rounded_8(Transfer::Srgb, value), "{value:e}");
            }
        }
        for value in [0.0, -0.0, f64::MIN_POSITIVE, 5e-324, -1.0, 1.0, 2.0, f64::INFINITY] {
            assert_eq!(srgb8(value), rounded_8(Transfer::Srgb, value), "{value:e}");
        }
        assert_eq!((srgb8(f64::NAN), srgb8(0.5), srgb8(0.214)), (0, 188, 127));
    }
}
