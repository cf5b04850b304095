//! PNG: 8 or 16 bits, or indices with their table; place on a canvas and transfer by its chunks.

use std::io::Cursor;

use ::png::{
    BitDepth, ColorType, Compression, Decoder, DeflateCompression, Encoder, Filter, Info, Limits,
    Transformations,
};

use super::interleaved::{self, Interleaved};
use super::{EncodeError, Format};
use crate::error::Cause;
use crate::image::Image;
use crate::lut::Lut;
use crate::memory;
use crate::samples::Samples;
use crate::transfer::Transfer;

/// The chunk of a picture's place: column and row, four bytes each, and a unit, 0 for pixels.
const PLACE: [u8; 4] = *b"oFFs";

/// A `gAMA` of this, in 100 000ths, is the curve of sRGB, and so is one within a twentieth of it,
/// as libpng and `ImageMagick` have it.
const SRGB_GAMMA: f64 = 45_455.0;

/// How hard DEFLATE tries, on samples. Against level 6, which most programs take, photographs and renders get 2 to 5 %
/// longer, smooth pictures of a few kilobytes 10 %, in a half to a fifth of the time; 2 would be twice as fast
/// again for 3 to 10 % more, 4 has the size of 3.
const LEVEL: u8 = 3;

pub(super) fn decode(bytes: &[u8]) -> Result<Image, Cause> {
    // The library's own limit is on memory in all; ours is on what the file can hold.
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: usize::MAX });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info()?;
    let size = [header.width, header.height];
    let is_indexed = header.color_type == ColorType::Indexed;
    let channels = if is_indexed { 4 } else { header.color_type.samples() as u64 };
    Format::Png.check_samples(size.map(u64::from), channels, bytes.len())?;
    decoder.set_transformations(if is_indexed {
        Transformations::IDENTITY
    } else {
        Transformations::EXPAND
    });
    let mut reader = decoder.read_info()?;
    let length = reader.output_buffer_size().ok_or("a size beyond this machine's")?;
    memory::check((length as u64).saturating_mul(2))?;
    let mut pixels = vec![0; length];
    let frame = reader.next_frame(&mut pixels)?;
    let mut image = if is_indexed {
        let lut = table(reader.info()).ok_or("a colour table of 1 to 256 colours is missing")?;
        interleaved::indexed(
            size,
            unpacked(&pixels, frame.line_size, size[0], frame.bit_depth),
            lut,
        )?
    } else {
        let color = matches!(frame.color_type, ColorType::Rgb | ColorType::Rgba);
        let covered = matches!(frame.color_type, ColorType::GrayscaleAlpha | ColorType::Rgba);
        let kinds = interleaved::kinds(color, covered);
        if frame.bit_depth == BitDepth::Sixteen {
            interleaved::image(size, &kinds, &pixels, u16::from_be_bytes, Samples::U16)?
        } else {
            interleaved::image(size, &kinds, &pixels, |[byte]| byte, Samples::U8)?
        }
    };
    image.properties.transfer = transfer(reader.info())?;
    image.properties.origin = place(bytes).unwrap_or_default();
    Ok(image)
}

fn table(info: &Info<'_>) -> Option<Lut> {
    let colors = info.palette.as_ref()?.as_chunks::<3>().0.iter();
    let coverage = info.trns.as_deref().unwrap_or_default().iter().copied();
    let coverage = coverage.chain(std::iter::repeat(u8::MAX));
    Lut::with_coverage(colors.zip(coverage).map(|(&[r, g, b], a)| [r, g, b, a]).collect())
}

/// Indices of 1, 2, 4 or 8 bits, the leftmost in the highest bits, each row in whole bytes.
fn unpacked(packed: &[u8], row_length: usize, columns: u32, depth: BitDepth) -> Vec<u8> {
    let bits = depth as usize;
    let columns = columns as usize;
    let mask = u8::MAX >> (8 - bits.min(8));
    packed
        .chunks_exact(row_length)
        .flat_map(|row| {
            (0..columns).map(move |column| {
                let at = column * bits;
                (row[at / 8] >> (8 - bits - at % 8)) & mask
            })
        })
        .collect()
}

