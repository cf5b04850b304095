//! Oklab (Ottosson, "A perceptual color space for image processing", 2020), scaled by 255: `L`
//! from 0 to 255, so that a distance is of the size of one between bytes.

use std::sync::LazyLock;

use idf::{Transfer, srgb8};

/// `L`, `a` and `b` of sRGB bytes.
pub fn from_srgb([red, green, blue]: [u8; 3]) -> [f32; 3] {
    from_linear(linear([red, green, blue]))
}

/// Linear light, 0 to 1, of sRGB bytes.
#[inline]
pub fn linear(bytes: [u8; 3]) -> [f32; 3] {
    let light: &[f32; 256] = &LIGHT;
    bytes.map(|byte| light[usize::from(byte)])
}

/// `L`, `a` and `b` of linear light from 0 to 1. Relative error below 1e-6 of `L`.
#[inline]
pub fn from_linear([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = cube_root(0.412_221_47 * r + 0.536_332_55 * g + 0.051_445_995 * b);
    let m = cube_root(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
    let s = cube_root(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
    [
        255.0 * (0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s),
        255.0 * (1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s),
        255.0 * (0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s),
    ]
}

/// Turns display values from 0 to 255, which need not be whole, into Oklab; between bytes, light
/// is interpolated.
pub fn convert(colors: &mut [[f32; 3]]) {
    let light: &[f32; 256] = &LIGHT;
    for colors in colors.chunks_mut(16) {
        for color in &mut *colors {
            *color = color.map(|value| {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "between 0 and 255"
                )]
                let below = (value as usize).min(254);
                let share = value - below as f32;
                light[below] + share * (light[below + 1] - light[below])
            });
        }
        convert_light(colors);
    }
}

/// Turns linear light into Oklab, in loops that the compiler runs on several lanes.
fn convert_light(colors: &mut [[f32; 3]]) {
    let mut axes = [[0.0; 16]; 3];
    for (lane, color) in colors.iter().enumerate() {
        for axis in 0..3 {
            axes[axis][lane] = color[axis];
        }
    }
    let axes = lanes_from_linear(&axes);
    for (lane, color) in colors.iter_mut().enumerate() {
        *color = std::array::from_fn(|axis| axes[axis][lane]);
    }
}

/// `L`, `a` and `b` of several colours of linear light, axis by axis.
#[inline]
pub(crate) fn lanes_from_linear<const N: usize>(light: &[[f32; N]; 3]) -> [[f32; N]; 3] {
    let mut axes = [[0.0; N]; 3];
    for lane in 0..N {
        let [l, a, b] = from_linear([light[0][lane], light[1][lane], light[2][lane]]);
        (axes[0][lane], axes[1][lane], axes[2][lane]) = (l, a, b);
    }
    axes
}

/// The nearest sRGB bytes; light outside the gamut is cut off channel by channel.
pub fn to_srgb(oklab: [f32; 3]) -> [u8; 3] {
    let [lightness, a, b] = oklab.map(|value| f64::from(value) / 255.0);
    let cubed = |root: f64| root * root * root;
    let l = cubed(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cubed(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cubed(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
    .map(srgb8)
}

/// Linear light of each byte.
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| {
    let mut light = [0.0; 256];
    for (light, byte) in light.iter_mut().zip(0..=u8::MAX) {
        *light = narrow(Transfer::Srgb.decode(f64::from(byte) / 255.0));
    }
    light
});

/// Cube root of 0 to 2^64, to 2 units in the last place: a third of the exponent (the constant of
/// `cbrtf` in FreeBSD, good to 5 bits), then Halley's rule twice, which triples the bits. In
/// operations that the compiler runs on several lanes.
#[inline]
fn cube_root(x: f32) -> f32 {
    const THIRD_OF_BIAS: u32 = 709_958_130;
    /// Of 3 / 2 · 2^30: the low bits of a sum with it are a whole number of times 2^7. A conversion by
    /// `as` looks for what does not fit, and takes as long as all the rest.
    const WHOLE: u32 = 0x4ec0_0000;
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    let third = x.to_bits().cast_signed() as f32 * (1.0 / 3.0) + f32::from_bits(WHOLE);
    let third = third.to_bits().wrapping_sub(WHOLE) << 7;
    let y = f32::from_bits(third.wrapping_add(THIRD_OF_BIAS));
    let halley = |y: f32| {
        let cube = y * y * y;
        // Without the last term 0 would be 0 / 0.
        y * (cube + 2.0 * x) / (2.0 * cube + x + f32::MIN_POSITIVE)
    };
    halley(halley(y))
}

#[expect(clippy::cast_possible_truncation, reason = "32 bits hold more than a byte's light")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use palette::{FromColor, Oklab, Srgb};

    use super::*;

    #[test]
    fn it_agrees_with_another_library_and_comes_back() {
        for at in 0..4096_u16 {
            let [high, low] = (at.wrapping_mul(4093)).to_be_bytes();
            for color in [[high, low, high ^ low], [low, low, low], [high, 0, 255]] {
                let [r, g, b] = color.map(|byte| f64::from(byte) / 255.0);
                let expected = Oklab::from_color(Srgb::new(r, g, b));
                let found = from_srgb(color);
                for (found, expected) in found.iter().zip([expected.l, expected.a, expected.b]) {
                    let error = f64::from(*found) - 255.0 * expected;
                    assert!(error.abs() < 1e-3, "{color:?}: {error}");
                }
                assert_eq!(to_srgb(found), color);
            }
        }
    }

    #[test]
    fn black_is_0_and_white_255() {
        assert_eq!(from_srgb([0; 3]).map(f32::to_bits), [0; 3]);
        assert!((from_srgb([255; 3])[0] - 255.0).abs() < 1e-3);
        let mut colors = [[0.0, 128.0, 255.0], [0.0; 3]];
        convert(&mut colors);
        assert_eq!(colors, [from_srgb([0, 128, 255]), [0.0; 3]]);
    }
}
