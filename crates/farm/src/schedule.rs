//! How long parts take when a number of workers share them: by simulation, with the numbers that a render has measured.
//!
//! ```
//! use farm::schedule::{Farm, makespan};
//!
//! // Two workers: one takes 3, the other 2 and then 2.
//! assert_eq!(makespan(&[3.0, 2.0, 2.0], 2), 4.0);
//! let farm = Farm { workers: 2, start: 0.5, end: 1.0 };
//! // 3.5 against 2.5 + 2.5, and the end: 7 seconds of work in 2 × 6.
//! assert_eq!(farm.seconds(&[3.0, 2.0, 2.0]), 6.0);
//! assert!((farm.efficiency(&[3.0, 2.0, 2.0]) - 7.0 / 12.0).abs() < 1e-12);
//! ```

/// Workers, and what their work costs besides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Farm {
    /// How many, at least 1.
    pub workers: usize,
    /// Seconds that a worker takes for a part besides rendering: to be started, to read the scene, to write the part.
    pub start: f64,
    /// Seconds from the last part to the picture: parts are put together.
    pub end: f64,
}

impl Farm {
    /// Seconds from the first worker to the picture, of parts that take so many seconds to be rendered, in their order.
    #[must_use]
    pub fn seconds(&self, parts: &[f64]) -> f64 {
        let costs: Vec<f64> = parts.iter().map(|seconds| seconds + self.start).collect();
        makespan(&costs, self.workers) + self.end
    }

    /// The share of the workers' time that goes into rendering, 0…1.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a few thousand workers at most")]
    pub fn efficiency(&self, parts: &[f64]) -> f64 {
        parts.iter().sum::<f64>() / (self.workers.max(1) as f64 * self.seconds(parts))
    }
}

/// When the last of some jobs is done, if each goes to the worker that is free first, in their order.
///
/// At most the sum over the number of workers and the longest (Graham, "Bounds on Multiprocessing Timing Anomalies", 1969).
#[must_use]
pub fn makespan(costs: &[f64], workers: usize) -> f64 {
    let mut ends = vec![0.0_f64; workers.max(1)];
    for cost in costs {
        let mut first = 0;
        for (worker, end) in ends.iter().enumerate() {
            if *end < ends[first] {
                first = worker;
            }
        }
        ends[first] += cost;
    }
    ends.into_iter().fold(0.0, |last, end| if end > last { end } else { last })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_ends_within_grahams_bound() {
        let mut state = 7_u32;
        let mut lot = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for workers in 1..=20 {
            for count in [0, 1, 7, 64] {
                let costs: Vec<f64> = (0..count).map(|_| lot()).collect();
                let sum: f64 = costs.iter().sum();
                let longest = costs.iter().copied().fold(0.0, f64::max);
                let share = sum / f64::from(u32::try_from(workers).unwrap());
                let found = makespan(&costs, workers);
                let least = share.max(longest) * (1.0 - 1e-12);
                assert!((least..=share + longest).contains(&found), "{workers} {count}: {found}");
            }
        }
    }
}
