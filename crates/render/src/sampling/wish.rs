//! Which way of sampling is meant by what is said about it: by the program's options, or from Python.

use std::fmt;
use std::time::Duration;

use super::filter::Filter;
use crate::options::{Rate, Sampling};

/// Which points of a pixel are looked at, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Antialiasing {
    /// A grid.
    None,
    /// Corners; pixels whose corners differ are divided.
    Adaptive,
    /// Drawn by lot.
    Stochastic,
}

/// What is said about samples; all of it may be left open.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wish {
    /// Of a pixel: a square on a grid, a power of 4 where pixels are divided, any number by lot.
    pub samples: Option<u32>,
    /// Where they lie.
    pub aa: Option<Antialiasing>,
    /// The error to be reached, in display steps.
    pub error: Option<f64>,
    /// The seconds that there are.
    pub seconds: Option<f64>,
    /// What can be proved of pixels is to be proved.
    pub certify: bool,
    /// What a sample counts for in the pixels around it.
    pub filter: Filter,
}

/// Why nothing can be meant. Whoever asks knows how its arguments are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WishError {
    /// More than one of `samples`, `error` and `seconds`.
    Several,
    /// An error or seconds that are not above 0, or above [`Wish::MOST_SECONDS`].
    Number {
        /// The argument.
        name: &'static str,
        /// Its value.
        found: f64,
    },
    /// An error or seconds with samples that are not drawn by lot.
    ByLot {
        /// The argument.
        name: &'static str,
    },
    /// Samples on a grid that are no square, or too many.
    Square {
        /// Their number.
        found: u32,
        /// The nearest that is one.
        nearest: u32,
    },
    /// Samples of divided pixels that are no power of 4, or too many.
    PowerOfFour {
        /// Their number.
        found: u32,
        /// The nearest that is one.
        nearest: u32,
    },
    /// No samples by lot, or more than [`Rate::MOST_SAMPLES`].
    Count {
        /// Their number.
        found: u32,
    },
    /// Something that proofs do not go with.
    Certify {
        /// The argument.
        name: &'static str,
        /// Why not, and what to do.
        why: &'static str,
    },
}

/// Samples where their number is not given.
const SAMPLES: u32 = 16;
/// Most squares along a side of a pixel.
const MOST_SIDE: u32 = 256;

impl Wish {
    /// Ten years: longer than anyone waits, and a number of seconds that clocks take.
    pub const MOST_SECONDS: f64 = 3e8;

    /// The way of sampling that is meant; none where nothing is said, so that it is the scene's to choose, by
    /// [`Sampling::fitting`]. A number of samples alone lies on a grid.
    ///
    /// # Errors
    ///
    /// What excludes something else, or is out of its range.
    pub fn sampling(&self) -> Result<Option<Sampling>, WishError> {
        if self.certify {
            self.check_certify()?;
        }
        let given = [self.samples.is_some(), self.error.is_some(), self.seconds.is_some()];
        if given.into_iter().filter(|given| *given).count() > 1 {
            return Err(WishError::Several);
        }
        for (name, number) in [("error", self.error), ("seconds", self.seconds)] {
            let Some(found) = number else { continue };
            if !(found > 0.0 && found <= Self::MOST_SECONDS) {
                return Err(WishError::Number { name, found });
            }
            if self.aa.is_some_and(|aa| aa != Antialiasing::Stochastic) {
                return Err(WishError::ByLot { name });
            }
        }
        if let Some(error) = self.error {
            return Ok(Some(Sampling::Stochastic(Rate::Error(error))));
        }
        if let Some(seconds) = self.seconds {
            let time = Duration::from_secs_f64(seconds);
            return Ok(Some(Sampling::Stochastic(Rate::Time(time))));
        }
        // Who says how many samples there are wants them everywhere.
        let everywhere = self.samples.is_some() || self.certify;
        let usual = everywhere.then_some(Antialiasing::None);
        self.aa.or(usual).map(|aa| self.at_once(aa)).transpose()
    }

    /// Sampling that does not go on until something is reached.
    fn at_once(&self, aa: Antialiasing) -> Result<Sampling, WishError> {
        match aa {
            Antialiasing::None => {
                let found = self.samples.unwrap_or(1);
                let side = nearest(found, 1..=MOST_SIDE, |side| side * side, u32::isqrt);
                side.map(Sampling::Grid)
                    .map_err(|side| WishError::Square { found, nearest: side * side })
            }
            Antialiasing::Adaptive => {
                let found = self.samples.unwrap_or(SAMPLES);
                let log = |samples: u32| samples.checked_ilog(4).unwrap_or(0);
                let power = |levels: u32| 1 << (2 * levels);
                nearest(found, 0..=Sampling::MOST_LEVELS, power, log)
                    .map(|levels| Sampling::Subdivided { levels })
                    .map_err(|levels| WishError::PowerOfFour { found, nearest: power(levels) })
            }
            Antialiasing::Stochastic => {
                let found = self.samples.unwrap_or(SAMPLES);
                if !(1..=Rate::MOST_SAMPLES).contains(&found) {
                    return Err(WishError::Count { found });
                }
                Ok(Sampling::Stochastic(Rate::Samples(found)))
            }
        }
    }

