//! Resampling: area average down, bilinear up, in linear premultiplied light.

use idf::plane::Role;
use idf::{Image, ImageError, Matte, Plane, Samples, Transfer, checked_size};

use crate::CopyError;

/// The samples of the original that one sample of the copy is mixed from.
struct Mix {
    first: usize,
    weights: Vec<f32>,
}

/// The picture with other columns and rows, at the top left of a canvas. Indices and measured
/// values cannot be mixed; of these the nearest is taken.
pub(crate) fn resized(image: &Image, [columns, rows]: [u32; 2]) -> Result<Image, CopyError> {
    checked_size(columns, rows)?;
    let premultiplied = image.with_matte(Matte::Premultiplied)?;
    let [width, height] = premultiplied.size().map(|length| length as usize);
    let [new_width, new_height] = [columns, rows].map(|length| length as usize);
    let (across, down) = (mixes(width, new_width), mixes(height, new_height));
    let mut planes = Vec::new();
    for Plane { kind, samples } in premultiplied.planes() {
        let role = kind.role();
        let depth = samples.depth();
        let samples = if matches!(role, Role::Light | Role::Coverage) {
            let light = role == Role::Light;
            let transfer = if light { image.transfer(depth) } else { Transfer::Linear };
            let values = mixed(&samples.decoded(transfer), width, &across, &down);
            Samples::encoded(&values, depth, transfer).map_err(|position| {
                let (column, row) = (position % new_width, position / new_width);
                ImageError::NotANumber { kind: *kind, column, row }
            })?
        } else {
            let nearest = |at: usize, from: usize, to: usize| (2 * at + 1) * from / (2 * to);
            samples.gathered((0..new_width * new_height).map(|at| {
                let column = nearest(at % new_width, width, new_width);
                nearest(at / new_width, height, new_height) * width + column
            }))
        };
        planes.push(Plane { kind: *kind, samples });
    }
    let mut copy = premultiplied.with_planes(columns, rows, planes)?;
    copy.properties.origin = [0, 0];
    Ok(copy.with_matte(image.properties.matte)?)
}

fn mixed(values: &[f32], width: usize, across: &[Mix], down: &[Mix]) -> Vec<f32> {
    let mut rows = Vec::with_capacity(values.len() / width * across.len());
    for row in values.chunks_exact(width) {
        rows.extend(across.iter().map(|mix| {
            mix.weights.iter().zip(&row[mix.first..]).map(|(w, value)| w * value).sum::<f32>()
        }));
    }
    let mut result = vec![0.0; across.len() * down.len()];
    for (target, mix) in result.chunks_exact_mut(across.len()).zip(down) {
        let sources = rows.chunks_exact(across.len()).skip(mix.first);
        for (weight, source) in mix.weights.iter().zip(sources) {
            for (sum, value) in target.iter_mut().zip(source) {
                *sum += weight * value;
            }
        }
    }
    result
}

/// Mixes that make `to` samples from `from`.
fn mixes(from: usize, to: usize) -> Vec<Mix> {
    (0..to)
        .map(|at| if to < from { average(at, from, to) } else { between(at, from, to) })
        .collect()
}

/// Average of what the sample `at` of `to` covers of `from`: with both as `from · to` parts, it
/// covers `from` of them, and each old sample `to`.
fn average(at: usize, from: usize, to: usize) -> Mix {
    let (start, end) = (at * from, (at + 1) * from);
    let first = start / to;
    let weights = (first..end.div_ceil(to))
        .map(|old| ratio(end.min((old + 1) * to) - start.max(old * to), from))
        .collect();
    Mix { first, weights }
}

/// The two samples about the centre of the sample `at`, by nearness; one at the edges. In parts
/// of `2 · to` for an old sample, the new centre is at `(2 at + 1) from`, the old ones at odd
/// multiples of `to`.
fn between(at: usize, from: usize, to: usize) -> Mix {
    let centre = (2 * at + 1) * from;
    if centre <= to {
        return Mix { first: 0, weights: vec![1.0] };
    }
    let (first, past) = ((centre - to) / (2 * to), (centre - to) % (2 * to));
    if past == 0 || first + 1 >= from {
        return Mix { first: first.min(from - 1), weights: vec![1.0] };
    }
    let second = ratio(past, 2 * to);
    Mix { first, weights: vec![1.0 - second, second] }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "a weight; its error is far below that of a sample"
)]
fn ratio(part: usize, whole: usize) -> f32 {
    (part as f64 / whole as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::Kind;

    fn image(columns: u32, planes: Vec<(Kind, Samples)>) -> Image {
        let rows = u32::try_from(planes[0].1.len()).unwrap() / columns;
        let planes = planes.into_iter().map(|(kind, samples)| Plane { kind, samples });
        Image::new(columns, rows, planes.collect()).unwrap()
    }

    fn floats(columns: u32, values: &[f32], size: [u32; 2]) -> Vec<f32> {
        let original = image(columns, vec![(Kind::Grg, Samples::F32(values.into()))]);
        resized(&original, size).unwrap().decoded(Kind::Grg).unwrap()
    }

    #[test]
    fn smaller_is_the_average_of_what_is_covered() {
        assert_eq!(floats(4, &[0.0, 1.0, 2.0, 4.0], [2, 1]), [0.5, 3.0]);
        // Three samples in two: one and a half each.
        let thirds = floats(3, &[3.0, 6.0, 9.0], [2, 1]);
        assert!((thirds[0] - 4.0).abs() < 1e-6 && (thirds[1] - 8.0).abs() < 1e-6, "{thirds:?}");
        assert_eq!(floats(2, &[1.0, 2.0, 3.0, 6.0], [1, 1]), [3.0]);
    }

    #[test]
    fn larger_is_bilinear() {
        // Centres at 1/4, 3/4, 5/4, 7/4 between those at 1/2 and 3/2.
        assert_eq!(floats(2, &[0.0, 4.0], [4, 1]), [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(floats(1, &[0.0, 4.0], [1, 4]), [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(floats(1, &[7.0], [3, 2]), [7.0; 6]);
    }

    #[test]
    fn the_same_size_is_the_same() {
        let values = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        assert_eq!(floats(3, &values, [3, 2]), values);
    }

    #[test]
    fn bytes_are_mixed_as_light_and_uncovered_color_does_not_count() {
        let planes =
            vec![(Kind::Grg, Samples::U8(vec![255, 0])), (Kind::Enc, Samples::U8(vec![7, 9]))];
        let half = resized(&image(2, planes), [1, 1]).unwrap();
        assert_eq!(half.plane(Kind::Grg), Some(&Samples::U8(vec![188])));
        assert_eq!(half.plane(Kind::Enc), Some(&Samples::U8(vec![9])));
        let planes =
            vec![(Kind::Grg, Samples::U8(vec![255, 99])), (Kind::Cvg, Samples::U8(vec![255, 0]))];
        let mut straight = image(2, planes);
        straight.properties.matte = Matte::Straight;
        let half = resized(&straight, [1, 1]).unwrap();
        assert_eq!(half.plane(Kind::Cvg), Some(&Samples::U8(vec![128])));
        // 188 over a coverage of 128 is 0.503/0.502: white but for rounding.
        assert_eq!(half.plane(Kind::Grg), Some(&Samples::U8(vec![255])));
    }
}
