//! `Lut`: a table of up to 256 colours.

use std::path::Path;

use crate::error::{ReadError, WriteError};
use crate::file;
use crate::transfer::{Transfer, rounded_8};

/// A table of 1 to 256 colours, as stored by the image's transfer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lut {
    colors: Vec<[u8; 3]>,
}

impl Lut {
    /// Most colours.
    pub const MOST: usize = 256;

    /// A table, or nothing where there are no colours or more than 256.
    pub fn new(colors: Vec<[u8; 3]>) -> Option<Self> {
        (1..=Self::MOST).contains(&colors.len()).then_some(Self { colors })
    }

    /// The colours, in order.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// A table from three rows of bytes, R, G and B, as a data file holds them; nothing where they
    /// are not three rows of 1 to 256.
    pub fn from_rows(rows: &[u8]) -> Option<Self> {
        let columns = rows.len() / 3;
        if rows.len() != columns * 3 {
            return None;
        }
        let color = |at| std::array::from_fn(|channel| rows[channel * columns + at]);
        Self::new((0..columns).map(color).collect())
    }

    /// Three rows of bytes: R, G and B.
    pub fn to_rows(&self) -> Vec<u8> {
        (0..3).flat_map(|channel| self.colors.iter().map(move |color| color[channel])).collect()
    }

    /// Reads a bare table: a file of three rows of as many bytes as there are colours.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is not three rows of 1 to 256 bytes.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let length = file::length(path)?;
        let bytes = if length <= 3 * 256 { file::contents(path, length)? } else { Vec::new() };
        Self::from_rows(&bytes).ok_or_else(|| ReadError::Length {
            path: path.into(),
            found: length,
            expected: "three rows of 1 to 256 bytes".into(),
        })
    }

    /// Writes a bare table.
    ///
    /// # Errors
    ///
    /// If the file cannot be written; the old one is then untouched.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        file::replace(path, &self.to_rows())
    }

    /// The same light, stored by another transfer.
    pub(crate) fn restored(&self, from: Transfer, to: Transfer) -> Self {
        let byte = |stored| rounded_8(to, from.decode(f64::from(stored) / 255.0));
        Self { colors: self.colors.iter().map(|color| color.map(byte)).collect() }
    }

    /// The number of colours, as the description has it.
    pub(crate) fn columns(&self) -> u32 {
        u32::try_from(self.colors.len()).expect("at most 256 colours")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_three_rows() {
        let lut = Lut::new(vec![[1, 2, 3], [4, 5, 6]]).unwrap();
        assert_eq!(lut.to_rows(), [1, 4, 2, 5, 3, 6]);
        assert_eq!(Lut::from_rows(&[1, 4, 2, 5, 3, 6]), Some(lut));
    }

    #[test]
    fn a_table_has_1_to_256_colors() {
        assert_eq!(Lut::from_rows(&[]), None);
        assert_eq!(Lut::from_rows(&[1, 2, 3, 4]), None);
        assert!(Lut::from_rows(&[0; 768]).is_some());
        assert_eq!(Lut::from_rows(&[0; 771]), None);
    }

    #[test]
    fn a_bare_table_comes_back_and_other_lengths_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lut");
        let lut = Lut::new(vec![[9, 8, 7]; 256]).unwrap();
        lut.write(&path).unwrap();
        assert_eq!(Lut::read(&path).unwrap(), lut);
        for length in [0, 4, 771] {
            std::fs::write(&path, vec![0; length]).unwrap();
            let message = Lut::read(&path).unwrap_err().to_string();
            assert!(
                message.ends_with(&format!(
                    "x.lut: {length} bytes, expected three rows of 1 to 256 bytes"
                )),
                "{message}"
            );
        }
    }
}
