//! Arrays to images and back.

use idf::plane::COLOR;
use idf::{Depth, Form, Image, Kind, Matte, Plane, Samples, Transfer, checked_size};
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{value, wrong_type};
use crate::failure;

/// What an array of measured values may hold, and what a message calls it.
type Layers<'a> = &'a [(&'static str, &'static [Kind])];

/// Measured channels by their names; an array of three is one of vectors.
pub(crate) const MEASURED: Layers<'static> = &[
    ("depth", &[Kind::Dep]),
    ("normal", &[Kind::Nrx, Kind::Nry, Kind::Nrz]),
    ("objects", &[Kind::Obj]),
];

/// An array taken apart: channels of one size.
struct Channels {
    columns: u32,
    rows: u32,
    samples: Vec<Samples>,
}

impl Channels {
    /// The channels of an array of shape (rows, columns) or (rows, columns, channels).
    fn of(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Self> {
        let untyped = array.cast::<PyUntypedArray>().map_err(|_| {
            let error = wrong_type("a numpy array of uint8, uint16 or float32", array);
            named(name, array.py(), &error)
        })?;
        let shape = untyped.shape();
        let (rows, columns, count) = match *shape {
            [rows, columns] => (rows, columns, 1),
            [rows, columns, count @ 1..=4] => (rows, columns, count),
            _ => {
                return Err(value(format!(
                    "{name}: expected an array of shape (rows, columns) or (rows, columns, 1 to 4), found {shape:?}"
                )));
            }
        };
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        let (columns, rows) = (side(columns), side(rows));
        let wrong = |error| value(format!("{name}: {}", failure::image(&error).value(array.py())));
        checked_size(columns, rows).map_err(wrong)?;
        let samples = if let Ok(array) = array.cast::<PyArrayDyn<u8>>() {
            channels(array, count)?.into_iter().map(Samples::U8).collect()
        } else if let Ok(array) = array.cast::<PyArrayDyn<u16>>() {
            channels(array, count)?.into_iter().map(Samples::U16).collect()
        } else if let Ok(array) = array.cast::<PyArrayDyn<f32>>() {
            channels(array, count)?.into_iter().map(Samples::F32).collect()
        } else {
            return Err(PyTypeError::new_err(format!(
                "{name}: expected an array of uint8, uint16 or float32, found {}",
                untyped.dtype()
            )));
        };
        Ok(Self { columns, rows, samples })
    }

    /// As an image, each channel of its kind.
    fn image(self, kinds: &[Kind]) -> PyResult<Image> {
        let plane = |(samples, &kind)| Plane { kind, samples };
        let planes = self.samples.into_iter().zip(kinds).map(plane).collect();
        Image::new(self.columns, self.rows, planes).map_err(|error| failure::image(&error))
    }
}

/// The same error with the name of the argument before it.
fn named(name: &str, py: Python<'_>, error: &PyErr) -> PyErr {
    PyTypeError::new_err(format!("{name}: {}", error.value(py)))
}

/// Each of `count` channels that lie side by side.
fn channels<T: Element + Copy>(
    array: &Bound<'_, PyArrayDyn<T>>,
    count: usize,
) -> PyResult<Vec<Vec<T>>> {
    let array = array.try_readonly().map_err(|error| value(error.to_string()))?;
    let array = array.as_array();
    let mut channels = Vec::with_capacity(count);
    for channel in 0..count {
        let mut samples = Vec::new();
        samples
            .try_reserve_exact(array.len() / count)
            .map_err(|error| PyMemoryError::new_err(error.to_string()))?;
        samples.extend(array.iter().skip(channel).step_by(count).copied());
        channels.push(samples);
    }
    Ok(channels)
}

/// The picture that an array is: grey or red, green and blue, with coverage or without.
pub(crate) fn image_of(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Image> {
    let channels = Channels::of(name, array)?;
    let kinds: &[Kind] = match channels.samples.len() {
        1 => &[Kind::Grg],
        2 => &[Kind::Grg, Kind::Cvg],
        3 => &COLOR,
        _ => &[Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg],
    };
    let mut image = channels.image(kinds)?;
    let form = usual_form(&image);
    image.properties.transfer = Some(form.transfer);
    image.properties.matte = form.matte;
    Ok(image)
}

/// Planes of one channel, or of as many as there are `kinds`.
pub(crate) fn planes_of(
    name: &str,
    array: &Bound<'_, PyAny>,
    kinds: &[Kind],
    size: [u32; 2],
) -> PyResult<Vec<Plane>> {
    let channels = Channels::of(name, array)?;
    let found = [channels.columns, channels.rows];
    if found != size || channels.samples.len() != kinds.len() {
        let [columns, rows] = size;
        let shape = array.cast::<PyUntypedArray>().map(|array| array.shape().to_vec());
        let expected = if kinds.len() == 1 { String::new() } else { format!(", {}", kinds.len()) };
        return Err(value(format!(
            "{name}: expected an array of shape ({rows}, {columns}{expected}), found {:?}",
            shape.unwrap_or_default()
        )));
    }
    Ok(channels.image(kinds)?.into_planes())
}

/// Indices of the colours of a table: (rows, columns) of bytes.
pub(crate) fn indices_of(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Image> {
    let channels = Channels::of(name, array)?;
    match channels.samples[..] {
        [Samples::U8(_)] => channels.image(&[Kind::Enc]),
        _ => Err(PyTypeError::new_err(format!(
            "{name}: expected indices, a uint8 array of shape (rows, columns)"
        ))),
    }
}

/// The colours of an array of shape (1 to 256, 3 or 4) of bytes.
pub(crate) fn palette_of(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<[u8; 4]>> {
    let expected = "a uint8 array of shape (1 to 256, 3 or 4)";
    let bytes = array.cast::<PyArrayDyn<u8>>().map_err(|_| {
        let found = array.cast::<PyUntypedArray>().map(|array| array.dtype().to_string());
        let found = found.unwrap_or_else(|_| array.get_type().to_string());
        PyTypeError::new_err(format!("{name}: expected {expected}, found {found}"))
    })?;
    let shape = bytes.shape();
    let &[1..=256, channels @ 3..=4] = shape else {
        return Err(value(format!("{name}: expected {expected}, found shape {shape:?}")));
    };
    let channels = self::channels(bytes, channels)?;
    let color = |at: usize| {
        let channel = |channel: usize| channels.get(channel).map_or(u8::MAX, |bytes| bytes[at]);
        std::array::from_fn(channel)
    };
    Ok((0..channels[0].len()).map(color).collect())
}

/// How arrays of the image's depth hold it.
fn usual_form(image: &Image) -> Form {
    let depth = image.depth();
    let covered = image.plane(Kind::Cvg).is_some();
    let matte =
        if depth == Depth::F32 || !covered { Matte::Premultiplied } else { Matte::Straight };
    let transfer = if depth == Depth::F32 { Transfer::Linear } else { Transfer::Srgb };
    Form { depth, transfer, matte }
}

/// What planes hold, as arrays by name: `light`, `coverage`, and what is measured.
pub(crate) fn arrays<'py>(py: Python<'py>, image: &Image) -> PyResult<Bound<'py, PyDict>> {
    let image = image.converted(usual_form(image)).map_err(|error| failure::image(&error))?;
    let arrays = PyDict::new(py);
    let light = image.light_kinds().map_err(|error| failure::image(&error))?;
    let named = [("light", &light[..]), ("coverage", &[Kind::Cvg][..])];
    for (name, kinds) in named.into_iter().chain(MEASURED.iter().copied()) {
        let samples: Vec<&Samples> = kinds.iter().filter_map(|&kind| image.plane(kind)).collect();
        if !samples.is_empty() && samples.len() == kinds.len() {
            arrays.set_item(name, array(py, image.size(), &samples)?)?;
        }
    }
    Ok(arrays)
}

/// Channels side by side; one alone is an array of two dimensions.
fn array<'py>(
    py: Python<'py>,
    [columns, rows]: [u32; 2],
    channels: &[&Samples],
) -> PyResult<Bound<'py, PyAny>> {
    let mut shape = vec![rows as usize, columns as usize];
    shape.extend((channels.len() > 1).then_some(channels.len()));
    match channels[0] {
        Samples::U8(_) => shaped(py, shape, interleaved(channels, Samples::u8)),
        Samples::U16(_) => shaped(py, shape, interleaved(channels, Samples::u16)),
        Samples::F32(_) => shaped(py, shape, interleaved(channels, Samples::f32)),
    }
}

