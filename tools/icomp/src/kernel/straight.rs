//! Bytes of any matte and transfer: light weighted by what is left, in 32 bits, and a table back.
//!
//! Light has 23 bits, the table what lies within one of its buckets. A sum that is so near to a
//! threshold of the result that its rounding may be on the other side is worked out as
//! [`super::plain`] does it.

use idf::{Image, ImageError, Kind, Matte, Transfer};

use super::{Target, bytes_of};
use crate::operator::Share;
use crate::plan::Plan;
use crate::store::threshold;

/// Binary places of light within a bucket.
const PLACES: u32 = 11;
/// Buckets for light of 1: the sRGB thresholds nearest to each other are 1.2 of them apart.
const UNIT: u16 = 4080;
/// Buckets; a power of two, so that a mask keeps an index inside.
const BUCKETS: usize = 4096;
/// Where in an entry the byte is: one place above a bucket's, so that a threshold may lie a little
/// beyond the bucket, and no threshold far from it.
const BYTE: u32 = PLACES + 1;
/// Least distance to a threshold at which rounding is sure. Tables, weights, products and the sum
/// are rounded to 24 bits, 5 · 2⁻²⁴ of at most 4080 · 2¹¹; light and threshold to whole numbers.
const NEAR: u32 = 4;
/// Pixels that are worked on together.
const BLOCK: usize = 64;

/// Light of each byte, in units of which `UNIT << PLACES` make 1.
type Light = [f32; 256];

/// What bytes of two layers stand for, and the bytes of the result.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    light: [Light; 2],
    bytes: Bytes,
}

impl Tables {
    /// The tables of two transfers and that of the result, or nothing where two thresholds of it
    /// are within one bucket or nearly so.
    pub(crate) fn new(transfers: [Transfer; 2], result: Transfer) -> Option<Self> {
        let light = transfers.map(|transfer| {
            std::array::from_fn(|byte| {
                let byte = u16::try_from(byte).unwrap_or(u16::MAX);
                narrow(transfer.decode(f64::from(byte) / 255.0) * f64::from(FULL))
            })
        });
        Some(Self { light, bytes: Bytes::new(result)? })
    }
}

/// Light of 1.
const FULL: f32 = UNIT as f32 * (1 << PLACES) as f32;

#[expect(clippy::cast_possible_truncation, reason = "tables hold 32-bit values by definition")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Light to bytes. The entry of a bucket has the byte at its start and, below it, what is lacking to
/// the next byte: one sum gives the byte and, in its lower bits, the distance to the threshold.
#[derive(Clone, Debug)]
struct Bytes(Box<[u32; BUCKETS]>);

impl Bytes {
    fn new(transfer: Transfer) -> Option<Self> {
        const WIDTH: u32 = 1 << PLACES;
        let mut entries: Vec<Option<u32>> = vec![None; BUCKETS];
        let mut set = |bucket: u32, entry: u32| {
            let place = entries.get_mut(bucket as usize)?;
            place.is_none().then(|| *place = Some(entry))
        };
        let mut bases = vec![255; BUCKETS];
        let mut done = 0;
        for byte in 0..255_u16 {
            let least = whole(threshold(transfer, byte, 255.0) / 255.0 * f64::from(FULL));
            let (bucket, inside) = (least >> PLACES, least & (WIDTH - 1));
            let base = u32::from(byte) << BYTE;
            set(bucket, base + 2 * WIDTH - inside)?;
            if inside <= NEAR && bucket > 0 {
                set(bucket - 1, base + WIDTH - inside)?;
            }
            if inside + NEAR >= WIDTH {
                set(bucket + 1, base + 3 * WIDTH - inside)?;
            }
            bases[done..=bucket as usize].fill(base);
            done = bucket as usize + 1;
        }
        bases[done..].fill(255 << BYTE);
        let far = |(entry, base): (Option<u32>, u32)| entry.unwrap_or(base + WIDTH / 2);
        let entries: Vec<u32> = entries.into_iter().zip(bases).map(far).collect();
        Some(Self(entries.into_boxed_slice().try_into().ok()?))
    }

    /// The byte for light of a bucket and what is within it, and how far that is beyond the nearest
    /// threshold but [`NEAR`], modulo the width of an entry.
    #[inline]
    fn entry(&self, light: u32) -> u32 {
        self.0[(light >> PLACES) as usize & (BUCKETS - 1)]
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "light of a threshold is between 0 and 1"
)]
fn whole(light: f64) -> u32 {
    (light + 0.5) as u32
}

