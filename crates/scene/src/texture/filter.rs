//! Means of patterns over what a pixel takes in of them, so that a far texture is smooth and does not flicker.

use glam::DVec3;

use super::lattice::split;

/// Where a function is looked at, and how much of its space a pixel takes in there.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The middle.
    pub point: DVec3,
    /// Length along each axis, from edge to edge; 0 for the point alone.
    pub width: DVec3,
}

impl Spot {
    /// A point alone.
    #[must_use]
    pub fn sharp(point: DVec3) -> Self {
        Self { point, width: DVec3::ZERO }
    }
}

/// Mean of the bands 1, −1, 1, −1 … of unit length over `width` about `x`, by the integral, a triangle wave.
pub(super) fn alternating(x: f64, width: f64) -> f64 {
    let integral = |x: f64| {
        let (_, share) = split(0.5 * x);
        // Rises by 1 in the first half of two bands and falls in the second.
        if share < 0.5 { 2.0 * share } else { 2.0 - 2.0 * share }
    };
    if is_point(x, width) {
        let (_, share) = split(0.5 * x);
        return if share < 0.5 { 1.0 } else { -1.0 };
    }
    // Rounding alone takes it out of range.
    ((integral(x + 0.5 * width) - integral(x - 0.5 * width)) / width).clamp(-1.0, 1.0)
}

/// Share of `width` about `x` that lies on lines about whole numbers, each `line` wide.
pub(super) fn lines(x: f64, width: f64, line: f64) -> f64 {
    let moved = x + 0.5 * line;
    if is_point(x, width) {
        return if split(moved).1 < line { 1.0 } else { 0.0 };
    }
    // Rounding alone takes it out of range.
    rising(moved, width, |share| if share < line { share } else { line }).clamp(0.0, 1.0)
}

/// Mean over `width` about `x` of what repeats in every unit, by its integral from 0 to a share of the unit.
pub(super) fn rising(x: f64, width: f64, integral: impl Fn(f64) -> f64) -> f64 {
    let (low, high) = (split(x - 0.5 * width), split(x + 0.5 * width));
    ((high.0 - low.0) * integral(1.0) + integral(high.1) - integral(low.1)) / width
}

/// True if `width` cannot be told from 0 at `x`: differences of integrals would be rounding.
pub(super) fn is_point(x: f64, width: f64) -> bool {
    /// Leaves half of the bits of a number to the difference.
    const LEAST: f64 = 1.0 / 67_108_864.0;
    // Also where either is not a number.
    !(width > LEAST * x.abs() && width.is_finite())
}

/// What is left of a wave of `turns` in a length when it is averaged over that length: sin(πx) / πx, up to its first 0.
pub(super) fn wave_left(turns: f64) -> f64 {
    /// What is shorter than this takes away less than 0.0005.
    const LEAST: f64 = 1.0 / 64.0;
    let angle = std::f64::consts::PI * turns;
    if turns < LEAST {
        1.0
    } else if turns < 1.0 {
        libm::sin(angle) / angle
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean at 4000 places.
    fn mean(x: f64, width: f64, of: impl Fn(f64) -> f64) -> f64 {
        let place = |i: u32| x + width * ((f64::from(i) + 0.5) / 4000.0 - 0.5);
        (0..4000).map(|i| of(place(i))).sum::<f64>() / 4000.0
    }

    #[test]
    fn integrals_are_means() {
        for i in 0..200 {
            let (x, width) = (f64::from(i) * 0.137 - 11.0, 0.03 + f64::from(i % 17) * 0.31);
            let expected = mean(x, width, |x| alternating(x, 0.0));
            assert!((alternating(x, width) - expected).abs() < 1e-3, "bands at {x} over {width}");
            for line in [0.0, 0.1, 0.7, 1.0] {
                let expected = mean(x, width, |x| lines(x, 0.0, line));
                let found = lines(x, width, line);
                assert!((found - expected).abs() < 1.1e-2, "lines of {line} at {x} over {width}");
            }
        }
    }

    #[test]
    fn points_are_sharp() {
        for (x, band) in [(0.0, 1.0), (0.999, 1.0), (1.0, -1.0), (-0.001, -1.0), (-1.5, 1.0)] {
            assert!((alternating(x, 0.0) - band).abs() < 1e-15, "band at {x}");
        }
        for (x, line) in [(0.0, 1.0), (0.04, 1.0), (-0.04, 1.0), (0.06, 0.0), (7.94, 0.0)] {
            assert!((lines(x, 0.0, 0.1) - line).abs() < 1e-15, "line at {x}");
        }
        for far in [1e300, -1e16, f64::INFINITY] {
            assert!(alternating(far, 3.0).abs() <= 1.0, "{far}");
            assert!((0.0..=1.0).contains(&lines(far, 3.0, 0.2)), "{far}");
        }
    }
}
