//! Linear RGB, and the display (sRGB) curve that names and pictures use.

/// Linear red, green and blue; 1 is display white, more is possible for light.
pub type Rgb = glam::DVec3;

/// One linear channel from its display value in 0…1 (IEC 61966-2-1).
#[must_use]
pub fn linear_from_display(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// A linear colour from display values in 0…1.
#[must_use]
pub fn linear(display: [f64; 3]) -> Rgb {
    Rgb::from_array(display.map(linear_from_display))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_the_standard_one() {
        assert!((linear_from_display(0.5) - 0.214_041_140_482_232_3).abs() < 1e-15, "middle");
        assert_eq!(linear([0.0, 1.0, 0.0]), Rgb::new(0.0, 1.0, 0.0), "ends are exact");
        assert!((linear_from_display(0.04045) - 0.04045 / 12.92).abs() < 1e-18, "joint");
    }
}
