//! How far off a picture is: against two references that know nothing of each other.
//!
//! With references R₁ and R₂ drawn by different seeds, (P − R₁)(P − R₂) has the mean square error of P as its mean: what
//! either reference is off by drops out. So they need not be converged far below the error that is measured.

use idf::{Image, ImageError, Kind, Plane, Samples, Transfer};
use render::Film;
use scene::Rgb;

/// Display white.
const WHITE: f64 = 255.0;

/// Channels of a picture.
const COLOR: [Kind; 3] = [Kind::Red, Kind::Grn, Kind::Blu];

/// A picture over its background as a display shows it, before it is rounded: red, green and blue of each pixel in steps
/// of 1/255, 0…255.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Row by row from the top.
    pub steps: Vec<[f64; 3]>,
}

/// Two pictures of the same, of many samples each, by different seeds.
#[derive(Clone, Debug)]
pub struct References {
    pair: [Shown; 2],
}

/// What is found of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueError {
    /// The root of the mean square error in display steps. Where that is less than its own uncertainty, that
    /// uncertainty.
    pub error: f64,
    /// Standard deviation of `error`, of what the references are off by and of the pixels there are.
    pub deviation: f64,
}

/// The light of a film over its background: linear, 32-bit floating point.
///
/// # Errors
///
/// If the picture is larger than an image may be.
pub fn light(film: &Film, background: Rgb) -> Result<Image, ImageError> {
    let form =
        render::Form { float: true, opaque: true, coverage: false, straight: false, dither: false };
    film.image(form, background)
}

impl Shown {
    /// Of an image of red, green and blue.
    ///
    /// # Errors
    ///
    /// If it has no such channels.
    pub fn of(image: &Image) -> Result<Self, ImageError> {
        let [red, green, blue] = COLOR.map(|kind| image.decoded(kind));
        let channels = red?.into_iter().zip(green?).zip(blue?);
        let step = |linear: f32| {
            let linear = f64::from(linear);
            // What is no number is dark.
            let shown = if linear > 0.0 { if linear < 1.0 { linear } else { 1.0 } } else { 0.0 };
            WHITE * Transfer::Srgb.encode(shown)
        };
        let steps = channels.map(|((r, g), b)| [step(r), step(g), step(b)]).collect();
        Ok(Self { size: image.size(), steps })
    }

    /// As 8 bits.
    ///
    /// # Errors
    ///
    /// If the size is none of an image's.
    pub fn image(&self) -> Result<Image, ImageError> {
        self.map(|pixel| pixel)
    }

    /// The absolute difference of two pictures, `gain` times, as 8 bits.
    ///
    /// # Errors
    ///
    /// If the size is none of an image's.
    pub fn difference(&self, other: &Self, gain: f64) -> Result<Image, ImageError> {
        let mut others = other.steps.iter();
        self.map(|pixel| {
            let other = others.next().unwrap_or(&pixel);
            std::array::from_fn(|k| gain * (pixel[k] - other[k]).abs())
        })
    }

    fn map(&self, mut value: impl FnMut([f64; 3]) -> [f64; 3]) -> Result<Image, ImageError> {
        let mut channels: [Vec<u8>; 3] = Default::default();
        for &pixel in &self.steps {
            for (channel, value) in channels.iter_mut().zip(value(pixel)) {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "conversion to integers saturates"
                )]
                channel.push((value + 0.5) as u8);
            }
        }
        let planes = COLOR.into_iter().zip(channels);
        let planes = planes.map(|(kind, bytes)| Plane { kind, samples: Samples::U8(bytes) });
        Image::new(self.size[0], self.size[1], planes.collect())
    }

    /// The root of the mean square difference of two pictures of one size, in steps.
    #[must_use]
    pub fn apart(&self, other: &Self) -> f64 {
        let pairs = self.steps.iter().zip(&other.steps);
        mean(pairs.map(|(a, b)| product(a, b, b)).collect()).sqrt()
    }
}

impl References {
    /// Two pictures of one size.
    #[must_use]
    pub fn new(pair: [Shown; 2]) -> Self {
        Self { pair }
    }

    /// The mean of both: the best picture there is.
    #[must_use]
    pub fn mean(&self) -> Shown {
        let [a, b] = &self.pair;
        let pairs = a.steps.iter().zip(&b.steps);
        let steps = pairs.map(|(a, b)| std::array::from_fn(|k| 0.5 * (a[k] + b[k]))).collect();
        Shown { size: a.size, steps }
    }