/// Samples of one depth.
trait Typed {
    fn u8(&self) -> &[u8];
    fn u16(&self) -> &[u16];
    fn f32(&self) -> &[f32];
}

impl Typed for Samples {
    fn u8(&self) -> &[u8] {
        if let Self::U8(samples) = self { samples } else { &[] }
    }

    fn u16(&self) -> &[u16] {
        if let Self::U16(samples) = self { samples } else { &[] }
    }

    fn f32(&self) -> &[f32] {
        if let Self::F32(samples) = self { samples } else { &[] }
    }
}

fn interleaved<'a, T: Copy>(channels: &[&'a Samples], typed: fn(&'a Samples) -> &'a [T]) -> Vec<T> {
    let channels: Vec<&[T]> = channels.iter().map(|&samples| typed(samples)).collect();
    (0..channels[0].len()).flat_map(|at| channels.iter().map(move |samples| samples[at])).collect()
}

/// An array that takes the samples over.
pub(crate) fn shaped<'py, T: Element>(
    py: Python<'py>,
    shape: Vec<usize>,
    samples: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, samples).reshape(shape)?.into_any())
}

/// Light with coverage behind it where there is any: the array of a picture.
pub(crate) fn pixels<'py>(py: Python<'py>, image: &Image) -> PyResult<Bound<'py, PyAny>> {
    let image = image.converted(usual_form(image)).map_err(|error| failure::image(&error))?;
    let mut kinds = image.light_kinds().map_err(|error| failure::image(&error))?;
    kinds.extend(image.plane(Kind::Cvg).map(|_| Kind::Cvg));
    let samples: Vec<&Samples> = kinds.iter().filter_map(|&kind| image.plane(kind)).collect();
    array(py, image.size(), &samples)
}
