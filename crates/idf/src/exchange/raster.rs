//! PNM, PAM, JPEG, TIFF and `WebP` by the `image` library; PNM and PAM out.

use std::io::Cursor;

use image::codecs::pnm::{PnmDecoder, PnmSubtype, SampleEncoding};
use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::interleaved::{self, Interleaved};
use super::{EncodeError, Format, bound};
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
    let length = usize::try_from(length)?;
    let stored = stored_pixels(bytes, color, length).filter(|_| library == ImageFormat::Pnm);
    let mut decoded;
    let pixels = match stored {
        Some(pixels) => pixels,
        None => {
            // Not written to until there are samples.
            decoded = vec![0; length];
            decoder.read_image(&mut decoded)?;
            &decoded
        }
    };
    let word = |bytes| {
        if stored.is_some() { u16::from_be_bytes(bytes) } else { u16::from_ne_bytes(bytes) }
    };
    let kinds = interleaved::kinds(color.has_color(), color.has_alpha());
    let size = [columns, rows];
    let image = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            interleaved::image(size, &kinds, pixels, |[byte]| byte, Samples::U8)
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            interleaved::image(size, &kinds, pixels, word, Samples::U16)
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            interleaved::image(size, &kinds, pixels, f32::from_ne_bytes, Samples::F32)
        }
        other => return Err(format!("expected 8, 16 or 32 bits, found {other:?}").into()),
    }?;
    upright(image, orientation)
}

/// The pixels of a binary PNM or PAM whose samples take all bits, as they are in the file: of others
/// the library makes such, by way of two copies.
fn stored_pixels(bytes: &[u8], color: ColorType, length: usize) -> Option<&[u8]> {
    use SampleEncoding::Binary;
    let (rest, header) = PnmDecoder::new(Cursor::new(bytes)).ok()?.into_inner();
    let most = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => most(false),
        _ => most(true),
    };
    let is_binary = matches!(
        header.subtype(),
        PnmSubtype::Graymap(Binary) | PnmSubtype::Pixmap(Binary) | PnmSubtype::ArbitraryMap
    );
    let is_full = is_binary && header.maximal_sample() == u32::from(most);
    bytes.get(usize::try_from(rest.position()).ok()?..)?.get(..length).filter(|_| is_full)
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

pub(super) fn encode_pnm(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let light = !image.resolved()?.light_kinds()?.is_empty();
    let opaque = if light { image.flattened(None)? } else { image.clone() };
    let [columns, rows] = image.size();
    let header = |channels: usize, is_deep: bool| {
        let (magic, most) = (if channels == 1 { "P5" } else { "P6" }, most(is_deep));
        format!("{magic}\n{columns} {rows}\n{most}\n").into_bytes()
    };
    Ok(Interleaved::behind(&opaque, header)?.bytes)
}

pub(super) fn encode_pam(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let [columns, rows] = image.size();
    let header = |channels: usize, is_deep: bool| {
        let kind = match channels {
            1 => "GRAYSCALE",
            2 => "GRAYSCALE_ALPHA",
            3 => "RGB",
            _ => "RGB_ALPHA",
        };
        let most = most(is_deep);
        let size = format!("WIDTH {columns}\nHEIGHT {rows}\nDEPTH {channels}\nMAXVAL {most}");
        format!("P7\n{size}\nTUPLTYPE {kind}\nENDHDR\n").into_bytes()
    };
    Ok(Interleaved::behind(image, header)?.bytes)
}

/// The largest sample.
fn most(is_deep: bool) -> u16 {
    if is_deep { u16::MAX } else { u8::MAX.into() }
}
