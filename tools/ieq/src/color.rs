//! Operations on the colour of a pixel, in Oklch.
//!
//! Oklab (Ottosson, "A perceptual color space for image processing", 2020) keeps lightness apart
//! from chroma and hue, so a colour that turns or fades stays as light as it was; in HSV and HSL
//! yellow and blue have one value and one lightness. A colour that leaves the range of the stored
//! samples is brought back by less chroma, with lightness and hue as they are.

use palette::convert::FromColorUnclamped;
use palette::{LinSrgb, Oklab};

/// What rounds to the edge of the range at 16 bits lies within it.
const EDGE: f64 = 0.5 / 65_535.0;

/// Halvings of the way to grey: the last is below a step of 16 bits.
const HALVINGS: usize = 20;

/// Chroma times S.
pub(crate) fn saturation(light: [f64; 3], parameters: &[f64], bounded: bool) -> [f64; 3] {
    changed(light, bounded, |[a, b]| [a * parameters[0], b * parameters[0]])
}

/// Hue turned by H degrees.
pub(crate) fn hue(light: [f64; 3], parameters: &[f64], bounded: bool) -> [f64; 3] {
    let angle = parameters[0].to_radians();
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    changed(light, bounded, |[a, b]| [a * cosine - b * sine, a * sine + b * cosine])
}

fn changed(light: [f64; 3], bounded: bool, change: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 3] {
    let lab = Oklab::from_color_unclamped(LinSrgb::from(light));
    let [a, b] = change([lab.a, lab.b]);
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

#[cfg(test)]
mod tests {
    use super::*;

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
