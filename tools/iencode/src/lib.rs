//! An image in the colours of a table: the nearest ones, or dithered.
//!
//! ```
//! use iencode::{Options, dither, encoded};
//! use ilut::{Pixels, Table};
//!
//! let grey = Pixels::new(4, 1, vec![[128, 128, 128, 255]; 4])?;
//! let table = Table::new(vec![[0, 0, 0, 255], [255; 4]]).expect("1 to 256 colours");
//! let options = Options { dither: &dither::FLOYD_STEINBERG, ..Options::default() };
//! let dithered = encoded(&[&grey], Some(table), &options)?;
//! assert!(dithered.indices[0].contains(&0) && dithered.indices[0].contains(&1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blue_noise;
pub mod command;
pub mod dither;
mod floyd_steinberg;
mod grid;
mod hull;
mod mask;
mod pattern;
pub mod sixel;

use ilut::{Pixels, Quantized, Table, TableError, quantize};

pub use dither::Dither;

/// How to encode.
#[derive(Clone, Debug)]
pub struct Options {
    /// How a table is made, and what is near.
    pub table: ilut::Options,
    /// How indices are chosen.
    pub dither: &'static Dither,
    /// Share of the error that is made up for, 0 to 1; without it, [`Dither::strength_for`] the table.
    pub strength: Option<f32>,
}

impl Default for Options {
    fn default() -> Self {
        Self { table: ilut::Options::default(), dither: &dither::NONE, strength: None }
    }
}

/// Pictures in the colours of one table: `table`, exactly and in its order, or one that is made
/// for them.
///
/// # Errors
///
/// If no table can be made as the options want it.
pub fn encoded(
    pictures: &[&Pixels],
    table: Option<Table>,
    options: &Options,
) -> Result<Quantized, TableError> {
    let Options { dither, .. } = options;
    let table = match table {
        Some(table) => table,
        // Quantising knows the nearest entries already.
        None if options.strength.unwrap_or(dither.strength) <= 0.0 => {
            return quantize(pictures, &options.table);
        }
        None => {
            let options = ilut::Options { spread: true, ..options.table.clone() };
            ilut::table(pictures, &options)?
        }
    };
    let metric = options.table.metric;
    let strength = options.strength.unwrap_or_else(|| dither.strength_for(&table));
    let indices = pictures.iter().map(|pixels| dither.indices(pixels, &table, metric, strength));
    Ok(Quantized { indices: indices.collect(), table })
}
