//! What textures make of the integer lattice: gradient noise and its sums of octaves (Perlin, "An Image Synthesizer",
//! 1985), and points scattered one to a cell (Schachter and Ahuja, "Random Pattern Generation Processes", 1979).

use glam::DVec3;

/// Smooth noise of feature size 1, 0 at lattice points and mostly within ±0.8.
///
/// Past 2⁵² units from the origin there are lattice points only.
pub(super) fn noise(p: DVec3) -> f64 {
    let (cell, f) = split_each(p);
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let corner = |x: f64, y: f64, z: f64| {
        let offset = DVec3::new(x, y, z);
        slope(hash(cell + offset), f - offset)
    };
    let mix = |t: f64, a: f64, b: f64| a + t * (b - a);
    let sheet = |z: f64| {
        let near = mix(u, corner(0.0, 0.0, z), corner(1.0, 0.0, z));
        let far = mix(u, corner(0.0, 1.0, z), corner(1.0, 1.0, z));
        mix(v, near, far)
    };
    mix(w, sheet(0.0), sheet(1.0))
}

/// What is summed up in octaves, and what a pixel makes of it.
#[derive(Debug)]
pub(super) struct Wave {
    of: fn(f64) -> f64,
    /// Mean and deviation, of the reference implementation of noise.
    pub(super) mean: f64,
    pub(super) deviation: f64,
    /// How fast it goes over to its mean, see [`left`].
    fineness: f64,
}

/// Noise as it is.
pub(super) const SMOOTH: Wave =
    Wave { of: |noise| noise, mean: 0.0, deviation: 0.27, fineness: 0.295 };
/// Noise without its sign.
pub(super) const CREASED: Wave =
    Wave { of: f64::abs, mean: 0.2204, deviation: 0.157, fineness: CREASED_FINENESS };
/// Also of what is scattered one to a cell.
pub(super) const CREASED_FINENESS: f64 = 0.74;

/// Sum of octaves of a wave, each of half the size and half the weight of the one before; what `width` takes in as a
/// whole is its mean. And the variance of what was left out.
pub(super) fn octaves(p: DVec3, width: DVec3, octaves: u32, wave: &Wave) -> (f64, f64) {
    let (mut sum, mut variance, mut scale) = (0.0, 0.0, 1.0);
    for _ in 0..octaves {
        let left = left(width * scale, wave.fineness);
        let mut octave = wave.mean;
        if left > 0.0 {
            octave += left * ((wave.of)(noise(p * scale)) - wave.mean);
        }
        sum += octave / scale;
        let lost = wave.deviation / scale;
        variance += (1.0 - left * left) * lost * lost;
        scale *= 2.0;
    }
    (sum, variance)
}

/// How much of a pattern of feature size 1 is left at a point when it is averaged over a box about it: the regression of
/// the mean on the value, measured for boxes up to 3 wide and fitted within 0.03 along each axis.
pub(super) fn left(width: DVec3, fineness: f64) -> f64 {
    /// Fainter than this it is nothing, so that octaves end.
    const LEAST: f64 = 1.0 / 32.0;
    let square = fineness * width * width;
    let left = 1.0 / ((1.0 + square.x) * (1.0 + square.y) * (1.0 + square.z));
    // Also where it is not a number.
    if left > LEAST { (left - LEAST) / (1.0 - LEAST) } else { 0.0 }
}

/// A point of the lattice, moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    /// How far it is away.
    pub(super) distance: f64,
    /// A share of its own, in 0…1.
    pub(super) share: f64,
}

/// The points that may be nearer than ½, in an order that is the same everywhere; one point lies anywhere in every cell.
pub(super) fn sites(p: DVec3) -> [Site; 8] {
    // A point nearer than ½ lies in the cell of p − ½ or in the next one, along each axis.
    let (cell, f) = split_each(p - 0.5);
    let mut corner = 0;
    [(); 8].map(|()| {
        let offset =
            DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2));
        corner += 1;
        let share = |bits: u32| f64::from(bits) / f64::from(u32::MAX);
        let x = hash(cell + offset);
        let y = scramble(x ^ 0x9e37_79b9);
        let z = scramble(y ^ 0x9e37_79b9);
        let place = offset + DVec3::new(share(x), share(y), share(z));
        let distance = place.distance(f + 0.5);
        Site { distance, share: share(scramble(z ^ 0x9e37_79b9)) }
    })
}

/// How much of a ball of `radius` is at `distance` from its middle: 1 inside, 0 outside, smooth over its outer share
/// `soft`.
pub(super) fn ball(distance: f64, radius: f64, soft: f64) -> f64 {
    if distance >= radius {
        return 0.0;
    }
    let depth = (radius - distance) / (radius * soft);
    if depth < 1.0 { fade(depth) } else { 1.0 }
}

