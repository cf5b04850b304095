//! The ways of sampling that a sweep tries, as their words on the command line of `portray`.

use render::{Filter, Rate, Sampling};

/// What points of a plot belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A grid in every pixel.
    Grid,
    /// Divided where corners differ.
    Adaptive,
    /// By lot, the same number in every pixel.
    Stochastic,
    /// By lot until the error is reached.
    Promised,
}

/// A way of sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// What it belongs to.
    pub kind: Kind,
    /// Which points.
    pub sampling: Sampling,
    /// What they count for.
    pub filter: Filter,
}

impl Kind {
    /// All, in the order of plots.
    pub const ALL: [Self; 4] = [Self::Grid, Self::Adaptive, Self::Stochastic, Self::Promised];

    /// The words on a plot.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "none",
            Self::Adaptive => "adaptive",
            Self::Stochastic => "stochastic",
            Self::Promised => "--error",
        }
    }
}

impl Way {
    /// Samples a pixel, or the error, as it stands beside a point.
    #[must_use]
    pub fn label(&self) -> String {
        match self.sampling {
            Sampling::Grid(side) => (side * side).to_string(),
            Sampling::Subdivided { levels } => (1_u64 << (2 * levels)).to_string(),
            Sampling::Stochastic(Rate::Samples(count)) => count.to_string(),
            Sampling::Stochastic(Rate::Error(error)) => error.to_string(),
            Sampling::Stochastic(Rate::Time(time)) => format!("{} s", time.as_secs_f64()),
        }
    }

    /// The options of `portray` that ask for it.
    #[must_use]
    pub fn words(&self) -> String {
        let label = self.label();
        let filter = match self.filter {
            Filter::Box => String::new(),
            filter => format!(" --filter {}", filter_word(filter)),
        };
        let sampling = match self.sampling {
            Sampling::Stochastic(Rate::Error(_)) => format!("--error {label}"),
            Sampling::Stochastic(Rate::Time(time)) => format!("--seconds {}", time.as_secs_f64()),
            _ => format!("--aa {} --samples {label}", self.kind.name()),
        };
        sampling + &filter
    }

    /// A name for files.
    #[must_use]
    pub fn file(&self) -> String {
        self.words().replace("--", "").replace(' ', "-")
    }

    /// Whether another seed is another picture of any scene.
    #[must_use]
    pub fn is_drawn(&self) -> bool {
        matches!(self.sampling, Sampling::Stochastic(_))
    }

    /// Samples of a pixel, or about the most it takes; none if that depends on the scene.
    #[must_use]
    pub fn cost(&self) -> Option<f64> {
        match self.sampling {
            Sampling::Grid(side) => Some(f64::from(side) * f64::from(side)),
            // Most pixels are not divided: less than half of all squares in scenes of nothing but edges.
            Sampling::Subdivided { levels } => Some(1.0 + 0.5 * f64::from(1_u32 << (2 * levels))),
            // Two halves cost about a quarter more than one set.
            Sampling::Stochastic(Rate::Samples(count)) => Some(1.25 * f64::from(count)),
            Sampling::Stochastic(Rate::Error(_) | Rate::Time(_)) => None,
        }
    }
}

/// The word of a filter on the command line.
#[must_use]
pub fn filter_word(filter: Filter) -> &'static str {
    match filter {
        Filter::Box => "box",
        Filter::Tent => "tent",
        Filter::Mitchell => "mitchell",
    }
}

/// All ways with the box filter; coarse ones first, so that a sweep that is stopped has points of all kinds. `quick` has
/// fewer.
#[must_use]
pub fn ways(quick: bool) -> Vec<Way> {
    let grid = |side| (Kind::Grid, Sampling::Grid(side));
    let adaptive = |levels| (Kind::Adaptive, Sampling::Subdivided { levels });
    let lot = |count| (Kind::Stochastic, Sampling::Stochastic(Rate::Samples(count)));
    let error = |error| (Kind::Promised, Sampling::Stochastic(Rate::Error(error)));
    let first = [
        grid(1),
        grid(2),
        adaptive(1),
        lot(4),
        grid(4),
        adaptive(2),
        lot(16),
        error(3.0),
        error(1.0),
        adaptive(3),
    ];
    let rest = [
        adaptive(0),
        grid(3),
        lot(1),
        lot(2),
        lot(8),
        error(10.0),
        grid(6),
        lot(32),
        error(0.5),
        grid(8),
        lot(64),
        error(0.3),
        adaptive(4),
    ];
    let all = first.into_iter().chain(rest).take(if quick { first.len() } else { usize::MAX });
    all.map(|(kind, sampling)| Way { kind, sampling, filter: Filter::Box }).collect()
}

/// Ways with the other filters: each is measured against references of its own.
#[must_use]
pub fn filtered() -> Vec<Way> {
    let both = [
        (Kind::Grid, Sampling::Grid(4)),
        (Kind::Stochastic, Sampling::Stochastic(Rate::Samples(16))),
    ];
    let filters = [Filter::Tent, Filter::Mitchell].into_iter();
    filters.flat_map(|filter| both.map(|(kind, sampling)| Way { kind, sampling, filter })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_portray() {
        let all = ways(false);
        let words: Vec<String> = all.iter().chain(&filtered()).map(Way::words).collect();
        for expected in [
            "--aa none --samples 16",
            "--aa adaptive --samples 256",
            "--aa stochastic --samples 64",
            "--error 0.3",
            "--aa none --samples 16 --filter tent",
        ] {
            assert!(words.iter().any(|words| words == expected), "{expected}: {words:?}");
        }
        let mut files: Vec<String> = all.iter().chain(&filtered()).map(Way::file).collect();
        files.sort_unstable();
        files.dedup();
        assert_eq!(files.len(), words.len(), "each has a file of its own");
        assert!(files.iter().all(|file| !file.contains([' ', '/'])), "{files:?}");
    }

    #[test]
    fn a_quick_sweep_is_the_beginning_of_a_whole_one() {
        let (quick, whole) = (ways(true), ways(false));
        assert!(quick.len() < whole.len() && whole.starts_with(&quick));
        for kind in Kind::ALL {
            let of_kind = quick.iter().filter(|way| way.kind == kind).count();
            assert!(of_kind >= 2, "{kind:?} has a slope");
        }
    }
}
