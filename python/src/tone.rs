//! Tones: the operations of `ieq`.

use ieq::{Operation, Work, toned};
use pyo3::prelude::*;

use crate::argument::{Whole, detached, threads, value};
use crate::{array, failure};

/// The picture with other tones, by a row of the table of operations.
#[pyfunction]
#[pyo3(signature = (image, operation, numbers, per_channel, threads))]
pub(crate) fn tone<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    operation: &str,
    numbers: Vec<f64>,
    per_channel: bool,
    threads: Option<Whole>,
) -> PyResult<Bound<'py, PyAny>> {
    let image = array::image_of("image", image)?;
    let threads = self::threads(threads)?;
    let known = || {
        let rows = ieq::TABLE.iter().filter(|row| !matches!(row.work, Work::Histogram));
        rows.map(|row| row.word).collect::<Vec<_>>().join(", ")
    };
    let mut work = Operation::new(operation, &numbers)
        .map_err(|error| value(format!("{operation}: {error}; there are {}", known())))?;
    if matches!(work.row().work, Work::Histogram) {
        return Err(value(format!("operation: expected one of {}, found {operation:?}", known())));
    }
    if per_channel && !work.row().looks_at_luma() {
        return Err(value(format!("per_channel: {operation} takes each channel by itself anyway")));
    }
    work.per_channel = per_channel;
    let toned = detached(py, threads, || toned(image, &work))?;
    array::pixels(py, &toned.map_err(|error| failure::image(&error))?)
}
