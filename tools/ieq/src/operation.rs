//! The table of operations: what each is called, takes and does.

use std::error::Error;
use std::fmt;

use idf::Samples;

use crate::light::Tones;
use crate::{clahe, color, curve, equalize};

/// A number that an operation takes.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What it is called. With a default it is an option of this name, else a place in the row.
    pub name: &'static str,
    /// Least and greatest value.
    pub range: [f64; 2],
    /// Whether it is a whole number.
    pub whole: bool,
    /// Its value where nothing is said; without one it has to be given.
    pub default: Option<f64>,
    /// What it does, for the help.
    pub about: &'static str,
}

/// What an operation looks at, and so what code it is.
#[derive(Clone, Copy, Debug)]
pub enum Work {
    /// The display value of one sample and the parameters give the new one.
    Curve(fn(f64, &[f64]) -> f64),
    /// The parameters give what a and b of Oklab become: the rows of a matrix.
    Color(fn(&[f64]) -> [[f64; 2]; 2]),
    /// All display values of a channel, or of luma, at once.
    Tones(fn(&Tones<'_>, &[f64]) -> Samples),
    /// Counts, and a picture of them.
    Histogram,
}

/// One row of [`TABLE`].
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The word on the command line.
    pub word: &'static str,
    /// What it does, for the help.
    pub about: &'static str,
    /// The numbers it takes, in order.
    pub parameters: &'static [Parameter],
    /// What it does.
    pub work: Work,
}

const fn number(name: &'static str, range: [f64; 2], about: &'static str) -> Parameter {
    Parameter { name, range, whole: false, default: None, about }
}

const fn option(
    name: &'static str,
    range: [f64; 2],
    default: f64,
    about: &'static str,
) -> Parameter {
    Parameter { name, range, whole: false, default: Some(default), about }
}

const fn whole(
    name: &'static str,
    range: [f64; 2],
    default: f64,
    about: &'static str,
) -> Parameter {
    Parameter { name, range, whole: true, default: Some(default), about }
}

/// All operations. A new operation is a new row.
pub const TABLE: &[Row] = &[
    Row {
        word: "equalize",
        about: "Spread tones so that all are equally frequent",
        parameters: &[],
        work: Work::Tones(equalize::equalized),
    },
    Row {
        word: "clahe",
        about: "Equalise within tiles, with limited contrast",
        parameters: &[
            whole("tiles", [1.0, 64.0], 8.0, "Tiles across and down, of whole pixels"),
            option("clip", [0.0, 1.0], 0.01, "Largest share of a tile in one bin; 0 is no limit"),
            whole("bins", [2.0, 4096.0], 256.0, "Bins of a tile's histogram"),
        ],
        work: Work::Tones(clahe::equalized),
    },
    Row {
        word: "gamma",
        about: "Raise display values to 1/G: above 1 is brighter",
        parameters: &[number("G", [0.01, 100.0], "Exponent")],
        work: Work::Curve(curve::gamma),
    },
    Row {
        word: "levels",
        about: "Spread the display values from LO to HI over 0 to 1",
        parameters: &[
            number("LO", [-100.0, 100.0], "Display value that becomes black"),
            number("HI", [-100.0, 100.0], "Display value that becomes white"),
        ],
        work: Work::Curve(curve::levels),
    },
    Row {
        word: "brightness",
        about: "Add to display values",
        parameters: &[number("B", [-1.0, 1.0], "What is added")],
        work: Work::Curve(curve::brightness),
    },
    Row {
        word: "contrast",
        about: "Scale display values about 0.5",
        parameters: &[number("C", [0.0, 100.0], "Factor")],
        work: Work::Curve(curve::contrast),
    },
    Row {
        word: "saturation",
        about: "Scale the chroma of Oklch; lightness and hue stay",
        parameters: &[number("S", [0.0, 100.0], "Factor")],
        work: Work::Color(color::saturation),
    },
    Row {
        word: "hue",
        about: "Turn the hue of Oklch; lightness stays",
        parameters: &[number("H", [-360.0, 360.0], "Angle in degrees, from red to yellow")],
        work: Work::Color(color::hue),
    },
    Row {
        word: "histogram",
        about: "Count display values: a table on standard output, a picture with -o",
        parameters: &[whole("bins", [1.0, 65536.0], 256.0, "Bins over the range of values")],
        work: Work::Histogram,
    },
];

/// A row of [`TABLE`] with its numbers.
#[derive(Clone, Debug)]
pub struct Operation {
    row: &'static Row,
    parameters: Vec<f64>,
    /// Each channel by itself, where luma would be looked at.
    pub per_channel: bool,
}

/// Why an operation is none.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum OperationError {
    /// No row has this word.
    Unknown(String),
    /// Too few or too many numbers.
    Count {
        /// Numbers that were given.
        found: usize,
        /// Numbers that the operation takes, with those that have a default and without.
        expected: [usize; 2],
    },
    /// A number is out of its range, or not whole.
    Number {
        /// Its name.
        name: &'static str,
        /// What was given.
        found: f64,
        /// Least and greatest value.
        range: [f64; 2],
    },
}

