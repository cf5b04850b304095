//! Operations on the colour of a pixel, in Oklch.
//!
//! Oklab (Ottosson, "A perceptual color space for image processing", 2020) keeps lightness apart
//! from chroma and hue, so a colour that turns or fades stays as light as it was; in HSV and HSL
//! yellow and blue have one value and one lightness. A colour that leaves the range of the stored
//! samples is brought back by less chroma, with lightness and hue as they are.

use std::ops::{Add, Div, Mul};

use idf::{Quantizer, Transfer};

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

/// A number of as many bits as the samples ask for: 32 for bytes, where the error is below a
/// thousandth of a step, else 64.
trait Real: Copy + PartialOrd + Add<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    const ZERO: Self;
    const ONE: Self;
    fn of(value: f64) -> Self;
    fn of_sample(value: f32) -> Self;
    fn sample(self) -> f32;
    /// A third of the exponent and its bits, within a 20th of the cube root of a positive number.
    fn about_cube_root(self) -> Self;
    fn magnitude(self) -> Self;
    fn with_sign(self, of: Self) -> Self;
    /// What is nearer to 0 counts as that in a cube root.
    const LEAST: Self;
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const LEAST: Self = 1e-60;

    #[inline]
    fn of(value: f64) -> Self {
        value
    }

    #[inline]
    fn of_sample(value: f32) -> Self {
        Self::from(value)
    }

    #[inline]
    fn sample(self) -> f32 {
        narrow(self)
    }

    #[inline]
    fn about_cube_root(self) -> Self {
        // Two thirds of the bias, less what makes the greatest error small.
        const BIAS: u32 = 715_094_163;
        let high = (self.to_bits() >> 32) as u32;
        Self::from_bits(u64::from(high / 3 + BIAS) << 32)
    }

    #[inline]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline]
    fn with_sign(self, of: Self) -> Self {
        self.copysign(of)
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const LEAST: Self = 1e-30;

    #[inline]
    fn of(value: f64) -> Self {
        narrow(value)
    }

    #[inline]
    fn of_sample(value: f32) -> Self {
        value
    }

    #[inline]
    fn sample(self) -> f32 {
        self
    }

    #[inline]
    fn about_cube_root(self) -> Self {
        const BIAS: u32 = 709_958_130;
        Self::from_bits(self.to_bits() / 3 + BIAS)
    }

    #[inline]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline]
    fn with_sign(self, of: Self) -> Self {
        self.copysign(of)
    }
}

/// Changes linear light; `bounded` where it is stored between 0 and 1.
pub(crate) fn change(light: [&mut [f32]; 3], turn: &Turn, bounded: bool) {
    changed::<f64>(light, turn, bounded);
}

/// Changes bytes that are stored by a transfer.
pub(crate) struct Bytes {
    light: [f32; 256],
    quantizer: Quantizer,
}

impl Bytes {
    /// Bytes stored by `transfer`.
    pub(crate) fn new(transfer: Transfer) -> Self {
        let light = |byte| {
            let byte = u8::try_from(byte).unwrap_or(u8::MAX);
            narrow(transfer.decode(f64::from(byte) / 255.0))
        };
        Self { light: std::array::from_fn(light), quantizer: Quantizer::new(transfer) }
    }

    /// Changes colours; it is for few at a time, whose light stays in the cache.
    pub(crate) fn change(&self, colors: [&mut [u8]; 3], turn: &Turn) {
        let decoded = |plane: &[u8]| -> Vec<f32> {
            plane.iter().map(|&byte| self.light[usize::from(byte)]).collect()
        };
        let [mut r, mut g, mut b] = colors.each_ref().map(|plane| decoded(plane));
        changed::<f32>([&mut r, &mut g, &mut b], turn, true);
        for (plane, light) in colors.into_iter().zip([r, g, b]) {
            self.quantizer.fill(&light, plane);
        }
    }
}

