//! `Lut`: a table of up to 256 colours.

use std::path::Path;

use crate::error::{ReadError, WriteError};
use crate::file;
use crate::transfer::{Transfer, rounded_8};

/// A table of 1 to 256 colours, as stored by the image's transfer. Where it has coverage, its
/// colours are straight, whatever the image's matte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lut {
    colors: Vec<[u8; 3]>,
    /// As many as colours, or none where all are opaque.
    coverage: Vec<u8>,
}

impl Lut {
    /// Most colours.
    pub const MOST: usize = 256;

    /// An opaque table, or nothing where there are no colours or more than 256.
    pub fn new(colors: Vec<[u8; 3]>) -> Option<Self> {
        let fits = (1..=Self::MOST).contains(&colors.len());
        fits.then_some(Self { colors, coverage: Vec::new() })
    }

    /// A table of straight colours with their coverage, or nothing where there are none or more
    /// than 256. Where all are opaque, it is the same as the opaque table.
    pub fn with_coverage(entries: Vec<[u8; 4]>) -> Option<Self> {
        let mut lut = Self::new(entries.iter().map(|&[r, g, b, _]| [r, g, b]).collect())?;
        if entries.iter().any(|entry| entry[3] < u8::MAX) {
            lut.coverage = entries.iter().map(|entry| entry[3]).collect();
        }
        Some(lut)
    }

    /// The colours, in order.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// The coverage of each colour, 0 to 255 for 0 to 1; nothing where all are opaque.
    pub fn coverage(&self) -> Option<&[u8]> {
        (!self.coverage.is_empty()).then_some(&self.coverage)
    }

    /// The colours with their coverage, in order.
    pub fn entries(&self) -> impl Iterator<Item = [u8; 4]> + '_ {
        let coverage = self.coverage.iter().copied().chain(std::iter::repeat(u8::MAX));
        self.colors.iter().zip(coverage).map(|(&[r, g, b], coverage)| [r, g, b, coverage])
    }

    /// An opaque table from three rows of bytes, R, G and B, as a data file holds them; nothing
    /// where they are not three rows of 1 to 256.
    pub fn from_rows(rows: &[u8]) -> Option<Self> {
        Self::new(across(rows)?)
    }

    /// A table from four rows of bytes, R, G, B and coverage; nothing where they are not four rows
    /// of 1 to 256.
    pub fn from_four_rows(rows: &[u8]) -> Option<Self> {
        Self::with_coverage(across(rows)?)
    }

    /// Rows of bytes, R, G and B, and coverage where not all are opaque.
    pub fn to_rows(&self) -> Vec<u8> {
        let mut rows = self.color_rows();
        rows.extend(&self.coverage);
        rows
    }

    fn color_rows(&self) -> Vec<u8> {
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

    /// Writes a bare table: the colours alone, without coverage.
    ///
    /// # Errors
    ///
    /// If the file cannot be written; the old one is then untouched.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        file::replace(path, &self.color_rows())
    }

    /// The same light, stored by another transfer.
    pub(crate) fn restored(&self, from: Transfer, to: Transfer) -> Self {
        let byte = |stored| rounded_8(to, from.decode(f64::from(stored) / 255.0));
        let colors = self.colors.iter().map(|color| color.map(byte)).collect();
        Self { colors, coverage: self.coverage.clone() }
    }

    /// The number of colours, as the description has it.
    pub(crate) fn columns(&self) -> u32 {
        u32::try_from(self.colors.len()).expect("at most 256 colours")
    }

    /// The number of rows, as the description has it.
    pub(crate) fn rows(&self) -> u32 {
        if self.coverage.is_empty() { 3 } else { 4 }
    }
}

/// The columns of `N` rows of bytes.
fn across<const N: usize>(rows: &[u8]) -> Option<Vec<[u8; N]>> {
    let columns = rows.len() / N;
    let entry = |at| std::array::from_fn(|row| rows[row * columns + at]);
    (rows.len() == columns * N).then(|| (0..columns).map(entry).collect())
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
    fn a_table_with_coverage_is_four_rows() {
        let entries = vec![[1, 2, 3, 255], [4, 5, 6, 0]];
        let lut = Lut::with_coverage(entries.clone()).unwrap();
        assert_eq!(lut.to_rows(), [1, 4, 2, 5, 3, 6, 255, 0]);
        assert_eq!(lut.coverage(), Some(&[255, 0][..]));
        assert_eq!(lut.entries().collect::<Vec<_>>(), entries);
        assert_eq!(Lut::from_four_rows(&[1, 4, 2, 5, 3, 6, 255, 0]), Some(lut));
        assert_eq!(Lut::from_four_rows(&[1; 6]), None);
    }

    #[test]
    fn a_table_whose_entries_are_opaque_has_no_coverage() {
        let lut = Lut::with_coverage(vec![[1, 2, 3, 255]]).unwrap();
        assert_eq!((lut.coverage(), lut.rows()), (None, 3));
        assert_eq!(lut.entries().collect::<Vec<_>>(), [[1, 2, 3, 255]]);
        assert_eq!(Some(lut), Lut::new(vec![[1, 2, 3]]));
        assert_eq!(Lut::with_coverage(Vec::new()), None);
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
