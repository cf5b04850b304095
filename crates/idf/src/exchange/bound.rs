//! How much picture a byte of a file can hold, by how its samples are coded.

use crate::error::Cause;
use crate::image::MOST_SAMPLES;
use crate::memory;

/// A bound on pixels by the length of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    /// Most pixels for each byte.
    PerByte(u64),
    /// None: a few bytes may stand for any number.
    None,
}

/// Most pixels of a small file where nothing bounds what a byte stands for.
const MOST_UNBOUNDED: u64 = 1 << 26;

impl Bound {
    /// Samples as they are, of a bit at least.
    pub(super) const BITS: Self = Self::PerByte(8);
    /// Deflate makes at most 1032 bytes of one (RFC 1951: 258 bytes from a length and a distance
    /// code of one bit each).
    pub(super) const DEFLATE: Self = Self::PerByte(1032 * 8);
    /// A code of 12 bits stands for at most 2^12 - 2 bytes, of 8 samples each.
    pub(super) const LZW: Self = Self::PerByte(4096 * 8 * 8 / 12);
    /// A block of 64 samples takes two codes of a bit, its difference and its end; four blocks
    /// where colours have half the columns and rows.
    pub(super) const JPEG: Self = Self::PerByte(64 * 8);
    /// A run of 128 bytes takes two.
    const PACK_BITS: Self = Self::PerByte(64 * 8);
    /// A macroblock of 256 pixels takes 3 bits: its modes have fixed chances (RFC 6386, 11.2), of
    /// which the best are 1.2 + 0.7 + 0.6 bits for luma and 0.8 for chroma.
    const VP8: Self = Self::PerByte(256 * 8 / 3);

    /// Refuses a size that a file of `length` bytes cannot hold, before memory is taken.
    pub(super) fn check(
        self,
        [columns, rows]: [u64; 2],
        channels: u64,
        length: usize,
    ) -> Result<(), Cause> {
        let length = length as u64;
        let most = match self {
            Self::PerByte(most) => length.saturating_mul(most),
            Self::None => MOST_UNBOUNDED.max(length.saturating_mul(1032 * 8)),
        };
        let pixels = columns.saturating_mul(rows);
        if pixels > most || pixels.saturating_mul(channels) > MOST_SAMPLES {
            return Err(format!(
                "{columns} x {rows} pixels of {channels} channels, expected at most {most} pixels \
                 in {length} bytes and {MOST_SAMPLES} samples"
            )
            .into());
        }
        // As the decoder gives them, and as planes; a byte each at least.
        Ok(memory::check(pixels.saturating_mul(channels).saturating_mul(2))?)
    }
}

/// The bound of a TIFF by the compression of its first picture (TIFF 6.0, sections 2 and 8); none
/// for fax, where a code gives a row of any length for a bit, and where it cannot be told.
pub(super) fn tiff(bytes: &[u8]) -> Bound {
    match compression(bytes) {
        // Nothing said is as it is.
        Some(1) => Bound::BITS,
        Some(5) => Bound::LZW,
        Some(7) => Bound::JPEG,
        Some(8 | 32_946) => Bound::DEFLATE,
        Some(32_773) => Bound::PACK_BITS,
        _ => Bound::None,
    }
}

/// The value of tag 259, or 1 without it; nothing where there is no table of tags.
fn compression(bytes: &[u8]) -> Option<u32> {
    let is_little = match bytes.get(..4)? {
        b"II*\0" => true,
        b"MM\0*" => false,
        _ => return None,
    };
    let number = |at: usize, length: usize| {
        let bytes = bytes.get(at..at.checked_add(length)?)?;
        let push = |number: u32, byte: &u8| number << 8 | u32::from(*byte);
        Some(if is_little { bytes.iter().rev().fold(0, push) } else { bytes.iter().fold(0, push) })
    };
    let table = usize::try_from(number(4, 4)?).ok()?;
    let first = table.checked_add(2)?;
    for entry in 0..usize::try_from(number(table, 2)?).ok()? {
        let entry = first.checked_add(12 * entry)?;
        if number(entry, 2)? == 259 {
            // One number of 2 bytes is on the left of the place for 4.
            return number(entry + 8, if number(entry + 2, 2)? == 3 { 2 } else { 4 });
        }
    }
    Some(1)
}

/// The bound of a `WebP`: none for a lossless one, as codes of no bits at all are allowed there.
pub(super) fn webp(bytes: &[u8]) -> Bound {
    // Of an extended file the first picture comes later; it may be lossless.
    match bytes.get(12..16) {
        Some(b"VP8 ") => Bound::VP8,
        _ => Bound::None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::image::codecs::tiff::TiffEncoder;
    use ::image::{ExtendedColorType, ImageEncoder};

    #[test]
    fn a_size_is_bounded_by_the_length_of_the_file() {
        let fits = |bound: Bound, pixels| bound.check([pixels, 1], 3, 100).is_ok();
        for (bound, most) in [(Bound::BITS, 800), (Bound::LZW, 2_184_500), (Bound::VP8, 68_200)] {
            assert!(fits(bound, most) && !fits(bound, most + 1), "{bound:?}");
        }
        assert!(fits(Bound::None, 1 << 26) && !fits(Bound::None, (1 << 26) + 1));
    }

    #[test]
    fn the_compression_of_a_tiff_is_found() {
        let mut file = std::io::Cursor::new(Vec::new());
        let encoder = TiffEncoder::new(&mut file);
        encoder.write_image(&[7; 18], 3, 2, ExtendedColorType::Rgb8).unwrap();
        let file = file.into_inner();
        assert_eq!(tiff(&file), Bound::BITS);
        let big = |number: u16| number.to_be_bytes();
        for (number, bound) in [
            (1, Bound::BITS),
            (4, Bound::None),
            (5, Bound::LZW),
            (7, Bound::JPEG),
            (8, Bound::DEFLATE),
            (32_773, Bound::PACK_BITS),
            (9, Bound::None),
        ] {
            // A tag before, and this one: a number of 2 bytes, one of them.
            let parts = [*b"MM", big(42), big(0), big(8), big(2)];
            let tags = [[256, 3, 0, 1, 3, 0], [259, 3, 0, 1, number, 0]].map(|tag| tag.map(big));
            let file = [parts.as_flattened(), tags.as_flattened().as_flattened()].concat();
            assert_eq!(tiff(&file), bound, "{number}");
            assert_eq!(tiff(&file[..file.len() - 6]), Bound::None, "cut off");
        }
        assert_eq!(tiff(b"MM\0*\0\0\0\x08\0\0"), Bound::BITS, "no tags");
        assert_eq!(tiff(b"II+\0"), Bound::None);
        assert_eq!(tiff(b"II*\0\xff\xff\xff\xff"), Bound::None);
    }

    #[test]
    fn only_a_lossy_webp_is_bounded() {
        assert_eq!(webp(b"RIFF\x10\0\0\0WEBPVP8 "), Bound::VP8);
        assert_eq!(webp(b"RIFF\x10\0\0\0WEBPVP8L"), Bound::None);
        assert_eq!(webp(b"RIFF"), Bound::None);
    }
}