fn changed<T: Real>([r, g, b]: [&mut [f32]; 3], turn: &Turn, bounded: bool) {
    let slopes = slopes(turn);
    // No chroma is left: the channels are to be equal, which matrices leave a rounding apart.
    let is_grey = turn.as_flattened().iter().all(|factor| factor.abs() <= 0.0);
    let blocks = r.chunks_mut(BLOCK).zip(g.chunks_mut(BLOCK)).zip(b.chunks_mut(BLOCK));
    let mut outside = Vec::new();
    for (block, ((r, g), b)) in blocks.enumerate() {
        let light = [&*r, &*g, &*b].map(|plane| {
            let mut values = [T::ZERO; BLOCK];
            let pairs = values.iter_mut().zip(plane);
            pairs.for_each(|(value, &light)| *value = T::of_sample(light));
            values
        });
        let lines = Lines::of(&light, &slopes);
        let new = if is_grey { lines.grey() } else { lines.ends() };
        for (plane, new) in [&mut *r, &mut *g, &mut *b].into_iter().zip(&new) {
            plane.iter_mut().zip(new).for_each(|(light, &new)| *light = new.sample());
        }
        let inside = fits(&new);
        if bounded && inside.contains(&false) {
            let found = (0..r.len()).filter(|&at| !inside[at]);
            outside.extend(found.map(|at| (block * BLOCK + at, lines.pixel(at))));
        }
    }
    for pixels in outside.chunks(BLOCK) {
        let mut lines = Lines::<T>::none();
        for (at, (_, line)) in pixels.iter().enumerate() {
            lines.set(at, line);
        }
        let cubics = lines.cubics();
        let new = light_at(&cubics, &most(&cubics));
        for (at, &(place, _)) in pixels.iter().enumerate() {
            [r[place], g[place], b[place]] = new.map(|plane| plane[at].sample());
        }
    }
}

/// Cube roots of what the cones see to what turned a and b add to the root of lightness.
fn slopes(turn: &Turn) -> [[f64; 3]; 3] {
    TO_ROOTS.map(|[by_a, by_b]| {
        let [a, b] = [0, 1].map(|column| by_a * turn[0][column] + by_b * turn[1][column]);
        [0, 1, 2].map(|root| a * TO_LAB[1][root] + b * TO_LAB[2][root])
    })
}

/// Cube roots of what the cones see, from grey on: `start + share · slope`.
struct Lines<T> {
    start: [T; BLOCK],
    slopes: [[T; BLOCK]; 3],
}

/// Light along lines: factors of 1, share, share² and share³ for each channel.
type Cubics<T> = [[[T; BLOCK]; 4]; 3];

impl<T: Real> Lines<T> {
    fn none() -> Self {
        Self { start: [T::ZERO; BLOCK], slopes: [[T::ZERO; BLOCK]; 3] }
    }

    /// The lines from the grey of each colour's lightness to the changed colour.
    fn of(light: &[[T; BLOCK]; 3], slopes: &[[f64; 3]; 3]) -> Self {
        let mut roots = times(&TO_CONES, light);
        for value in roots.as_flattened_mut() {
            *value = cube_root(*value);
        }
        Self { start: row_times(TO_LAB[0], &roots), slopes: times(slopes, &roots) }
    }

    /// The light at the start, where all channels are equal.
    fn grey(&self) -> [[T; BLOCK]; 3] {
        [self.start.map(|root| root * root * root); 3]
    }

    /// The light at the ends.
    fn ends(&self) -> [[T; BLOCK]; 3] {
        let mut cones = [[T::ZERO; BLOCK]; 3];
        for (cone, slopes) in cones.iter_mut().zip(&self.slopes) {
            for (cone, (&start, &slope)) in cone.iter_mut().zip(self.start.iter().zip(slopes)) {
                let root = start + slope;
                *cone = root * root * root;
            }
        }
        times(&TO_LIGHT, &cones)
    }

