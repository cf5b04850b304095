//! A case: what is promised of it, and how that is measured.

use std::fmt;

/// One pixel of this many may differ in pictures that are alike.
const SHARE: u64 = 10_000;
/// And in those that are nearly so.
const NEARLY: u64 = 1000;

/// What is promised of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Promise {
    /// Every pixel is the oracle's, but where moving the rays by a few rounding bounds shows the oracle another colour.
    Right,
    /// The same bytes.
    Same,
    /// At most one pixel of 10 000 differs by more than a step of 255.
    Alike,
    /// At most one pixel of 1000 does.
    Nearly,
    /// An error, in the unit of the case, is at most this.
    Within(f64),
    /// There is an error or a warning with these words.
    Said(&'static str),
}

impl fmt::Display for Promise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Right => write!(f, "right"),
            Self::Same => write!(f, "same bytes"),
            Self::Alike => write!(f, "alike"),
            Self::Nearly => write!(f, "nearly alike"),
            Self::Within(most) => write!(f, "≤ {}", figure(*most)),
            Self::Said(words) => write!(f, "“{words}”"),
        }
    }
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Found {
    /// Pixels that are not as promised, of how many, and those on edges, which are left out.
    Pixels { wrong: u64, of: u64, edges: u64 },
    /// The largest error.
    Error(f64),
    /// The largest error of each decade, from 10⁰ on.
    Decades(Vec<f64>),
    /// Messages.
    Said(String),
}

impl Found {
    /// No pixel yet.
    pub(crate) const NONE: Self = Self::Pixels { wrong: 0, of: 0, edges: 0 };

    /// Pixels that differ, of how many.
    pub(crate) fn differing(wrong: usize, of: usize) -> Self {
        Self::Pixels { wrong: wrong as u64, of: of as u64, edges: 0 }
    }

    /// Both together.
    pub(crate) fn and(self, other: Self) -> Self {
        match (self, other) {
            (
                Self::Pixels { wrong, of, edges },
                Self::Pixels { wrong: more, of: all, edges: rims },
            ) => Self::Pixels { wrong: wrong + more, of: of + all, edges: edges + rims },
            (Self::Error(a), Self::Error(b)) => {
                Self::Error(if b > a || b.is_nan() { b } else { a })
            }
            (found, _) => found,
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pixels { wrong, of, edges: 0 } => write!(f, "{wrong} of {of}"),
            Self::Pixels { wrong, of, edges } => write!(f, "{wrong} of {of}, {edges} on edges"),
            Self::Error(error) => write!(f, "{}", figure(*error)),
            Self::Decades(errors) => {
                let all: Vec<String> = errors.iter().map(|error| figure(*error)).collect();
                write!(f, "{}", all.join(", "))
            }
            Self::Said(_) => write!(f, "said"),
        }
    }
}

/// A number in two digits.
pub(crate) fn figure(number: f64) -> String {
    if number <= 0.0 {
        "0".to_owned()
    } else if (0.01..1e4).contains(&number) {
        let digits = if number < 1.0 { 2 } else { usize::from(number < 10.0) };
        format!("{number:.digits$}")
    } else {
        format!("{number:.1e}")
    }
}

/// What another program makes of a case.
#[derive(Clone, Debug)]
pub(crate) enum Peer {
    /// Pixels that differ from its own picture of the scene as it is written.
    Itself(Written),
    /// Pixels that nothing in ours is like, in its place or beside it.
    Ours(Written),
    /// Pixels that nothing is like in its own picture with other numbers, at which it still draws what is there.
    Own(Written, Written),
    /// Pixels that differ from those of a block when so many operators leave it as it is.
    Chain(u32),
}

/// A scene of `scenes/extreme` with other numbers in it.
#[derive(Clone, Debug)]
pub(crate) struct Written {
    pub(crate) file: &'static str,
    pub(crate) definitions: Vec<(&'static str, f64)>,
}

/// A row of the table.
pub(crate) struct Case {
    /// Heading of the page that it stands under.
    pub(crate) section: &'static str,
    pub(crate) name: String,
    pub(crate) promise: Promise,
    pub(crate) measure: Box<dyn Fn() -> Found>,
    pub(crate) peer: Option<Peer>,
}

impl Case {
    pub(crate) fn new(
        section: &'static str,
        name: impl Into<String>,
        promise: Promise,
        measure: impl Fn() -> Found + 'static,
    ) -> Self {
        Self { section, name: name.into(), promise, measure: Box::new(measure), peer: None }
    }

    pub(crate) fn beside(self, peer: Peer) -> Self {
        Self { peer: Some(peer), ..self }
    }

    /// Whether what was found is what is promised.
    pub(crate) fn holds(&self, found: &Found) -> bool {
        match (self.promise, found) {
            (Promise::Right | Promise::Same, Found::Pixels { wrong, of, .. }) => {
                *wrong == 0 && *of > 0
            }
            (Promise::Alike, Found::Pixels { wrong, of, .. }) => wrong * SHARE <= *of && *of > 0,
            (Promise::Nearly, Found::Pixels { wrong, of, .. }) => wrong * NEARLY <= *of && *of > 0,
            (Promise::Within(most), Found::Error(error)) => *error <= most,
            (Promise::Within(most), Found::Decades(errors)) => {
                !errors.is_empty() && errors.iter().all(|error| *error <= most)
            }
            (Promise::Said(words), Found::Said(text)) => text.contains(words),
            _ => false,
        }
    }
}
