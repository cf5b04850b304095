//! Pictures in the colours of a table: `ilut` and `iencode`.

use iencode::{Dither, Options, dither, encoded};
use ilut::{Method, Metric, Pixels, Quantized, Table};
use pyo3::prelude::*;

use crate::argument::{Whole, detached, threads, value, word};
use crate::{array, failure};

/// Indices and table, as arrays.
type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A picture in the colours of a table.
#[pyfunction]
#[pyo3(signature = (image, colours, method, metric, dither, strength, palette, keep, max_error, matte, threads))]
pub(crate) fn quantize<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    colours: Whole,
    method: &str,
    metric: &str,
    dither: &str,
    strength: Option<f64>,
    palette: Option<&Bound<'py, PyAny>>,
    keep: Option<&Bound<'py, PyAny>>,
    max_error: Option<f64>,
    matte: Option<[f64; 3]>,
    threads: Option<Whole>,
) -> PyResult<Arrays<'py>> {
    let image = array::image_of("image", image)?;
    let palette = palette.map(|array| array::palette_of("palette", array)).transpose()?;
    let keep = keep.map(|array| array::palette_of("keep", array)).transpose()?.unwrap_or_default();
    if let Some(most) = max_error.filter(|most| !(most.is_finite() && *most >= 0.0)) {
        return Err(value(format!("max_error: expected a number of 0 or more, found {most}")));
    }
    if matte.is_some_and(|matte| !matte.iter().all(|channel| (0.0..=1.0).contains(channel))) {
        return Err(value(format!(
            "matte: expected three display values from 0 to 1, found {:?}",
            matte.unwrap_or_default()
        )));
    }
    let table = ilut::Options {
        colors: colours.within("colours", 1..=256)?,
        method: word("method", method, Method::ALL.map(|row| (row.word(), row)))?,
        metric: word("metric", metric, Metric::ALL.map(|row| (row.word(), row)))?,
        keep,
        max_error,
        spread: false,
    };
    let dither: &Dither = word("dither", dither, dither::TABLE.iter().map(|row| (row.name, row)))?;
    let options = Options { table, dither, strength: share(dither, strength)? };
    let table = palette.and_then(Table::new);
    let threads = self::threads(threads)?;
    let size = image.size();
    let work = || {
        let pixels = Pixels::of(&image, matte).map_err(|error| failure::image(&error))?;
        encoded(&[&pixels], table, &options).map_err(|error| value(error.to_string()))
    };
    let Quantized { mut indices, table } = detached(py, threads, work)??;
    let [columns, rows] = size.map(|side| side as usize);
    let indices = array::shaped(py, vec![rows, columns], indices.swap_remove(0))?;
    Ok((indices, palette_array(py, table.colors())?))
}

/// Colours as an array: of three channels where all are opaque, else of four.
pub(crate) fn palette_array<'py>(
    py: Python<'py>,
    colors: &[[u8; 4]],
) -> PyResult<Bound<'py, PyAny>> {
    let channels = if colors.iter().all(|color| color[3] == u8::MAX) { 3 } else { 4 };
    let bytes = colors.iter().flat_map(|color| color[..channels].iter().copied()).collect();
    array::shaped(py, vec![colors.len(), channels], bytes)
}

/// How much of the error is made up for.
fn share(dither: &Dither, strength: Option<f64>) -> PyResult<Option<f32>> {
    let Some(strength) = strength else { return Ok(None) };
    if dither.name == dither::NONE.name {
        return Err(value("strength: belongs to a dither"));
    }
    if !(0.0..=1.0).contains(&strength) {
        return Err(value(format!("strength: expected a number from 0 to 1, found {strength}")));
    }
    #[expect(clippy::cast_possible_truncation, reason = "0 to 1")]
    Ok(Some(strength as f32))
}
