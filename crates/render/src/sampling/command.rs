//! The part of the command line that says how pixels are sampled.

use std::time::Duration;

use clap::{Args, ValueEnum};
use idf::command::UsageError;

use super::filter::Filter;
use crate::options::{Options, Rate, Sampling};

/// How pixels are sampled.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct SamplingArguments {
    /// Samples a pixel: without `--aa` or with `none` a square, 1, 4, 9, 16 …; with `adaptive` the squares that a pixel
    /// is divided into at most, a power of 4; any number with `stochastic` [default: 1 with `none`, else 16]
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Which points of a pixel are looked at [default: by the scene, stochastic where it has lights with a radius or a lens,
    /// and with --glossy, adaptive in others; none with --samples or --certify]
    #[arg(long, value_enum)]
    aa: Option<Antialiasing>,
    /// Sample until the picture is off by at most E: the estimated root of the mean square error, in display steps of
    /// 1/255 before rounding
    #[arg(long, value_name = "E", allow_hyphen_values = true, conflicts_with_all = ["samples", "seconds"])]
    error: Option<f64>,
    /// The best picture in T seconds, reading and writing included
    #[arg(long, value_name = "T", allow_hyphen_values = true, conflicts_with = "samples")]
    seconds: Option<f64>,
    /// Prove what can be proved to show one surface, or none, and divide the rest: no silhouette is missed. Samples are then
    /// of light, not of shape: one a surface of a pixel does
    #[arg(long)]
    pub(crate) certify: bool,
    /// Sample 4000 pixels, or all of fewer, twice more to find out how far off the picture is, whatever made it
    #[arg(long)]
    pub(crate) audit: bool,
    /// What a sample counts for in the pixels around it
    #[arg(long, value_enum, default_value_t = FilterWord::Box)]
    filter: FilterWord,
    /// Rough surfaces mirror what is around them, by facets drawn for each ray, in place of ambient light
    #[arg(long)]
    pub(crate) glossy: bool,
    /// Another number draws other samples
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    seed: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Antialiasing {
    /// A grid, with one sample at the centre
    None,
    /// The corners; where they differ by colour or by object the pixel is divided
    Adaptive,
    /// Drawn by lot, evenly spread
    Stochastic,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FilterWord {
    /// In its own pixel alone
    Box,
    /// Less and less up to the centres of the neighbours
    Tent,
    /// A cubic over four pixels, the sharpest
    Mitchell,
}

/// Ten years: longer than anyone waits, and a number of seconds that clocks take.
const MOST_SECONDS: f64 = 3e8;

/// Samples where their number is not given.
const SAMPLES: u32 = 16;

impl SamplingArguments {
    pub(crate) fn filter(&self) -> Filter {
        match self.filter {
            FilterWord::Box => Filter::Box,
            FilterWord::Tent => Filter::Tent,
            FilterWord::Mitchell => Filter::Mitchell,
        }
    }

    /// Something is said of how many samples there are, or where.
    pub(crate) fn is_asked(&self) -> bool {
        self.samples.is_some()
            || self.aa.is_some()
            || self.error.is_some()
            || self.seconds.is_some()
    }

    pub(crate) fn seed(&self) -> u32 {
        self.seed
    }

    /// The way of sampling that is asked for; none where the scene chooses.
    pub(crate) fn sampling(&self) -> Result<Option<Sampling>, UsageError> {
        if self.certify {
            self.check_certify()?;
        }
        let progressive = [("--error", self.error), ("--seconds", self.seconds)];
        for (option, number) in progressive {
            let Some(number) = number else { continue };
            if !(number > 0.0 && number <= MOST_SECONDS) {
                return Err(UsageError(format!(
                    "{option} {number}: expected a number above 0 and up to {MOST_SECONDS}"
                )));
            }
            if self.aa.is_some_and(|aa| aa != Antialiasing::Stochastic) {
                return Err(UsageError(format!(
                    "{option}: samples are drawn by lot; leave `--aa` out, or give `--aa stochastic`"
                )));
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
        let Some(aa) = self.aa.or(everywhere.then_some(Antialiasing::None)) else {
            return Ok(None);
        };
        self.at_once(aa).map(Some)
    }

    /// Sampling that does not go on until something is reached.
    fn at_once(&self, aa: Antialiasing) -> Result<Sampling, UsageError> {
        match aa {
            Antialiasing::None => {
                let root = |samples: u32| samples.isqrt();
                let side = nearest(self.samples.unwrap_or(1), 1..=256, |side| side * side, root);
                side.map(Sampling::Grid).map_err(|nearest| {
                    self.wrong(&format!(
                        "samples lie on a square grid, at most 256 × 256; the nearest is {}, and `--aa stochastic` takes any number",
                        nearest * nearest
                    ))
                })
            }
            Antialiasing::Adaptive => {
                let levels = 0..=Sampling::MOST_LEVELS;
                let log = |samples: u32| samples.checked_ilog(4).unwrap_or(0);
                nearest(self.samples.unwrap_or(SAMPLES), levels, |levels| 1 << (2 * levels), log)
                    .map(|levels| Sampling::Subdivided { levels })
                    .map_err(|nearest| {
                        self.wrong(&format!(
                            "a pixel is divided into a power of 4, at most 256; the nearest is {}",
                            1 << (2 * nearest)
                        ))
                    })
            }
            Antialiasing::Stochastic => {
                let samples = self.samples.unwrap_or(SAMPLES);
                if !(1..=Rate::MOST_SAMPLES).contains(&samples) {
                    let most = Rate::MOST_SAMPLES;
                    return Err(self.wrong(&format!("expected a number from 1 to {most}")));
                }
                Ok(Sampling::Stochastic(Rate::Samples(samples)))
            }
        }
    }

    /// What is proved is proved of the square of a pixel, and says where samples go.
    fn check_certify(&self) -> Result<(), UsageError> {
        let hindrances = [
            (
                !matches!(self.filter, FilterWord::Box),
                "--filter",
                "proofs are of the square of a pixel, and other filters reach beyond it; leave it out",
            ),
            (
                self.aa == Some(Antialiasing::Adaptive),
                "--aa adaptive",
                "pixels are divided by what is proved; take `none` or `stochastic`",
            ),
            (
                self.error.is_some(),
                "--error",
                "parts of a pixel have samples by their area; take `--samples`",
            ),
            (
                self.seconds.is_some(),
                "--seconds",
                "proofs take the time they take; take `--samples`",
            ),
        ];
        match hindrances.iter().find(|(hinders, ..)| *hinders) {
            Some((_, option, why)) => Err(UsageError(format!("--certify with {option}: {why}"))),
            None => Ok(()),
        }
    }

    fn wrong(&self, message: &str) -> UsageError {
        UsageError(format!("--samples {}: {message}", self.samples.unwrap_or_default()))
    }
}

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
