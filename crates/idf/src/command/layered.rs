//! Layers of `OpenEXR` files: they go along with the picture, or are named where they cannot.

use std::io;
use std::path::Path;

use super::{Job, Talk, is_stream, open, save};
use crate::error::{ReadError, WriteError};
use crate::exchange::{Format, Layers, read_layered, read_stream_layered, write_layered};
use crate::image::Image;
use crate::read::ReadOptions;
use crate::write::WriteOptions;

impl Talk {
    /// Warns of layers that are left out, by their names, if there are any; `why` follows "left out".
    pub fn left_out(self, words: &[String], why: &str) {
        if !words.is_empty() {
            let words = words.join(" ");
            self.warn(format_args!(
                "left out {why}: {words}; icopy --channels NAME copies a layer"
            ));
        }
    }
}

/// Opens an image as [`open`] does, and what an `.exr` holds besides.
///
/// # Errors
///
/// As [`open`].
pub fn open_layered(name: &Path, options: &ReadOptions) -> Result<(Image, Layers), ReadError> {
    open_layer(name, None, options)
}

/// [`open_layered`] of the layer, part or channel `picture`, if that is said.
///
/// # Errors
///
/// As [`open`], or if nothing is called so.
pub fn open_layer(
    name: &Path,
    picture: Option<&str>,
    options: &ReadOptions,
) -> Result<(Image, Layers), ReadError> {
    if is_stream(name) {
        let (name, stream) = (Path::new("standard input"), io::stdin().lock());
        return read_stream_layered(name, stream, picture, options);
    }
    if has_layers(name) {
        return read_layered(name, picture, options);
    }
    Ok((open(name, options)?, Layers::default()))
}

/// Writes an image as [`save`] does, and, where that is an `.exr`, layers of another one with it. What IDF has
/// no place for is named.
///
/// # Errors
///
/// As [`save`].
pub fn save_layered(
    name: &Path,
    image: Image,
    layers: &Layers,
    options: &WriteOptions,
    job: &Job,
    talk: Talk,
) -> Result<(), WriteError> {
    if has_layers(name) {
        return write_layered(name, &image, layers);
    }
    if Format::of(name) == Some(Format::Idf) && !is_stream(name) {
        talk.left_out(&layers.words(), "as IDF has no place for it");
    }
    save(name, image, options, job)
}

fn has_layers(name: &Path) -> bool {
    Format::of(name) == Some(Format::Exr) && !is_stream(name)
}
