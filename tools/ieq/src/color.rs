//! Operations on the colour of a pixel, in Oklch.
//!
//! Oklab (Ottosson, "A perceptual color space for image processing", 2020) keeps lightness apart
//! from chroma and hue, so a colour that turns or fades stays as light as it was; in HSV and HSL
//! yellow and blue have one value and one lightness. A colour that leaves the range of the stored
//! samples is brought back by less chroma, with lightness and hue as they are.

use crate::light::narrow;

/// What rounds to the edge of the range at 16 bits lies within it.
const EDGE: f64 = 0.5 / 65_535.0;

/// Halvings of the way to grey: the last is below a step of 16 bits.
const HALVINGS: usize = 20;

/// Pixels whose planes are worked on together, step by step.
const BLOCK: usize = 64;

/// Light to what the cones see, cube roots of that to lightness, a and b, and both ways back: the
/// matrices of the source, as it has them since 2021. The last is without its first column of 1.
const TO_CONES: [[f64; 3]; 3] = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];
const TO_LAB: [[f64; 3]; 3] = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];
const TO_LIGHT: [[f64; 3]; 3] = [
    [4.076_741_662_1, -3.307_711_591_3, 0.230_969_929_2],
    [-1.268_438_004_6, 2.609_757_401_1, -0.341_319_396_5],
    [-0.004_196_086_3, -0.703_418_614_7, 1.707_614_701_0],
];
const TO_ROOTS: [[f64; 2]; 3] = [
    [0.396_337_777_4, 0.215_803_757_3],
    [-0.105_561_345_8, -0.063_854_172_8],
    [-0.089_484_177_5, -1.291_485_548_0],
];

/// What a and b become: a matrix, row by row.
pub(crate) type Turn = [[f64; 2]; 2];

/// Chroma times S.
pub(crate) fn saturation(parameters: &[f64]) -> Turn {
    [[parameters[0], 0.0], [0.0, parameters[0]]]
}

/// Hue turned by H degrees.
pub(crate) fn hue(parameters: &[f64]) -> Turn {
    let angle = parameters[0].to_radians();
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    [[cosine, -sine], [sine, cosine]]
}

/// Changes linear light; `bounded` where it is stored between 0 and 1.
pub(crate) fn change([r, g, b]: [&mut [f32]; 3], turn: &Turn, bounded: bool) {
    let blocks = r.chunks_mut(BLOCK).zip(g.chunks_mut(BLOCK)).zip(b.chunks_mut(BLOCK));
    let mut outside = Vec::new();
    for (block, ((r, g), b)) in blocks.enumerate() {
        let light = [&*r, &*g, &*b].map(|plane| {
            let mut values = [0.0; BLOCK];
            values.iter_mut().zip(plane).for_each(|(value, &light)| *value = f64::from(light));
            values
        });
        let lines = Lines::of(&light, turn);
        let new = lines.light(&[1.0; BLOCK]);
        for (plane, new) in [&mut *r, &mut *g, &mut *b].into_iter().zip(&new) {
            plane.iter_mut().zip(new).for_each(|(light, &new)| *light = narrow(new));
        }
        let inside = fits(&new);
        if bounded && inside.contains(&false) {
            let found = (0..r.len()).filter(|&at| !inside[at]);
            outside.extend(found.map(|at| (block * BLOCK + at, lines.pixel(at))));
        }
    }
    for pixels in outside.chunks(BLOCK) {
        let mut lines = Lines::default();
        for (at, (_, line)) in pixels.iter().enumerate() {
            lines.set(at, line);
        }
        let new = lines.light(&lines.most());
        for (at, &(place, _)) in pixels.iter().enumerate() {
            [r[place], g[place], b[place]] = new.map(|plane| narrow(plane[at]));
        }
    }
}

/// Cube roots of what the cones see, from grey on: `start + share · slope`.
struct Lines {
    start: [f64; BLOCK],
    slopes: [[f64; BLOCK]; 3],
}

impl Default for Lines {
    fn default() -> Self {
        Self { start: [0.0; BLOCK], slopes: [[0.0; BLOCK]; 3] }
    }
}

impl Lines {
    /// The lines from the grey of each colour's lightness to the changed colour.
    fn of(light: &[[f64; BLOCK]; 3], turn: &Turn) -> Self {
        let mut roots = times(&TO_CONES, light);
        for value in roots.as_flattened_mut() {
            *value = cube_root(*value);
        }
        let [start, a, b] = times(&TO_LAB, &roots);
        let mut slopes = [[0.0; BLOCK]; 3];
        for (slopes, [by_a, by_b]) in slopes.iter_mut().zip(&TO_ROOTS) {
            for ((slope, a), b) in slopes.iter_mut().zip(&a).zip(&b) {
                let turned = turn.map(|[x, y]| x * a + y * b);
                *slope = by_a * turned[0] + by_b * turned[1];
            }
        }
        Self { start, slopes }
    }