    /// The cubes of the lines, in the matrix from what the cones see to light.
    fn cubics(&self) -> Cubics<T> {
        let three = T::of(3.0);
        let mut cubics = [[[T::ZERO; BLOCK]; 4]; 3];
        for (cubic, row) in cubics.iter_mut().zip(TO_LIGHT) {
            for (at, &start) in self.start.iter().enumerate() {
                let mut sums = [T::ZERO; 4];
                for (slopes, factor) in self.slopes.iter().zip(row) {
                    let mut power = T::of(factor);
                    for sum in &mut sums {
                        *sum = *sum + power;
                        power = power * slopes[at];
                    }
                }
                let [zero, one, two, cube] = sums;
                cubic[0][at] = zero * start * start * start;
                cubic[1][at] = three * one * start * start;
                cubic[2][at] = three * two * start;
                cubic[3][at] = cube;
            }
        }
        cubics
    }

    fn pixel(&self, at: usize) -> [T; 4] {
        let [l, m, s] = self.slopes.each_ref().map(|slopes| slopes[at]);
        [self.start[at], l, m, s]
    }

    fn set(&mut self, at: usize, &[start, l, m, s]: &[T; 4]) {
        self.start[at] = start;
        self.slopes.iter_mut().zip([l, m, s]).for_each(|(slopes, slope)| slopes[at] = slope);
    }
}

fn light_at<T: Real>(cubics: &Cubics<T>, shares: &[T; BLOCK]) -> [[T; BLOCK]; 3] {
    let mut light = [[T::ZERO; BLOCK]; 3];
    for (light, [zero, one, two, three]) in light.iter_mut().zip(cubics) {
        for (at, (light, &share)) in light.iter_mut().zip(shares).enumerate() {
            *light = zero[at] + share * (one[at] + share * (two[at] + share * three[at]));
        }
    }
    light
}

/// The most of each line that is in range, by bisection.
fn most<T: Real>(cubics: &Cubics<T>) -> [T; BLOCK] {
    let half = T::of(0.5);
    let (mut inside, mut outside) = ([T::ZERO; BLOCK], [T::ONE; BLOCK]);
    for _ in 0..HALVINGS {
        let mut middle = [T::ZERO; BLOCK];
        for ((middle, &inside), &outside) in middle.iter_mut().zip(&inside).zip(&outside) {
            *middle = half * (inside + outside);
        }
        let fits = fits(&light_at(cubics, &middle));
        let ends = inside.iter_mut().zip(&mut outside);
        for ((inside, outside), (&middle, &fits)) in ends.zip(middle.iter().zip(&fits)) {
            *inside = if fits { middle } else { *inside };
            *outside = if fits { *outside } else { middle };
        }
    }
    inside
}

/// A matrix times the vector of each pixel.
fn times<T: Real>(matrix: &[[f64; 3]; 3], vectors: &[[T; BLOCK]; 3]) -> [[T; BLOCK]; 3] {
    matrix.map(|row| row_times(row, vectors))
}

fn row_times<T: Real>(row: [f64; 3], [x, y, z]: &[[T; BLOCK]; 3]) -> [T; BLOCK] {
    let row = row.map(T::of);
    let mut values = [T::ZERO; BLOCK];
    for (value, ((&x, &y), &z)) in values.iter_mut().zip(x.iter().zip(y).zip(z)) {
        *value = row[0] * x + row[1] * y + row[2] * z;
    }
    values
}

/// Which pixels are in range.
fn fits<T: Real>([r, g, b]: &[[T; BLOCK]; 3]) -> [bool; BLOCK] {
    let (low, high) = (T::of(-EDGE), T::of(1.0 + EDGE));
    let mut fits = [false; BLOCK];
    for (fits, ((&r, &g), &b)) in fits.iter_mut().zip(r.iter().zip(g).zip(b)) {
        let least = if r < g { r } else { g };
        let least = if least < b { least } else { b };
        let most = if r > g { r } else { g };
        let most = if most > b { most } else { b };
        *fits = (least >= low) & (most <= high);
    }
    fits
}

