//! PNM and PAM row by row: where samples take all bits they lie in the file as they are, so that any rows can be
//! read, and are written one band after the other. A picture so larger than memory can be worked on, and a smaller
//! one takes only the memory of its planes.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use image::codecs::pnm::{PnmDecoder, PnmSubtype, SampleEncoding};
use image::{ColorType, ImageDecoder};
use tempfile::NamedTempFile;

use super::interleaved::{self, Interleaved};
use super::{Format, write_error};
use crate::error::{ReadError, WriteError};
use crate::file;
use crate::image::{Image, ImageError, Matte, Plane, Properties, checked_size};
use crate::plane::Kind;
use crate::rows::Reader;
use crate::samples::Samples;

/// Bytes in which a header is looked for; one with longer comments is left to the library.
const HEAD: u64 = 1 << 12;

/// Bytes that are read at once.
const CHUNK: usize = 1 << 21;

/// Pixels that are written at once.
const TASK: usize = 1 << 18;

/// The rows of a binary PNM or PAM file of 8 or 16 bits.
#[derive(Debug)]
pub(crate) struct AnymapReader {
    path: PathBuf,
    file: File,
    /// Where the samples begin.
    start: u64,
    columns: usize,
    kinds: Vec<Kind>,
    is_deep: bool,
    /// Some rows as they are in the file.
    bytes: Vec<u8>,
}

/// Opens the rows of a PNM or PAM file; none where they cannot be had alone: where samples are text,
/// bits, or scaled to another maximum, or are not all there. [`read_image`](super::read_image) reads
/// these, or says what is wrong.
///
/// # Errors
///
/// If the file cannot be read.
pub fn open_rows(path: &Path) -> Result<Option<Reader>, ReadError> {
    if !matches!(Format::of(path), Some(Format::Pnm | Format::Pam)) {
        return Ok(None);
    }
    let length = file::length(path)?;
    let io = |source| ReadError::Io { path: path.into(), source };
    let mut file = File::open(path).map_err(io)?;
    let mut head = Vec::new();
    Read::by_ref(&mut file).take(HEAD).read_to_end(&mut head).map_err(io)?;
    let Some((start, size, kinds, is_deep)) = header(&head) else { return Ok(None) };
    let bytes = u64::from(size[0]) * u64::from(size[1]) * kinds.len() as u64;
    let bytes = if is_deep { 2 * bytes } else { bytes };
    if checked_size(size[0], size[1]).is_err() || length - start < bytes {
        return Ok(None);
    }
    let covered = kinds.contains(&Kind::Cvg);
    let matte = if covered { Matte::Straight } else { Matte::Premultiplied };
    let rows = AnymapReader {
        path: path.into(),
        file,
        start,
        columns: size[0] as usize,
        kinds,
        is_deep,
        bytes: Vec::new(),
    };
    Ok(Some(Reader::of_anymap(path, size, rows, Properties { matte, ..Properties::default() })))
}

/// Where the samples begin, columns and rows, channels, and whether samples have 16 bits.
fn header(head: &[u8]) -> Option<(u64, [u32; 2], Vec<Kind>, bool)> {
    use SampleEncoding::Binary;
    let decoder = PnmDecoder::new(Cursor::new(head)).ok()?;
    let (size, color) = (decoder.dimensions(), decoder.color_type());
    let is_deep = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => false,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => true,
        _ => return None,
    };
    let (rest, header) = decoder.into_inner();
    let is_binary = matches!(
        header.subtype(),
        PnmSubtype::Graymap(Binary) | PnmSubtype::Pixmap(Binary) | PnmSubtype::ArbitraryMap
    );
    let is_full = is_binary && header.maximal_sample() == u32::from(most(is_deep));
    let kinds = interleaved::kinds(color.has_color(), color.has_alpha());
    is_full.then_some((rest.position(), size.into(), kinds, is_deep))
}

impl AnymapReader {
    /// Bytes of all channels of the picture that is `rows` high.
    pub(crate) fn bytes_in_all(&self, rows: u32) -> u64 {
        self.row_bytes() as u64 * u64::from(rows)
    }

    fn row_bytes(&self) -> usize {
        self.columns * self.kinds.len() * if self.is_deep { 2 } else { 1 }
    }

    /// Some rows, by channels.
    pub(crate) fn read(&mut self, rows: Range<usize>) -> Result<Vec<Plane>, ReadError> {
        let pixels = rows.len() * self.columns;
        let (mut shallow, mut deep) = (Vec::new(), Vec::new());
        if self.is_deep {
            deep = interleaved::empty::<u16>(self.kinds.len(), pixels);
        } else {
            shallow = interleaved::empty::<u8>(self.kinds.len(), pixels);
        }
        let row_bytes = self.row_bytes();
        let io = |source| ReadError::Io { path: self.path.clone(), source };
        let first = self.start + rows.start as u64 * row_bytes as u64;
        self.file.seek(SeekFrom::Start(first)).map_err(io)?;
        let height = (CHUNK / row_bytes).max(1);
        for row in (0..rows.len()).step_by(height) {
            let rows = height.min(rows.len() - row);
            self.bytes.resize(rows * row_bytes, 0);
            self.file.read_exact(&mut self.bytes).map_err(io)?;
            let at = row * self.columns;
            if self.is_deep {
                interleaved::split(&self.bytes, &mut deep, at, u16::from_be_bytes);
            } else {
                interleaved::split(&self.bytes, &mut shallow, at, |[byte]| byte);
            }
        }
        let samples =
            shallow.into_iter().map(Samples::U8).chain(deep.into_iter().map(Samples::U16));
        let kinds = self.kinds.iter();
        Ok(kinds.zip(samples).map(|(&kind, samples)| Plane { kind, samples }).collect())
    }
}

