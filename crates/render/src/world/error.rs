//! Why a scene cannot be loaded.

use crate::shade::texture_file::ImageFailure;

/// Why a scene cannot be rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// It has no camera.
    NoCamera,
    /// Camera and target are the same point.
    CameraAtTarget,
    /// It stands for more primitives than can be told apart by their place in the source.
    TooManyLeaves,
    /// Operators are nested more deeply than a thread's stack allows.
    TooDeep {
        /// Levels found.
        found: u32,
        /// Levels allowed.
        limit: u32,
    },
    /// Numbers too large to compose: some coordinate is infinite.
    OutOfRange {
        /// Which object, counted from 1.
        object: usize,
    },
    /// A picture that paint shows cannot be read.
    Image(ImageFailure),
}

impl std::fmt::Display for LoadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Image(failure) => write!(f, "{failure}"),
            Self::NoCamera => {
                write!(f, "the scene has no camera; add a statement such as `camera at (0, 2, 10)`")
            }
            Self::CameraAtTarget => {
                write!(f, "camera and target are the same point; move one of them")
            }
            Self::TooManyLeaves => {
                write!(
                    f,
                    "the scene stands for more primitives (about 2⁶²) than can be told apart; nest fewer classes"
                )
            }
            Self::TooDeep { found, limit } => {
                write!(f, "operators are nested {found} deep, at most {limit} are possible")
            }
            Self::OutOfRange { object } => write!(
                f,
                "object {object} has coordinates too large for double precision; scale the scene down"
            ),
        }
    }
}

impl std::error::Error for LoadError {}
