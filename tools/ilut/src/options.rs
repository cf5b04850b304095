//! What table to make, and why none is made.

use std::error::Error;
use std::fmt;

use idf::Lut;

use crate::Metric;

/// How a table is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Median cut of 15-bit colours (Heckbert 1982).
    Heckbert,
    /// Variance cut and one round of k-means; the map takes all colours of a cell of 64 together.
    Fast,
    /// Variance cut and ten rounds of k-means.
    #[default]
    Best,
}

/// What table to make.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Most colours, 1 to 256.
    pub colors: usize,
    /// How.
    pub method: Method,
    /// What is near.
    pub metric: Metric,
    /// Colours that the table begins with, whatever the pictures have: at most as many as
    /// `colors`.
    pub keep: Vec<[u8; 4]>,
    /// Take as few colours as reach this error over all pictures: the root mean square difference
    /// of a channel in display steps for RGB, the root mean square distance for Oklab.
    pub max_error: Option<f64>,
    /// Make the table for a dither: of up to 32 colours, the opaque ones reach out so that mixes of
    /// them show the picture's. Median cut stays as it was in 1982.
    pub spread: bool,
}

/// Why no table is made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// No picture.
    NoPicture,
    /// Not 1 to 256 colours.
    Colors(usize),
    /// More colours to keep than the table has.
    Keep {
        /// Colours to keep.
        found: usize,
        /// Colours of the table.
        most: usize,
    },
    /// The error is larger with all colours that the table may have.
    MaxError {
        /// The error reached.
        found: f64,
        /// The error allowed.
        most: f64,
        /// Colours of the table.
        colors: usize,
    },
}

impl Method {
    /// All, fast ones first.
    pub const ALL: [Self; 3] = [Self::Heckbert, Self::Fast, Self::Best];

    /// The word on a command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Heckbert => "heckbert",
            Self::Fast => "fast",
            Self::Best => "best",
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            colors: Lut::MOST,
            method: Method::default(),
            metric: Metric::default(),
            keep: Vec::new(),
            max_error: None,
            spread: false,
        }
    }
}

impl Options {
    /// Whether errors count by how much they are seen, where there is time to find that out.
    pub(crate) fn is_visual(&self) -> bool {
        self.method == Method::Best && self.metric == Metric::Oklab
    }

    /// Whether a table can be made so.
    pub(crate) fn check(&self) -> Result<(), TableError> {
        let most = self.colors;
        if !(1..=Lut::MOST).contains(&most) {
            return Err(TableError::Colors(most));
        }
        let found = self.keep.len();
        if found > most { Err(TableError::Keep { found, most }) } else { Ok(()) }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPicture => f.write_str("no picture"),
            Self::Colors(found) => write!(f, "{found} colours, expected 1 to {}", Lut::MOST),
            Self::Keep { found, most } => {
                write!(f, "{found} colours to keep, expected at most the {most} of the table")
            }
            Self::MaxError { found, most, colors } => write!(
                f,
                "{colors} colours leave an error of {found:.3}, expected at most {most}; allow \
                 more colours or a larger error"
            ),
        }
    }
}

impl Error for TableError {}
