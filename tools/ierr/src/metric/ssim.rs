//! Structural similarity of luma.
//!
//! Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
//! Similarity", 2004: a Gaussian window of 11 x 11 pixels with a standard deviation of 1.5, the
//! means of the population, K1 = 0.01, K2 = 0.03.

use rayon::prelude::*;

use super::{Measured, Place, Viewing, mean_of};
use crate::filter::BAND;
use crate::pair::Pair;

/// Pixels from the middle of the window to its edge.
const REACH: usize = 5;
const DEVIATION: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Windowed means of the first, the second, their squares and their product.
type Means = [f64; 5];

/// The mean over the pixels whose window lies within the picture; nothing where there are none.
/// In the map, a pixel at the edge has the value of the nearest of these.
pub(super) fn measured(pair: &Pair, _viewing: &Viewing) -> Option<Measured> {
    let (columns, rows) = (pair.columns, pair.rows);
    if columns.min(rows) <= 2 * REACH {
        return None;
    }
    let window = window();
    let inner = columns - 2 * REACH;
    let mut core = vec![0.0; inner * (rows - 2 * REACH)];
    core.par_chunks_mut(inner * BAND).enumerate().for_each(|(band, core)| {
        let [mut reference, mut test] = [(); 2].map(|()| Vec::new());
        let first = band * BAND;
        for row in first..first + core.len() / inner + 2 * REACH {
            let [a, b] = pair.display(row);
            reference.extend(luma(&a));
            test.extend(luma(&b));
        }
        for (row, core) in core.chunks_mut(inner).enumerate() {
            let rows = row * columns..(row + 2 * REACH + 1) * columns;
            let down = down(&reference[rows.clone()], &test[rows], columns, &window);
            for (value, means) in core.iter_mut().zip(down.windows(window.len())) {
                let mut across = [0.0; 5];
                for (means, weight) in means.iter().zip(window) {
                    (0..5).for_each(|at| across[at] += weight * means[at]);
                }
                *value = similarity(across);
            }
        }
    });
    let value = mean_of(&core, inner);
    let nearest = |at: usize, length: usize| at.clamp(REACH, length - 1 - REACH) - REACH;
    let pixel =
        |at: usize| core[nearest(at / columns, rows) * inner + nearest(at % columns, columns)];
    let (at, _) = core.iter().enumerate().fold((0, f32::INFINITY), |(place, least), (at, &v)| {
        if v < least { (at, v) } else { (place, least) }
    });
    let worst = Place { column: at % inner + REACH, row: at / inner + REACH, kind: None };
    let map = (0..columns * rows).map(pixel).collect();
    Some(Measured { value, channels: Vec::new(), worst: Some(worst), map: Some(map) })
}

/// Rec. 709 luma of display values.
fn luma([r, g, b]: &[Vec<f32>; 3]) -> impl Iterator<Item = f64> {
    let pixels = r.iter().zip(g).zip(b);
    let luma = |((&r, &g), &b): ((&f32, &f32), &f32)| {
        0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
    };
    pixels.map(luma)
}

fn window() -> [f64; 2 * REACH + 1] {
    let weights = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10_u32].map(|at| {
        let x = f64::from(at) - 5.0;
        libm::exp(-x * x / (2.0 * DEVIATION * DEVIATION))
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// The means of each column of a strip of as many rows as the window has.
fn down(reference: &[f64], test: &[f64], columns: usize, window: &[f64]) -> Vec<Means> {
    let mut means = vec![[0.0; 5]; columns];
    let rows = reference.chunks_exact(columns).zip(test.chunks_exact(columns));
    for ((reference, test), weight) in rows.zip(window) {
        for ((means, &a), &b) in means.iter_mut().zip(reference).zip(test) {
            let terms = [a, b, a * a, b * b, a * b];
            (0..5).for_each(|at| means[at] += weight * terms[at]);
        }
    }
    means
}

#[expect(clippy::cast_possible_truncation, reason = "maps hold 32-bit values by definition")]
fn similarity([a, b, aa, bb, ab]: Means) -> f32 {
    let (variances, covariance) = (aa - a * a + bb - b * b, ab - a * b);
    let above = (2.0 * a * b + C1) * (2.0 * covariance + C2);
    (above / ((a * a + b * b + C1) * (variances + C2))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Viewing;
    use idf::{Image, Kind, Plane, Samples};

    fn ssim(first: &[u8], second: &[u8], columns: u32) -> Option<Measured> {
        let image = |samples: &[u8]| {
            let rows = u32::try_from(samples.len()).unwrap() / columns;
            let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples.into()) };
            Image::new(columns, rows, vec![plane]).unwrap()
        };
        let pair = Pair::new(&image(first), &image(second)).unwrap();
        measured(&pair, &Viewing::default())
    }

    #[test]
    fn flat_pictures_differ_in_their_means_alone() {
        let found = ssim(&[51; 121], &[102; 121], 11).unwrap();
        let (a, b) = (0.2, 0.4);
        let expected = (2.0 * a * b + C1) / (a * a + b * b + C1);
        assert!((found.value - expected).abs() < 1e-6, "{} {expected}", found.value);
        assert!(ssim(&[51; 110], &[51; 110], 10).is_none(), "no window fits");
    }

    #[test]
    fn it_agrees_with_the_definition() {
        let (columns, rows) = (16_usize, 13_usize);
        let first: Vec<u8> = (0..208_u32).map(|i| (i * 37 % 251).to_le_bytes()[0]).collect();
        let second: Vec<u8> =
            (0..208_u32).map(|i| (i * 37 % 251 / 2 + i % 7).to_le_bytes()[0]).collect();
        let mut sum = 0.0;
        let mut count = 0.0;
        for y in 5..rows - 5 {
            for x in 5..columns - 5 {
                let mut weights = 0.0;
                let mut m = [0.0; 5];
                for v in 0..11 {
                    for u in 0..11 {
                        let (dx, dy) = (u as f64 - 5.0, v as f64 - 5.0);
                        let weight = libm::exp(-(dx * dx + dy * dy) / 4.5);
                        let at = (y + v - 5) * columns + x + u - 5;
                        let (a, b) = (f64::from(first[at]) / 255.0, f64::from(second[at]) / 255.0);
                        weights += weight;
                        for (m, term) in m.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                            *m += weight * term;
                        }
                    }
                }
                let [a, b, aa, bb, ab] = m.map(|m| m / weights);
                let (va, vb, cov) = (aa - a * a, bb - b * b, ab - a * b);
                sum += (2.0 * a * b + 1e-4) * (2.0 * cov + 9e-4)
                    / ((a * a + b * b + 1e-4) * (va + vb + 9e-4));
                count += 1.0;
            }
        }
        let found = ssim(&first, &second, 16).unwrap().value;
        assert!((found - sum / count).abs() < 1e-6, "{found} {}", sum / count);
    }
}