impl Parameter {
    /// Checks a value.
    ///
    /// # Errors
    ///
    /// If it is out of range, or should be whole and is not.
    pub fn checked(&self, found: f64) -> Result<f64, OperationError> {
        let [least, most] = self.range;
        let fits = (least..=most).contains(&found) && (!self.whole || found.fract() == 0.0);
        let error = OperationError::Number { name: self.name, found, range: self.range };
        if fits { Ok(found) } else { Err(error) }
    }
}

impl Row {
    /// Whether the operation looks at luma unless it is told to take each channel by itself.
    pub fn looks_at_luma(&self) -> bool {
        matches!(self.work, Work::Tones(_))
    }
}

impl Operation {
    /// The operation that `word` names, with its numbers in the order of the row; those with a
    /// default may be left out at the end.
    ///
    /// ```
    /// use ieq::Operation;
    ///
    /// assert!(Operation::new("gamma", &[2.2]).is_ok());
    /// assert!(Operation::new("gamma", &[-1.0]).is_err());
    /// ```
    ///
    /// # Errors
    ///
    /// If there is no such operation, or numbers are missing, too many or out of range.
    pub fn new(word: &str, numbers: &[f64]) -> Result<Self, OperationError> {
        let row = TABLE.iter().find(|row| row.word == word);
        let row = row.ok_or_else(|| OperationError::Unknown(word.into()))?;
        let required = row.parameters.iter().filter(|p| p.default.is_none()).count();
        let expected = [required, row.parameters.len()];
        if !(required..=row.parameters.len()).contains(&numbers.len()) {
            return Err(OperationError::Count { found: numbers.len(), expected });
        }
        let given = numbers.iter().map(|&number| Some(number)).chain(std::iter::repeat(None));
        let parameters = row.parameters.iter().zip(given).filter_map(|(parameter, given)| {
            given.or(parameter.default).map(|value| parameter.checked(value))
        });
        Ok(Self { row, parameters: parameters.collect::<Result<_, _>>()?, per_channel: false })
    }

    /// Its row.
    pub fn row(&self) -> &'static Row {
        self.row
    }

    /// Its numbers, one for each parameter of the row.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }
}

impl fmt::Display for OperationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(word) => write!(f, "no operation is called `{word}`"),
            Self::Count { found, expected: [least, most] } => {
                write!(f, "expected {least} to {most} numbers, found {found}")
            }
            Self::Number { name, found, range: [least, most] } => {
                write!(f, "expected {name} from {least} to {most}, found {found}")
            }
        }
    }
}

impl Error for OperationError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_distinct_and_defaults_are_in_range() {
        for (position, row) in TABLE.iter().enumerate() {
            assert!(TABLE[..position].iter().all(|other| other.word != row.word), "{}", row.word);
            let mut optional = false;
            for parameter in row.parameters {
                optional |= parameter.default.is_some();
                assert_eq!(parameter.default.is_some(), optional, "options are last: {}", row.word);
                if let Some(default) = parameter.default {
                    assert_eq!(parameter.checked(default), Ok(default), "{}", row.word);
                }
            }
        }
    }

    #[test]
    fn numbers_are_checked() {
        let new = |word, numbers: &[f64]| Operation::new(word, numbers).map(|o| o.parameters);
        assert_eq!(new("levels", &[0.2, 0.8]), Ok(vec![0.2, 0.8]));
        assert_eq!(new("clahe", &[4.0]), Ok(vec![4.0, 0.01, 256.0]));
        assert_eq!(new("twirl", &[]), Err(OperationError::Unknown("twirl".into())));
        let count = OperationError::Count { found: 1, expected: [2, 2] };
        assert_eq!(new("levels", &[0.2]), Err(count));
        let number = OperationError::Number { name: "tiles", found: 1.5, range: [1.0, 64.0] };
        assert_eq!(new("clahe", &[1.5]), Err(number));
        assert!(new("gamma", &[f64::NAN]).is_err());
    }
}
