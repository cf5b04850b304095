//! The table of plane kinds: what an image can hold, and how each is treated.

use std::fmt;

/// What the samples of a plane mean, and so what may be done to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Light: decoded by the image's transfer, premultiplied where there is coverage.
    Light,
    /// Share of the pixel that is covered, 0 to 1. Never decoded.
    Coverage,
    /// Index into the `lut`; 8 bits deep.
    Index,
    /// Measured values, kept as they are.
    Data,
    /// The colour table; it has its own size.
    Table,
    /// Text, not samples.
    Text,
}

/// One row of [`TABLE`].
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The kind of this row.
    pub kind: Kind,
    /// The word in the description, and the ending of the data file.
    pub word: &'static str,
    /// How the samples are treated.
    pub role: Role,
    /// What it holds, for messages and help texts.
    pub about: &'static str,
}

macro_rules! planes {
    ($($kind:ident $word:literal $role:ident $about:literal;)*) => {
        /// Kind of a plane; the rows of [`TABLE`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Kind {
            $(#[doc = $about] $kind,)*
        }

        /// All plane kinds. A new kind is a new row.
        pub const TABLE: &[Row] = &[
            $(Row { kind: Kind::$kind, word: $word, role: Role::$role, about: $about },)*
        ];
    };
}

planes! {
    Red "red" Light    "red light";
    Grn "grn" Light    "green light";
    Blu "blu" Light    "blue light";
    Cvg "cvg" Coverage "coverage";
    Grg "grg" Light    "grey light";
    Lut "lut" Table    "colour table";
    Enc "enc" Index    "indices into the colour table";
    Dep "dep" Data     "distance from the camera";
    Nrx "nrx" Data     "x of the surface normal";
    Nry "nry" Data     "y of the surface normal";
    Nrz "nrz" Data     "z of the surface normal";
    Obj "obj" Data     "number of the object";
    Log "log" Text     "history";
}

/// The three planes of a colour, in the order of a pixel.
pub const COLOR: [Kind; 3] = [Kind::Red, Kind::Grn, Kind::Blu];

impl Kind {
    /// The kind that `word` names.
    pub fn from_word(word: &str) -> Option<Self> {
        TABLE.iter().find(|row| row.word == word).map(|row| row.kind)
    }

    /// The kind's row in [`TABLE`].
    pub fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The word in the description, and the ending of the data file.
    pub fn word(self) -> &'static str {
        self.row().word
    }

    /// How the samples are treated.
    pub fn role(self) -> Role {
        self.row().role
    }

    /// Whether the kind has one sample for each pixel.
    pub fn has_pixels(self) -> bool {
        !matches!(self.role(), Role::Table | Role::Text)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_the_order_of_the_kinds() {
        for (position, row) in TABLE.iter().enumerate() {
            assert_eq!(row.kind as usize, position, "{}", row.word);
        }
    }

    #[test]
    fn words_are_distinct_and_three_small_letters() {
        for (position, row) in TABLE.iter().enumerate() {
            assert!(row.word.len() == 3 && row.word.bytes().all(|b| b.is_ascii_lowercase()));
            assert!(TABLE[..position].iter().all(|other| other.word != row.word), "{}", row.word);
            assert_eq!(Kind::from_word(row.word), Some(row.kind), "{}", row.word);
        }
        assert_eq!(Kind::from_word("idf"), None);
    }
}