/// Whole part and fraction. An infinite number is 0: it stands for a place without fractions.
pub(super) fn split(x: f64) -> (f64, f64) {
    let whole = libm::floor(x);
    if whole.is_finite() { (whole, x - whole) } else { (0.0, 0.0) }
}

fn split_each(p: DVec3) -> (DVec3, DVec3) {
    let [x, y, z] = p.to_array().map(split);
    (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
}

/// From 0 to 1 with no slope and no curvature at either end (Perlin, "Improving Noise", 2002).
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// One of twelve directions to the edges of a cube, dotted with `f`.
fn slope(hash: u32, f: DVec3) -> f64 {
    let h = hash % 12;
    let (a, b) = match h / 4 {
        0 => (f.x, f.y),
        1 => (f.x, f.z),
        _ => (f.y, f.z),
    };
    (if h & 1 == 0 { a } else { -a }) + (if h & 2 == 0 { b } else { -b })
}

fn hash(cell: DVec3) -> u32 {
    cell.to_array().into_iter().fold(0x9e37_79b9_u32, |state, coordinate| {
        #[expect(clippy::cast_possible_truncation, reason = "saturates, and wraps to its low half")]
        let bits = coordinate as i64 as i32;
        scramble(state ^ bits.cast_unsigned())
    })
}

fn scramble(bits: u32) -> u32 {
    let mut x = bits.wrapping_mul(0x85eb_ca6b);
    x ^= x >> 13;
    x = x.wrapping_mul(0xc2b2_ae35);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero_on_the_lattice_and_smooth_between() {
        for i in -20..20 {
            let f = f64::from(i);
            assert!(noise(DVec3::new(f, 2.0 * f, -f)).abs() < 1e-15, "lattice point {i}");
            let p = DVec3::new(f * 0.37, f * 0.11, f * 0.73);
            let step = noise(p + DVec3::splat(1e-7)) - noise(p);
            assert!(step.abs() < 1e-6, "no jump at {p}");
        }
    }

    /// Mean and mean square of what a function of noise is at 20 000 places.
    fn moments(of: impl Fn(DVec3) -> f64) -> (f64, f64) {
        let (mut sum, mut square) = (0.0, 0.0);
        for i in 0..20_000 {
            let f = f64::from(i);
            let n = of(DVec3::new(f * 0.618, f * 0.377, f * 0.271));
            sum += n;
            square += n * n;
        }
        (sum / 20_000.0, square / 20_000.0)
    }

    #[test]
    fn noise_has_the_moments_of_perlins() {
        // Of the reference implementation of 2002: deviation 0.270, six octaves of its absolute value 0.434.
        let (mean, square) = moments(noise);
        assert!(mean.abs() < 0.01, "mean {mean}");
        assert!((square.sqrt() - 0.270).abs() < 0.01, "deviation {}", square.sqrt());
        let (mean, _) = moments(|p| octaves(p, DVec3::ZERO, 6, &CREASED).0);
        assert!((mean - 0.434).abs() < 0.01, "mean of turbulence {mean}");
    }

    #[test]
    fn far_places_are_lattice_points() {
        for far in [1e16, -1e300, f64::INFINITY] {
            assert!(noise(DVec3::splat(far)).abs() < 1e-15, "{far}");
            assert_eq!(split(far).1.to_bits(), 0, "{far}");
        }
    }

    #[test]
    fn no_site_nearer_than_a_half_is_missed() {
        for i in 0..4000 {
            let f = f64::from(i);
            let p = DVec3::new(f * 0.618 % 1.0, f * 0.377 % 1.0, f * 0.271 % 1.0);
            let near = |p: DVec3| sites(p).into_iter().filter(|site| site.distance < 0.5);
            // A small step to any side finds the same sites, but for those on the rim.
            for step in DVec3::AXES {
                let there: Vec<f64> = near(p + step * 1e-3).map(|site| site.share).collect();
                for site in near(p).filter(|site| site.distance < 0.498) {
                    assert!(there.contains(&site.share), "{} away from {p}", site.distance);
                }
            }
        }
    }

    #[test]
    fn a_ball_is_full_inside_and_fades_out() {
        for (distance, soft, expected) in
            [(0.0, 0.5, 1.0), (0.2, 0.5, 1.0), (0.3, 0.5, 0.5), (0.4, 0.5, 0.0), (0.399, 0.0, 1.0)]
        {
            let found = ball(distance, 0.4, soft);
            assert!((found - expected).abs() < 1e-12, "{distance} {soft}: {found}");
        }
        assert_eq!(ball(0.0, 0.0, 0.0).to_bits(), 0, "no ball");
    }
}
