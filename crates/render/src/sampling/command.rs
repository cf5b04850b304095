//! The part of the command line that says how pixels are sampled.

use clap::{Args, ValueEnum};
use idf::command::UsageError;

use super::filter::Filter;
use super::wish::{Antialiasing, Wish, WishError};
use crate::options::{Options, Sampling};

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
    aa: Option<AntialiasingWord>,
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
enum AntialiasingWord {
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
        let aa = self.aa.map(|aa| match aa {
            AntialiasingWord::None => Antialiasing::None,
            AntialiasingWord::Adaptive => Antialiasing::Adaptive,
            AntialiasingWord::Stochastic => Antialiasing::Stochastic,
        });
        let Self { samples, error, seconds, certify, .. } = *self;
        let wish = Wish { samples, aa, error, seconds, certify, filter: self.filter() };
        wish.sampling().map_err(|error| UsageError(told(error)))
    }
}

/// What is wrong, with the options as they are written.
fn told(error: WishError) -> String {
    match error {
        WishError::Several => error.to_string(),
        WishError::Number { name, found } => format!("--{name} {found}: {error}"),
        WishError::ByLot { name } => {
            format!("--{name}: {error}; leave `--aa` out, or give `--aa stochastic`")
        }
        WishError::Square { found, .. } => {
            format!("--samples {found}: {error}, and `--aa stochastic` takes any number")
        }
        WishError::PowerOfFour { found, .. } | WishError::Count { found } => {
            format!("--samples {found}: {error}")
        }
        WishError::Certify { name, .. } => {
            let option = if name == "aa" { "aa adaptive" } else { name };
            format!("--certify with --{option}: {error}")
        }
    }
}
