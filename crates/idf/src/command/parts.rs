//! Images that are parts of one picture, put together where a program is given several images.

use std::error::Error;
use std::path::PathBuf;

use super::{Progress, is_stream};
use crate::error::ReadError;
use crate::exchange::Format;
use crate::image::Image;
use crate::part::{Assembly, Part, Share};
use crate::read::{Ask, ReadOptions, read};

/// What several images are, as their descriptions say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// Parts of one picture.
    OfOne,
    /// Parts of several pictures.
    OfSeveral {
        /// Some are tiles, which are nothing by themselves.
        tiles: bool,
    },
    /// Some are no parts: those that are, are windows.
    Windows,
    /// Some are no parts, and some are parts of tiles, which are nothing by themselves.
    Mixed,
}

/// Looks at the descriptions of images; one image alone is what it is.
///
/// # Errors
///
/// If one cannot be read.
pub fn parts(names: &[PathBuf]) -> Result<Parts, ReadError> {
    let mut found = Vec::new();
    for name in names.iter().filter(|_| names.len() > 1) {
        let is_own = Format::of(name) == Some(Format::Idf) && !is_stream(name);
        if let Some(part) = if is_own { Part::at(name)? } else { None } {
            found.push(part);
        }
    }
    let tiles = found.iter().any(|part| matches!(part.share, Share::Tiles(_)));
    if found.is_empty() || found.len() < names.len() {
        return Ok(if tiles { Parts::Mixed } else { Parts::Windows });
    }
    let is_one = found.iter().all(|part| part.picture == found[0].picture);
    Ok(if is_one { Parts::OfOne } else { Parts::OfSeveral { tiles } })
}

/// The picture that parts make. One part after the other is in memory.
///
/// # Errors
///
/// If one cannot be read, is of another picture, or has pixels that another has; or if they do not cover the
/// picture. The message says which.
pub fn assembled(
    names: &[PathBuf],
    options: &ReadOptions,
    progress: &Progress,
) -> Result<Image, Box<dyn Error + Send + Sync>> {
    // The checksum is that of all channels.
    let options = ReadOptions { ask: Ask::All, ..options.clone() };
    let mut assembly: Option<Assembly> = None;
    for name in names {
        progress.stage(format!("reads {}", name.display()));
        let image = read(name, &options)?;
        let put = match &mut assembly {
            Some(assembly) => assembly.add(&image),
            None => Assembly::new(&image).map(|new| assembly = Some(new)),
        };
        put.map_err(|error| ReadError::Part { path: name.clone(), error })?;
        progress.advance(1);
    }
    Ok(assembly.ok_or("no part of a picture")?.finish()?)
}