    /// What is proved is proved of the square of a pixel, and says where samples go.
    fn check_certify(&self) -> Result<(), WishError> {
        let hindrances = [
            (
                self.filter != Filter::Box,
                "filter",
                "proofs are of the square of a pixel, and other filters reach beyond it; leave it out",
            ),
            (
                self.aa == Some(Antialiasing::Adaptive),
                "aa",
                "pixels are divided by what is proved, not by what corners show; take none or stochastic",
            ),
            (
                self.error.is_some(),
                "error",
                "parts of a pixel have samples by their area; give a number of samples",
            ),
            (
                self.seconds.is_some(),
                "seconds",
                "proofs take the time they take; give a number of samples",
            ),
        ];
        match hindrances.into_iter().find(|(hinders, ..)| *hinders) {
            Some((_, name, why)) => Err(WishError::Certify { name, why }),
            None => Ok(()),
        }
    }
}

impl fmt::Display for WishError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Several => {
                write!(out, "expected one of samples, error and seconds, found more")
            }
            Self::Number { .. } => {
                write!(out, "expected a number above 0 and up to {}", Wish::MOST_SECONDS)
            }
            Self::ByLot { .. } => write!(out, "samples are drawn by lot"),
            Self::Square { nearest, .. } => write!(
                out,
                "samples lie on a square grid, at most {MOST_SIDE} × {MOST_SIDE}; the nearest is {nearest}"
            ),
            Self::PowerOfFour { nearest, .. } => write!(
                out,
                "a pixel is divided into a power of 4, at most {}; the nearest is {nearest}",
                1 << (2 * Sampling::MOST_LEVELS)
            ),
            Self::Count { .. } => write!(out, "expected a number from 1 to {}", Rate::MOST_SAMPLES),
            Self::Certify { why, .. } => out.write_str(why),
        }
    }
}

impl std::error::Error for WishError {}

/// The number of `range` whose value is `wanted`, or the one whose value is nearest; `below` gives the one at or below it.
fn nearest(
    wanted: u32,
    range: std::ops::RangeInclusive<u32>,
    value: impl Fn(u32) -> u32,
    below: impl Fn(u32) -> u32,
) -> Result<u32, u32> {
    let below = below(wanted).clamp(*range.start(), *range.end());
    let above = (below + 1).min(*range.end());
    let off = |number: u32| wanted.abs_diff(value(number));
    let nearest = if off(below) <= off(above) { below } else { above };
    if off(nearest) == 0 { Ok(nearest) } else { Err(nearest) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_meant() {
        let wish = Wish::default();
        let lot = Some(Antialiasing::Stochastic);
        let divided = Some(Antialiasing::Adaptive);
        let seconds = Rate::Time(Duration::from_millis(1500));
        for (wish, expected) in [
            (Wish { aa: divided, ..wish }, Sampling::Subdivided { levels: 2 }),
            (Wish { samples: Some(9), ..wish }, Sampling::Grid(3)),
            (Wish { aa: Some(Antialiasing::None), ..wish }, Sampling::Grid(1)),
            (Wish { certify: true, ..wish }, Sampling::Grid(1)),
            (Wish { samples: Some(1), aa: divided, ..wish }, Sampling::Subdivided { levels: 0 }),
            (Wish { aa: lot, ..wish }, Sampling::Stochastic(Rate::Samples(16))),
            (Wish { error: Some(0.5), aa: lot, ..wish }, Sampling::Stochastic(Rate::Error(0.5))),
            (Wish { seconds: Some(1.5), ..wish }, Sampling::Stochastic(seconds)),
        ] {
            assert_eq!(wish.sampling(), Ok(Some(expected)), "{wish:?}");
        }
        assert_eq!(wish.sampling(), Ok(None), "the scene chooses");
    }

    #[test]
    fn what_cannot_be() {
        let wish = Wish::default();
        let certify = Wish { certify: true, ..wish };
        let (lot, divided) = (Some(Antialiasing::Stochastic), Some(Antialiasing::Adaptive));
        for (wish, expected) in [
            (Wish { samples: Some(4), error: Some(1.0), ..wish }, WishError::Several),
            (Wish { error: Some(0.0), ..wish }, WishError::Number { name: "error", found: 0.0 }),
            (
                Wish { seconds: Some(f64::INFINITY), ..wish },
                WishError::Number { name: "seconds", found: f64::INFINITY },
            ),
            (
                Wish { seconds: Some(1.0), aa: divided, ..wish },
                WishError::ByLot { name: "seconds" },
            ),
            (Wish { samples: Some(15), ..wish }, WishError::Square { found: 15, nearest: 16 }),
            (
                Wish { samples: Some(8), aa: divided, ..wish },
                WishError::PowerOfFour { found: 8, nearest: 4 },
            ),
            (Wish { samples: Some(0), aa: lot, ..wish }, WishError::Count { found: 0 }),
        ] {
            assert_eq!(wish.sampling(), Err(expected), "{wish:?}");
        }
        for (wish, expected) in [
            (Wish { filter: Filter::Tent, ..certify }, "filter"),
            (Wish { aa: divided, ..certify }, "aa"),
            (Wish { error: Some(1.0), ..certify }, "error"),
            (Wish { seconds: Some(1.0), ..certify }, "seconds"),
        ] {
            let found = wish.sampling();
            let is_it = matches!(found, Err(WishError::Certify { name, .. }) if name == expected);
            assert!(is_it, "{wish:?}: {found:?}");
        }
    }
}
