//! Compositing: the operators of `icomp`.

use icomp::{OPERATORS, Operator, Options, Rule, composed};
use idf::{Depth, Image, Matte, Window};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::argument::{Whole, detached, threads, value, word};
use crate::{array, failure};

/// Places on the canvas go so far either way.
const FAR: i64 = 1 << 24;

/// One picture of two, or of one.
#[pyfunction]
#[pyo3(signature = (operator, a, b, at, factor, stored, threads))]
pub(crate) fn composite<'py>(
    py: Python<'py>,
    operator: &str,
    a: &Bound<'py, PyAny>,
    b: Option<&Bound<'py, PyAny>>,
    at: (Whole, Whole),
    factor: Option<f64>,
    stored: bool,
    threads: Option<Whole>,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = OPERATORS.iter().map(|row| (row.name, row));
    let operator: &Operator = word("operator", operator, rows)?;
    let mut a = array::image_of("a", a)?;
    let (column, row) = at;
    a.properties.origin = [column.within("at", -FAR..=FAR)?, row.within("at", -FAR..=FAR)?];
    let b = b.map(|b| array::image_of("b", b)).transpose()?;
    let threads = self::threads(threads)?;
    let factor = checked(operator, b.as_ref(), factor)?;
    let images: Vec<&Image> = std::iter::once(&a).chain(&b).collect();
    let whole = images.iter().all(|image| image.depth() != Depth::F32);
    if operator.name == "opaque" && whole {
        return Err(value(
            "opaque: leaves light that covers nothing, which arrays of integers cannot hold; take float32",
        ));
    }
    check_memory(&images)?;
    let matte = Some(if whole { Matte::Straight } else { Matte::Premultiplied });
    let options = Options { factor, stored, matte };
    let made = detached(py, threads, || composed(operator, &images, &options))?;
    array::pixels(py, &made.map_err(|error| failure::image(&error))?)
}

/// The factor, if the operator has as many pictures and factors as it takes.
fn checked(operator: &Operator, b: Option<&Image>, factor: Option<f64>) -> PyResult<f64> {
    let name = operator.name;
    match (operator.rule, b, factor) {
        (Rule::Two { .. }, Some(_), None) => Ok(1.0),
        (Rule::Two { .. }, None, _) => {
            Err(value(format!("{name}: expected two pictures, found one")))
        }
        (Rule::Two { .. }, _, Some(_)) => {
            Err(value(format!("factor: {name} takes none; darken, dissolve and opaque do")))
        }
        (Rule::One { .. }, None, Some(factor)) if factor >= 0.0 && factor.is_finite() => Ok(factor),
        (Rule::One { .. }, None, Some(factor)) => {
            Err(value(format!("factor: expected a number of 0 or more, found {factor}")))
        }
        (Rule::One { .. }, None, None) => Err(value(format!("{name}: expected a factor"))),
        (Rule::One { .. }, Some(_), _) => {
            Err(value(format!("{name}: expected one picture, found two")))
        }
    }
}

/// Asks for all the memory of the canvas at once and gives it back: pictures of a few bytes may lie far apart.
fn check_memory(images: &[&Image]) -> PyResult<()> {
    let windows = || images.iter().map(|image| image.window());
    let length = |first: fn(Window) -> i32, side: fn(Window) -> u32| {
        let start = windows().map(|window| i64::from(first(window))).min().unwrap_or(0);
        let end = windows().map(|window| i64::from(first(window)) + i64::from(side(window))).max();
        u64::try_from(end.unwrap_or(0) - start).unwrap_or(0)
    };
    let (columns, rows) = (length(|w| w.column, |w| w.columns), length(|w| w.row, |w| w.rows));
    let depth = images.iter().map(|image| image.depth().bytes() as u64).max().unwrap_or(1);
    // Four channels in planes, side by side, and once more while they are combined.
    let bytes = columns.saturating_mul(rows).saturating_mul(3 * 4 * depth);
    let room = usize::try_from(bytes).ok().map(|bytes| Vec::<u8>::new().try_reserve_exact(bytes));
    match room {
        Some(Ok(())) => Ok(()),
        _ => Err(PyMemoryError::new_err(format!(
            "no memory for a canvas of {columns} x {rows} pixels, which takes {} MB",
            bytes >> 20
        ))),
    }
}
