//! Other formats: PNG and `OpenEXR` in and out, PNM too, JPEG in.

mod exr;
mod raster;

use std::io::{Read, Write};
use std::path::Path;

use crate::error::{Cause, ReadError, WriteError};
use crate::file;
use crate::image::{Image, ImageError, Matte};
use crate::plane::{Kind, Role};
use crate::read::{Ask, ReadOptions, read};
use crate::write::{WriteOptions, write};

/// A format, by the ending of a file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// This crate's own.
    Idf,
    /// Portable Network Graphics, 8 or 16 bits, straight coverage.
    Png,
    /// `OpenEXR`, 32-bit floating point, linear and premultiplied.
    Exr,
    /// Portable any map, 8 or 16 bits, opaque.
    Pnm,
    /// JPEG; only read.
    Jpeg,
}

/// Endings of file names. A name without one is in this crate's format.
const ENDINGS: [(&str, Format); 9] = [
    ("idf", Format::Idf),
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("ppm", Format::Pnm),
    ("pgm", Format::Pnm),
    ("pbm", Format::Pnm),
    ("pnm", Format::Pnm),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
];

/// First bytes of files.
const MAGIC: [(&[u8], Format); 9] = [
    (b"\x89PNG\r\n\x1a\n", Format::Png),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"\xff\xd8\xff", Format::Jpeg),
    (b"P1", Format::Pnm),
    (b"P2", Format::Pnm),
    (b"P3", Format::Pnm),
    (b"P4", Format::Pnm),
    (b"P5", Format::Pnm),
    (b"P6", Format::Pnm),
];

/// Most bytes of a file in another format, and of what is read from standard input.
const MOST_BYTES: u64 = 1 << 32;

/// Most pixels for each byte of a file: Deflate makes at most 1032 bytes of one (RFC 1951: 258
/// bytes from a length and a distance code of one bit each), and a byte holds at most 8 pixels.
const MOST_PIXELS_PER_BYTE: u64 = 1032 * 8;

/// Most samples in all channels and layers of a file.
const MOST_FILE_SAMPLES: u64 = crate::image::MOST_SAMPLES;

impl Format {
    /// The format of a file with this name.
    pub fn of(path: &Path) -> Option<Self> {
        let Some(ending) = path.extension() else { return Some(Self::Idf) };
        let ending = ending.to_str()?.to_ascii_lowercase();
        ENDINGS.iter().find(|row| row.0 == ending).map(|row| row.1)
    }

    /// Whether pictures in it are usually opaque, so that a renderer paints the background in.
    pub fn is_plain(self) -> bool {
        matches!(self, Self::Png | Self::Pnm | Self::Jpeg)
    }
}

/// Reads an image in any format, by the ending of its name.
///
/// # Errors
///
/// If the file cannot be read, is damaged, is larger than its length allows, or lacks a channel
/// that was asked for.
pub fn read_image(path: &Path, options: &ReadOptions) -> Result<Image, ReadError> {
    let error = || ReadError::Format { path: path.into(), expected: endings(|_| true) };
    let format = Format::of(path).ok_or_else(error)?;
    if format == Format::Idf {
        return read(path, options);
    }
    let length = file::length(path)?;
    if length > MOST_BYTES {
        return Err(too_long(path, length));
    }
    chosen(path, decode(path, &file::contents(path, length)?, format)?, &options.ask)
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
    let mut bytes = Vec::new();
    let io = |source| ReadError::Io { path: name.into(), source };
    let length = stream.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(io)? as u64;
    if length > MOST_BYTES {
        return Err(too_long(name, length));
    }
    let format = MAGIC.iter().find(|row| bytes.starts_with(row.0)).map(|row| row.1);
    let expected = "PNG, OpenEXR, PNM or JPEG";
    let error = || ReadError::Format { path: name.into(), expected: expected.into() };
    chosen(name, decode(name, &bytes, format.ok_or_else(error)?)?, &options.ask)
}

/// Writes an image in any format, by the ending of its name; without one, in this crate's.
///
/// PNG gets 8 bits, or 16 where the image is deeper, sRGB and straight coverage; `OpenEXR` gets
/// 32-bit floating point, linear and premultiplied; PNM is opaque, over the background.
///
/// # Errors
///
/// If the format is unknown or cannot hold the image, or the file cannot be written; the old one
/// is then whole.
pub fn write_image(path: &Path, image: &Image, options: &WriteOptions) -> Result<(), WriteError> {
    let writable = |format| format != Format::Jpeg;
    let format = Format::of(path).filter(|&format| writable(format)).ok_or_else(|| {
        let expected = format!("a name that ends in {}", endings(writable));
        WriteError::Format { path: path.into(), expected }
    })?;
    if format == Format::Idf {
        return write(path, image, options);
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
        Format::Pnm => raster::encode_pnm(image),
        Format::Png | Format::Idf | Format::Jpeg => raster::encode_png(image),
    };
    result.map_err(|error| match error {
        EncodeError::Image(error) => WriteError::Image { path: path.into(), error },
        EncodeError::Library(source) => WriteError::Encode { path: path.into(), source },
    })
}

fn decode(path: &Path, bytes: &[u8], format: Format) -> Result<Image, ReadError> {
    let result = match format {
        Format::Exr => exr::decode(bytes),
        Format::Png | Format::Pnm | Format::Jpeg | Format::Idf => raster::decode(bytes, format),
    };
    result.map_err(|source| ReadError::Decode { path: path.into(), source })
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

/// Refuses a size that `bytes` cannot hold, before memory is taken.
fn check_samples(columns: u64, rows: u64, channels: u64, bytes: &[u8]) -> Result<(), Cause> {
    let most = (bytes.len() as u64).saturating_mul(MOST_PIXELS_PER_BYTE);
    let pixels = columns.saturating_mul(rows);
    if pixels > most || pixels.saturating_mul(channels) > MOST_FILE_SAMPLES {
        return Err(format!(
            "{columns} x {rows} pixels of {channels} channels, expected at most {most} pixels in \
             {} bytes and {MOST_FILE_SAMPLES} samples",
            bytes.len()
        )
        .into());
    }
    Ok(())
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
    let Ask::Only(kinds) = ask else { return Ok(image) };
    let present = image.kinds();
    if let Some(&kind) = kinds.iter().find(|kind| !present.contains(kind)) {
        return Err(ReadError::Missing { path: path.into(), kind, present });
    }
    let error = |error| ReadError::Image { path: path.into(), error };
    // Light alone is what is seen, not its share.
    let straight = kinds.iter().all(|kind| kind.role() != Role::Coverage);
    let premultiply = straight && image.properties.matte == Matte::Straight;
    let image =
        if premultiply { image.with_matte(Matte::Premultiplied).map_err(error)? } else { image };
    let planes = image.planes().iter().filter(|p| kinds.contains(&p.kind)).cloned().collect();
    image.with_planes(image.columns(), image.rows(), planes).map_err(error)
}

fn endings(wanted: impl Fn(Format) -> bool) -> String {
    let endings = ENDINGS.iter().filter(|row| wanted(row.1)).map(|row| format!(".{}", row.0));
    endings.collect::<Vec<_>>().join(" ")
}

fn too_long(path: &Path, found: u64) -> ReadError {
    ReadError::Length { path: path.into(), found, expected: format!("at most {MOST_BYTES}") }
}
