//! Operations on one display value at a time.
//!
//! Display values are sRGB, 0 to 1. What lies beyond, in floating point, follows the same formula
//! and is not clamped.

/// `value` to the power of 1 / G; below 0 mirrored.
pub(crate) fn gamma(value: f64, parameters: &[f64]) -> f64 {
    libm::pow(value.abs(), 1.0 / parameters[0]).copysign(value)
}

/// LO becomes 0 and HI becomes 1. Where they are equal, what is below becomes 0 and all else 1.
pub(crate) fn levels(value: f64, parameters: &[f64]) -> f64 {
    let (low, high) = (parameters[0], parameters[1]);
    if (high - low).abs() > 0.0 {
        return (value - low) / (high - low);
    }
    if value < low { 0.0 } else { 1.0 }
}

/// `value` and B.
pub(crate) fn brightness(value: f64, parameters: &[f64]) -> f64 {
    value + parameters[0]
}

/// The distance from 0.5 times C.
pub(crate) fn contrast(value: f64, parameters: &[f64]) -> f64 {
    (value - 0.5) * parameters[0] + 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
    }

    #[test]
    fn curves_have_the_values_of_their_formulas() {
        near(gamma(0.25, &[2.0]), 0.5);
        near(gamma(0.5, &[0.5]), 0.25);
        near(gamma(-0.25, &[2.0]), -0.5);
        near(gamma(4.0, &[2.0]), 2.0);
        near(levels(0.25, &[0.0, 0.5]), 0.5);
        near(levels(0.75, &[0.5, 0.6]), 2.5);
        near(brightness(0.25, &[-0.5]), -0.25);
        near(contrast(0.75, &[2.0]), 1.0);
        near(contrast(0.5, &[100.0]), 0.5);
    }

    #[test]
    fn levels_turn_round_and_cut() {
        near(levels(0.25, &[1.0, 0.0]), 0.75);
        near(levels(0.499, &[0.5, 0.5]), 0.0);
        near(levels(0.5, &[0.5, 0.5]), 1.0);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for curve in [gamma, levels, brightness, contrast] {
            assert!(curve(f64::NAN, &[0.5, 0.75]).is_nan());
        }
    }
}
