//! Linear bytes: whole numbers of 255ths, sixteen at a time in what the compiler makes of it.

use idf::{Image, ImageError};

use super::{Left, Target, bytes_of};
use crate::operator::{ALL, NONE, Share};
use crate::plan::Plan;

/// All planes of a composite, in the plan's order, from the pixels of two layers from `start` on.
pub(crate) fn planes(
    plan: &Plan,
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
        let light = |layer: usize| match plan.layers[layer].light.get(position) {
            Some(plane) => {
                bytes_of(plane.as_ref().map(|plane| plane.0), images[layer], start, &full)
            }
            None => Ok(left.coverage[layer]),
        };
        composite(shares, [light(0)?, light(1)?], [left_a, left_b], out);
    }
    Ok(())
}

/// `x · y / 255`, rounded to the nearest: exact for all pairs, and never half way between, as 255 is
/// odd.
#[inline]
fn product(x: u8, y: u8) -> u8 {
    rounded(u16::from(x) * u16::from(y))
}

/// `value / 255`, rounded to the nearest, for values up to 255².
#[inline]
fn rounded(value: u16) -> u8 {
    let half_up = value + 128;
    ((half_up + (half_up >> 8)) >> 8).to_le_bytes()[0]
}

/// One plane of a composite. `shares` hold what is left of A and B, as 255ths.
pub(crate) fn composite(
    [share_a, share_b]: [Share; 2],
    [a, b]: [&[u8]; 2],
    [left_a, left_b]: [&[u8]; 2],
    out: &mut [u8],
) {
    match (share_a, share_b) {
        (NONE, NONE) => out.fill(0),
        (ALL, NONE) => out.copy_from_slice(a),
        (NONE, ALL) => out.copy_from_slice(b),
        (ALL, ALL) => add(a, b, out),
        (ALL, _) => add_product(a, b, left_b, out),
        (_, ALL) => add_product(b, a, left_a, out),
        (_, NONE) => multiply(a, left_a, out),
        (NONE, _) => multiply(b, left_b, out),
        _ => {
            let shares = left_a.iter().zip(left_b);
            for ((out, (&a, &b)), (&left_a, &left_b)) in
                out.iter_mut().zip(a.iter().zip(b)).zip(shares)
            {
                let sum = (u16::from(a) * u16::from(left_a))
                    .saturating_add(u16::from(b) * u16::from(left_b));
                *out = rounded(sum.min(255 * 255));
            }
        }
    }
}

fn add(a: &[u8], b: &[u8], out: &mut [u8]) {
    for (out, (&a, &b)) in out.iter_mut().zip(a.iter().zip(b)) {
        *out = a.saturating_add(b);
    }
}

/// A whole number and a rounded product: rounded as their exact sum would be.
fn add_product(whole: &[u8], part: &[u8], left: &[u8], out: &mut [u8]) {
    let inputs = whole.iter().zip(part).zip(left);
    for (out, ((&whole, &part), &left)) in out.iter_mut().zip(inputs) {
        *out = whole.saturating_add(product(part, left));
    }
}

fn multiply(part: &[u8], left: &[u8], out: &mut [u8]) {
    for (out, (&part, &left)) in out.iter_mut().zip(part.iter().zip(left)) {
        *out = product(part, left);
    }
}