/// The cube root, with an error below 2^-46 of it, or of a few steps of 32 bits: two steps of
/// Halley's method, each of which leaves less than two thirds of the third power of the error.
#[inline]
fn cube_root<T: Real>(value: T) -> T {
    let x = value.magnitude();
    let x = if x > T::LEAST { x } else { T::LEAST };
    let mut root = x.about_cube_root();
    for _ in 0..2 {
        let cube = root * root * root;
        root = root * ((cube + x + x) / (cube + cube + x));
    }
    root.with_sign(value)
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
    fn bytes_are_as_the_plain_way() {
        // All colours of steps of 15, and all greys.
        let steps = || (0..=255_u8).step_by(15);
        let mut colors: Vec<[u8; 3]> = steps()
            .flat_map(|r| steps().flat_map(move |g| steps().map(move |b| [r, g, b])))
            .collect();
        colors.extend((0..=255).map(|grey| [grey; 3]));
        for transfer in [Transfer::Srgb, Transfer::Linear, Transfer::Gamma(2.2)] {
            let bytes = Bytes::new(transfer);
            for turn in [super::saturation(&[1.7]), super::saturation(&[0.4]), super::hue(&[50.0])]
            {
                let [mut r, mut g, mut b] =
                    [0, 1, 2].map(|c| colors.iter().map(|color| color[c]).collect::<Vec<u8>>());
                bytes.change([&mut r, &mut g, &mut b], &turn);
                for (at, color) in colors.iter().enumerate() {
                    let light = color.map(|byte| transfer.decode(f64::from(byte) / 255.0));
                    let expected = plain(light, turn, true).map(|l| 255.0 * transfer.encode(l));
                    for (found, expected) in [r[at], g[at], b[at]].into_iter().zip(expected) {
                        let off = (f64::from(found) - expected.clamp(0.0, 255.0)).abs();
                        assert!(off < 0.51, "{transfer} {color:?}: {found}, {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn cube_roots_are_near() {
        let mut x = 1e-50_f64;
        while x < 1e50 {
            let (found, expected) = (cube_root(x), libm::cbrt(x));
            assert!((found / expected - 1.0).abs() < 1.5e-14, "{x}: {found} {expected}");
            assert!((cube_root(-x) + found).abs() <= 0.0, "{x}");
            if (1e-29..1e29).contains(&x) {
                let (x, found) = (f64::from(narrow(x)), f64::from(cube_root(narrow(x))));
                assert!((found / libm::cbrt(x) - 1.0).abs() < 3e-7, "{x}: {found}");
            }
            x *= 1.037;
        }
        assert!(cube_root(0.0_f64).abs() < 1e-19);
        assert!(cube_root(0.0_f32).abs() < 1.1e-10);
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
    fn without_chroma_all_channels_are_equal() {
        let turn = super::saturation(&[0.0]);
        for bounded in [true, false] {
            for color in COLORS {
                let [r, g, b] = changed(color, turn, bounded).map(f64::to_bits);
                assert!(r == g && g == b, "{color:?}");
            }
        }
        let colors: Vec<u8> = (0..=255).collect();
        let bytes = Bytes::new(Transfer::Srgb);
        let (mut r, mut g) = (colors.clone(), colors.clone());
        let mut b: Vec<u8> = colors.iter().rev().copied().collect();
        bytes.change([&mut r, &mut g, &mut b], &turn);
        assert!(r == g && g == b);
        // A grey stays as it is.
        let [mut r, mut g, mut b] = [(); 3].map(|()| colors.clone());
        bytes.change([&mut r, &mut g, &mut b], &turn);
        assert_eq!((r, g, b), (colors.clone(), colors.clone(), colors));
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
