//! LDR-FLIP: how much of a difference is seen when two images alternate in one place.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", HPG 2020. Colours are filtered by the eye's sensitivity to
//! contrast and compared as Hunt-adjusted L*a*b* by the `HyAB` distance; a difference of edges or
//! points, which the filter would hide, amplifies them.

use std::f64::consts::PI;

use idf::Transfer;
use rayon::prelude::*;

use super::{Measured, Place, Viewing, mean_of};
use crate::filter::{Across, BAND, clamped, padded, with_reach};
use crate::pair::Pair;

/// Light of the sRGB primaries as X, Y, Z, and back, with white at Y = 1.
const XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

const RGB: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// X, Y, Z of white: the sums of the rows above.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

/// The spread of the eye's sensitivity to light, red against green, and blue against yellow, as
/// pairs of an amplitude and a width (table 1 of the paper).
const LIGHT: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// Exponent of the colour difference, and of the feature difference.
const COLOR_EXPONENT: f32 = 0.7;

/// Colour differences up to this share of the greatest are spread over so much of the result.
const KNEE: f32 = 0.4;
const KNEE_VALUE: f32 = 0.95;

/// Width of the edge detector in degrees, from peak to trough.
const EDGE_WIDTH: f64 = 0.082;

/// All filters for one distance of viewing.
struct Filters {
    reach: usize,
    light: Vec<f32>,
    red_green: Vec<f32>,
    /// Two, with the share of each.
    blue_yellow: [(Vec<f32>, f32); 2],
    smooth: Vec<f32>,
    edge: Vec<f32>,
    point: Vec<f32>,
}

/// A row of one image, filtered.
struct Row {
    /// L*, a*, b* after the Hunt adjustment, of the filtered colour.
    lab: Vec<[f32; 3]>,
    /// Strength of edges and of points.
    features: Vec<[f32; 2]>,
}

/// The mean over all pixels, with the map and its greatest value's place.
///
/// Light beyond white is shown white. What is seen is light over black; coverage by itself is not.
pub(super) fn measured(pair: &Pair, viewing: &Viewing) -> Option<Measured> {
    let filters = Filters::new(viewing.pixels_per_degree);
    let farthest = farthest();
    let mut map = vec![0.0; pair.columns * pair.rows];
    map.par_chunks_mut(pair.columns * BAND).enumerate().for_each(|(band, map)| {
        let start = band * BAND;
        let band = start..start + map.len() / pair.columns;
        let [reference, test] = [false, true]
            .map(|is_test| filters.rows(|row| pair.display_of(is_test, row), pair.rows, &band));
        let pixels = reference.iter().zip(&test).flat_map(|(a, b)| {
            let colors = a.lab.iter().zip(&b.lab);
            colors.zip(a.features.iter().zip(&b.features))
        });
        for (value, ((&lab, &other), (&features, &others))) in map.iter_mut().zip(pixels) {
            let color = color_difference(hyab(lab, other), farthest);
            let feature = (0..2).map(|at| (features[at] - others[at]).abs());
            let feature = feature.fold(0.0, |most, d: f32| if d > most { d } else { most });
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            *value = libm::powf(color, 1.0 - feature);
        }
    });
    let (at, _) = map.iter().enumerate().fold((0, 0.0), |(place, most), (at, &value)| {
        if value > most { (at, value) } else { (place, most) }
    });
    let worst = Place { column: at % pair.columns, row: at / pair.columns, kind: None };
    let value = mean_of(&map, pair.columns);
    Some(Measured { value, channels: Vec::new(), worst: Some(worst), map: Some(map) })
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        let widest = BLUE_YELLOW[0][1];
        let color_reach = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
        let deviation = 0.5 * EDGE_WIDTH * pixels_per_degree;
        let feature_reach = (3.0 * deviation).ceil();
        let color = |[_, width]: [f64; 2]| {
            let fall = PI * PI / (width * pixels_per_degree * pixels_per_degree);
            weights(color_reach, |x| libm::exp(-fall * x * x))
        };
        let gaussian = |x: f64| libm::exp(-x * x / (2.0 * deviation * deviation));
        let smooth = weights(feature_reach, gaussian);
        // A separable filter with weights that add up to 1 has the amplitude of both sums.
        let shares = BLUE_YELLOW.map(|row| {
            let sum: f64 = color(row).iter().sum();
            row[0] * (PI / row[1]).sqrt() * sum * sum
        });
        let blue_yellow = [0, 1].map(|at| {
            let share = shares[at] / (shares[0] + shares[1]);
            (narrowed(&normalized(&color(BLUE_YELLOW[at]))), narrow(share))
        });
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few pixels")]
        let reach = color_reach.max(feature_reach) as usize;
        Self {
            reach,
            light: narrowed(&normalized(&color(LIGHT))),
            red_green: narrowed(&normalized(&color(RED_GREEN))),
            blue_yellow,
            smooth: narrowed(&normalized(&smooth)),
            edge: narrowed(&balanced(&weights(feature_reach, |x| -x * gaussian(x)))),
            point: narrowed(&balanced(&weights(feature_reach, |x| {
                (x * x / (deviation * deviation) - 1.0) * gaussian(x)
            }))),
        }
    }

    /// The rows of `band` of one image of `rows`, whose display values `display` gives, filtered.
    fn rows(
        &self,
        display: impl Fn(usize) -> [Vec<f32>; 3],
        rows: usize,
        band: &std::ops::Range<usize>,
    ) -> Vec<Row> {
        let reached = with_reach(band, self.reach);
        let mut filtered = [(); 7].map(|()| Across::new(reached.start));
        for row in reached {
            let rgb = display(clamped(row, rows));
            let opponent = opponent_row(&rgb.each_ref().map(|channel| &channel[..]));
            let [y, cx, cz] = opponent.map(|channel| padded(&channel, self.reach));
            let luminance: Vec<f32> = y.iter().map(|y| (y + 16.0) / 116.0).collect();
            let [a, b, c, d, e, f, g] = &mut filtered;
            a.push(&y, self.reach, &self.light);
            b.push(&cx, self.reach, &self.red_green);
            c.push(&cz, self.reach, &self.blue_yellow[0].0);
            d.push(&cz, self.reach, &self.blue_yellow[1].0);
            e.push(&luminance, self.reach, &self.smooth);
            f.push(&luminance, self.reach, &self.edge);
            g.push(&luminance, self.reach, &self.point);
        }
        band.clone().map(|row| self.row(&filtered, row)).collect()
    }

    fn row(&self, [y, cx, cz, other, smooth, edge, point]: &[Across; 7], row: usize) -> Row {
        let y = y.down(row, &self.light);
        let cx = cx.down(row, &self.red_green);
        let [(first, share), (second, rest)] = &self.blue_yellow;
        let (cz, other) = (cz.down(row, first), other.down(row, second));
        let lab = (0..y.len()).map(|at| {
            let cz = share * cz[at] + rest * other[at];
            hunt_lab(linear([y[at], cx[at], cz].map(f64::from)))
        });
        let edges = [edge.down(row, &self.smooth), smooth.down(row, &self.edge)];
        let points = [point.down(row, &self.smooth), smooth.down(row, &self.point)];
        let strength = |[across, down]: &[Vec<f32>; 2], at: usize| {
            (across[at] * across[at] + down[at] * down[at]).sqrt()
        };
        let features = (0..y.len()).map(|at| [strength(&edges, at), strength(&points, at)]);
        Row { lab: lab.collect(), features: features.collect() }
    }
}

