//! Which points of a pixel are looked at, from what is said about them, as `portray` understands it.

use pyo3::prelude::*;
use render::{Antialiasing, Rate, Sampling, Wish, WishError};

use crate::argument::{Whole, value, word};

const WORDS: [(&str, Antialiasing); 3] = [
    ("none", Antialiasing::None),
    ("adaptive", Antialiasing::Adaptive),
    ("stochastic", Antialiasing::Stochastic),
];

/// The word for where samples lie.
pub(crate) fn antialiasing(aa: Option<&str>) -> PyResult<Option<Antialiasing>> {
    aa.map(|aa| word("aa", aa, WORDS)).transpose()
}

/// How many samples, if it is said.
pub(crate) fn count(samples: Option<Whole>) -> PyResult<Option<u32>> {
    let most = i64::from(Rate::MOST_SAMPLES);
    samples.map(|samples| samples.within("samples", 1..=most)).transpose()
}

/// The way of sampling that is meant, none where the scene chooses; or what is wrong with the arguments as they are written
/// here.
pub(crate) fn sampling(wish: &Wish) -> PyResult<Option<Sampling>> {
    wish.sampling().map_err(|error| {
        value(match error {
            WishError::Several => error.to_string(),
            WishError::Number { name, found } => format!("{name}: {error}, found {found}"),
            WishError::ByLot { name } => {
                format!("{name}: {error}; leave aa out, or say aa=\"stochastic\"")
            }
            WishError::Square { found, .. } => {
                format!("samples: found {found}: {error}, and aa=\"stochastic\" takes any number")
            }
            WishError::PowerOfFour { found, .. } | WishError::Count { found } => {
                format!("samples: found {found}: {error}")
            }
            WishError::Certify { name, .. } => format!("certify with {name}: {error}"),
        })
    })
}
