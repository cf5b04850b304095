//! Pixels from several others: linear, multiplied by coverage, and rounded once.

use idf::plane::Role;
use idf::{Depth, Image, ImageError, Kind, Matte, Plane, Samples, Transfer};

use crate::CopyError;

/// An image of `size` whose light and coverage are `mix` of the old values, and all else `pick`
/// of the old samples.
pub(crate) fn remixed(
    image: &Image,
    size: [u32; 2],
    mix: impl Fn(&[f32]) -> Vec<f32>,
    pick: impl Fn(&Samples) -> Samples,
) -> Result<Image, CopyError> {
    let columns = size[0] as usize;
    let straight = image.properties.matte == Matte::Straight;
    let coverage = match image.plane(Kind::Cvg) {
        Some(_) => Some(image.decoded(Kind::Cvg)?),
        None => None,
    };
    let mixed_coverage = coverage.as_ref().map(|values| {
        let mut values = mix(values);
        // Negative weights lead beyond what can be covered.
        values.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
        values
    });
    let mut planes = Vec::new();
    for Plane { kind, samples } in image.planes() {
        let depth = samples.depth();
        let samples = match kind.role() {
            Role::Light => {
                let transfer = image.transfer(depth);
                let mut values = samples.decoded(transfer);
                if let Some(coverage) = coverage.as_ref().filter(|_| straight) {
                    values.iter_mut().zip(coverage).for_each(|(value, share)| *value *= share);
                }
                values = mix(&values);
                if let Some(coverage) = mixed_coverage.as_ref().filter(|_| straight) {
                    for (value, &share) in values.iter_mut().zip(coverage) {
                        *value = if share > 0.0 { *value / share } else { 0.0 };
                    }
                }
                encoded(*kind, &values, columns, depth, transfer)?
            }
            Role::Coverage => {
                let values = mixed_coverage.as_deref().unwrap_or_default();
                encoded(*kind, values, columns, depth, Transfer::Linear)?
            }
            _ => pick(samples),
        };
        planes.push(Plane { kind: *kind, samples });
    }
    Ok(image.with_planes(size[0], size[1], planes)?)
}

/// Samples of linear values; the error has the place of what is not a number.
pub(crate) fn encoded(
    kind: Kind,
    values: &[f32],
    columns: usize,
    depth: Depth,
    transfer: Transfer,
) -> Result<Samples, ImageError> {
    Samples::encoded(values, depth, transfer).map_err(|position| {
        let (column, row) = (position % columns, position / columns);
        ImageError::NotANumber { kind, column, row }
    })
}
