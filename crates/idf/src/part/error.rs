//! `PartError`: why parts do not make a picture.

use std::error::Error;
use std::fmt;

use crate::image::{ImageError, words};
use crate::memory::MemoryError;
use crate::plane::Kind;
use crate::samples::Depth;

/// Why an image is no part, or parts do not make a picture.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PartError {
    /// The line that says what an image is a part of.
    Line {
        /// As it is.
        found: String,
    },
    /// The image is not what was written.
    Sum,
    /// An image that says nothing of a part.
    NoPart,
    /// Not of the same picture as the parts before: another scene, options or size.
    Picture,
    /// Other channels than the parts before, apart from coverage.
    Channels {
        /// Those of the first part.
        first: Vec<Kind>,
        /// Those of this one.
        other: Vec<Kind>,
    },
    /// A channel has another depth than before.
    Depth {
        /// The channel.
        kind: Kind,
        /// Before, and now.
        depths: [Depth; 2],
    },
    /// Light is stored otherwise than in the parts before.
    Light,
    /// Pixels that an earlier part has, too.
    Twice {
        /// The earlier part.
        other: String,
        /// The first such pixel.
        pixel: [u32; 2],
    },
    /// Pixels that no part has.
    Missing {
        /// Numbers of the parts that are not there, where there are numbers.
        parts: Vec<u32>,
        /// How many pixels are missing.
        pixels: u64,
        /// The first of them.
        pixel: [u32; 2],
    },
    /// There is no memory for the picture.
    Memory(MemoryError),
    /// The picture is no image.
    Image(ImageError),
}

/// Most numbers of parts that a message lists.
const LISTED: usize = 12;

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { found } => write!(
                f,
                "expected `part N of M tiles SIDE` or `part window`, then `canvas COLUMNS ROWS \
                 picture NUMBER sum NUMBER`, found `{found}`"
            ),
            Self::Sum => f.write_str(
                "the checksum of this part is wrong: it was damaged, render it again; or it was changed, and \
                 is no part any more: take the line `part` out of its description",
            ),
            Self::NoPart => f.write_str("not a part of a picture, as the others are"),
            Self::Picture => f.write_str(
                "a part of another picture than the first: another scene, size or option",
            ),
            Self::Channels { first, other } => {
                write!(f, "channels {}, the first part has {}", words(other), words(first))
            }
            Self::Depth { kind, depths: [first, other] } => {
                let (first, other) = (first.word(), other.word());
                write!(f, "`{kind}` has a depth of {other}, the first part one of {first}")
            }
            Self::Light => f.write_str("light is not stored as in the first part"),
            Self::Twice { other, pixel: [column, row] } => {
                write!(f, "column {column}, row {row} is in {other}, too")
            }
            Self::Missing { parts, pixels, pixel: [column, row] } => {
                let listed: Vec<String> =
                    parts.iter().take(LISTED).map(ToString::to_string).collect();
                match parts.len() {
                    0 => {}
                    1 => write!(f, "part {} is missing: ", listed[0])?,
                    n if n > LISTED => {
                        let more = n - LISTED;
                        write!(f, "parts {} and {more} more are missing: ", listed.join(", "))?;
                    }
                    _ => write!(f, "parts {} are missing: ", listed.join(", "))?,
                }
                let (are, pixels) = if *pixels == 1 {
                    ("is", "1 pixel".into())
                } else {
                    ("are", format!("{pixels} pixels"))
                };
                write!(f, "{pixels} {are} not covered, the first at column {column}, row {row}")
            }
            Self::Memory(error) => error.fmt(f),
            Self::Image(error) => error.fmt(f),
        }
    }
}

impl Error for PartError {}

impl From<ImageError> for PartError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}
