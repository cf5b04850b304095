//! How long parts take when a number of workers share them: by simulation, with the numbers that a render has measured.
//!
//! ```
//! use farm::schedule::Farm;
//!
//! let farm = Farm { workers: 2, start: 0.5, end: 1.0 };
//! // 3.5 against 2.5 + 2.5, and the end: 7 seconds of work in 2 × 6.
//! assert_eq!(farm.seconds(&[3.0, 2.0, 2.0]), 6.0);
//! assert!((farm.efficiency(&[3.0, 2.0, 2.0]) - 7.0 / 12.0).abs() < 1e-12);
//! ```

use render::scheduled;

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
        scheduled(&costs, self.workers.max(1)) + self.end
    }

    /// The share of the workers' time that goes into rendering, 0…1.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a few thousand workers at most")]
    pub fn efficiency(&self, parts: &[f64]) -> f64 {
        parts.iter().sum::<f64>() / (self.workers.max(1) as f64 * self.seconds(parts))
    }
}
