//! Rays in air that fade toward the background.

/// The share of light left after `length` units of air; `1 − ` it is background.
pub(crate) fn clear_share(half_distance: f64, length: f64) -> f64 {
    libm::exp2(-length / half_distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_by_the_half_distance() {
        for (length, expected) in [(0.0, 1.0), (1.0, 0.5), (2.0, 0.25), (3.0, 0.125)] {
            assert!((clear_share(1.0, length) - expected).abs() < 1e-9, "{length}");
        }
    }
}
