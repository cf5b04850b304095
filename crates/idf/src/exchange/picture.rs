//! Files of which there is something to be seen.

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};

use super::read_image;
use crate::error::ReadError;
use crate::image::{Image, ImageError};
use crate::plane::Kind;
use crate::read::{Ask, ReadOptions};

/// Why a file shows nothing.
#[derive(Debug)]
#[non_exhaustive]
pub enum PictureError {
    /// It cannot be read.
    Read(ReadError),
    /// What it holds makes no picture.
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ImageError,
    },
    /// It holds neither light nor coverage.
    NoPicture(PathBuf),
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(error) => {
                write!(f, "{error}")?;
                let mut cause = error.source();
                while let Some(inner) = cause {
                    write!(f, ": {inner}")?;
                    cause = inner.source();
                }
                Ok(())
            }
            Self::Image { path, source } => write!(f, "{}: {source}", path.display()),
            Self::NoPicture(path) => {
                write!(f, "{}: expected a picture, found no channel of one", path.display())
            }
        }
    }
}

impl Error for PictureError {}

/// Reads an image in any format, with all that can be seen of it: colours are looked up in its table, and light or
/// coverage is there. Channels that are no picture are left out where they have another size.
///
/// # Errors
///
/// [`PictureError`], whose message names the file and all that is known of the reason.
pub fn read_picture(path: &Path) -> Result<Image, PictureError> {
    let all = ReadOptions { ask: Ask::All, ..ReadOptions::default() };
    let picture = ReadOptions { ask: Ask::Picture, ..all.clone() };
    let image = read_image(path, &all)
        .or_else(|_| read_image(path, &picture))
        .map_err(PictureError::Read)?;
    let wrong = |source| PictureError::Image { path: path.into(), source };
    let image = image.resolved().map_err(wrong)?;
    if image.light_kinds().map_err(wrong)?.is_empty() && image.plane(Kind::Cvg).is_none() {
        return Err(PictureError::NoPicture(path.into()));
    }
    Ok(image)
}
