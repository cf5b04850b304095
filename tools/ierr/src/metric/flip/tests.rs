//! FLIP against facts of its paper and against its formula written plainly.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::disallowed_methods,
    reason = "the formula as the paper has it, within a tolerance"
)]

use super::*;
use idf::{Image, Kind, Plane, Samples};

fn flip(first: &Image, second: &Image, viewing: &Viewing) -> Measured {
    measured(&Pair::new(first, second).unwrap(), viewing).unwrap()
}

fn color(columns: u32, pixels: &[[u8; 3]]) -> Image {
    let rows = u32::try_from(pixels.len()).unwrap() / columns;
    let plane = |(channel, kind)| {
        let samples = pixels.iter().map(|pixel| pixel[channel]).collect();
        Plane { kind, samples: Samples::U8(samples) }
    };
    let planes = idf::plane::COLOR.into_iter().enumerate().map(plane).collect();
    Image::new(columns, rows, planes).unwrap()
}

fn flat(pixel: [u8; 3]) -> Image {
    color(24, &[pixel; 24 * 20])
}

#[test]
fn flat_colors_have_the_distance_of_the_paper() {
    // Black and white are 100 apart: 100^0.7 = 25.12. Green and blue are 41.28 apart after the
    // power (CIE L*a*b* 87.73 -86.18 83.18 and 32.30 79.19 -107.86, a* and b* times L* / 100), so
    // that is 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51).
    let found = flip(&flat([0; 3]), &flat([255; 3]), &Viewing::default()).value;
    assert!((found - 0.9674).abs() < 2e-4, "{found}");
    let found = flip(&flat([0, 255, 0]), &flat([0, 0, 255]), &Viewing::default()).value;
    assert!((found - 1.0).abs() < 1e-4, "{found}");
    // A grey of 50 % light has L* = 76.07; from white that is 23.93, whose power is 9.23.
    let grey =
        Image::new(24, 20, vec![Plane { kind: Kind::Grg, samples: Samples::F32(vec![0.5; 480]) }]);
    let found = flip(&flat([255; 3]), &grey.unwrap(), &Viewing::default()).value;
    assert!((found - 9.232 * 0.95 / 16.513).abs() < 1e-3, "{found}");
}

#[test]
fn it_agrees_with_the_formula() {
    let (columns, rows) = (19_usize, 14_usize);
    let first: Vec<[u8; 3]> = (0..266_u32)
        .map(|i| [i * 37 % 251, i * 11 % 256, i * i % 241].map(|v| v.to_le_bytes()[0]))
        .collect();
    let second: Vec<[u8; 3]> = (0..266_u32)
        .map(|i| [i * 37 % 251 / 2, i * 11 % 256, (i * i % 241 + 9 * (i % 5)) % 256])
        .map(|pixel| pixel.map(|v| v.to_le_bytes()[0]))
        .collect();
    for pixels_per_degree in [67.0, 25.0] {
        let viewing = Viewing { pixels_per_degree };
        let found = flip(&color(19, &first), &color(19, &second), &viewing);
        let expected = plain(&first, &second, [columns, rows], pixels_per_degree);
        let map = found.map.unwrap();
        for (at, (found, expected)) in map.iter().zip(&expected).enumerate() {
            assert!((f64::from(*found) - expected).abs() < 2e-4, "at {at}: {found} {expected}");
        }
        let mean = expected.iter().sum::<f64>() / 266.0;
        assert!((found.value - mean).abs() < 2e-5, "{} {mean}", found.value);
    }
}

#[test]
fn the_worst_pixel_is_found_across_bands() {
    let (columns, rows) = (30, 3 * BAND + 5);
    let black = vec![[0; 3]; columns * rows];
    for row in [0, BAND - 1, BAND, 2 * BAND + 7, rows - 1] {
        let mut spot = black.clone();
        spot[row * columns + 9] = [255; 3];
        let found = flip(&color(30, &black), &color(30, &spot), &Viewing::default());
        assert_eq!(found.worst, Some(Place { column: 9, row, kind: None }));
    }
}

/// The whole formula in two dimensions, with nothing separated and nothing shared.
fn plain(a: &[[u8; 3]], b: &[[u8; 3]], size: [usize; 2], degree: f64) -> Vec<f64> {
    let [[lab_a, edge_a, point_a], [lab_b, edge_b, point_b]] =
        [a, b].map(|image| plain_image(image, size, degree));
    let green = plain_lab([0.0, 1.0, 0.0]);
    let blue = plain_lab([0.0, 0.0, 1.0]);
    let hyab = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2]);
    let most = hyab(green, blue).powf(0.7);
    (0..a.len())
        .map(|at| {
            let power = hyab(lab_a[at], lab_b[at]).powf(0.7);
            let color = if power < 0.4 * most {
                0.95 / (0.4 * most) * power
            } else {
                0.95 + 0.05 * (power - 0.4 * most) / (0.6 * most)
            };
            let strength = |v: [f64; 3]| v[0].hypot(v[1]);
            let edge = (strength(edge_a[at]) - strength(edge_b[at])).abs();
            let point = (strength(point_a[at]) - strength(point_b[at])).abs();
            color.powf(1.0 - (edge.max(point) / 2.0_f64.sqrt()).sqrt())
        })
        .collect()
}

