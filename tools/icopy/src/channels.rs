//! Channels picked, renamed, filled with a number, or made of others.

use idf::plane::Role;
use idf::{Depth, Image, ImageError, Kind, Matte, Plane, Samples, Transfer};

use crate::CopyError;
use crate::mix::encoded;

/// A channel of the copy, and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Kind in the copy.
    pub to: Kind,
    /// Where it comes from.
    pub from: Source,
}

/// Where a channel comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A channel of the original, as it is stored.
    Kind(Kind),
    /// One value: for light a display value (sRGB, 0 to 1) of the covered part, for coverage 0 to
    /// 1, for indices a whole number, for measured values any.
    Constant(f64),
    /// Luminance of the colour in linear light (ITU-R BT.709), or the grey that is there.
    Luminance,
}

impl From<Kind> for Source {
    fn from(kind: Kind) -> Self {
        Self::Kind(kind)
    }
}

/// Share of red, green and blue light in luminance (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Only the channels of `picks`.
pub(crate) fn picked(image: &Image, picks: &[Pick]) -> Result<Image, CopyError> {
    let mut planes: Vec<Plane> = Vec::new();
    for pick in picks {
        let samples = match pick.from {
            Source::Kind(Kind::Lut) => continue,
            Source::Kind(kind) => image.needed(kind)?.clone(),
            Source::Luminance => luminance(image)?,
            // After all others, as light is multiplied by the copy's coverage.
            Source::Constant(_) => Samples::U8(Vec::new()),
        };
        planes.push(Plane { kind: pick.to, samples });
    }
    let depth = image.depth();
    let constant = |pick: &Pick| match pick.from {
        Source::Constant(value) => Some((pick.to, value)),
        Source::Kind(_) | Source::Luminance => None,
    };
    let constants: Vec<(Kind, f64)> = picks.iter().filter_map(constant).collect();
    // Coverage first.
    for wanted in [Role::Coverage, Role::Light, Role::Data, Role::Index] {
        for &(kind, value) in constants.iter().filter(|(kind, _)| kind.role() == wanted) {
            let coverage = planes.iter().find(|plane| plane.kind == Kind::Cvg);
            let samples = filled(image, kind, value, depth, coverage)?;
            let empty = |plane: &&mut Plane| plane.kind == kind && plane.samples.is_empty();
            if let Some(plane) = planes.iter_mut().find(empty) {
                plane.samples = samples;
            }
        }
    }
    let wants_lut = picks.iter().any(|pick| pick.from == Source::Kind(Kind::Lut));
    if wants_lut && image.lut.is_none() {
        let present = image.kinds();
        return Err(ImageError::Missing { kind: Kind::Lut, present }.into());
    }
    let mut copy = image.with_planes(image.columns(), image.rows(), planes)?;
    copy.lut = copy.lut.filter(|_| wants_lut);
    Ok(copy)
}

/// A plane of one value.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "planes hold 32-bit values by definition; an index is checked where it is parsed"
)]
fn filled(
    image: &Image,
    kind: Kind,
    value: f64,
    depth: Depth,
    coverage: Option<&Plane>,
) -> Result<Samples, ImageError> {
    let [columns, rows] = image.size().map(|length| length as usize);
    let even = |value: f64| vec![value as f32; columns * rows];
    match kind.role() {
        Role::Light => {
            let mut values = even(Transfer::Srgb.decode(value));
            let premultiplied = image.properties.matte == Matte::Premultiplied;
            if let Some(plane) = coverage.filter(|_| premultiplied) {
                let shares = plane.samples.decoded(Transfer::Linear);
                values.iter_mut().zip(shares).for_each(|(value, share)| *value *= share);
            }
            encoded(kind, &values, columns, depth, image.transfer(depth))
        }
        Role::Coverage => encoded(kind, &even(value), columns, depth, Transfer::Linear),
        Role::Index => Ok(Samples::U8(vec![value as u8; columns * rows])),
        _ => Ok(Samples::F32(even(value))),
    }
}

