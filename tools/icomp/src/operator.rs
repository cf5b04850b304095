//! The table of operators.

/// Share of one picture's pixel that survives: `constant + slope · α`, where α is the other
/// picture's coverage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// The share where the other picture covers nothing, 0 or 1.
    pub constant: i8,
    /// What the other picture's coverage adds, -1, 0 or 1.
    pub slope: i8,
}

/// Nothing is left.
pub const NONE: Share = Share { constant: 0, slope: 0 };
/// All is left.
pub const ALL: Share = Share { constant: 1, slope: 0 };
/// What lies inside the other picture.
pub const INSIDE: Share = Share { constant: 0, slope: 1 };
/// What lies outside the other picture.
pub const OUTSIDE: Share = Share { constant: 1, slope: -1 };

/// What an operator does with premultiplied pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The sum of two pictures' shares; coverage beyond 1 is 1.
    Two {
        /// What is left of the first.
        a: Share,
        /// What is left of the second.
        b: Share,
    },
    /// One picture, of which a factor scales some channels.
    One {
        /// Whether it scales light.
        light: bool,
        /// Whether it scales coverage.
        coverage: bool,
    },
}

/// One row of [`OPERATORS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// The word on the command line.
    pub name: &'static str,
    /// What it does.
    pub rule: Rule,
    /// What is seen, for help texts.
    pub about: &'static str,
}

const fn two(name: &'static str, a: Share, b: Share, about: &'static str) -> Operator {
    Operator { name, rule: Rule::Two { a, b }, about }
}

const fn one(name: &'static str, light: bool, coverage: bool, about: &'static str) -> Operator {
    Operator { name, rule: Rule::One { light, coverage }, about }
}

/// All operators (Porter and Duff, "Compositing Digital Images", 1984, sections 4.3 to 4.5). A new
/// operator is a new row.
pub const OPERATORS: &[Operator] = &[
    two("clear", NONE, NONE, "nothing"),
    two("a", ALL, NONE, "A alone"),
    two("b", NONE, ALL, "B alone"),
    two("over", ALL, OUTSIDE, "A in front of B"),
    two("rover", OUTSIDE, ALL, "B in front of A"),
    two("in", INSIDE, NONE, "A where B is"),
    two("rin", NONE, INSIDE, "B where A is"),
    two("out", OUTSIDE, NONE, "A where B is not"),
    two("rout", NONE, OUTSIDE, "B where A is not"),
    two("atop", INSIDE, OUTSIDE, "A in front of B, where B is"),
    two("ratop", OUTSIDE, INSIDE, "B in front of A, where A is"),
    two("xor", OUTSIDE, OUTSIDE, "A where B is not, and B where A is not"),
    two("plus", ALL, ALL, "A and B added"),
    one("darken", true, false, "light of A times F"),
    one("dissolve", true, true, "light and coverage of A times F"),
    one("opaque", false, true, "coverage of A times F; 0 leaves light that covers nothing"),
];

impl Operator {
    /// The operator that `name` names.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        OPERATORS.iter().find(|operator| operator.name == name)
    }
}

impl Share {
    /// The share where the other picture covers `coverage` of `full`, in the same unit.
    #[inline]
    pub fn of(self, coverage: f64, full: f64) -> f64 {
        f64::from(self.constant) * full + f64::from(self.slope) * coverage
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_small() {
        for (position, row) in OPERATORS.iter().enumerate() {
            assert!(row.name.bytes().all(|b| b.is_ascii_lowercase()), "{}", row.name);
            assert!(OPERATORS[..position].iter().all(|other| other.name != row.name));
            assert_eq!(Operator::from_name(row.name), Some(row));
            assert!(!row.about.is_empty());
        }
        assert_eq!(Operator::from_name("under"), None);
    }

    #[test]
    fn shares_stay_between_nothing_and_all() {
        for row in OPERATORS {
            let Rule::Two { a, b } = row.rule else { continue };
            for share in [a, b] {
                for coverage in [0.0, 0.25, 1.0] {
                    assert!((0.0..=1.0).contains(&share.of(coverage, 1.0)), "{}", row.name);
                }
            }
        }
    }
}
