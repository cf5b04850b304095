//! Colours where nothing is covered, from what is covered about them.

use idf::plane::Role;
use idf::{Image, Kind, Matte, Plane, Samples};

use crate::CopyError;
use crate::mix::encoded;

/// The image with straight light, which goes on where coverage is 0; coverage stays.
///
/// Light is averaged by its coverage over 2 x 2 pixels, again and again (pull); from the coarsest
/// on, what has no light yet gets it from the coarser level, bilinear (push; Gortler et al., "The
/// Lumigraph", 1996, section 3.4.1). What is covered at all keeps its colour.
pub(crate) fn filled(image: &Image) -> Result<Image, CopyError> {
    if image.plane(Kind::Cvg).is_none() {
        return Ok(image.clone());
    }
    let straight = image.with_matte(Matte::Straight)?;
    let coverage = image.decoded(Kind::Cvg)?;
    let [columns, rows] = image.size().map(|length| length as usize);
    let mut planes = straight.planes().to_vec();
    for Plane { kind, samples } in planes.iter_mut().filter(|p| p.kind.role() == Role::Light) {
        let depth = samples.depth();
        let transfer = straight.transfer(depth);
        let values = spread(&samples.decoded(transfer), &coverage, [columns, rows]);
        let spread = encoded(*kind, &values, columns, depth, transfer)?;
        // What is covered stays to the bit.
        take_uncovered(samples, &spread, &coverage);
    }
    Ok(straight.with_planes(image.columns(), image.rows(), planes)?)
}

fn take_uncovered(samples: &mut Samples, from: &Samples, coverage: &[f32]) {
    fn take<T: Copy>(samples: &mut [T], from: &[T], coverage: &[f32]) {
        for ((sample, &other), &share) in samples.iter_mut().zip(from).zip(coverage) {
            if share <= 0.0 {
                *sample = other;
            }
        }
    }
    match (samples, from) {
        (Samples::U8(samples), Samples::U8(from)) => take(samples, from, coverage),
        (Samples::U16(samples), Samples::U16(from)) => take(samples, from, coverage),
        (Samples::F32(samples), Samples::F32(from)) => take(samples, from, coverage),
        _ => {}
    }
}

/// Light and its weight, 0 where there is none, of one level.
struct Level {
    size: [usize; 2],
    light: Vec<f32>,
    weight: Vec<f32>,
}

/// `light` where `coverage` is above 0, and elsewhere what surrounds it.
fn spread(light: &[f32], coverage: &[f32], size: [usize; 2]) -> Vec<f32> {
    let mut levels = vec![Level { size, light: light.to_vec(), weight: coverage.to_vec() }];
    while let Some(level) = levels.last().filter(|level| level.size != [1, 1]) {
        let coarser = pulled(level);
        levels.push(coarser);
    }
    let mut coarser = levels.pop().expect("there is a level of one pixel");
    while let Some(mut level) = levels.pop() {
        push(&mut level, &coarser);
        coarser = level;
    }
    coarser.light
}

/// Half the columns and rows: averages by weight, and the mean weight.
fn pulled(level: &Level) -> Level {
    let [columns, rows] = level.size;
    let size = level.size.map(|length| length.div_ceil(2));
    let (mut light, mut weight) = (Vec::new(), Vec::new());
    for row in 0..size[1] {
        for column in 0..size[0] {
            let (mut sum, mut total) = (0.0, 0.0);
            for y in 2 * row..(2 * row + 2).min(rows) {
                for x in 2 * column..(2 * column + 2).min(columns) {
                    let at = y * columns + x;
                    sum += level.weight[at] * level.light[at];
                    total += level.weight[at];
                }
            }
            light.push(if total > 0.0 { sum / total } else { 0.0 });
            weight.push(total / 4.0);
        }
    }
    Level { size, light, weight }
}

/// Gives what has no light that of the `coarser` level.
fn push(level: &mut Level, coarser: &Level) {
    let [columns, _] = level.size;
    // The centre of a pixel lies a quarter off that of the coarser one that holds it.
    let near = |at: usize, length: usize| {
        let own = at / 2;
        let next =
            if at.is_multiple_of(2) { own.saturating_sub(1) } else { (own + 1).min(length - 1) };
        [(own, 0.75), (next, 0.25)]
    };
    for at in (0..level.light.len()).filter(|&at| level.weight[at] <= 0.0) {
        let mut sum = 0.0;
        for (y, down) in near(at / columns, coarser.size[1]) {
            for (x, across) in near(at % columns, coarser.size[0]) {
                sum += down * across * coarser.light[y * coarser.size[0] + x];
            }
        }
        level.light[at] = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(columns: u32, light: &[u8], coverage: &[u8]) -> Image {
        let plane = |kind, samples: &[u8]| Plane { kind, samples: Samples::U8(samples.into()) };
        let planes = vec![plane(Kind::Grg, light), plane(Kind::Cvg, coverage)];
        let rows = u32::try_from(light.len()).unwrap() / columns;
        let mut image = Image::new(columns, rows, planes).unwrap();
        image.properties.matte = Matte::Straight;
        image
    }

    fn light(image: &Image) -> Vec<u8> {
        match image.plane(Kind::Grg) {
            Some(Samples::U8(samples)) => samples.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn one_color_goes_everywhere_and_coverage_stays() {
        let mut coverage = vec![0; 35];
        coverage[11] = 3;
        let mut original = vec![7; 35];
        original[11] = 200;
        let copy = filled(&image(7, &original, &coverage)).unwrap();
        assert_eq!(light(&copy), [200; 35]);
        assert_eq!(copy.plane(Kind::Cvg), Some(&Samples::U8(coverage)));
        assert_eq!(copy.properties.matte, Matte::Straight);
    }

    #[test]
    fn what_is_covered_stays_and_the_rest_lies_between() {
        // Dark on the left, light on the right, nothing in the middle.
        let row = |left, middle, right| {
            (0..16)
                .map(|at| {
                    if at < 3 {
                        left
                    } else if at < 13 {
                        middle
                    } else {
                        right
                    }
                })
                .collect()
        };
        let (original, coverage): (Vec<u8>, Vec<u8>) = (row(50, 0, 220), row(255, 0, 1));
        let found = light(&filled(&image(16, &original, &coverage)).unwrap());
        assert_eq!((found[..3].to_vec(), found[13..].to_vec()), (vec![50; 3], vec![220; 3]));
        assert!(found.is_sorted(), "{found:?}");
        assert!(found[3] < 100 && found[12] > 200, "{found:?}");
    }

    #[test]
    fn an_uncovered_picture_is_black_and_an_opaque_one_as_it_was() {
        assert_eq!(light(&filled(&image(2, &[9, 9], &[0, 0])).unwrap()), [0, 0]);
        assert_eq!(light(&filled(&image(2, &[8, 9], &[255, 255])).unwrap()), [8, 9]);
    }
}