/// Display values as `YCxCz`: L*a*b* without its cube root.
fn opponent_row(rgb: &[&[f32]; 3]) -> [Vec<f32>; 3] {
    let mut opponent = [(); 3].map(|()| Vec::with_capacity(rgb[0].len()));
    for ((&r, &g), &b) in rgb[0].iter().zip(rgb[1]).zip(rgb[2]) {
        let light = [r, g, b].map(|value| Transfer::Srgb.decode(f64::from(value)));
        let [x, y, z] = over_white(light);
        let values = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
        for (channel, value) in opponent.iter_mut().zip(values) {
            channel.push(narrow(value));
        }
    }
    opponent
}

/// Linear light, within 0 to 1, of `YCxCz`.
fn linear([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let xyz = [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]];
    product(&RGB, xyz).map(|value| value.clamp(0.0, 1.0))
}

/// L*a*b* of linear light, with a* and b* times L* / 100: dark colours look less colourful.
fn hunt_lab(light: [f64; 3]) -> [f32; 3] {
    const CORNER: f64 = 6.0 / 29.0;
    let [x, y, z] = over_white(light).map(|value| {
        if value > CORNER * CORNER * CORNER {
            libm::cbrt(value)
        } else {
            value / (3.0 * CORNER * CORNER) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)].map(narrow)
}

/// Distance of lightness, and distance of colour (Abasi, Tehran and Fairchild 2020).
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [l, x, y] = [0, 1, 2].map(|at| a[at] - b[at]);
    l.abs() + (x * x + y * y).sqrt()
}

/// The distance of green and blue, the farthest of two colours that a screen shows.
fn farthest() -> f32 {
    hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0]))
}

/// A distance as 0 to 1, large ones compressed.
fn color_difference(distance: f32, farthest: f32) -> f32 {
    let power = libm::powf(distance, COLOR_EXPONENT);
    let most = libm::powf(farthest, COLOR_EXPONENT);
    let knee = KNEE * most;
    if power < knee {
        KNEE_VALUE / knee * power
    } else {
        KNEE_VALUE + (power - knee) / (most - knee) * (1.0 - KNEE_VALUE)
    }
}

fn over_white(light: [f64; 3]) -> [f64; 3] {
    let xyz = product(&XYZ, light);
    [0, 1, 2].map(|at| xyz[at] / WHITE[at])
}

fn product(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// `weight` at the whole numbers from -`reach` to `reach`.
fn weights(reach: f64, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    std::iter::successors(Some(-reach), |x| Some(x + 1.0))
        .take_while(|x| *x <= reach)
        .map(weight)
        .collect()
}

/// Weights that add up to 1.
fn normalized(weights: &[f64]) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Positive weights that add up to 1, and negative ones that add up to -1.
fn balanced(weights: &[f64]) -> Vec<f64> {
    let sum = |sign: f64| weights.iter().map(|weight| (weight * sign).max(0.0)).sum::<f64>();
    let (above, below) = (sum(1.0), sum(-1.0));
    weights.iter().map(|&weight| weight / if weight > 0.0 { above } else { below }).collect()
}

fn narrowed(weights: &[f64]) -> Vec<f32> {
    weights.iter().map(|&weight| narrow(weight)).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "maps hold 32-bit values by definition")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests;
