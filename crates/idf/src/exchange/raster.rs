//! PNG, PNM and JPEG: interleaved integers, sRGB, straight coverage.

use std::io::Cursor;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ColorType, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader};

use super::{EncodeError, Format, check_samples, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, Matte, Plane};
use crate::plane::{COLOR, Kind};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

pub(super) fn decode(bytes: &[u8], format: Format) -> Result<Image, Cause> {
    let format = match format {
        Format::Jpeg => ImageFormat::Jpeg,
        Format::Pnm => ImageFormat::Pnm,
        Format::Png | Format::Exr | Format::Idf => ImageFormat::Png,
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // The library's own limit is on memory in all; ours is on what the file can hold.
    reader.no_limits();
    let decoder = reader.into_decoder()?;
    let (columns, rows) = decoder.dimensions();
    let (kinds, depth): (&[Kind], Depth) = match decoder.color_type() {
        ColorType::L8 => (&[Kind::Grg], Depth::U8),
        ColorType::La8 => (&[Kind::Grg, Kind::Cvg], Depth::U8),
        ColorType::Rgb8 => (&COLOR, Depth::U8),
        ColorType::Rgba8 => (&[Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg], Depth::U8),
        ColorType::L16 => (&[Kind::Grg], Depth::U16),
        ColorType::La16 => (&[Kind::Grg, Kind::Cvg], Depth::U16),
        ColorType::Rgb16 => (&COLOR, Depth::U16),
        ColorType::Rgba16 => (&[Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg], Depth::U16),
        other => return Err(format!("expected 8 or 16 bits, found {other:?}").into()),
    };
    check_samples(columns.into(), rows.into(), kinds.len() as u64, bytes)?;
    let mut pixels = vec![0; usize::try_from(decoder.total_bytes())?];
    decoder.read_image(&mut pixels)?;
    let plane = |(position, &kind): (usize, &Kind)| {
        let samples = match depth {
            Depth::U8 | Depth::F32 => {
                Samples::U8(pixels.iter().skip(position).step_by(kinds.len()).copied().collect())
            }
            Depth::U16 => {
                let words = pixels.as_chunks().0.iter().skip(position).step_by(kinds.len());
                Samples::U16(words.map(|&word| u16::from_ne_bytes(word)).collect())
            }
        };
        Plane { kind, samples }
    };
    let mut image = Image::new(columns, rows, kinds.iter().enumerate().map(plane).collect())?;
    if kinds.contains(&Kind::Cvg) {
        image.properties.matte = Matte::Straight;
    }
    Ok(image)
}

pub(super) fn encode_png(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let picture = Interleaved::new(&image.resolved()?)?;
    let color = match (picture.channels, picture.depth) {
        (1, Depth::U8) => ExtendedColorType::L8,
        (2, Depth::U8) => ExtendedColorType::La8,
        (3, Depth::U8) => ExtendedColorType::Rgb8,
        (_, Depth::U8) => ExtendedColorType::Rgba8,
        (1, _) => ExtendedColorType::L16,
        (2, _) => ExtendedColorType::La16,
        (3, _) => ExtendedColorType::Rgb16,
        _ => ExtendedColorType::Rgba16,
    };
    let bytes: Vec<u8> = match picture.depth {
        Depth::U8 => picture.bytes(|sample| [sample.to_be_bytes()[1]]),
        Depth::U16 | Depth::F32 => picture.bytes(u16::to_ne_bytes),
    };
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive)
        .write_image(&bytes, image.columns(), image.rows(), color)
        .map_err(|error| EncodeError::Library(error.into()))?;
    Ok(file)
}

pub(super) fn encode_pnm(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let light = !image.resolved()?.light_kinds()?.is_empty();
    let opaque = if light { image.flattened(None)? } else { image.clone() };
    let picture = Interleaved::new(&opaque)?;
    let magic = if picture.channels == 1 { "P5" } else { "P6" };
    let most = if picture.depth == Depth::U8 { 255 } else { 65_535 };
    let mut file = format!("{magic}\n{} {}\n{most}\n", image.columns(), image.rows()).into_bytes();
    match picture.depth {
        Depth::U8 => file.extend(picture.bytes(|sample| [sample.to_be_bytes()[1]])),
        Depth::U16 | Depth::F32 => file.extend(picture.bytes(u16::to_be_bytes)),
    }
    Ok(file)
}

/// Samples pixel by pixel, as these formats have them.
struct Interleaved {
    channels: usize,
    depth: Depth,
    samples: Vec<u16>,
}

impl Interleaved {
    fn new(image: &Image) -> Result<Self, EncodeError> {
        let kinds = picture_kinds(image)?;
        let depth = if image.depth() == Depth::U8 { Depth::U8 } else { Depth::U16 };
        let form = Form { depth, transfer: Transfer::Srgb, matte: Matte::Straight };
        let image = image.converted(form)?;
        let channels = kinds.len();
        let pixels = image.columns() as usize * image.rows() as usize;
        let mut samples = vec![0; channels * pixels];
        for (position, &kind) in kinds.iter().enumerate() {
            let places = samples.iter_mut().skip(position).step_by(channels);
            match image.needed(kind)? {
                Samples::U8(plane) => places.zip(plane).for_each(|(p, &s)| *p = u16::from(s)),
                Samples::U16(plane) => places.zip(plane).for_each(|(p, &s)| *p = s),
                Samples::F32(_) => {}
            }
        }
        Ok(Self { channels, depth, samples })
    }

    fn bytes<const N: usize>(&self, bytes: impl Fn(u16) -> [u8; N]) -> Vec<u8> {
        self.samples.iter().flat_map(|&sample| bytes(sample)).collect()
    }
}
