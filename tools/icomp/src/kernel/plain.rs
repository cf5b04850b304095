//! Any pictures, in 64 bits: layers folded from the left, and rounded once.
//!
//! Values are numerators. Coverage of one layer is counted in `full`, its light in `full` of light
//! times `full` of coverage; combining with a further one multiplies both units by `full`. For
//! integers stored linearly all are whole numbers, below 2^53 for two layers, so that the result is
//! that of exact arithmetic. The fast ways are tested against this one.

use idf::{Image, ImageError, Matte};

use super::Target;
use crate::operator::{Rule, Share};
use crate::plan::{Layer, Plan};
use crate::store::full;

/// Light and coverage of a stretch of pixels.
struct Stretch {
    light: Vec<Vec<f64>>,
    coverage: Vec<f64>,
    /// The number that stands for coverage 1.
    unit: f64,
}

/// Unit beyond which numbers are made smaller, far from overflow.
const MOST_UNIT: f64 = 1e90;
/// 2⁻³⁰⁰, so that this rounds nothing.
const SMALLER: f64 = f64::from_bits((1023 - 300) << 52);

/// Fills the planes of the result, in the plan's order.
pub(crate) fn composite(
    plan: &Plan,
    images: &[&Image],
    start: usize,
    targets: &mut [Target<'_>],
) -> Result<(), ImageError> {
    let count = targets.first().map_or(0, Target::len);
    let full = full(plan.depth);
    let mut layers = plan.layers.iter().zip(images);
    let Some((layer, image)) = layers.next() else { return Ok(()) };
    let mut result = stretch(plan, layer, image, start, count)?;
    match plan.rule {
        Rule::One { light, coverage } => {
            if light {
                let values = result.light.iter_mut().flatten();
                values.for_each(|value| *value *= plan.factor);
            }
            if coverage {
                let values = result.coverage.iter_mut();
                values.for_each(|value| *value = (*value * plan.factor).min(full));
            }
        }
        Rule::Two { a, b } => {
            for (layer, image) in layers {
                let next = stretch(plan, layer, image, start, count)?;
                combine(&mut result, &next, [a, b]);
            }
        }
    }
    for (position, target) in targets.iter_mut().enumerate() {
        match result.light.get(position) {
            Some(light) => store_light(plan, light, &result, target),
            None => store_coverage(plan, &result, target),
        }
    }
    Ok(())
}

/// Premultiplied light and coverage of one layer.
fn stretch(
    plan: &Plan,
    layer: &Layer,
    image: &Image,
    start: usize,
    count: usize,
) -> Result<Stretch, ImageError> {
    let unit = full(plan.depth);
    let mut coverage = vec![unit; count];
    if let Some((kind, decoder)) = &layer.coverage {
        decoder.fill(image.needed(*kind)?, start, &mut coverage);
        coverage.iter_mut().for_each(|value| *value = value.clamp(0.0, unit));
    }
    let mut light = Vec::with_capacity(layer.light.len());
    for source in &layer.light {
        let mut values = vec![0.0; count];
        if let Some((kind, decoder)) = source {
            decoder.fill(image.needed(*kind)?, start, &mut values);
            for (value, &coverage) in values.iter_mut().zip(&coverage) {
                *value = match (layer.matte, plan.stored) {
                    (Matte::Straight, _) => *value * coverage,
                    (Matte::Premultiplied, false) => *value * unit,
                    (Matte::Premultiplied, true) if coverage > 0.0 => {
                        plan.transfer.encode(*value / coverage) * unit * coverage
                    }
                    (Matte::Premultiplied, true) => 0.0,
                };
            }
        }
        light.push(values);
    }
    Ok(Stretch { light, coverage, unit })
}

/// What is left of the layers so far and of the next one, added.
fn combine(result: &mut Stretch, next: &Stretch, [share_a, share_b]: [Share; 2]) {
    let unit = result.unit * next.unit;
    let factor = if unit > MOST_UNIT { SMALLER } else { 1.0 };
    let left =
        result.coverage.iter().zip(&next.coverage).map(|(&a, &b)| {
            (share_a.of(b, next.unit) * factor, share_b.of(a, result.unit) * factor)
        });
    let left: Vec<(f64, f64)> = left.collect();
    let combine = |values: &mut [f64], others: &[f64]| {
        for ((value, other), (a, b)) in values.iter_mut().zip(others).zip(&left) {
            *value = *value * a + *other * b;
        }
    };
    for (light, other) in result.light.iter_mut().zip(&next.light) {
        combine(light, other);
    }
    combine(&mut result.coverage, &next.coverage);
    result.unit = unit * factor;
    let most = result.unit;
    result.coverage.iter_mut().for_each(|value| *value = value.min(most));
}

fn store_coverage(plan: &Plan, result: &Stretch, target: &mut Target<'_>) {
    let full = full(plan.depth);
    target.fill(
        |at| plan.coverage.sample(result.coverage[at] * full, result.unit),
        |at| result.coverage[at] / result.unit,
    );
}

fn store_light(plan: &Plan, light: &[f64], result: &Stretch, target: &mut Target<'_>) {
    let full = full(plan.depth);
    let straight = plan.matte == Matte::Straight;
    let weight = |at: usize| if straight { result.coverage[at] } else { result.unit };
    // Light, in `full` times the weight; or stored values that stay so.
    let value = |at: usize| {
        let (value, coverage) = (light[at], result.coverage[at]);
        match plan.stored && !straight {
            true if coverage > 0.0 => {
                plan.transfer.decode(value / coverage / full) * full * coverage
            }
            true => 0.0,
            false => value,
        }
    };
    target.fill(
        |at| plan.light.sample(value(at), weight(at)),
        |at| {
            let weight = weight(at);
            let value = if weight > 0.0 { value(at) / weight } else { 0.0 };
            if plan.stored && straight { value } else { plan.transfer.encode(value) }
        },
    );
}