/// All planes of a composite, in the plan's order, from the pixels of two layers from `start` on.
pub(crate) fn planes(
    plan: &Plan,
    tables: &Tables,
    shares: [Share; 2],
    images: &[&Image],
    start: usize,
    targets: &mut [Target<'_>],
) -> Result<(), ImageError> {
    let count = targets.first().map_or(0, Target::len);
    let full = vec![u8::MAX; count];
    let plane = |layer: usize, kind: Option<Kind>| bytes_of(kind, images[layer], start, &full);
    let coverage =
        |layer: usize| plane(layer, plan.layers[layer].coverage.as_ref().map(|plane| plane.0));
    let coverage = [coverage(0)?, coverage(1)?];
    let mut lights = Vec::new();
    for position in 0..plan.layers[0].light.len() {
        let light = |layer: usize| {
            plane(layer, plan.layers[layer].light[position].as_ref().map(|plane| plane.0))
        };
        lights.push([light(0)?, light(1)?]);
    }
    let mut mix = Mix::new(plan, tables, shares);
    for from in (0..count).step_by(BLOCK) {
        let block = from..(from + BLOCK).min(count);
        mix.weigh(coverage.map(|plane| padded(&plane[block.clone()])));
        for (position, target) in targets.iter_mut().enumerate() {
            let Target::U8(out) = target else { continue };
            let out = &mut out[block.clone()];
            let new = match lights.get(position) {
                Some(planes) => {
                    mix.light(position, planes.map(|plane| padded(&plane[block.clone()])))
                }
                None => mix.covered(),
            };
            out.copy_from_slice(&new[..out.len()]);
        }
    }
    Ok(())
}

/// The bytes of a block, and 0 beyond them.
fn padded(bytes: &[u8]) -> [u8; BLOCK] {
    match bytes.first_chunk() {
        Some(whole) => *whole,
        None => {
            let mut block = [0; BLOCK];
            block[..bytes.len()].copy_from_slice(bytes);
            block
        }
    }
}

/// What is left of two layers in a block of pixels.
struct Mix<'a> {
    plan: &'a Plan,
    tables: &'a Tables,
    shares: [Share; 2],
    straight: [bool; 2],
    /// Whether layers and result are stored alike.
    same: bool,
    coverage: [[u8; BLOCK]; 2],
    /// Coverage of the result, in units of which the square of 255 make 1.
    covered: [u32; BLOCK],
    /// What each layer's light adds to the light of the result.
    weights: [[f32; BLOCK]; 2],
    /// The layer of which all samples but those of weight 0 are the result's.
    only: Option<usize>,
}

impl<'a> Mix<'a> {
    fn new(plan: &'a Plan, tables: &'a Tables, shares: [Share; 2]) -> Self {
        Self {
            plan,
            tables,
            shares,
            straight: [0, 1].map(|layer| plan.layers[layer].is_straight()),
            same: plan.stored_alike(),
            coverage: [[0; BLOCK]; 2],
            covered: [0; BLOCK],
            weights: [[0.0; BLOCK]; 2],
            only: None,
        }
    }

    fn weigh(&mut self, coverage: [[u8; BLOCK]; 2]) {
        const UNIT: u32 = 255 * 255;
        // All that is chosen is chosen before the loop: 0.4 ns a pixel where it were 2.9.
        let least = if self.plan.matte == Matte::Straight { 0 } else { UNIT };
        let [share_a, share_b] = self.shares;
        let by = self.straight.map(|straight| if straight { [0, 1] } else { [255, 0] });
        // Whether of a layer there is a part of a result, and anything at all.
        let (mut partial_a, mut partial_b, mut any_a, mut any_b) = (0, 0, 0, 0);
        let [weights_a, weights_b] = &mut self.weights;
        let inputs = coverage[0].iter().zip(&coverage[1]);
        let outputs = self.covered.iter_mut().zip(weights_a.iter_mut().zip(weights_b));
        for ((&in_a, &in_b), (covered, (weight_a, weight_b))) in inputs.zip(outputs) {
            let (in_a, in_b) = (u32::from(in_a), u32::from(in_b));
            let (left_a, left_b) = (left(share_a, in_b), left(share_b, in_a));
            let sum = (in_a * left_a + in_b * left_b).min(UNIT);
            let whole = sum.max(least);
            let a = left_a * (by[0][0] + by[0][1] * in_a);
            let b = left_b * (by[1][0] + by[1][1] * in_b);
            let scale = if whole > 0 { 1.0 / float(whole) } else { 0.0 };
            *covered = sum;
            *weight_a = float(a) * scale;
            *weight_b = float(b) * scale;
            any_a |= a;
            any_b |= b;
            partial_a |= if a > 0 { a ^ whole } else { 0 };
            partial_b |= if b > 0 { b ^ whole } else { 0 };
        }
        self.coverage = coverage;
        self.only = match [partial_a | any_b, partial_b | any_a] {
            [0, _] if self.same => Some(0),
            [_, 0] if self.same => Some(1),
            _ => None,
        };
    }

    fn covered(&self) -> [u8; BLOCK] {
        // The nearest 255th of a product of two bytes (Blinn, "Three Wrongs Make a Right", 1995).
        self.covered.map(|covered| {
            let sum = covered + 128;
            ((sum + (sum >> 8)) >> 8).to_le_bytes()[0]
        })
    }