/// What the file says of its light; without a word on it, as is usual.
fn transfer(info: &Info<'_>) -> Result<Option<Transfer>, Cause> {
    let gamma = match info.gama_chunk {
        Some(gamma) if info.srgb.is_none() => f64::from(gamma.into_scaled()),
        _ => return Ok(None),
    };
    if (gamma / SRGB_GAMMA - 1.0).abs() <= 0.05 {
        return Ok(None);
    }
    let exponent = 100_000.0 / gamma;
    if (exponent - 1.0).abs() <= 0.000_01 {
        return Ok(Some(Transfer::Linear));
    }
    if !Transfer::GAMMAS.contains(&exponent) {
        return Err(format!("a gamma of {gamma} / 100000, expected 10000 to 1000000").into());
    }
    Ok(Some(Transfer::Gamma(exponent)))
}

/// The place that an undamaged chunk before the samples gives.
fn place(bytes: &[u8]) -> Option<[i32; 2]> {
    let mut rest = bytes.get(8..)?;
    loop {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let chunk = after.get(..length.checked_add(4)?)?;
        let (sum, next) = after[chunk.len()..].split_first_chunk::<4>()?;
        match chunk.split_first_chunk::<4>()? {
            (b"IDAT", _) => return None,
            (&PLACE, &[c3, c2, c1, c0, r3, r2, r1, r0, 0])
                if checksum(chunk) == u32::from_be_bytes(*sum) =>
            {
                return Some([[c3, c2, c1, c0], [r3, r2, r1, r0]].map(i32::from_be_bytes));
            }
            _ => rest = next,
        }
    }
}

/// The checksum of a chunk (PNG, annex D): CRC-32 with reversed bits.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, image.columns(), image.rows());
    let bytes = if let Some((indices, lut)) = interleaved::indices(image)? {
        let depth = index_depth(lut.colors().len());
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(depth);
        encoder.set_compression(Compression::Balanced);
        encoder.set_filter(Filter::NoFilter);
        encoder.set_palette(lut.colors().concat());
        if let Some(coverage) = lut.coverage() {
            encoder.set_trns(coverage.to_vec());
        }
        packed(indices, image.columns(), depth)
    } else {
        let picture = Interleaved::new(image)?;
        encoder.set_color(match picture.channels() {
            1 => ColorType::Grayscale,
            2 => ColorType::GrayscaleAlpha,
            3 => ColorType::Rgb,
            _ => ColorType::Rgba,
        });
        encoder.set_depth(if picture.is_deep { BitDepth::Sixteen } else { BitDepth::Eight });
        encoder.set_deflate_compression(DeflateCompression::Level(LEVEL));
        encoder.set_filter(Filter::Adaptive);
        picture.bytes()?
    };
    let written = encoder.write_header().and_then(|mut writer| {
        let origin = image.properties.origin;
        if origin != [0, 0] {
            let [[c3, c2, c1, c0], [r3, r2, r1, r0]] = origin.map(i32::to_be_bytes);
            let data = [c3, c2, c1, c0, r3, r2, r1, r0, 0];
            writer.write_chunk(::png::chunk::ChunkType(PLACE), &data)?;
        }
        writer.write_image_data(&bytes)?;
        writer.finish()
    });
    written.map_err(|error| EncodeError::Library(error.into()))?;
    Ok(file)
}

/// The fewest bits that hold an index of a table of `colors`.
fn index_depth(colors: usize) -> BitDepth {
    match colors {
        0..=2 => BitDepth::One,
        3..=4 => BitDepth::Two,
        5..=16 => BitDepth::Four,
        _ => BitDepth::Eight,
    }
}

/// The reverse of [`unpacked`].
fn packed(indices: &[u8], columns: u32, depth: BitDepth) -> Vec<u8> {
    let bits = depth as usize;
    let byte = |indices: &[u8]| {
        indices.iter().zip(1..).fold(0, |byte, (index, past)| byte | index << (8 - bits * past))
    };
    let rows = indices.chunks_exact(columns as usize);
    rows.flat_map(|row| row.chunks(8 / bits).map(byte)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_the_standard() {
        // The check value of CRC-32, and the sum of every PNG's last chunk.
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn indices_are_packed_from_the_left_in_whole_bytes() {
        let indices = [1, 0, 1, 0, 1, 1];
        assert_eq!(packed(&indices, 3, BitDepth::One), [0b1010_0000, 0b0110_0000]);
        assert_eq!(packed(&indices, 3, BitDepth::Two), [0b0100_0100, 0b0001_0100]);
        assert_eq!(packed(&indices, 3, BitDepth::Four), [0x10, 0x10, 0x01, 0x10]);
        for depth in [BitDepth::One, BitDepth::Two, BitDepth::Four, BitDepth::Eight] {
            let bytes = packed(&indices, 3, depth);
            assert_eq!(unpacked(&bytes, bytes.len() / 2, 3, depth), indices, "{depth:?}");
        }
    }
}
