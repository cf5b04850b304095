//! The colours that an image gets by with.
//!
//! Pictures are display values ([`Pixels`]: sRGB bytes, straight, with alpha), a [`Table`] is 1 to
//! 256 of them. [`table`] finds one for several pictures, [`quantize`] also the index of each
//! pixel, [`Nearest`] the indices for a table from elsewhere, exactly; [`quality`] says how far the
//! result is from the original. What is near is a matter of [`Metric`]; a table that is good for
//! one is not for the other, so both figures are told.
//!
//! Colours are counted one by one where they are few, else in 2^18 cells of 64 ([`Method`]): boxes
//! of them are cut where the squared error falls most, and rounds of k-means move the entries. A
//! picture that has no more colours than the table may have comes back unchanged. Results are the
//! same bytes for any number of threads.
//!
//! ```
//! use ilut::{Options, Pixels, quality, quantize};
//!
//! let colors = (0..64 * 64).map(|at| [(at % 64 * 4) as u8, (at / 64 * 4) as u8, 128, 255]);
//! let picture = Pixels::new(64, 64, colors.collect())?;
//! let quantized = quantize(&[&picture], &Options::default())?;
//! assert_eq!(quantized.table.colors().len(), 256);
//! let figures = quality(&picture, &quantized.table, &quantized.indices[0]);
//! assert!(figures.rms_rgb < 4.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cells;
mod choose;
mod color_table;
pub mod command;
mod cut;
mod entries;
mod heckbert;
mod histogram;
mod hull;
mod key;
mod map;
mod metric;
mod nearest;
pub mod oklab;
mod options;
mod pixels;
mod points;
mod quality;
mod quantize;
mod refine;
mod spread;
mod translucent;
mod unique;
mod visibility;

pub use color_table::Table;
pub use hull::nearest_in_hull;
pub use metric::Metric;
pub use nearest::Nearest;
pub use options::{Method, Options, TableError};
pub use pixels::Pixels;
pub use quality::{Quality, quality, rms_rgb};
pub use quantize::{Quantized, quantize, table};
