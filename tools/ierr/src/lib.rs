//! How far one image is from another.
//!
//! Metrics are rows of [`TABLE`]. Integer images are compared as display values (sRGB); where either is
//! floating point, both are compared as linear light. Light is taken multiplied by coverage, and
//! coverage is compared as a channel of its own.
//!
//! ```
//! use idf::{Image, Kind, Plane, Samples};
//! use ierr::{Pair, Row, Viewing};
//!
//! let grey = |samples| Image::new(2, 1, vec![Plane { kind: Kind::Grg, samples }]);
//! let pair = Pair::new(&grey(Samples::U8(vec![0, 51]))?, &grey(Samples::U8(vec![0, 0]))?)?;
//! let max = Row::from_word("max").ok_or("a row of the table")?;
//! let found = (max.measure)(&pair, &Viewing::default()).ok_or("large enough")?;
//! assert_eq!(found.value, 0.2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod command;
mod filter;
mod metric;
mod pair;
mod picture;
mod report;
mod values;

pub use metric::{Measured, Place, Row, TABLE, Unit, Viewing};
pub use pair::{Channel, ONE, Pair, PairError, Scale};
pub use picture::{difference, map};
pub use report::{Figure, Report};
pub use values::Values;
