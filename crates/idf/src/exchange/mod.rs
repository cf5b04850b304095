//! Other formats: PNG, `OpenEXR`, PNM, PAM and GIF in and out; JPEG, TIFF and `WebP` in.

mod anymap;
mod bound;
mod exr;
mod format;
mod gif;
mod interleaved;
mod layers;
mod part;
mod picture;
mod png;
mod raster;

use std::io::{Read, Write};
use std::path::Path;

use crate::error::{Cause, ReadError, WriteError};
use crate::file;
use crate::image::{Image, ImageError, Matte};
use crate::memory::MemoryError;
use crate::plane::{Kind, Role};
use crate::read::{Ask, ReadOptions, read};
use crate::write::{WriteOptions, write};

pub(crate) use anymap::AnymapReader;
pub use anymap::{AnymapWriter, open_rows};
pub use format::Format;
pub(crate) use format::endings;
pub use gif::write_frames;
pub use layers::{Layers, read_layered, read_stream_layered, write_layered};
pub use picture::{PictureError, read_picture};

/// Most bytes of a file in another format, and of what is read from standard input.
const MOST_BYTES: u64 = 1 << 32;

/// Reads an image in any format, by the ending of its name.
///
/// The light of PNG, PNM, GIF, JPEG, TIFF and `WebP` is sRGB, unless a PNG has a `gAMA` chunk that says
/// otherwise, and its coverage is straight; floating point is linear. A PNG's `oFFs` chunk and the
/// data window of `OpenEXR` are the place on the canvas. Of several pictures the first is read.
/// Indexed PNG and GIF give colours, and indices and table where [`Ask::Only`] names `enc` or
/// `lut`.
///
/// # Errors
///
/// If the file cannot be read, is damaged, is larger than its length allows, or lacks a channel
/// that was asked for.
pub fn read_image(path: &Path, options: &ReadOptions) -> Result<Image, ReadError> {
    let error = || {
        let expected = format!("{}{}", endings(false), hint(path));
        ReadError::Format { path: path.into(), expected }
    };
    let format = Format::of(path).ok_or_else(error)?;
    if format == Format::Idf {
        return read(path, options);
    }
    let length = file::length(path)?;
    if length > MOST_BYTES {
        return Err(too_long(path, length));
    }
    let image = match open_rows(path)? {
        Some(rows) => rows.whole()?,
        None => decode(path, &file::contents(path, length)?, format)?,
    };
    chosen(path, image, &options.ask)
}

/// What was perhaps meant by a name of unknown ending: an image whose name has a dot, or the image
/// that a file of a channel belongs to.
fn hint(path: &Path) -> String {
    let mut whole = path.as_os_str().to_owned();
    whole.push(".idf");
    let image = path.with_extension("idf");
    let ending = path.extension().and_then(|ending| ending.to_str()).and_then(Kind::from_word);
    if Path::new(&whole).is_file() {
        return format!("; there is `{}`", whole.display());
    }
    match ending {
        Some(kind) if image.is_file() => {
            format!(
                "; this is a channel's file, for the image `{}`, {kind} alone by icopy --channels {kind}",
                image.display()
            )
        }
        _ => String::new(),
    }
}

/// Reads an image in another format from a stream, by its first bytes. `name` is for messages.
///
/// # Errors
///
/// As [`read_image`].
pub fn read_stream(
    name: &Path,
    stream: impl Read,
    options: &ReadOptions,
) -> Result<Image, ReadError> {
    let bytes = stream_bytes(name, stream)?;
    let error = || ReadError::Format { path: name.into(), expected: format::names() };
    let format = Format::of_bytes(&bytes).ok_or_else(error)?;
    chosen(name, decode(name, &bytes, format)?, &options.ask)
}

/// All of a stream.
fn stream_bytes(name: &Path, stream: impl Read) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let io = |source| ReadError::Io { path: name.into(), source };
    let length = stream.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(io)? as u64;
    if length > MOST_BYTES {
        return Err(too_long(name, length));
    }
    Ok(bytes)
}

/// Writes an image in any format, by the ending of its name; without one, in this crate's.
///
/// PNG and PAM get 8 bits, or 16 where the image is deeper, sRGB and straight coverage; PNG has the
/// place on the canvas too. An image of indices and their table, without other pictures and
/// coverage, makes an indexed PNG: the table in its order, all of it, with its coverage, at 1, 2, 4
/// or 8 bits. GIF needs such an image; a coverage of less than 128/255 becomes none there, else
/// whole. `OpenEXR` gets 32-bit floating point, linear and premultiplied, and measured channels as
/// Z, N.X, N.Y, N.Z and id. PNM is opaque, over the background.
///
/// # Errors
///
/// If the format is unknown or cannot hold the image, or the file cannot be written; the old one
/// is then whole.
pub fn write_image(path: &Path, image: &Image, options: &WriteOptions) -> Result<(), WriteError> {
    let format = Format::of(path).filter(|format| format.is_written()).ok_or_else(|| {
        let expected = format!("a name that ends in {}", endings(true));
        WriteError::Format { path: path.into(), expected }
    })?;
    match format {
        Format::Idf => return write(path, image, options),
        Format::Pnm | Format::Pam => return anymap::write(path, image),
        _ => {}
    }
    file::replace(path, &encode(path, image, format)?)
}

