//! GIF: indices with a table of opaque colours and one without coverage.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use ::gif::{ColorOutput, DecodeOptions, DisposalMethod, Encoder, Frame, MemoryLimit, Repeat};

use super::{EncodeError, Format, interleaved, write_error};
use crate::error::{Cause, WriteError};
use crate::file;
use crate::image::Image;
use crate::lut::Lut;

/// Coverage from which a colour is opaque here.
const OPAQUE: u8 = 128;

/// The first picture of a file. Where it does not fill the screen, the rest has no coverage.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, Cause> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    options.check_frame_consistency(true);
    options.set_memory_limit(MemoryLimit::Unlimited);
    let mut decoder = options.read_info(Cursor::new(bytes))?;
    let screen = [decoder.width(), decoder.height()];
    Format::Gif.check_samples(screen.map(u64::from), 4, bytes.len())?;
    let frame = decoder.next_frame_info()?.ok_or("expected a picture, found none")?;
    let (left, top) = (usize::from(frame.left), usize::from(frame.top));
    let [width, height] = [frame.width, frame.height].map(usize::from);
    let nothing = frame.transparent;
    let mut indices = vec![0; width * height];
    decoder.read_into_buffer(&mut indices)?;
    let mut entries: Vec<[u8; 4]> = decoder
        .palette()?
        .as_chunks::<3>()
        .0
        .iter()
        .zip(0_u8..=255)
        .map(|(&[r, g, b], index)| [r, g, b, if nothing == Some(index) { 0 } else { u8::MAX }])
        .collect();
    let [columns, rows] = screen.map(usize::from);
    if [width, height] != [columns, rows] {
        let beside = match nothing {
            Some(index) => index,
            None => u8::try_from(entries.len())
                .map_err(|_| "expected a picture as large as the screen, or a free colour")?,
        };
        if usize::from(beside) == entries.len() {
            entries.push([0; 4]);
        }
        let mut whole = vec![beside; columns * rows];
        let targets = whole.chunks_exact_mut(columns.max(1)).skip(top);
        for (target, row) in targets.zip(indices.chunks_exact(width.max(1))) {
            target[left..left + width].copy_from_slice(row);
        }
        indices = whole;
    }
    let lut = Lut::with_coverage(entries).ok_or("expected a table of 1 to 256 colours")?;
    interleaved::indexed(screen.map(u32::from), indices, lut)
}

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, EncodeError> {
    encode_frames(std::slice::from_ref(image), 0, 1)
}

/// Writes an animation as GIF: pictures of indices with their tables, each for `hundredths` of a
/// second; it is shown `times` times, or for ever where that is 0.
///
/// Each picture lies at its window on a screen that holds all windows, and takes the place of the
/// one before. A table's coverage is that of [`write_image`](super::write_image) to a `.gif`.
///
/// # Errors
///
/// If there is no picture, one has no indices and table, or the screen is larger than
/// 65535 x 65535; or the file cannot be written: the old one is then whole.
pub fn write_frames(
    path: &Path,
    images: &[Image],
    hundredths: u16,
    times: u16,
) -> Result<(), WriteError> {
    let bytes = encode_frames(images, hundredths, times);
    file::replace(path, &bytes.map_err(|error| write_error(path, error))?)
}

fn encode_frames(images: &[Image], hundredths: u16, times: u16) -> Result<Vec<u8>, EncodeError> {
    let library = |error: ::gif::EncodingError| EncodeError::Library(error.into());
    let pictures = images.iter().map(Picture::new).collect::<Result<Vec<_>, _>>()?;
    let (origin, screen) = screen(images)?;
    // Tables that agree are written once.
    let shared = pictures.first().map(|first| first.colors.clone()).unwrap_or_default();
    let mut encoder = Encoder::new(Vec::new(), screen[0], screen[1], &shared).map_err(library)?;
    match times {
        0 => encoder.set_repeat(Repeat::Infinite).map_err(library)?,
        // What is shown once more is repeated once.
        _ => encoder.set_repeat(Repeat::Finite(times - 1)).map_err(library)?,
    }
    let holes = pictures.iter().any(|picture| picture.nothing.is_some());
    for (picture, image) in pictures.iter().zip(images) {
        let [column, row] = image.properties.origin;
        let place = |at: i32, start: i32| within_screen(i64::from(at) - i64::from(start));
        let frame = Frame {
            delay: hundredths,
            dispose: if holes { DisposalMethod::Background } else { DisposalMethod::Keep },
            transparent: picture.nothing,
            left: place(column, origin[0])?,
            top: place(row, origin[1])?,
            width: within_screen(image.columns().into())?,
            height: within_screen(image.rows().into())?,
            palette: Some(picture.colors.clone()).filter(|colors| *colors != shared),
            buffer: Cow::Borrowed(&picture.indices),
            ..Frame::default()
        };
        encoder.write_frame(&frame).map_err(library)?;
    }
    encoder.into_inner().map_err(library)
}

/// What a frame holds.
struct Picture<'a> {
    indices: Cow<'a, [u8]>,
    colors: Vec<u8>,
    /// The index that has no coverage.
    nothing: Option<u8>,
}

impl<'a> Picture<'a> {
    fn new(image: &'a Image) -> Result<Self, EncodeError> {
        let Some((indices, lut)) = interleaved::indices(image)? else {
            let present = crate::image::words(&image.kinds());
            let message = format!(
                "expected channels enc and lut alone, found {present}; make them with iencode"
            );
            return Err(EncodeError::Library(message.into()));
        };
        let colors = lut.colors().concat();
        let coverage = lut.coverage().unwrap_or_default();
        let is_open = |index: u8| coverage.get(usize::from(index)).is_some_and(|&c| c < OPAQUE);
        let nothing = (0..=u8::MAX).find(|&index| is_open(index));
        // The format has one such colour; the others become it.
        let indices = match nothing {
            None => Cow::Borrowed(indices),
            Some(nothing) => {
                indices.iter().map(|&i| if is_open(i) { nothing } else { i }).collect()
            }
        };
        Ok(Self { indices, colors, nothing })
    }
}

/// Top left and size of the rectangle that holds all windows.
fn screen(images: &[Image]) -> Result<([i32; 2], [u16; 2]), EncodeError> {
    let mut start = [i32::MAX; 2];
    let mut end = [i64::MIN; 2];
    for image in images {
        for (axis, size) in image.size().into_iter().enumerate() {
            let at = image.properties.origin[axis];
            start[axis] = start[axis].min(at);
            end[axis] = end[axis].max(i64::from(at) + i64::from(size));
        }
    }
    if images.is_empty() {
        return Err(EncodeError::Library("expected a picture, found none".into()));
    }
    let length = |axis: usize| within_screen(end[axis] - i64::from(start[axis]));
    Ok((start, [length(0)?, length(1)?]))
}

fn within_screen(pixels: i64) -> Result<u16, EncodeError> {
    u16::try_from(pixels).map_err(|_| {
        let message = format!("expected at most 65535 columns and rows, found {pixels}");
        EncodeError::Library(message.into())
    })
}
