//! The table of formats: endings, first bytes, and how much picture a byte of a file can hold.

use std::path::Path;

use super::bound::Bound;
use crate::error::Cause;

/// One row of [`TABLE`].
struct Row {
    format: Format,
    /// For messages.
    name: &'static str,
    endings: &'static [&'static str],
    /// What a file begins with.
    magic: &'static [&'static [u8]],
    is_written: bool,
    is_plain: bool,
    /// How much picture a byte of a file can hold.
    bound: Bound,
}

macro_rules! formats {
    ($($(#[$about:meta])* $format:ident $name:literal $endings:expr, $magic:expr,
       written: $written:literal, plain: $plain:literal, bound: $bound:expr;)*) => {
        /// A format, by the ending of a file's name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Format {
            $($(#[$about])* $format,)*
        }

        /// All formats. A new one is a new row.
        const TABLE: &[Row] = &[
            $(Row {
                format: Format::$format,
                name: $name,
                endings: &$endings,
                magic: &$magic,
                is_written: $written,
                is_plain: $plain,
                bound: $bound,
            },)*
        ];
    };
}

formats! {
    /// This crate's own.
    Idf "IDF" ["idf"], [],
        written: true, plain: false, bound: Bound::PerByte(0);
    /// Portable Network Graphics, 8 or 16 bits or indexed, straight coverage.
    Png "PNG" ["png"], [b"\x89PNG\r\n\x1a\n"],
        written: true, plain: true, bound: Bound::DEFLATE;
    /// `OpenEXR`, 32-bit floating point, linear and premultiplied; measured channels too.
    Exr "OpenEXR" ["exr"], [b"\x76\x2f\x31\x01"],
        written: true, plain: false, bound: Bound::DEFLATE;
    /// Portable any map, 8 or 16 bits, opaque.
    Pnm "PNM" ["ppm", "pgm", "pbm", "pnm"], [b"P1", b"P2", b"P3", b"P4", b"P5", b"P6"],
        written: true, plain: true, bound: Bound::BITS;
    /// Portable arbitrary map, 8 or 16 bits, straight coverage.
    Pam "PAM" ["pam"], [b"P7"],
        written: true, plain: true, bound: Bound::BITS;
    /// Graphics Interchange Format, indexed; of an animation the first picture.
    Gif "GIF" ["gif"], [b"GIF87a", b"GIF89a"],
        written: true, plain: true, bound: Bound::LZW;
    /// JPEG; only read.
    Jpeg "JPEG" ["jpg", "jpeg"], [b"\xff\xd8\xff"],
        written: false, plain: true, bound: Bound::JPEG;
    /// Tagged Image File Format; only read.
    Tiff "TIFF" ["tif", "tiff"], [b"II*\0", b"MM\0*"],
        written: false, plain: true, bound: Bound::None;
    /// `WebP`; only read.
    WebP "WebP" ["webp"], [b"RIFF"],
        written: false, plain: true, bound: Bound::None;
}

impl Format {
    /// The format of a file with this name; without an ending, this crate's own.
    pub fn of(path: &Path) -> Option<Self> {
        let Some(ending) = path.extension() else { return Some(Self::Idf) };
        let ending = ending.to_str()?.to_ascii_lowercase();
        TABLE.iter().find(|row| row.endings.contains(&ending.as_str())).map(|row| row.format)
    }

    /// The format of a file that begins with `bytes`.
    pub fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let found = |row: &&Row| row.magic.iter().any(|magic| bytes.starts_with(magic));
        TABLE.iter().find(found).map(|row| row.format)
    }

    /// Whether pictures in it are usually opaque, so that a renderer paints the background in.
    pub fn is_plain(self) -> bool {
        self.row().is_plain
    }

    /// Whether it can be written.
    pub fn is_written(self) -> bool {
        self.row().is_written
    }

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// Refuses a size that a file of `length` bytes cannot hold, before memory is taken.
    pub(super) fn check_samples(
        self,
        size: [u64; 2],
        channels: u64,
        length: usize,
    ) -> Result<(), Cause> {
        self.row().bound.check(size, channels, length)
    }
}

/// Endings of the names of files that can be read, or only of those that can be written.
pub(crate) fn endings(written: bool) -> String {
    let rows = TABLE.iter().filter(|row| row.is_written || !written);
    let endings = rows.flat_map(|row| row.endings).map(|ending| format!(".{ending}"));
    endings.collect::<Vec<_>>().join(" ")
}

/// Names of the formats that are known by their first bytes.
pub(super) fn names() -> String {
    let names: Vec<&str> =
        TABLE.iter().filter(|row| !row.magic.is_empty()).map(|row| row.name).collect();
    names.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_the_order_of_the_formats_and_distinct() {
        let mut endings = Vec::new();
        for (position, row) in TABLE.iter().enumerate() {
            assert_eq!(row.format as usize, position, "{}", row.name);
            for ending in row.endings {
                assert!(!endings.contains(ending), "{ending}");
                endings.push(ending);
                let name = format!("x.{}", ending.to_uppercase());
                assert_eq!(Format::of(Path::new(&name)), Some(row.format));
            }
            for magic in row.magic {
                assert_eq!(Format::of_bytes(magic), Some(row.format), "{}", row.name);
            }
        }
    }

    #[test]
    fn sizes_are_bounded_by_the_length_of_the_file() {
        let check = |format: Format, pixels| format.check_samples([pixels, 1], 3, 100).is_ok();
        for (format, most) in [(Format::Png, 825_600), (Format::Pnm, 800), (Format::Gif, 2_184_500)]
        {
            assert!(check(format, most) && !check(format, most + 1), "{format:?}");
        }

        assert!(Format::Png.check_samples([u64::MAX, 2], 1, 100).is_err());
    }
}
