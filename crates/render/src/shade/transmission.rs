//! What a clear body takes from the light that crosses it.

use scene::Rgb;

use crate::world::Medium;

/// The share of each channel left after `length` units: halved every h / (1 + 8 (1 − colour)) of them, so cutting a
/// body in two changes nothing.
pub(crate) fn transmittance(medium: &Medium, length: f64) -> Rgb {
    let halvings = medium.rate * length;
    let x = libm::exp2(-halvings.x);
    // Neutral bodies need one power instead of three, and are the rule.
    let same = |other: f64| (other - halvings.x).abs() <= 0.0;
    let y = if same(halvings.y) { x } else { libm::exp2(-halvings.y) };
    let z = if same(halvings.z) { y } else { libm::exp2(-halvings.z) };
    Rgb::new(x, y, if same(halvings.z) { x } else { z })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(color: Rgb, half_distance: f64) -> Medium {
        Medium { value: 1, index: 1.5, rate: (1.0 + 8.0 * (1.0 - color)) / half_distance }
    }

    #[test]
    fn halves_by_the_half_distance() {
        let glass = body(Rgb::ONE, 1000.0);
        for (length, expected) in
            [(12.0, 0.991_717), (100.0, 0.933_033), (1000.0, 0.5), (5000.0, 0.03125)]
        {
            let left = transmittance(&glass, length);
            assert!(
                (left.x - expected).abs() < 1e-6 && left.x.to_bits() == left.z.to_bits(),
                "{length}: {left}"
            );
        }
        let wine = transmittance(&body(Rgb::X, 900.0), 100.0);
        assert!((wine.x - libm::exp2(-1.0 / 9.0)).abs() < 1e-15, "red passes");
        assert!((wine.y - 0.5).abs() < 1e-15 && (wine.z - 0.5).abs() < 1e-15, "the rest halves");
    }

    #[test]
    fn two_halves_are_a_whole() {
        let medium = body(Rgb::new(0.2, 0.5, 0.9), 3.0);
        let whole = transmittance(&medium, 2.5);
        let parts = transmittance(&medium, 1.0) * transmittance(&medium, 1.5);
        assert!(whole.abs_diff_eq(parts, 1e-15), "{whole} {parts}");
    }
}