/// A PNM or PAM file that is written band by band. Until [`AnymapWriter::finish`] what was there is as
/// it was; without it nothing stays on disk.
#[derive(Debug)]
pub struct AnymapWriter {
    path: PathBuf,
    file: NamedTempFile,
    size: [u32; 2],
    rows: u32,
    /// Some rows as they are in the file.
    bytes: Vec<u8>,
}

impl AnymapWriter {
    /// Starts a file of `size`, columns and rows, at `path`: PAM by that ending, else PNM.
    ///
    /// # Errors
    ///
    /// If the file cannot be made.
    pub fn create(path: &Path, size: [u32; 2]) -> Result<Self, WriteError> {
        file::check_target(path)?;
        let file = file::create_beside(path)?;
        Ok(Self { path: path.into(), file, size, rows: 0, bytes: Vec::new() })
    }

    /// Writes the next rows, all of one depth and the same channels, as
    /// [`write_image`](super::write_image) does.
    ///
    /// # Errors
    ///
    /// If they are no picture, have other columns, are too many, or cannot be written.
    pub fn write(&mut self, band: &Image) -> Result<(), WriteError> {
        let [columns, rows] = self.size;
        if band.columns() != columns || band.rows() > rows - self.rows {
            let expected = format!("{} rows of {columns} samples", rows - self.rows);
            return Err(WriteError::Format { path: self.path.clone(), expected });
        }
        let format = Format::of(&self.path);
        let error = |error| write_error(&self.path, error);
        let shown = shown(format, band).map_err(|e| error(e.into()))?;
        let picture = Interleaved::new(&shown).map_err(error)?;
        let io = |source| file::io_error(&self.path, source);
        if self.rows == 0 {
            let head = head(format, self.size, picture.channels(), picture.is_deep);
            self.file.write_all(&head).map_err(io)?;
        }
        let pixels = columns as usize * band.rows() as usize;
        for start in (0..pixels).step_by(TASK) {
            self.bytes.resize(picture.length(TASK.min(pixels - start)), 0);
            picture.put(start, &mut self.bytes).map_err(error)?;
            self.file.write_all(&self.bytes).map_err(io)?;
        }
        self.rows += band.rows();
        Ok(())
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    ///
    /// If rows are missing, or the file cannot be written; the old one is then whole.
    pub fn finish(self) -> Result<(), WriteError> {
        if self.rows != self.size[1] {
            let expected = format!("{} rows, found {}", self.size[1], self.rows);
            return Err(WriteError::Format { path: self.path, expected });
        }
        file::put(self.file, &self.path)
    }
}

/// Writes a whole image.
pub(super) fn write(path: &Path, image: &Image) -> Result<(), WriteError> {
    let mut writer = AnymapWriter::create(path, image.size())?;
    writer.write(image)?;
    writer.finish()
}

/// What a format shows of a picture: PNM has no coverage, so light is seen before the background.
fn shown(format: Option<Format>, image: &Image) -> Result<Cow<'_, Image>, ImageError> {
    if format == Some(Format::Pam) {
        return Ok(Cow::Borrowed(image));
    }
    let image = match image.plane(Kind::Enc) {
        Some(_) => Cow::Owned(image.resolved()?),
        None => Cow::Borrowed(image),
    };
    if image.plane(Kind::Cvg).is_none() || image.light_kinds()?.is_empty() {
        return Ok(image);
    }
    Ok(Cow::Owned(image.flattened(None)?))
}

fn head(
    format: Option<Format>,
    [columns, rows]: [u32; 2],
    channels: usize,
    is_deep: bool,
) -> Vec<u8> {
    let most = most(is_deep);
    if format != Some(Format::Pam) {
        let magic = if channels == 1 { "P5" } else { "P6" };
        return format!("{magic}\n{columns} {rows}\n{most}\n").into_bytes();
    }
    let kind = match channels {
        1 => "GRAYSCALE",
        2 => "GRAYSCALE_ALPHA",
        3 => "RGB",
        _ => "RGB_ALPHA",
    };
    let size = format!("WIDTH {columns}\nHEIGHT {rows}\nDEPTH {channels}\nMAXVAL {most}");
    format!("P7\n{size}\nTUPLTYPE {kind}\nENDHDR\n").into_bytes()
}

/// The largest sample.
fn most(is_deep: bool) -> u16 {
    if is_deep { u16::MAX } else { u8::MAX.into() }
}
