//! Pictures of differences.

use idf::{Depth, Image, ImageError, Kind, Plane, Samples, Transfer};
use rayon::prelude::*;

use crate::pair::{Channel, ONE, Pair, Scale};

/// The absolute difference of each channel times `gain`, black where the images are equal, at
/// `depth`. A difference of coverage is shown in all channels where it is greater than theirs; of
/// coverage alone the picture is grey. Samples that cannot be compared are white.
///
/// # Errors
///
/// If the size is beyond an image's.
pub fn difference(pair: &Pair, gain: f64, depth: Depth) -> Result<Image, ImageError> {
    let light: Vec<&Channel> =
        pair.channels.iter().filter(|channel| channel.kind != Kind::Cvg).collect();
    let coverage = pair.channels.iter().find(|channel| channel.kind == Kind::Cvg);
    let planes = match (light.as_slice(), coverage) {
        ([], Some(coverage)) => vec![(Kind::Grg, values(pair, coverage, None, gain))],
        (light, _) => light.iter().map(|c| (c.kind, values(pair, c, coverage, gain))).collect(),
    };
    stored(pair, planes, depth)
}

/// The values of a metric's map times `gain` as grey, at `depth`.
///
/// # Errors
///
/// If the size is beyond an image's.
pub fn map(pair: &Pair, map: &[f32], gain: f64, depth: Depth) -> Result<Image, ImageError> {
    let values = map.iter().map(|&value| scaled(value, gain)).collect();
    stored(pair, vec![(Kind::Grg, values)], depth)
}

/// Differences as shares of 1.
fn values(pair: &Pair, channel: &Channel, coverage: Option<&Channel>, gain: f64) -> Vec<f32> {
    let apart = |a: f32, b: f32| {
        let apart = (a - b).abs() / ONE;
        if !apart.is_nan() {
            apart
        } else if a.is_nan() && b.is_nan() || a.to_bits() == b.to_bits() {
            0.0
        } else {
            1.0
        }
    };
    let mut values = vec![0.0; channel.reference.len()];
    values.par_chunks_mut(pair.columns).enumerate().for_each(|(row, values)| {
        let [a, b] = pair.row(channel, row);
        let covered = coverage.map(|coverage| pair.row(coverage, row));
        for (at, value) in values.iter_mut().enumerate() {
            let own = apart(a[at], b[at]);
            let other = covered.as_ref().map_or(0.0, |[a, b]| apart(a[at], b[at]));
            *value = scaled(if other > own { other } else { own }, gain);
        }
    });
    values
}

/// Integers hold the values as they are seen, floating point as light.
fn stored(pair: &Pair, planes: Vec<(Kind, Vec<f32>)>, depth: Depth) -> Result<Image, ImageError> {
    let [columns, rows] = [pair.columns, pair.rows]
        .map(|length| u32::try_from(length).expect("the size of two images"));
    // Differences of linear light are shown as light.
    let transfer = match (pair.scale, depth) {
        (Scale::Linear, Depth::U8 | Depth::U16) => Transfer::Srgb,
        _ => Transfer::Linear,
    };
    let plane = |(kind, values): (Kind, Vec<f32>)| {
        let samples = Samples::encoded(&values, depth, transfer).map_err(|position| {
            let (column, row) = (position % pair.columns, position / pair.columns);
            ImageError::NotANumber { kind, column, row }
        })?;
        Ok(Plane { kind, samples })
    };
    Image::new(columns, rows, planes.into_iter().map(plane).collect::<Result<_, ImageError>>()?)
}

#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn scaled(value: f32, gain: f64) -> f32 {
    (f64::from(value) * gain) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(samples: Samples) -> Image {
        let columns = u32::try_from(samples.len()).unwrap();
        Image::new(columns, 1, vec![Plane { kind: Kind::Grg, samples }]).unwrap()
    }

    #[test]
    fn a_step_apart_is_a_step_above_black() {
        let (a, b) = (grey(Samples::U8(vec![9, 100, 255])), grey(Samples::U8(vec![9, 101, 0])));
        let pair = Pair::new(&a, &b).unwrap();
        let picture = |gain, depth| {
            difference(&pair, gain, depth).unwrap().plane(Kind::Grg).cloned().unwrap()
        };
        assert_eq!(picture(1.0, Depth::U8), Samples::U8(vec![0, 1, 255]));
        assert_eq!(picture(10.0, Depth::U8), Samples::U8(vec![0, 10, 255]));
        assert_eq!(picture(1.0, Depth::U16), Samples::U16(vec![0, 257, 65_535]));
    }

    #[test]
    fn coverage_is_seen_in_the_light() {
        let image = |light: u8, coverage: u8| {
            let plane = |kind, value| Plane { kind, samples: Samples::U8(vec![value]) };
            Image::new(1, 1, vec![plane(Kind::Grg, light), plane(Kind::Cvg, coverage)]).unwrap()
        };
        let pair = Pair::new(&image(10, 200), &image(12, 150)).unwrap();
        let picture = difference(&pair, 1.0, Depth::U8).unwrap();
        assert_eq!(picture.kinds(), [Kind::Grg]);
        assert_eq!(picture.plane(Kind::Grg), Some(&Samples::U8(vec![50])));
    }

    #[test]
    fn what_cannot_be_compared_is_white() {
        let nan = f32::NAN;
        let a = grey(Samples::F32(vec![nan, nan, 0.5, f32::INFINITY]));
        let b = grey(Samples::F32(vec![nan, 0.5, 0.25, f32::INFINITY]));
        let pair = Pair::new(&a, &b).unwrap();
        let picture = difference(&pair, 1.0, Depth::F32).unwrap();
        assert_eq!(picture.plane(Kind::Grg), Some(&Samples::F32(vec![0.0, 1.0, 0.25, 0.0])));
    }
}
