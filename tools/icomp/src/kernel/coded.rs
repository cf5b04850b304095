//! Bytes of any transfer: a table of light, products in fixed point, and a table back.

use idf::{Image, ImageError, Transfer};

use super::{Left, Target, bytes, bytes_of};
use crate::operator::{ALL, Share};
use crate::plan::Plan;
use crate::store::threshold;

/// Binary places of light in fixed point. Shares add 8 bits and a sum one more, which leaves 5 of
/// 64.
const PLACES: u32 = 50;
/// Binary places, of light times 255, that a bucket spans: a 4080th of 1, as the sRGB thresholds
/// nearest to each other are 1 / (255 · 12.92) apart.
const BUCKET_PLACES: u32 = PLACES - 4;
/// Buckets beyond a light of 2, the most that two pictures give; a power of two, so that a mask
/// keeps an index inside.
const BUCKETS: usize = 8192;

/// Light of each byte.
type Light = [u64; 256];

/// What bytes of two layers stand for, and the bytes of the result.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    light: [Light; 2],
    /// Light of the first layer times 255: all of it.
    full_a: Light,
    bytes: Bytes,
    /// Whether layers and result are stored alike.
    same: bool,
}

impl Tables {
    /// The tables of two transfers and that of the result, or nothing where two thresholds of it
    /// fall into one bucket.
    pub(crate) fn new(transfers: [Transfer; 2], result: Transfer) -> Option<Self> {
        let same = transfers.iter().all(|&transfer| transfer == result);
        let light = transfers.map(light);
        let full_a = light[0].map(|light| 255 * light);
        Some(Self { light, full_a, bytes: Bytes::new(result)?, same })
    }
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
    let full = vec![u8::MAX; targets.first().map_or(0, Target::len)];
    let left = Left::new(plan, shares, images, start, &full)?;
    let [left_a, left_b] = &left.shares;
    for (position, target) in targets.iter_mut().enumerate() {
        let Target::U8(out) = target else { continue };
        let light = |layer: usize| plan.layers[layer].light.get(position);
        let (Some(Some(a)), Some(Some(b))) = (light(0), light(1)) else {
            bytes::composite(shares, left.coverage, [left_a, left_b], out);
            continue;
        };
        let a = bytes_of(Some(a.0), images[0], start, &full)?;
        let b = bytes_of(Some(b.0), images[1], start, &full)?;
        composite(tables, shares, [a, b], [left_a, left_b], out);
    }
    Ok(())
}

/// The light of bytes stored by `transfer`, in fixed point.
fn light(transfer: Transfer) -> Light {
    std::array::from_fn(|byte| {
        let value = u16::try_from(byte).unwrap_or(u16::MAX);
        fixed(transfer.decode(f64::from(value) / 255.0))
    })
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "light of a byte is between 0 and 1"
)]
fn fixed(light: f64) -> u64 {
    (light * f64::from(1 << 25) * f64::from(1 << 25) + 0.5) as u64
}

/// Light times 255 to bytes. The entry of a bucket has the byte at its start and, below it, what is
/// lacking to the next byte, so that one sum and a shift give the byte: no comparison, no jump.
#[derive(Clone, Debug)]
struct Bytes(Box<[u64; BUCKETS]>);

impl Bytes {
    /// The table of `transfer`, or nothing where two thresholds fall into one bucket.
    fn new(transfer: Transfer) -> Option<Self> {
        let mut entries = vec![0_u64; BUCKETS];
        let mut byte = 0_u16;
        for (bucket, entry) in (0_u64..).zip(&mut entries) {
            *entry = u64::from(byte) << BUCKET_PLACES;
            if byte == 255 {
                continue;
            }
            let start = bucket << BUCKET_PLACES;
            let inside = |byte| {
                let least = 255 * fixed(threshold(transfer, byte, 255.0) / 255.0);
                least.checked_sub(start).filter(|least| *least < 1 << BUCKET_PLACES)
            };
            if let Some(least) = inside(byte) {
                *entry += (1 << BUCKET_PLACES) - least;
                byte += 1;
                if byte < 255 && inside(byte).is_some() {
                    return None;
                }
            }
        }
        Some(Self(entries.into_boxed_slice().try_into().ok()?))
    }

    /// The byte for light times 255.
    #[inline]
    fn byte(&self, value: u64) -> u8 {
        let bucket = (value >> BUCKET_PLACES) & (BUCKETS as u64 - 1);
        let entry = self.0[usize::try_from(bucket).unwrap_or(0)];
        ((entry + (value & ((1 << BUCKET_PLACES) - 1))) >> BUCKET_PLACES).to_le_bytes()[0]
    }
}

/// Bytes whose shares are looked at together.
const BLOCK: usize = 64;

/// One plane of a composite. `left_a` and `left_b` are what is left of A and B, as 255ths.
///
/// Where all of one picture is left and nothing of the other, its bytes are the result.
fn composite(
    tables: &Tables,
    shares: [Share; 2],
    [a, b]: [&[u8]; 2],
    [left_a, left_b]: [&[u8]; 2],
    out: &mut [u8],
) {
    let Tables { light: [light_a, light_b], full_a, bytes, same } = tables;
    let whole = shares[0] == ALL;
    let inputs = a.chunks(BLOCK).zip(b.chunks(BLOCK));
    let left = left_a.chunks(BLOCK).zip(left_b.chunks(BLOCK));
    for ((out, (a, b)), (left_a, left_b)) in out.chunks_mut(BLOCK).zip(inputs).zip(left) {
        if *same {
            let only_a = gone(b, left_b);
            if only_a && all(left_a, u8::MAX) {
                out.copy_from_slice(a);
                continue;
            }
            if gone(a, left_a) && all(left_b, u8::MAX) {
                out.copy_from_slice(b);
                continue;
            }
        }
        let pixels = a.iter().zip(b).zip(left_a.iter().zip(left_b));
        if whole {
            for (out, ((&a, &b), (_, &left))) in out.iter_mut().zip(pixels) {
                let value = full_a[usize::from(a)] + light_b[usize::from(b)] * u64::from(left);
                *out = bytes.byte(value);
            }
        } else {
            for (out, ((&a, &b), (&left_a, &left_b))) in out.iter_mut().zip(pixels) {
                let value = light_a[usize::from(a)] * u64::from(left_a)
                    + light_b[usize::from(b)] * u64::from(left_b);
                *out = bytes.byte(value);
            }
        }
    }
}

/// Whether nothing of a picture is left.
fn gone(bytes: &[u8], left: &[u8]) -> bool {
    all(left, 0) || all(bytes, 0)
}

fn all(bytes: &[u8], value: u8) -> bool {
    bytes.iter().fold(0, |differ, byte| differ | (byte ^ value)) == 0
}
