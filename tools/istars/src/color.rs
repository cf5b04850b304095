//! Colours of hot bodies, and how hot stars are.

use crate::random::Random;

/// A spectral class: its letter, its share of the stars down to a given magnitude, and how hot they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Class {
    /// Its letter.
    pub letter: char,
    /// Stars of it among a hundred.
    pub percent: f64,
    /// Least and greatest temperature of the surface in kelvins.
    pub kelvins: [f64; 2],
}

/// The classes of Harvard; shares are those of the stars that the eye sees (Hoffleit, "The Bright Star Catalogue", 1991,
/// rounded), and sum up to 100.
pub const CLASSES: [Class; 7] = [
    Class { letter: 'O', percent: 0.5, kelvins: [30_000.0, 45_000.0] },
    Class { letter: 'B', percent: 19.5, kelvins: [10_000.0, 30_000.0] },
    Class { letter: 'A', percent: 21.0, kelvins: [7500.0, 10_000.0] },
    Class { letter: 'F', percent: 14.0, kelvins: [6000.0, 7500.0] },
    Class { letter: 'G', percent: 15.0, kelvins: [5200.0, 6000.0] },
    Class { letter: 'K', percent: 25.0, kelvins: [3700.0, 5200.0] },
    Class { letter: 'M', percent: 5.0, kelvins: [2400.0, 3700.0] },
];

/// The temperature of one of the stars, in kelvins: even on a scale of ratios within its class.
pub(crate) fn temperature(random: &mut Random) -> f64 {
    let (mut left, within) = (random.share() * 100.0, random.share());
    let last = CLASSES[CLASSES.len() - 1];
    let class = CLASSES.iter().find(|class| {
        left -= class.percent;
        left <= 0.0
    });
    let [low, high] = class.unwrap_or(&last).kelvins;
    low * libm::pow(high / low, within)
}

/// Linear light in the primaries of sRGB of a black body of so many kelvins, from 1000 on; its luminance is 1.
///
/// Planck's law times the matching functions of CIE 1931 as sums of bells (Wyman, Sloan, Shirley, "Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions", 2013), every 5 nm. What is out of gamut is mixed with
/// white until it is in.
pub fn black_body(kelvins: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for step in 0..=80 {
        let nanometres = 380.0 + 5.0 * f64::from(step);
        let radiance = planck(nanometres, kelvins);
        for (sum, weight) in xyz.iter_mut().zip(matching(nanometres)) {
            *sum += radiance * weight;
        }
    }
    let [x, y, z] = xyz.map(|value| value / xyz[1]);
    // XYZ to sRGB (IEC 61966-2-1).
    let rgb = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    let least =
        rgb.iter().fold(0.0, |least: f64, &value| if value < least { value } else { least });
    rgb.map(|value| (value - least) / (1.0 - least))
}

/// Spectral radiance up to a factor that no colour has.
fn planck(nanometres: f64, kelvins: f64) -> f64 {
    /// h c / k in nanometres times kelvins.
    const SECOND: f64 = 1.438_776_877e7;
    let l = nanometres / 560.0;
    1.0 / (l * l * l * l * l * (libm::exp(SECOND / (nanometres * kelvins)) - 1.0))
}

/// x̄, ȳ and z̄ of CIE 1931.
fn matching(nanometres: f64) -> [f64; 3] {
    let bell = |height: f64, middle: f64, below: f64, above: f64| {
        let width = if nanometres < middle { below } else { above };
        let t = (nanometres - middle) * width;
        height * libm::exp(-0.5 * t * t)
    };
    [
        bell(0.362, 442.0, 0.0624, 0.0374)
            + bell(1.056, 599.8, 0.0264, 0.0323)
            + bell(-0.065, 501.1, 0.0490, 0.0382),
        bell(0.821, 568.8, 0.0213, 0.0247) + bell(0.286, 530.9, 0.0613, 0.0322),
        bell(1.217, 437.0, 0.0845, 0.0278) + bell(0.681, 459.0, 0.0385, 0.0725),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance([red, green, blue]: [f64; 3]) -> f64 {
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    #[test]
    fn a_body_of_daylight_is_almost_white() {
        // The white of sRGB, D65, is near a black body of 6500 K, but a little greener.
        let [red, green, blue] = black_body(6500.0);
        for value in [red, green, blue] {
            assert!((value - 1.0).abs() < 0.06, "{red} {green} {blue}");
        }
    }

    #[test]
    fn chromaticities_are_those_of_the_planckian_locus() {
        // CIE 1931 x and y of black bodies (Wyszecki and Stiles, "Color Science", 1982, table 1(3.11)).
        for (kelvins, x, y) in
            [(3000.0, 0.4369, 0.4041), (5000.0, 0.3451, 0.3516), (10_000.0, 0.2807, 0.2884)]
        {
            let [r, g, b] = black_body(kelvins);
            let cie_x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
            let cie_y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            let cie_z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
            let sum = cie_x + cie_y + cie_z;
            let off = [(cie_x / sum - x).abs(), (cie_y / sum - y).abs()];
            assert!(off.iter().all(|off| *off < 0.004), "{kelvins}: {off:?}");
        }
    }

    #[test]
    fn hot_is_blue_and_luminance_is_one() {
        let mut bluer = 0.0;
        for class in CLASSES.iter().rev() {
            for kelvins in class.kelvins {
                let color = black_body(kelvins);
                assert!((luminance(color) - 1.0).abs() < 0.002, "{kelvins}: {color:?}");
                assert!(color.iter().all(|value| *value >= 0.0), "{kelvins}: {color:?}");
                assert!(color[2] / color[0] >= bluer, "{kelvins}: {color:?}");
                bluer = color[2] / color[0];
            }
        }
    }

    #[test]
    fn classes_are_as_frequent_as_the_table_says() {
        let all: f64 = CLASSES.iter().map(|class| class.percent).sum();
        assert!((all - 100.0).abs() < 1e-12, "{all}");
        let count = 40_000;
        let kelvins: Vec<f64> =
            (0..count).map(|index| temperature(&mut Random::new(1, index))).collect();
        for class in CLASSES {
            let [low, high] = class.kelvins;
            let found = kelvins.iter().filter(|k| (low..high).contains(*k)).count();
            let expected = f64::from(u32::try_from(count).unwrap()) * class.percent / 100.0;
            // Four standard deviations.
            let off = (found as f64 - expected).abs();
            assert!(off < 4.0 * expected.sqrt(), "{}: {found}, {expected}", class.letter);
        }
    }
}
