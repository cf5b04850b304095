//! Pictures in, a table and indices out.

use std::sync::OnceLock;

use idf::Lut;

use crate::choose::{Places, choose};
use crate::histogram::Histogram;
use crate::key::{CELLS, PLACES, key};
use crate::nearest::Nearest;
use crate::quality::{Sums, sums_of};
use crate::{Method, Metric, Options, Pixels, Table, TableError};

/// Pictures in the colours of one table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantized {
    /// The colours of all pictures.
    pub table: Table,
    /// For each picture, the index of each pixel's colour.
    pub indices: Vec<Vec<u8>>,
}

/// One table for all `pictures`.
///
/// If they have no more colours than the table may have, these are the table.
///
/// # Errors
///
/// If there is no picture, or the options cannot be met.
pub fn table(pictures: &[&Pixels], options: &Options) -> Result<Table, TableError> {
    if options.max_error.is_some() {
        return quantize(pictures, options).map(|quantized| quantized.table);
    }
    Ok(Source::new(pictures, options)?.table(options.colors))
}

/// One table for all `pictures`, and each of them in its colours.
///
/// # Errors
///
/// As [`table`].
pub fn quantize(pictures: &[&Pixels], options: &Options) -> Result<Quantized, TableError> {
    let source = Source::new(pictures, options)?;
    let all = source.quantized(options.colors);
    let Some(most) = options.max_error else { return Ok(all) };
    let found = source.error(&all);
    if found > most {
        return Err(TableError::MaxError { found, most, colors: options.colors });
    }
    // Halving keeps this true: `enough` colours are enough, and `short` are not.
    let mut enough = (all.table.colors().len(), all);
    let mut short = options.keep.len().max(1) - 1;
    while enough.0 > short + 1 {
        let colors = short + (enough.0 - short) / 2;
        let quantized = source.quantized(colors);
        if source.error(&quantized) <= most {
            enough = (colors, quantized);
        } else {
            short = colors;
        }
    }
    Ok(enough.1)
}

/// Pictures whose colours are counted.
struct Source<'a> {
    pictures: &'a [&'a Pixels],
    options: &'a Options,
    histogram: Histogram,
    /// Median cut does without.
    places: OnceLock<Places>,
}

impl<'a> Source<'a> {
    fn new(pictures: &'a [&'a Pixels], options: &'a Options) -> Result<Self, TableError> {
        options.check()?;
        if pictures.is_empty() {
            return Err(TableError::NoPicture);
        }
        let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
        let most = match (options.method, options.metric) {
            (Method::Best, Metric::Oklab) => MOST_DISTINCT.min(pixels / 4),
            (Method::Best, Metric::Rgb) => MOST_DISTINCT_RGB.min(pixels / 4),
            (Method::Heckbert | Method::Fast, _) => 0,
        };
        let histogram = Histogram::new(pictures, most.max(Lut::MOST), options.is_visual());
        Ok(Self { pictures, options, histogram, places: OnceLock::new() })
    }

    fn places(&self) -> &Places {
        self.places.get_or_init(|| Places::new(&self.histogram, self.options))
    }

    fn table(&self, most: usize) -> Table {
        let colors = choose(&self.histogram, || self.places(), self.options, most);
        Table::new(colors).expect("a picture has at least one colour, and a table room for one")
    }

    fn quantized(&self, most: usize) -> Quantized {
        let table = self.table(most);
        let nearest = Nearest::new(&table, self.options.metric);
        let cells = self.histogram.cells();
        let is_by_cells =
            self.options.method == Method::Fast && self.histogram.distinct().is_none();
        let indices = if is_by_cells && nearest.opaque().len() > 0 {
            let mut index_of = vec![0; CELLS];
            for (cell, index) in cells.iter().zip(self.places().opaque_indices(nearest.opaque())) {
                index_of[*cell as usize] = index;
            }
            let index = |color| index_of[key(color) as usize / PLACES % CELLS];
            self.pictures.iter().map(|picture| nearest.indices_by(picture, index)).collect()
        } else if self.is_scattered(cells.len()) {
            self.pictures.iter().map(|picture| nearest.indices_by_color(picture)).collect()
        } else {
            let map = nearest.map(&cells);
            self.pictures.iter().map(|picture| nearest.indices_by_map(picture, &map)).collect()
        };
        Quantized { table, indices }
    }

    /// Whether there are so many cells that their map, 64 colours each, is more work than the
    /// search for each pixel.
    fn is_scattered(&self, cells: usize) -> bool {
        let pixels: usize = self.pictures.iter().map(|picture| picture.colors().len()).sum();
        cells > pixels / 4
    }

    /// Root mean square error over all pictures, as [`Options::max_error`] has it.
    fn error(&self, quantized: &Quantized) -> f64 {
        let sums = self.pictures.iter().zip(&quantized.indices);
        let sums = sums.map(|(picture, indices)| sums_of(picture, &quantized.table, indices));
        let quality = sums.fold(Sums::default(), Sums::and).quality();
        match self.options.metric {
            Metric::Rgb => quality.rms_rgb,
            Metric::Oklab => quality.rms_oklab,
        }
    }
}

/// Colours up to which all are taken one by one to the eye, which sees the last bits of dark
/// ones: a picture of 110 000 colours gains 0.7 dB over cells, and takes twice the time.
const MOST_DISTINCT: usize = 150_000;

/// As [`MOST_DISTINCT`], for RGB, where fewer than these gain 0.2 dB and more.
const MOST_DISTINCT_RGB: usize = 1 << 16;
