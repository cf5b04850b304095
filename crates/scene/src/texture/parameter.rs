//! Arguments of texture functions: names, defaults, and the values they may have.

use std::fmt;

/// A number that a texture function takes.
///
/// What is written as one argument may be several numbers: a point is three rows of one name, one for each axis.
#[derive(Debug)]
pub struct Parameter {
    /// Its name in the language.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: f64,
    /// The values it may have.
    pub range: Range,
}

/// What an argument may be, beside finite. Printed as it stands in messages: `above 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any number.
    Any,
    /// More than this.
    Above(f64),
    /// From the first to the second, both included.
    Within(f64, f64),
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
    /// One of some words; its place among them is the number.
    Word(&'static [&'static str]),
    /// The coordinate of a point along an axis, 0…2.
    Coordinate(u8),
}

impl Range {
    /// True if `value` is finite and in the range.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        let whole =
            |low: f64, high: f64| libm::floor(value) >= value && low <= value && value <= high;
        value.is_finite()
            && match self {
                Self::Any | Self::Coordinate(_) => true,
                Self::Above(low) => value > low,
                Self::Within(low, high) => low <= value && value <= high,
                Self::Whole(low, high) => whole(f64::from(low), f64::from(high)),
                Self::Word(words) => whole(0.0, words.len() as f64 - 1.0),
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => write!(out, "any number"),
            Self::Above(low) => write!(out, "above {low}"),
            Self::Within(low, high) => write!(out, "from {low} to {high}"),
            Self::Whole(low, high) => write!(out, "a whole number from {low} to {high}"),
            Self::Word(words) => write!(out, "one of {}", words.join(", ")),
            Self::Coordinate(_) => write!(out, "a point"),
        }
    }
}

/// An argument as it is written: its name and its rows.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The place of its first row.
    pub first: usize,
    /// One row, or three for a point.
    pub rows: &'static [Parameter],
}

impl Setting {
    /// The arguments of these rows.
    pub(super) fn all(rows: &'static [Parameter]) -> impl Iterator<Item = Self> {
        let begins = |row: &Parameter| !matches!(row.range, Range::Coordinate(1 | 2));
        (0..rows.len()).filter(move |&first| begins(&rows[first])).map(move |first| {
            let more = rows[first + 1..].iter().take_while(|row| !begins(row)).count();
            Self { first, rows: &rows[first..=first + more] }
        })
    }

    /// Its name in the language.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.rows[0].name
    }

    /// The values it may have.
    #[must_use]
    pub fn range(&self) -> Range {
        self.rows[0].range
    }

    /// Its value where none is given, as it is written.
    #[must_use]
    pub fn default(&self) -> String {
        match (self.range(), self.rows) {
            (Range::Word(words), [row]) => word(words, row.default).to_owned(),
            (_, [row]) => row.default.to_string(),
            (_, rows) => {
                let coordinates: Vec<String> =
                    rows.iter().map(|row| row.default.to_string()).collect();
                format!("({})", coordinates.join(", "))
            }
        }
    }
}

/// The word that a number stands for.
pub(crate) fn word(words: &'static [&'static str], number: f64) -> &'static str {
    words.get(whole(number) as usize).copied().unwrap_or_default()
}

/// The argument of a parameter whose range is [`Range::Whole`] or [`Range::Word`].
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, in its range")]
pub(super) fn whole(argument: f64) -> u32 {
    argument as u32
}
