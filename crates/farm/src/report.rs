//! What parts say about their making, and how well workers were used.

use std::collections::BTreeMap;
use std::time::Duration;

use idf::command::Job;

/// Figures that are sums over parts.
const COUNTED: [&str; 6] =
    ["rays", "primary", "secondary", "shadow", "cut_by_depth", "cut_by_weight"];
/// The figure of the seconds that a part took to be rendered.
const SECONDS: &str = "trace_seconds";

/// Sums of what the histories of parts say.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    counts: BTreeMap<&'static str, u64>,
    /// Seconds of rendering.
    pub(crate) seconds: f64,
}

impl Figures {
    /// Adds those of a part: its last line.
    pub(crate) fn add(&mut self, history: &[String]) {
        let figures = history.last().and_then(|line| line.rsplit('\t').next()).unwrap_or_default();
        for (name, value) in figures.split(' ').filter_map(|pair| pair.split_once('=')) {
            if let (Some(name), Ok(count)) =
                (COUNTED.iter().find(|counted| **counted == name), value.parse::<u64>())
            {
                *self.counts.entry(name).or_default() += count;
            } else if let (SECONDS, Ok(seconds)) = (name, value.parse::<f64>()) {
                self.seconds += seconds;
            }
        }
    }

    /// A line of history with these figures.
    pub(crate) fn told(&self, mut job: Job) -> Job {
        for name in COUNTED {
            if let Some(count) = self.counts.get(name) {
                job = job.with_figure(name, count);
            }
        }
        job.with_figure(SECONDS, format_args!("{:.4}", self.seconds))
    }
}

/// How a render went.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Report {
    /// Parts that were rendered now.
    pub(crate) parts: usize,
    /// Pictures that were finished now.
    pub(crate) pictures: usize,
    /// Parts that were done again.
    pub(crate) again: usize,
    /// Seconds of rendering in all parts.
    pub(crate) seconds: f64,
    /// From the start of the first worker to the last picture.
    pub(crate) elapsed: Duration,
    /// Workers at a time, at most.
    pub(crate) workers: usize,
}

impl Report {
    /// Seconds of rendering out of those that the workers had: 1 where nothing was lost to starting, waiting and
    /// putting together.
    #[expect(clippy::cast_precision_loss, reason = "a few thousand workers at most")]
    pub(crate) fn efficiency(&self) -> f64 {
        let had = self.elapsed.as_secs_f64() * self.workers as f64;
        if had > 0.0 { self.seconds / had } else { 1.0 }
    }

    /// As one line.
    pub(crate) fn line(&self) -> String {
        let Self { parts, pictures, again, seconds, workers, .. } = *self;
        let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
        let again = if again > 0 {
            format!(", {} rendered again", count(again, "part"))
        } else {
            String::new()
        };
        format!(
            "{} in {} in {:.1} s by {}: {seconds:.1} s of rendering, efficiency {:.2}{again}",
            count(pictures, "picture"),
            count(parts, "part"),
            self.elapsed.as_secs_f64(),
            count(workers, "worker"),
            self.efficiency()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_parts_add_up() {
        let mut figures = Figures::default();
        for line in [
            "2026-01-01T00:00:00Z\tportray\t1\tpart a\trays=5 shadow=2 trace_seconds=0.5000",
            "2026-01-01T00:00:00Z\tportray\t1\trays=9 b\trays=7 primary=1 trace_seconds=1.2500",
        ] {
            figures.add(&["older\trays=100".to_owned(), line.to_owned()]);
        }
        figures.add(&[]);
        let line = figures.told(Job::start("prfarm", "1")).entry().to_string();
        let told = line.rsplit('\t').next().unwrap();
        assert!(
            told.starts_with("rays=12 primary=1 shadow=2 trace_seconds=1.7500 seconds="),
            "{told}"
        );
    }

    #[test]
    fn efficiency_is_the_share_of_time_that_was_used() {
        let report = Report {
            parts: 8,
            pictures: 1,
            again: 1,
            seconds: 9.0,
            elapsed: Duration::from_secs(5),
            workers: 2,
        };
        assert!((report.efficiency() - 0.9).abs() < 1e-12);
        assert_eq!(
            report.line(),
            "1 picture in 8 parts in 5.0 s by 2 workers: 9.0 s of rendering, efficiency 0.90, 1 part rendered again"
        );
        assert!((Report::default().efficiency() - 1.0).abs() < 1e-12, "nothing was to be done");
    }
}