    /// The root of the mean square error of [`References::mean`], in steps: half of what both are apart.
    #[must_use]
    pub fn own_error(&self) -> f64 {
        0.5 * self.pair[0].apart(&self.pair[1])
    }

    /// How far off a picture of the same size is.
    #[must_use]
    pub fn error(&self, picture: &Shown) -> TrueError {
        let [a, b] = &self.pair;
        let all = picture.steps.iter().zip(a.steps.iter().zip(&b.steps));
        let products: Vec<f64> = all.map(|(p, (a, b))| product(p, a, b)).collect();
        #[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
        let count = products.len() as f64;
        let square = mean(products.clone());
        let spread = mean(products.iter().map(|x| (x - square) * (x - square)).collect());
        // Pixels are taken as independent.
        let deviation = (spread / count).sqrt();
        let known = if square > deviation { square } else { deviation };
        let error = known.sqrt();
        let deviation = if error > 0.0 { deviation / (2.0 * error) } else { 0.0 };
        TrueError { error, deviation }
    }
}

/// The mean over the channels of (p − a)(p − b).
fn product(p: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - a[k]) * (p[k] - b[k])).sum::<f64>() / 3.0
}

#[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
fn mean(values: Vec<f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.into_iter().sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 64;

    fn flat(value: f64) -> Shown {
        let steps = vec![[value; 3]; (SIDE * SIDE) as usize];
        Shown { size: [SIDE, SIDE], steps }
    }

    /// Numbers from −1 to 1 by a linear congruence (Knuth's MMIX).
    fn chance(state: &mut u64) -> f64 {
        *state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (*state >> 11) as f64 / (1_u64 << 53) as f64;
        2.0 * share - 1.0
    }

    fn noisy(value: f64, amplitude: f64, seed: u64) -> Shown {
        let mut state = seed;
        let mut picture = flat(value);
        for pixel in &mut picture.steps {
            *pixel = std::array::from_fn(|_| value + amplitude * chance(&mut state));
        }
        picture
    }

    #[test]
    fn errors_of_references_drop_out() {
        // The references are off by 3/√3 steps each, the picture by 1/√3 and by 2 for what it is worth.
        let references = References::new([noisy(100.0, 3.0, 1), noisy(100.0, 3.0, 2)]);
        for (picture, expected) in
            [(noisy(100.0, 1.0, 3), 1.0 / 3.0_f64.sqrt()), (flat(102.0), 2.0), (flat(97.0), 3.0)]
        {
            let found = references.error(&picture);
            let off = (found.error - expected).abs();
            assert!(off < 4.0 * found.deviation, "{found:?}, not {expected}");
            assert!(found.deviation < 0.1, "{found:?}");
        }
        // Of the mean of both: (3/√3)/√2.
        let own = references.own_error();
        assert!((own - (1.5_f64).sqrt()).abs() < 0.03, "{own}");
        assert!((references.mean().apart(&flat(100.0)) - own).abs() < 0.03);
    }

    #[test]
    fn what_cannot_be_known_is_no_error_of_0() {
        let references = References::new([noisy(9.0, 2.0, 1), noisy(9.0, 2.0, 2)]);
        let found = references.error(&flat(9.0));
        assert!(found.error > 0.0 && found.error < 0.3, "{found:?}");
        let exact = References::new([flat(9.0), flat(9.0)]).error(&flat(9.0));
        assert_eq!(exact, TrueError { error: 0.0, deviation: 0.0 });
    }

    #[test]
    fn pictures_are_shown_and_rounded() {
        let planes = COLOR.into_iter().zip([[0.0, 2.0], [1.0, f32::NAN], [0.214_041_14, -1.0]]);
        let planes = planes.map(|(kind, v)| Plane { kind, samples: Samples::F32(v.into()) });
        let image = Image::new(2, 1, planes.collect()).unwrap();
        let shown = Shown::of(&image).unwrap();
        // sRGB shows 0.21404114 as 0.5.
        let expected = [[0.0, 255.0, 127.5], [255.0, 0.0, 0.0]];
        for (found, expected) in shown.steps.iter().flatten().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-4, "{shown:?}");
        }
        let black = Shown { size: [2, 1], steps: vec![[0.0, 250.0, 0.0], [0.0; 3]] };
        let difference = shown.difference(&black, 2.0).unwrap();
        let bytes = COLOR.map(|kind| difference.plane(kind).cloned().unwrap());
        let expected = [[0, 255], [10, 0], [255, 0]].map(|v| Samples::U8(v.into()));
        assert_eq!(bytes, expected);
    }
}