    fn light(&self, position: usize, samples: [[u8; BLOCK]; 2]) -> [u8; BLOCK] {
        // Whole numbers of 23 bits are the lowest bits of a sum with this.
        const WHOLE: f32 = (1 << 23) as f32;
        const LOW: u32 = (1 << PLACES) - 1;
        let mut out = [0; BLOCK];
        if let Some(layer) = self.only {
            let pixels = samples[layer].iter().zip(&self.weights[layer]);
            for (out, (&sample, &weight)) in out.iter_mut().zip(pixels) {
                *out = if weight > 0.0 { sample } else { 0 };
            }
            return out;
        }
        let light = [0, 1].map(|layer: usize| {
            samples[layer].map(|sample| self.tables.light[layer][usize::from(sample)])
        });
        let mut sums = [0; BLOCK];
        for (at, sum) in sums.iter_mut().enumerate() {
            let light = light[0][at] * self.weights[0][at] + light[1][at] * self.weights[1][at];
            let light = if light < FULL { light } else { FULL };
            *sum = (light + WHOLE).to_bits() & ((1 << 23) - 1);
        }
        let mut entries = [0; BLOCK];
        for (entry, &light) in entries.iter_mut().zip(&sums) {
            *entry = self.tables.bytes.entry(light);
        }
        let mut nearest = u32::MAX;
        for ((out, entry), light) in out.iter_mut().zip(&mut entries).zip(&sums) {
            *entry += light & LOW;
            *out = (*entry >> BYTE).to_le_bytes()[0];
            let near = from_threshold(*entry);
            nearest = if near < nearest { near } else { nearest };
        }
        if nearest <= 2 * NEAR {
            for (at, out) in out.iter_mut().enumerate() {
                if from_threshold(entries[at]) <= 2 * NEAR {
                    *out = self.plain(position, at, samples.map(|plane| plane[at]));
                }
            }
        }
        out
    }

    /// One sample as the plain way has it.
    #[cold]
    fn plain(&self, position: usize, at: usize, samples: [u8; 2]) -> u8 {
        let light = [0, 1].map(|layer: usize| {
            let plane = self.plan.layers[layer].light[position].as_ref();
            plane.map_or(0.0, |(_, decoder)| decoder.table()[usize::from(samples[layer])])
        });
        let coverage = self.coverage.map(|plane| f64::from(plane[at]));
        let covered = f64::from(self.covered[at]);
        self.plan.weighted(self.shares, light, coverage, covered).to_le_bytes()[0]
    }
}

/// Steps from [`NEAR`] below a threshold on, modulo twice the width of a bucket.
#[inline]
fn from_threshold(entry: u32) -> u32 {
    entry.wrapping_add(NEAR) & ((1 << BYTE) - 1)
}

/// What the other picture's coverage leaves, as 255ths.
#[inline]
fn left(share: Share, other: u32) -> u32 {
    let constant = 255 * i32::from(share.constant);
    constant.wrapping_add(i32::from(share.slope).wrapping_mul(other.cast_signed())).cast_unsigned()
}

/// Products of two bytes are exact in 24 bits.
#[inline]
#[expect(clippy::cast_precision_loss, reason = "below 2^24")]
fn float(product: u32) -> f32 {
    product.cast_signed() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_is_that_of_the_threshold_or_in_doubt() {
        for transfer in [Transfer::Srgb, Transfer::Linear, Transfer::Gamma(1.2)] {
            let bytes = Bytes::new(transfer).unwrap();
            let (mut least, mut byte, mut doubts) = (0.0, 0, 0_u32);
            let top = u32::from(UNIT) << PLACES;
            for light in 0..=top {
                while byte < 255 && f64::from(light) >= least_above(transfer, byte) {
                    least = least_above(transfer, byte);
                    byte += 1;
                }
                let entry = bytes.entry(light) + (light & ((1 << PLACES) - 1));
                if from_threshold(entry) <= 2 * NEAR {
                    doubts += 1;
                    continue;
                }
                assert_eq!(entry >> BYTE, u32::from(byte), "{transfer} {light} above {least}");
                // Nothing within reach of a threshold is sure.
                let next = if byte < 255 { least_above(transfer, byte) } else { f64::INFINITY };
                let far = (f64::from(light) - least).min(next - f64::from(light));
                assert!(byte == 0 || far > f64::from(NEAR) - 1.0, "{transfer} {light}: {far}");
            }
            assert_eq!(byte, 255);
            assert!(doubts <= 255 * (2 * NEAR + 1), "{transfer}: {doubts} are in doubt");
        }
    }

    fn least_above(transfer: Transfer, byte: u16) -> f64 {
        threshold(transfer, byte, 255.0) / 255.0 * f64::from(FULL)
    }

    #[test]
    fn a_steep_curve_has_no_table() {
        assert!(Bytes::new(Transfer::Gamma(10.0)).is_none());
    }
}
