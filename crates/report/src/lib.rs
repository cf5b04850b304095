//! Error against run time, speed, and what was left out, measured on any scene.
//!
//! A sweep ([`sweep`]) renders a scene in many ways and finds how far off each picture is from two independent references
//! ([`truth`]). What is measured is kept line by line ([`journal`]), so that a sweep goes on where it was stopped. From
//! the measurements come tables ([`table`]), slopes, frontiers and what wins at equal time ([`curve`]), plots ([`plot`])
//! and one page ([`page`]). [`speed`] does the same for generated scenes of growing size, and [`passes`] for what is left out of
//! scenes.
//!
//! ```
//! use report::curve::{Point, frontier, slope};
//!
//! // A hundred times the time for a tenth of the error.
//! let points = [0.01, 0.1, 1.0].map(|seconds: f64| Point { seconds, error: 0.3 / seconds.sqrt() });
//! assert!((slope(&points).unwrap() + 0.5).abs() < 1e-9);
//! assert_eq!(frontier(&points), [0, 1, 2]);
//! ```

pub mod clock;
pub mod colors;
pub mod command;
pub mod curve;
pub mod journal;
pub mod page;
pub mod passes;
pub mod peer;
pub mod plot;
pub mod sheet;
pub mod speed;
pub mod sweep;
pub mod table;
pub mod truth;
pub mod way;
