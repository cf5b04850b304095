//! JPEG, TIFF, `WebP`, and all PNM and PAM but those that [`super::anymap`] takes, by the `image` library.

use std::io::Cursor;

use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::{Format, bound, interleaved};
use crate::error::Cause;
use crate::image::{Image, Plane};
use crate::memory;
use crate::samples::Samples;

/// Bytes that a decoder may take beyond the picture and as much again.
const SPARE: u64 = 1 << 26;

pub(super) fn decode(bytes: &[u8], format: Format) -> Result<Image, Cause> {
    let library = match format {
        Format::Jpeg => {
            check_jpeg_end(bytes)?;
            ImageFormat::Jpeg
        }
        Format::Tiff => ImageFormat::Tiff,
        Format::WebP => ImageFormat::WebP,
        _ => ImageFormat::Pnm,
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), library);
    reader.no_limits();
    let mut decoder = reader.into_decoder()?;
    let (columns, rows) = decoder.dimensions();
    let color = decoder.color_type();
    let channels = color.channel_count();
    let size = [columns, rows].map(u64::from);
    match format {
        Format::Tiff => bound::tiff(bytes).check(size, channels.into(), bytes.len())?,
        Format::WebP => bound::webp(bytes).check(size, channels.into(), bytes.len())?,
        _ => format.check_samples(size, channels.into(), bytes.len())?,
    }
    let length = decoder.total_bytes();
    // As the library gives them, and as planes.
    memory::check(length.saturating_mul(2))?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(length.saturating_mul(2).saturating_add(SPARE));
    decoder.set_limits(limits)?;
    let orientation = decoder.orientation()?;
    // Not written to until there are samples.
    let mut pixels = vec![0; usize::try_from(length)?];
    decoder.read_image(&mut pixels)?;
    let kinds = interleaved::kinds(color.has_color(), color.has_alpha());
    let size = [columns, rows];
    let image = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            interleaved::image(size, &kinds, &pixels, |[byte]| byte, Samples::U8)
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            interleaved::image(size, &kinds, &pixels, u16::from_ne_bytes, Samples::U16)
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            interleaved::image(size, &kinds, &pixels, f32::from_ne_bytes, Samples::F32)
        }
        other => return Err(format!("expected 8, 16 or 32 bits, found {other:?}").into()),
    }?;
    upright(image, orientation)
}

/// The picture as the camera was held.
fn upright(image: Image, orientation: Orientation) -> Result<Image, Cause> {
    // Turned is what comes first: whether the axes change places; then which are reversed.
    let (turned, reversed) = match orientation {
        Orientation::NoTransforms => return Ok(image),
        Orientation::FlipHorizontal => (false, [true, false]),
        Orientation::Rotate180 => (false, [true, true]),
        Orientation::FlipVertical => (false, [false, true]),
        Orientation::Rotate90FlipH => (true, [false, false]),
        Orientation::Rotate90 => (true, [false, true]),
        Orientation::Rotate270FlipH => (true, [true, true]),
        Orientation::Rotate270 => (true, [true, false]),
    };
    let size = image.size();
    let [columns, rows] = if turned { [size[1], size[0]] } else { size };
    let [old_columns, old_rows] = size.map(|length| length as usize);
    let positions = || {
        (0..rows as usize).flat_map(move |y| {
            (0..columns as usize).map(move |x| {
                let [x, y] = if turned { [y, x] } else { [x, y] };
                let x = if reversed[0] { old_columns - 1 - x } else { x };
                let y = if reversed[1] { old_rows - 1 - y } else { y };
                y * old_columns + x
            })
        })
    };
    let plane =
        |plane: &Plane| Plane { kind: plane.kind, samples: plane.samples.gathered(positions()) };
    Ok(image.with_planes(columns, rows, image.planes().iter().map(plane).collect())?)
}

/// Refuses a file that ends within its samples: the library would make up the rest.
fn check_jpeg_end(bytes: &[u8]) -> Result<(), Cause> {
    let mut at = 2;
    let mut in_scan = false;
    while let Some(&[mark, code]) = bytes.get(at..at + 2).and_then(|pair| pair.first_chunk()) {
        match code {
            // Samples; a stuffed byte, a fill byte or a restart mark among them.
            _ if mark != 0xff && in_scan => at += 1,
            _ if mark != 0xff => return Err(format!("expected a marker at byte {at}").into()),
            0xff => at += 1,
            0x00 | 0x01 | 0xd0..=0xd7 => at += 2,
            0xd9 => return Ok(()),
            _ => {
                let length = bytes.get(at + 2..at + 4).and_then(|pair| pair.first_chunk());
                at += 2 + length.map_or(0, |&length| usize::from(u16::from_be_bytes(length)));
                in_scan = code == 0xda;
            }
        }
    }
    Err("the file ends within the picture".into())
}
