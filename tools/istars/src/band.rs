//! Where in the picture stars are dense: a band with clouds of dust along its middle.

use crate::random::Random;

/// The band of a galaxy seen from within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Stars in its midst for one far away from it; 1 is no band.
    pub strength: f64,
    /// Its standard deviation as a share of the picture's diagonal.
    pub width: f64,
    /// Degrees by which it rises to the right.
    pub tilt_degrees: f64,
    /// Share of the stars that dust hides where it is thickest, 0 to 1.
    pub dust: f64,
}

/// Octaves of the clouds.
const OCTAVES: u32 = 5;

impl Band {
    /// How dense stars are at a place, from 0 to 1, whose distances from the middle are shares of the diagonal; x to the
    /// right, y down.
    pub(crate) fn density(&self, seed: u64, [x, y]: [f64; 2]) -> f64 {
        if self.strength <= 1.0 {
            return 1.0;
        }
        let angle = self.tilt_degrees * std::f64::consts::PI / 180.0;
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let (along, across) = (x * cosine - y * sine, x * sine + y * cosine);
        let from_middle = across / self.width;
        let bulge = libm::exp(-0.5 * from_middle * from_middle);
        let clouds = clouds(seed, [along * 9.0, across * 9.0]);
        let lane = from_middle - 1.6 * (clouds - 0.5);
        let dust = self.dust * libm::exp(-4.0 * lane * lane);
        (1.0 + (self.strength - 1.0) * bulge * (0.4 + 0.6 * clouds) * (1.0 - dust)) / self.strength
    }
}

/// Fractal clouds, 0 to 1: smooth noise on lattices, each twice as fine and half as strong.
fn clouds(seed: u64, [x, y]: [f64; 2]) -> f64 {
    let (mut sum, mut most, mut scale, mut strength) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..OCTAVES {
        sum += strength * lattice(seed.wrapping_add(u64::from(octave) << 32), x * scale, y * scale);
        most += strength;
        scale *= 2.0;
        strength *= 0.5;
    }
    // Sums lie about one half: spread them out.
    (0.5 + 1.9 * (sum / most - 0.5)).clamp(0.0, 1.0)
}

/// Numbers at the corners of squares, and between them smoothly.
fn lattice(seed: u64, x: f64, y: f64) -> f64 {
    let (left, top) = (libm::floor(x), libm::floor(y));
    #[expect(clippy::cast_possible_truncation, reason = "pictures reach a few hundred squares")]
    let (column, row) = (left as i64, top as i64);
    let corner = |across: i64, down: i64| {
        let place = (column + across).wrapping_mul(0x1_0000_0001).wrapping_add((row + down) << 16);
        Random::new(seed, place.cast_unsigned()).share()
    };
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v) = (smooth(x - left), smooth(y - top));
    let mixed = |a: f64, b: f64, t: f64| a + (b - a) * t;
    mixed(mixed(corner(0, 0), corner(1, 0), u), mixed(corner(0, 1), corner(1, 1), u), v)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAND: Band = Band { strength: 10.0, width: 0.1, tilt_degrees: 0.0, dust: 0.0 };

    #[test]
    fn densities_are_shares() {
        for dust in [0.0, 0.5, 1.0] {
            let band = Band { dust, tilt_degrees: 30.0, ..BAND };
            for step in 0..400_u32 {
                let place = [f64::from(step % 20) * 0.05 - 0.5, f64::from(step / 20) * 0.05 - 0.5];
                let density = band.density(3, place);
                assert!((0.1..=1.0).contains(&density), "{place:?}: {density}");
            }
        }
    }

    #[test]
    fn the_band_lies_as_it_is_tilted() {
        let mean = |band: &Band, place: fn(f64) -> [f64; 2]| -> f64 {
            (-10..=10).map(|step| band.density(5, place(f64::from(step) * 0.04))).sum::<f64>()
                / 21.0
        };
        let level = mean(&BAND, |t| [t, 0.0]);
        let upright = mean(&BAND, |t| [0.0, t]);
        assert!(level > 2.0 * upright, "{level}, {upright}");
        let turned = Band { tilt_degrees: 90.0, ..BAND };
        assert!(mean(&turned, |t| [0.0, t]) > 2.0 * mean(&turned, |t| [t, 0.0]));
        // It rises to the right: y is down.
        let half = Band { tilt_degrees: 45.0, ..BAND };
        assert!(mean(&half, |t| [t, -t]) > 2.0 * mean(&half, |t| [t, t]));
        assert!(mean(&Band { dust: 1.0, ..BAND }, |t| [t, 0.0]) < level, "dust hides stars");
    }

    #[test]
    fn without_a_band_the_sky_is_even() {
        let none = Band { strength: 1.0, ..BAND };
        assert_eq!(none.density(1, [0.3, -0.2]).to_bits(), 1.0_f64.to_bits());
    }
}