    fn light(&self, shares: &[f64; BLOCK]) -> [[f64; BLOCK]; 3] {
        let mut cones = [[0.0; BLOCK]; 3];
        for (cone, slopes) in cones.iter_mut().zip(&self.slopes) {
            let lines = self.start.iter().zip(slopes).zip(shares);
            for (cone, ((start, slope), share)) in cone.iter_mut().zip(lines) {
                let root = start + share * slope;
                *cone = root * root * root;
            }
        }
        times(&TO_LIGHT, &cones)
    }

    /// The most of each line that is in range, by bisection.
    fn most(&self) -> [f64; BLOCK] {
        let (mut inside, mut outside) = ([0.0; BLOCK], [1.0; BLOCK]);
        for _ in 0..HALVINGS {
            let mut middle = [0.0; BLOCK];
            for ((middle, inside), outside) in middle.iter_mut().zip(&inside).zip(&outside) {
                *middle = 0.5 * (inside + outside);
            }
            let fits = fits(&self.light(&middle));
            let ends = inside.iter_mut().zip(&mut outside);
            for ((inside, outside), (&middle, &fits)) in ends.zip(middle.iter().zip(&fits)) {
                *inside = if fits { middle } else { *inside };
                *outside = if fits { *outside } else { middle };
            }
        }
        inside
    }

    fn pixel(&self, at: usize) -> [f64; 4] {
        let [l, m, s] = self.slopes.each_ref().map(|slopes| slopes[at]);
        [self.start[at], l, m, s]
    }

    fn set(&mut self, at: usize, &[start, l, m, s]: &[f64; 4]) {
        self.start[at] = start;
        self.slopes.iter_mut().zip([l, m, s]).for_each(|(slopes, slope)| slopes[at] = slope);
    }
}

/// A matrix times the vector of each pixel.
fn times(matrix: &[[f64; 3]; 3], [x, y, z]: &[[f64; BLOCK]; 3]) -> [[f64; BLOCK]; 3] {
    let mut result = [[0.0; BLOCK]; 3];
    for (values, row) in result.iter_mut().zip(matrix) {
        for (value, ((x, y), z)) in values.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *value = row[0] * x + row[1] * y + row[2] * z;
        }
    }
    result
}

/// Which pixels are in range.
fn fits([r, g, b]: &[[f64; BLOCK]; 3]) -> [bool; BLOCK] {
    let mut fits = [false; BLOCK];
    for (fits, ((r, g), b)) in fits.iter_mut().zip(r.iter().zip(g).zip(b)) {
        let least = r.min(*g).min(*b);
        let most = r.max(*g).max(*b);
        *fits = (least >= -EDGE) & (most <= 1.0 + EDGE);
    }
    fits
}

