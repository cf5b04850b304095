//! How the light of a star is spread over pixels.

use std::ops::Range;

/// A sharp core and a wide, faint halo, each a Gaussian: the profile of a telescope, simplified (King, "The profile of a
/// star image", 1971). Light is neither lost nor won but beyond the reach of a star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// Standard deviation of the core in pixels, above 0.
    pub core: f64,
    /// Share of the light in the halo.
    pub halo: f64,
}

/// The halo is so many times as wide as the core.
const WIDER: f64 = 5.0;
/// A star ends where it adds less than this to a pixel; one step of 8 bits near black is 3·10⁻⁴.
const LEAST: f64 = 2e-6;
/// Standard deviations after which nothing is left.
const END: f64 = 6.0;

impl Profile {
    /// How far a star with this much light reaches, in pixels.
    pub(crate) fn reach(&self, light: f64) -> f64 {
        let part = |share: f64, deviation: f64| {
            let peak = light * share / (std::f64::consts::TAU * deviation * deviation);
            if peak <= LEAST {
                return 0.0;
            }
            let ends = (2.0 * libm::log(peak / LEAST)).sqrt();
            deviation * if ends < END { ends } else { END }
        };
        let (core, halo) = (part(1.0 - self.halo, self.core), part(self.halo, WIDER * self.core));
        1.0 + if core > halo { core } else { halo }
    }

    /// Shares of the light in the columns (or rows) of a cut, for a star at `place`: those of the core and of the halo,
    /// whose products are the shares of pixels.
    pub(crate) fn fill(&self, place: f64, cut: &Range<usize>, shares: &mut Vec<[f64; 2]>) {
        shares.clear();
        let below = |edge: usize| {
            let of = |deviation: f64| {
                let away = (edge as f64 - place) / (deviation * std::f64::consts::SQRT_2);
                0.5 * (1.0 + libm::erf(away))
            };
            [of(self.core), of(WIDER * self.core)]
        };
        let mut before = below(cut.start);
        for edge in cut.clone() {
            let next = below(edge + 1);
            shares.push([next[0] - before[0], next[1] - before[1]]);
            before = next;
        }
    }

    /// The share of one pixel from those of its column and its row.
    pub(crate) fn share(&self, column: [f64; 2], row: [f64; 2]) -> f64 {
        (1.0 - self.halo) * column[0] * row[0] + self.halo * column[1] * row[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: Profile = Profile { core: 0.6, halo: 0.1 };

    #[test]
    fn shares_of_a_star_sum_up_to_its_light() {
        for place in [20.0, 20.25, 20.5, 20.99] {
            let (mut across, mut down) = (Vec::new(), Vec::new());
            PROFILE.fill(place, &(0..41), &mut across);
            PROFILE.fill(20.3, &(0..41), &mut down);
            let all: f64 = across
                .iter()
                .flat_map(|&column| down.iter().map(move |&row| PROFILE.share(column, row)))
                .sum();
            assert!((all - 1.0).abs() < 1e-9, "{place}: {all}");
        }
    }

    #[test]
    fn the_middle_pixel_has_what_the_bell_has() {
        // erf(0.5 / (0.6 √2)) = 0.595343 for the core, erf(0.5 / (3 √2)) = 0.132368 for the halo.
        let mut shares = Vec::new();
        PROFILE.fill(0.5, &(0..1), &mut shares);
        let expected = 0.9 * 0.595_343 * 0.595_343 + 0.1 * 0.132_368 * 0.132_368;
        let found = PROFILE.share(shares[0], shares[0]);
        assert!((found - expected).abs() < 1e-5, "{found}, {expected}");
    }

    #[test]
    fn bright_stars_reach_farther() {
        let reaches = [1e-9, 1e-4, 1e-2, 1.0, 1e3].map(|light| PROFILE.reach(light));
        assert!(reaches.windows(2).all(|pair| pair[0] <= pair[1]), "{reaches:?}");
        assert!(reaches[0] <= 1.0 && reaches[4] <= 1.0 + 6.0 * 3.0, "{reaches:?}");
    }
}
