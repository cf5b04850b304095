//! The stars of a sky: how many there are, where, how bright and how hot.

use std::error::Error;
use std::fmt;

use crate::color::temperature;
use crate::random::Random;
use crate::sky::Options;

/// log₁₀ of how many times as many stars there are a magnitude fainter. Were stars spread evenly through space, it
/// would be 0.6; what is seen down to the twelfth magnitude is a little less.
pub const SLOPE: f64 = 0.51;
/// The magnitude of the brightest star there can be.
pub const BRIGHTEST: f64 = -1.5;
/// Stars of the whole sky that the eye sees, down to magnitude 6.5 (Hoffleit, "The Bright Star Catalogue", 1991).
const SEEN: f64 = 9096.0;
/// The magnitude down to which it sees.
const SEEN_TO: f64 = 6.5;
/// Square degrees of the whole sky.
const SKY: f64 = 41_252.961_249_419_28;
/// The greatest number of stars of a picture.
pub const MOST_STARS: u64 = 50_000_000;

/// A star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Where it is in the picture, in pixels from the top left corner: to the right, and down.
    pub place: [f64; 2],
    /// How bright it is; five magnitudes more are a hundredth of the light.
    pub magnitude: f64,
    /// How hot its surface is.
    pub kelvins: f64,
}

/// All stars of a picture, each by its number.
#[derive(Clone, Copy, Debug)]
pub struct Catalogue<'a> {
    options: &'a Options,
    count: u64,
}

/// There would be more stars than [`MOST_STARS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooManyStars(pub f64);

/// Stars of the whole sky brighter than a magnitude.
pub fn brighter_than(magnitude: f64) -> f64 {
    SEEN * libm::pow(10.0, SLOPE * (magnitude - SEEN_TO))
}

/// The light of a star, where one of magnitude 0 has 1 (Pogson 1856).
pub fn flux(magnitude: f64) -> f64 {
    libm::pow(10.0, -0.4 * magnitude)
}

impl<'a> Catalogue<'a> {
    /// The stars of a picture: as many as a field of its size has.
    ///
    /// # Errors
    ///
    /// [`TooManyStars`], found before any is made.
    pub fn new(options: &'a Options) -> Result<Self, TooManyStars> {
        let [columns, rows] = [options.columns, options.rows].map(f64::from);
        let field = options.field_degrees;
        let square_degrees = field * (field * rows / columns);
        let expected = brighter_than(options.faintest) * square_degrees / SKY;
        let most = MOST_STARS as f64;
        if expected > most || expected.is_nan() {
            return Err(TooManyStars(expected));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
        let count = libm::floor(expected + 0.5) as u64;
        Ok(Self { options, count })
    }

    /// How many stars there are.
    pub fn len(&self) -> u64 {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The star of a number. A star beyond the last is one more of the same kind.
    pub fn star(&self, index: u64) -> Star {
        let options = self.options;
        let mut random = Random::new(options.seed, index);
        // Counts grow as 10^(0.51 m), so the share of stars up to a magnitude is even.
        let fainter = libm::log10(random.share()) / SLOPE;
        let magnitude = options.faintest + fainter;
        let magnitude = if magnitude > BRIGHTEST { magnitude } else { BRIGHTEST };
        let kelvins = temperature(&mut random);
        Star { place: self.place(&mut random), magnitude, kelvins }
    }

    /// Places are tried until one is taken, each by how dense stars are there.
    fn place(&self, random: &mut Random) -> [f64; 2] {
        let options = self.options;
        let size = [options.columns, options.rows].map(f64::from);
        let diagonal = libm::hypot(size[0], size[1]);
        loop {
            let shares = [random.share(), random.share()];
            let place = [0, 1].map(|axis| size[axis] * (1.0 - shares[axis]));
            let from_middle = [0, 1].map(|axis| (place[axis] - 0.5 * size[axis]) / diagonal);
            if random.share() <= options.band.density(options.seed, from_middle) {
                return place;
            }
        }
    }
}

impl fmt::Display for TooManyStars {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.3e} stars, at most {MOST_STARS} can be had: a brighter faintest magnitude or a narrower field has fewer",
            self.0
        )
    }
}

impl Error for TooManyStars {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::band::Band;

    #[test]
    fn the_sky_has_as_many_stars_as_the_eye_sees() {
        assert!((brighter_than(6.5) - 9096.0).abs() < 1e-9);
        let (ten, nine) = (brighter_than(10.0), brighter_than(9.0));
        assert!((ten / nine - libm::pow(10.0, 0.51)).abs() < 1e-9, "{}", ten / nine);
        assert!((brighter_than(10.0) - 554_500.0).abs() < 500.0, "{}", brighter_than(10.0));
    }

    #[test]
    fn five_magnitudes_are_a_hundredth() {
        assert!((flux(0.0) - 1.0).abs() < 1e-15);
        assert!((flux(5.0) / flux(0.0) - 0.01).abs() < 1e-15);
        assert!((flux(-1.0) - 2.511_886_431_5).abs() < 1e-9);
    }

    fn options() -> Options {
        Options {
            columns: 300,
            rows: 200,
            faintest: 9.0,
            field_degrees: 90.0,
            ..Options::default()
        }
    }

    #[test]
    fn each_magnitude_has_its_number() {
        let options = options();
        let catalogue = Catalogue::new(&options).unwrap();
        // 90 x 60 degrees of a sky with 171 372 stars: 5400 / 41 253 of them.
        let all = brighter_than(9.0) * 5400.0 / SKY;
        assert!((catalogue.len() as f64 - all).abs() <= 0.5, "{all}");
        let stars: Vec<Star> = (0..catalogue.len()).map(|index| catalogue.star(index)).collect();
        for limit in [5.0, 6.0, 7.0, 8.0, 9.0] {
            let found = stars.iter().filter(|star| star.magnitude <= limit).count() as f64;
            let expected = brighter_than(limit) * 5400.0 / SKY;
            // Four standard deviations.
            assert!(
                (found - expected).abs() <= 4.0 * expected.sqrt(),
                "{limit}: {found}, {expected}"
            );
        }
        for star in stars {
            let [x, y] = star.place;
            assert!((0.0..300.0).contains(&x) && (0.0..200.0).contains(&y), "{star:?}");
            assert!((BRIGHTEST..=9.0).contains(&star.magnitude), "{star:?}");
        }
    }

    #[test]
    fn the_band_has_more_stars() {
        let band = Band { strength: 20.0, width: 0.08, tilt_degrees: 0.0, dust: 0.0 };
        let options = Options { band, ..options() };
        let catalogue = Catalogue::new(&options).unwrap();
        let rows: Vec<f64> =
            (0..catalogue.len()).map(|index| catalogue.star(index).place[1]).collect();
        let within = |from: f64| rows.iter().filter(|y| (from..from + 40.0).contains(*y)).count();
        assert!(within(80.0) > 4 * within(0.0), "{} and {}", within(80.0), within(0.0));
        assert!(within(80.0) > 4 * within(160.0), "{} and {}", within(80.0), within(160.0));
    }

    #[test]
    fn too_many_stars_are_refused() {
        let options = Options { faintest: 20.0, ..options() };
        let error = Catalogue::new(&options).unwrap_err();
        assert!(error.to_string().contains("at most 50000000"), "{error}");
    }
}