/// The cube root, with an error below 2^-46 of it: a third of the exponent and its bits, within a
/// 20th of the root, and two steps of Halley's method, each of which leaves less than two thirds of the
/// third power of the error. What is below 10^-60 counts as that.
#[inline]
fn cube_root(value: f64) -> f64 {
    const LEAST: f64 = 1e-60;
    // Two thirds of the bias, less what makes the greatest error small.
    const BIAS: u32 = 715_094_163;
    let x = value.abs();
    let x = if x > LEAST { x } else { LEAST };
    let high = (x.to_bits() >> 32) as u32;
    let mut root = f64::from_bits(u64::from(high / 3 + BIAS) << 32);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    root.copysign(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palette::convert::FromColorUnclamped;
    use palette::{LinSrgb, Oklab};

    /// One colour by the matrices of another crate and a cube root of a third.
    fn plain(light: [f64; 3], turn: Turn, bounded: bool) -> [f64; 3] {
        let lab = Oklab::from_color_unclamped(LinSrgb::from(light));
        let [a, b] = turn.map(|[x, y]| x * lab.a + y * lab.b);
        let at = |share: f64| -> [f64; 3] {
            LinSrgb::from_color_unclamped(Oklab::new(lab.l, share * a, share * b)).into()
        };
        let whole = at(1.0);
        if !bounded || fits(whole) {
            return whole;
        }
        let (mut inside, mut outside) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if fits(at(middle)) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        at(inside)
    }

    fn fits(light: [f64; 3]) -> bool {
        light.iter().all(|value| (-EDGE..=1.0 + EDGE).contains(value))
    }

    fn changed(light: [f64; 3], turn: Turn, bounded: bool) -> [f64; 3] {
        let [mut r, mut g, mut b] = light.map(|value| [narrow(value)]);
        change([&mut r, &mut g, &mut b], &turn, bounded);
        [r, g, b].map(|[value]| f64::from(value))
    }

    fn saturation(light: [f64; 3], parameters: &[f64], bounded: bool) -> [f64; 3] {
        changed(light, super::saturation(parameters), bounded)
    }

    fn hue(light: [f64; 3], parameters: &[f64], bounded: bool) -> [f64; 3] {
        changed(light, super::hue(parameters), bounded)
    }

    #[test]
    fn blocks_are_as_the_plain_way() {
        let mut seed = 1_u32;
        let mut unit = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from(seed.to_be_bytes()[0]) / 255.0;
            value * value
        };
        // No multiple of a block; 0 and 1 among them, and less than 0 where there is no range.
        for (turn, bounded, low) in [
            (super::saturation(&[1.5]), true, 0.0),
            (super::saturation(&[0.3]), true, 0.0),
            (super::saturation(&[30.0]), true, 0.0),
            (super::hue(&[77.0]), true, 0.0),
            (super::saturation(&[1.5]), false, -0.5),
            (super::hue(&[-100.0]), false, -0.5),
        ] {
            let planes = [(); 3].map(|()| (0..3001).map(|_| unit() + low).collect::<Vec<f32>>());
            let [mut r, mut g, mut b] = planes.clone();
            change([&mut r, &mut g, &mut b], &turn, bounded);
            for at in 0..3001 {
                let light = planes.each_ref().map(|plane| f64::from(plane[at]));
                let found = [r[at], g[at], b[at]].map(f64::from);
                // A tenth of a step of 16 bits, where light is within 0 and 1.
                near(found, plain(light, turn, bounded), 1.5e-6);
            }
        }
    }

    #[test]
    fn cube_roots_are_near() {
        let mut x = 1e-50;
        while x < 1e50 {
            let (found, expected) = (cube_root(x), libm::cbrt(x));
            assert!((found / expected - 1.0).abs() < 1.5e-14, "{x}: {found} {expected}");
            assert!((cube_root(-x) + found).abs() <= 0.0, "{x}");
            x *= 1.037;
        }
        assert!(cube_root(0.0).abs() < 1e-19);
    }

    /// Lightness, a and b by the matrices of the source, written out.
    fn oklab([r, g, b]: [f64; 3]) -> [f64; 3] {
        let l = libm::cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
        let m = libm::cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
        let s = libm::cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
        [
            0.210_454_255_3 * l + 0.793_617_785 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766 * s,
        ]
    }

    fn near(found: [f64; 3], expected: [f64; 3], bound: f64) {
        let close = found.iter().zip(expected).all(|(f, e)| (f - e).abs() <= bound);
        assert!(close, "{found:?}, expected {expected:?}");
    }

    const COLORS: [[f64; 3]; 6] = [
        [0.5, 0.25, 0.125],
        [0.02, 0.3, 0.1],
        [0.9, 0.9, 0.1],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.3, 0.3, 0.3],
    ];

    #[test]
    fn nothing_to_do_changes_nothing() {
        for color in COLORS {
            near(saturation(color, &[1.0], true), color, 1e-5);
            near(hue(color, &[360.0], true), color, 1e-5);
        }
    }

    #[test]
    fn lightness_stays_and_chroma_scales() {
        for color in COLORS {
            let [l, a, b] = oklab(color);
            near(oklab(saturation(color, &[0.5], true)), [l, 0.5 * a, 0.5 * b], 1e-6);
            near(oklab(saturation(color, &[2.0], false)), [l, 2.0 * a, 2.0 * b], 1e-6);
            near(oklab(hue(color, &[90.0], false)), [l, -b, a], 1e-6);
            let grey = saturation(color, &[0.0], true);
            near(grey, [grey[0]; 3], 1e-6);
        }
    }

    #[test]
    fn what_leaves_the_range_gets_less_chroma() {
        for color in COLORS {
            let [l, a, b] = oklab(color);
            let strong = saturation(color, &[3.0], true);
            assert!(fits(strong), "{strong:?}");
            let [strong_l, strong_a, strong_b] = oklab(strong);
            assert!((strong_l - l).abs() < 1e-5, "{color:?}: {strong_l} {l}");
            // The same direction of a and b.
            assert!((strong_a * b - strong_b * a).abs() < 1e-5, "{color:?}: {strong:?}");
        }
    }
}