/// Writes an image as PNG to a stream. `name` is for messages.
///
/// # Errors
///
/// If PNG cannot hold the image, or the stream does not take it.
pub fn write_stream(name: &Path, mut stream: impl Write, image: &Image) -> Result<(), WriteError> {
    let bytes = encode(name, image, Format::Png)?;
    let result = stream.write_all(&bytes).and_then(|()| stream.flush());
    result.map_err(|source| file::io_error(name, source))
}

/// The bytes of a file in another format.
fn encode(path: &Path, image: &Image, format: Format) -> Result<Vec<u8>, WriteError> {
    let result = match format {
        Format::Exr => exr::encode(image),
        Format::Gif => gif::encode(image),
        _ => png::encode(image),
    };
    result.map_err(|error| write_error(path, error))
}

fn write_error(path: &Path, error: EncodeError) -> WriteError {
    match error {
        EncodeError::Image(error) => WriteError::Image { path: path.into(), error },
        EncodeError::Library(source) => WriteError::Encode { path: path.into(), source },
    }
}

fn decode(path: &Path, bytes: &[u8], format: Format) -> Result<Image, ReadError> {
    let result = match format {
        Format::Exr => exr::decode(bytes),
        Format::Png | Format::Idf => png::decode(bytes),
        Format::Gif => gif::decode(bytes),
        Format::Pnm | Format::Pam | Format::Jpeg | Format::Tiff | Format::WebP => {
            raster::decode(bytes, format)
        }
    };
    result.map_err(|source| undecoded(path, source))
}

fn undecoded(path: &Path, source: Cause) -> ReadError {
    let path = path.into();
    match source.downcast::<MemoryError>() {
        Ok(error) => ReadError::Memory { path, error: *error },
        Err(source) => ReadError::Decode { path, source },
    }
}

/// Why an image does not become a file.
enum EncodeError {
    Image(ImageError),
    Library(Cause),
}

impl From<ImageError> for EncodeError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

/// The kinds that another format gets: colour or grey, or coverage alone as grey.
fn picture_kinds(image: &Image) -> Result<Vec<Kind>, ImageError> {
    let mut kinds = image.light_kinds()?;
    if image.plane(Kind::Cvg).is_some() {
        kinds.push(Kind::Cvg);
    }
    if kinds.is_empty() {
        return Err(ImageError::Missing { kind: Kind::Grg, present: image.kinds() });
    }
    Ok(kinds)
}

/// Keeps the channels that were asked for.
fn chosen(path: &Path, image: Image, ask: &Ask) -> Result<Image, ReadError> {
    let error = |error| ReadError::Image { path: path.into(), error };
    let indexed = image.plane(Kind::Enc).is_some();
    let kinds = match ask {
        Ask::All | Ask::Picture if indexed => return image.resolved().map_err(error),
        Ask::All => return Ok(image),
        Ask::Picture => picture_kinds(&image).map_err(error)?,
        Ask::Only(kinds) => kinds.clone(),
    };
    let image = if indexed { with_indices(&image, &kinds).map_err(error)? } else { image };
    let present = image.kinds();
    if let Some(&kind) = kinds.iter().find(|kind| !present.contains(kind)) {
        return Err(ReadError::Missing { path: path.into(), kind, present });
    }
    // Light alone is what is seen, not its share.
    let light = kinds.iter().any(|kind| kind.role() == Role::Light);
    let straight = light && kinds.iter().all(|kind| kind.role() != Role::Coverage);
    let premultiply = straight && image.properties.matte == Matte::Straight;
    let image =
        if premultiply { image.with_matte(Matte::Premultiplied).map_err(error)? } else { image };
    if image.planes().iter().all(|plane| kinds.contains(&plane.kind)) && image.lut.is_none() {
        return Ok(image);
    }
    let planes = image.planes().iter().filter(|p| kinds.contains(&p.kind)).cloned().collect();
    let mut chosen = image.with_planes(image.columns(), image.rows(), planes).map_err(error)?;
    chosen.lut = chosen.lut.filter(|_| kinds.contains(&Kind::Lut));
    Ok(chosen)
}

/// The colours of an indexed picture, and the indices and the table where `kinds` has them.
fn with_indices(image: &Image, kinds: &[Kind]) -> Result<Image, ImageError> {
    if kinds.iter().all(|kind| matches!(kind, Kind::Enc | Kind::Lut)) {
        return Ok(image.clone());
    }
    let colors = image.resolved()?;
    let planes = [colors.planes(), image.planes()].concat();
    let mut both = colors.with_planes(image.columns(), image.rows(), planes)?;
    both.lut.clone_from(&image.lut);
    Ok(both)
}

fn too_long(path: &Path, found: u64) -> ReadError {
    ReadError::Length { path: path.into(), found, expected: format!("at most {MOST_BYTES}") }
}
