//! Which points of a pixel are looked at, from what is said about them, as `portray` understands it.

use std::time::Duration;

use pyo3::prelude::*;
use render::{Rate, Sampling};

use crate::argument::{Whole, value, word};

/// Samples where nothing is said.
const SAMPLES: u32 = 16;
/// Ten years, a number of seconds that clocks take.
const MOST_SECONDS: f64 = 3e8;
/// Most squares along a side of a pixel.
const MOST_SIDE: u32 = 256;

/// What is said about samples.
pub(crate) struct Wish<'a> {
    pub(crate) samples: Option<Whole>,
    pub(crate) aa: Option<&'a str>,
    pub(crate) error: Option<f64>,
    pub(crate) seconds: Option<f64>,
}

#[derive(Clone, Copy, PartialEq)]
enum Antialiasing {
    None,
    Adaptive,
    Stochastic,
}

const WORDS: [(&str, Antialiasing); 3] = [
    ("none", Antialiasing::None),
    ("adaptive", Antialiasing::Adaptive),
    ("stochastic", Antialiasing::Stochastic),
];

impl Wish<'_> {
    /// The way of sampling that is meant.
    pub(crate) fn sampling(&self) -> PyResult<Sampling> {
        let aa = self.aa.map(|aa| word("aa", aa, WORDS)).transpose()?;
        let most = i64::from(Rate::MOST_SAMPLES);
        let samples: Option<u32> =
            self.samples.map(|samples| samples.within("samples", 1..=most)).transpose()?;
        let given =
            [samples.is_some(), self.error.is_some(), self.seconds.is_some()].map(usize::from);
        if given.iter().sum::<usize>() > 1 {
            return Err(value("samples, error, seconds: expected one of them, found more"));
        }
        for (name, number) in [("error", self.error), ("seconds", self.seconds)] {
            let Some(number) = number else { continue };
            if !(number > 0.0 && number <= MOST_SECONDS) {
                return Err(value(format!(
                    "{name}: expected a number above 0 and up to {MOST_SECONDS}, found {number}"
                )));
            }
            if aa.is_some_and(|aa| aa != Antialiasing::Stochastic) {
                return Err(value(format!(
                    "{name}: samples are drawn by lot; leave aa out, or say aa=\"stochastic\""
                )));
            }
        }
        if let Some(error) = self.error {
            return Ok(Sampling::Stochastic(Rate::Error(error)));
        }
        if let Some(seconds) = self.seconds {
            return Ok(Sampling::Stochastic(Rate::Time(Duration::from_secs_f64(seconds))));
        }
        let usual = if samples.is_some() { Antialiasing::None } else { Antialiasing::Adaptive };
        match aa.unwrap_or(usual) {
            Antialiasing::None => grid(samples.unwrap_or(1)),
            Antialiasing::Adaptive => divided(samples.unwrap_or(SAMPLES)),
            Antialiasing::Stochastic => {
                Ok(Sampling::Stochastic(Rate::Samples(samples.unwrap_or(SAMPLES))))
            }
        }
    }
}

fn grid(samples: u32) -> PyResult<Sampling> {
    let side = samples.isqrt();
    if side * side == samples && side <= MOST_SIDE {
        return Ok(Sampling::Grid(side));
    }
    Err(value(format!(
        "samples: expected a square, 1, 4, 9, 16 … {}, found {samples}; aa=\"stochastic\" takes any number",
        MOST_SIDE * MOST_SIDE
    )))
}

fn divided(samples: u32) -> PyResult<Sampling> {
    let levels = samples.ilog2() / 2;
    if samples == 1 << (2 * levels) && levels <= Sampling::MOST_LEVELS {
        return Ok(Sampling::Subdivided { levels });
    }
    Err(value(format!(
        "samples: expected a power of 4 up to {} with aa=\"adaptive\", found {samples}",
        1 << (2 * Sampling::MOST_LEVELS)
    )))
}