/// Filtered colours, and edges and points as pairs of across and down.
fn plain_image(image: &[[u8; 3]], size: [usize; 2], degree: f64) -> [Vec<[f64; 3]>; 3] {
    let opponent: Vec<[f64; 3]> = image
        .iter()
        .map(|pixel| {
            let light = pixel.map(|v| Transfer::Srgb.decode(f64::from(v) / 255.0));
            let xyz = plain_product(XYZ, light);
            let [x, y, z] = [xyz[0] / WHITE[0], xyz[1], xyz[2] / WHITE[2]];
            [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
        })
        .collect();
    let gaussian = |rows: &[[f64; 2]], x: f64, y: f64| -> f64 {
        let far = (x * x + y * y) / (degree * degree);
        rows.iter().map(|[a, b]| a * (PI / b).sqrt() * (-PI * PI * far / b).exp()).sum()
    };
    let reach = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * degree).ceil() as i64;
    let sensitivity: [&[[f64; 2]]; 3] =
        [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];
    let filtered = [0, 1, 2].map(|channel| {
        let plane: Vec<f64> = opponent.iter().map(|pixel| pixel[channel]).collect();
        plain_filter(&plane, size, reach, 1, |x, y| gaussian(sensitivity[channel], x, y))
    });
    let lab = (0..image.len())
        .map(|at| {
            let [y, cx, cz] = [0, 1, 2].map(|channel| filtered[channel][at]);
            let y = (y + 16.0) / 116.0;
            let xyz = [(y + cx / 500.0) * WHITE[0], y, (y - cz / 200.0) * WHITE[2]];
            plain_lab(plain_product(RGB, xyz).map(|value| value.clamp(0.0, 1.0)))
        })
        .collect();
    let luminance: Vec<f64> = opponent.iter().map(|pixel| (pixel[0] + 16.0) / 116.0).collect();
    let s = 0.5 * 0.082 * degree;
    let reach = (3.0 * s).ceil() as i64;
    let bell = move |x: f64, y: f64| (-(x * x + y * y) / (2.0 * s * s)).exp();
    let edge = move |x: f64, y: f64| -x * bell(x, y);
    let point = move |x: f64, y: f64| (x * x / (s * s) - 1.0) * bell(x, y);
    let across = |f: &dyn Fn(f64, f64) -> f64| plain_filter(&luminance, size, reach, 2, f);
    let pairs = |x: Vec<f64>, y: Vec<f64>| x.into_iter().zip(y).map(|(x, y)| [x, y, 0.0]).collect();
    let edges = pairs(across(&edge), across(&|x, y| edge(y, x)));
    let points = pairs(across(&point), across(&|x, y| point(y, x)));
    [lab, edges, points]
}

/// A filter whose positive weights add up to 1, and with two signs its negative ones to -1.
fn plain_filter(
    plane: &[f64],
    [columns, rows]: [usize; 2],
    reach: i64,
    signs: u32,
    weight: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let offsets: Vec<(i64, i64)> =
        (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y))).collect();
    let weights: Vec<f64> = offsets.iter().map(|&(x, y)| weight(x as f64, y as f64)).collect();
    let above: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let below: f64 = weights.iter().filter(|w| **w < 0.0).map(|w| -w).sum();
    assert_eq!(below > 0.0, signs == 2);
    (0..plane.len())
        .map(|at| {
            let (column, row) = ((at % columns) as i64, (at / columns) as i64);
            let value = |(&(x, y), &weight): (&(i64, i64), &f64)| {
                let x = (column + x).clamp(0, columns as i64 - 1) as usize;
                let y = (row + y).clamp(0, rows as i64 - 1) as usize;
                plane[y * columns + x] * weight / if weight > 0.0 { above } else { below }
            };
            offsets.iter().zip(&weights).map(value).sum()
        })
        .collect()
}

fn plain_lab(light: [f64; 3]) -> [f64; 3] {
    let xyz = plain_product(XYZ, light);
    let root = |value: f64| {
        if value > 216.0 / 24_389.0 { value.cbrt() } else { (841.0 / 108.0) * value + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|at| root(xyz[at] / WHITE[at]));
    let l = 116.0 * y - 16.0;
    [l, l * 5.0 * (x - y), l * 2.0 * (y - z)]
}

fn plain_product(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
}
