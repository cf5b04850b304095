//! What a sample counts for in a pixel, by how far it is from the pixel's centre.

/// The weight of light around a pixel: the same function across and along, multiplied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The pixel's own square, everywhere alike.
    #[default]
    Box,
    /// Falls to nothing at the centres of the neighbours.
    Tent,
    /// Mitchell and Netravali's cubic with B = C = 1/3 ("Reconstruction Filters in Computer Graphics", 1988): sharper
    /// than the tent, with faint negative lobes, two pixels to either side.
    Mitchell,
}

impl Filter {
    /// Half its width in pixels.
    #[must_use]
    pub fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Mitchell => 2.0,
        }
    }

    /// How many pixels to each side of its own a sample counts in.
    pub(crate) fn reach(self) -> u32 {
        match self {
            Self::Box => 0,
            Self::Tent => 1,
            Self::Mitchell => 2,
        }
    }

    /// The weight at a distance in pixels along one axis; the integral over all distances is 1.
    #[must_use]
    pub fn weight(self, distance: f64) -> f64 {
        let x = distance.abs();
        match self {
            Self::Box => f64::from(u8::from(x <= 0.5)),
            Self::Tent if x < 1.0 => 1.0 - x,
            Self::Mitchell if x < 1.0 => ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0,
            Self::Mitchell if x < 2.0 => {
                (((12.0 - 7.0 / 3.0 * x) * x - 20.0) * x + 32.0 / 3.0) / 6.0
            }
            Self::Tent | Self::Mitchell => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_weights() {
        // Reference page on sampling.
        for (x, expected) in [
            (0.0, 0.888_888_9),
            (0.5, 0.534_722_2),
            (1.0, 0.055_555_6),
            (-1.5, -0.034_722_2),
            (2.0, 0.0),
        ] {
            let found = Filter::Mitchell.weight(x);
            assert!((found - expected).abs() < 1e-7, "{x}: {found}");
        }
        assert!((Filter::Tent.weight(-0.25) - 0.75).abs() < 1e-15);
        assert_eq!((Filter::Box.weight(0.4), Filter::Box.weight(0.6)), (1.0, 0.0));
    }

    #[test]
    fn weights_integrate_to_one_and_end_at_the_radius() {
        for filter in [Filter::Box, Filter::Tent, Filter::Mitchell] {
            let steps = 4000;
            let width = 2.0 * filter.radius();
            let middle = |i| (f64::from(i) + 0.5) / f64::from(steps) * width - filter.radius();
            let sum: f64 = (0..steps).map(|i| filter.weight(middle(i))).sum();
            let integral = sum * width / f64::from(steps);
            assert!((integral - 1.0).abs() < 1e-6, "{filter:?}: {integral}");
            assert!(filter.weight(filter.radius() + 1e-9) == 0.0, "{filter:?}");
            assert!(f64::from(filter.reach()) + 0.5 >= filter.radius(), "{filter:?}");
        }
    }
}
