//! `Table`: the colours that a picture gets by with.

use idf::Lut;

/// 1 to 256 colours (sRGB bytes, straight, with alpha), in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table(Vec<[u8; 4]>);

impl Table {
    /// A table, or nothing where there are no colours or more than 256.
    pub fn new(colors: Vec<[u8; 4]>) -> Option<Self> {
        (1..=Lut::MOST).contains(&colors.len()).then_some(Self(colors))
    }

    /// The colours, in order.
    pub fn colors(&self) -> &[[u8; 4]] {
        &self.0
    }
}

impl From<&Lut> for Table {
    fn from(lut: &Lut) -> Self {
        Self(lut.entries().collect())
    }
}

impl From<&Table> for Lut {
    fn from(table: &Table) -> Self {
        Self::with_coverage(table.0.clone()).expect("1 to 256 colours on both sides")
    }
}