/// Luminance, as light is stored here.
fn luminance(image: &Image) -> Result<Samples, ImageError> {
    let resolved = image.resolved()?;
    let kinds = resolved.light_kinds()?;
    let [red, green, blue] = kinds[..] else {
        return resolved.needed(Kind::Grg).cloned();
    };
    let depths = kinds.iter().filter_map(|&kind| resolved.plane(kind)).map(Samples::depth);
    let depth = depths.max().unwrap_or(Depth::U8);
    let mut sum = vec![0.0; resolved.needed(red)?.len()];
    for (kind, share) in [red, green, blue].into_iter().zip(LUMINANCE) {
        let values = resolved.decoded(kind)?;
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
    }
    encoded(Kind::Grg, &sum, image.columns() as usize, depth, resolved.transfer(depth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::Lut;

    fn plane(kind: Kind, samples: &[u8]) -> Plane {
        Plane { kind, samples: Samples::U8(samples.into()) }
    }

    fn image() -> Image {
        let planes = vec![plane(Kind::Enc, &[0, 1]), plane(Kind::Grg, &[128, 0])];
        let mut image = Image::new(2, 1, planes).unwrap();
        image.lut = Lut::new(vec![[1, 2, 3]; 2]);
        image
    }

    fn kinds(picks: &[(Kind, Kind)]) -> Result<Image, CopyError> {
        let pick = |&(to, from)| Pick { to, from: Source::Kind(from) };
        picked(&image(), &picks.iter().map(pick).collect::<Vec<_>>())
    }

    #[test]
    fn channels_are_picked_and_renamed() {
        let copy = kinds(&[(Kind::Cvg, Kind::Grg), (Kind::Grg, Kind::Grg)]).unwrap();
        assert_eq!(copy.kinds(), [Kind::Cvg, Kind::Grg]);
        assert_eq!(copy.plane(Kind::Cvg), Some(&Samples::U8(vec![128, 0])));
        let copy = kinds(&[(Kind::Lut, Kind::Lut), (Kind::Enc, Kind::Enc)]).unwrap();
        assert_eq!(copy.kinds(), [Kind::Enc, Kind::Lut]);
        let present = vec![Kind::Enc, Kind::Grg, Kind::Lut];
        let missing = ImageError::Missing { kind: Kind::Red, present };
        assert_eq!(kinds(&[(Kind::Red, Kind::Red)]), Err(CopyError::Image(missing)));
        let twice = kinds(&[(Kind::Cvg, Kind::Grg), (Kind::Cvg, Kind::Grg)]);
        assert_eq!(twice, Err(CopyError::Image(ImageError::Twice(Kind::Cvg))));
    }

    #[test]
    fn constants_are_of_the_covered_part() {
        let pick = |to, value| Pick { to, from: Source::Constant(value) };
        let picks = [pick(Kind::Red, 1.0), Pick { to: Kind::Cvg, from: Source::Kind(Kind::Grg) }];
        let copy = picked(&image(), &picks).unwrap();
        assert_eq!(copy.kinds(), [Kind::Red, Kind::Cvg]);
        // 128/255 of white light is stored as 188.
        assert_eq!(copy.plane(Kind::Red), Some(&Samples::U8(vec![188, 0])));
        let picks = [pick(Kind::Grg, 0.5), pick(Kind::Cvg, 1.0), pick(Kind::Dep, -3.0)];
        let copy = picked(&image(), &picks).unwrap();
        assert_eq!(copy.plane(Kind::Grg), Some(&Samples::U8(vec![128; 2])));
        assert_eq!(copy.plane(Kind::Cvg), Some(&Samples::U8(vec![255; 2])));
        assert_eq!(copy.plane(Kind::Dep), Some(&Samples::F32(vec![-3.0; 2])));
        let copy = picked(&image(), &[pick(Kind::Enc, 7.0)]).unwrap();
        assert_eq!(copy.plane(Kind::Enc), Some(&Samples::U8(vec![7; 2])));
    }

    #[test]
    fn luminance_is_of_linear_light() {
        let planes = vec![
            plane(Kind::Red, &[255, 0, 0, 188]),
            plane(Kind::Grn, &[0, 255, 0, 188]),
            plane(Kind::Blu, &[0, 0, 255, 188]),
        ];
        let color = Image::new(4, 1, planes).unwrap();
        let picks = [Pick { to: Kind::Grg, from: Source::Luminance }];
        let copy = picked(&color, &picks).unwrap();
        // sRGB of 0.2126, 0.7152 and 0.0722, times 255: 127.1, 219.9, 75.9.
        assert_eq!(copy.plane(Kind::Grg), Some(&Samples::U8(vec![127, 220, 76, 188])));
        let grey = picked(&image(), &picks).unwrap();
        assert_eq!(grey.plane(Kind::Grg), image().plane(Kind::Grg));
    }
}
