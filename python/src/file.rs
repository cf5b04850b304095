//! Images from files and to files, in every format of the suite.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use idf::exchange::{Format, read_image, write_image};
use idf::{Ask, Encoding, Image, Kind, Lut, ReadOptions, Samples, WriteOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{Whole, detached, value};
use crate::array::{self, MEASURED};
use crate::failure;
use crate::quantize::palette_array;

/// An image: a dictionary of arrays by the names of channels.
#[pyfunction]
#[pyo3(signature = (path))]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let work = || {
        let whole = read_image(&path, &ReadOptions::default())?;
        let ask = Ask::Only(vec![Kind::Enc, Kind::Lut]);
        let table = is_indexed(&path)
            .then(|| read_image(&path, &ReadOptions { ask, ..ReadOptions::default() }));
        Ok((whole, table.transpose()?))
    };
    let (image, indexed) = detached(py, None, work)?.map_err(|error| failure::read(&error))?;
    let resolved = image.resolved().map_err(|error| failure::image(&error))?;
    let arrays = array::arrays(py, &resolved)?;
    let [column, row] = image.properties.origin;
    arrays.set_item("at", (column, row))?;
    let image = indexed.as_ref().unwrap_or(&image);
    if let Some(Samples::U8(indices)) = image.plane(Kind::Enc) {
        let [columns, rows] = image.size().map(|side| side as usize);
        arrays.set_item("indices", array::shaped(py, vec![rows, columns], indices.clone())?)?;
    }
    if let Some(table) = &image.lut {
        let colors: Vec<[u8; 4]> = table.entries().collect();
        arrays.set_item("palette", palette_array(py, &colors)?)?;
    }
    Ok(arrays)
}

/// Whether a file of another format holds indices: GIF does, and PNG of colour type 3.
fn is_indexed(path: &Path) -> bool {
    match Format::of(path) {
        Some(Format::Gif) => true,
        Some(Format::Png) => {
            // Signature, length and name of the first chunk, then width, height, depth, colour type.
            let mut head = [0; 26];
            let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
            read.is_ok() && head[25] == 3
        }
        _ => false,
    }
}

/// Writes an image in the format of its name.
#[pyfunction]
#[pyo3(signature = (path, pixels, measured, indices, palette, at, rle))]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    pixels: Option<&Bound<'_, PyAny>>,
    measured: &Bound<'_, PyDict>,
    indices: Option<&Bound<'_, PyAny>>,
    palette: Option<&Bound<'_, PyAny>>,
    at: (Whole, Whole),
    rle: bool,
) -> PyResult<()> {
    let format = Format::of(&path);
    let holds = matches!(format, Some(Format::Idf | Format::Exr));
    let mut image = match (pixels, indices, palette) {
        (Some(pixels), None, None) => array::image_of("image", pixels)?,
        (None, Some(indices), Some(_)) => array::indices_of("image", indices)?,
        _ => return Err(value("image: expected a picture, or indices with their palette")),
    };
    if let Some(palette) = palette {
        image.lut = Lut::with_coverage(array::palette_of("palette", palette)?);
        check_indices(&image)?;
    }
    for &(name, kinds) in MEASURED {
        let Some(found) = measured.get_item(name)? else { continue };
        if !holds {
            return Err(value(format!(
                "{name}: holds measured values; write a name without ending, or with .idf or .exr"
            )));
        }
        let mut planes = image.planes().to_vec();
        planes.extend(array::planes_of(name, &found, kinds, image.size())?);
        image = image
            .with_planes(image.columns(), image.rows(), planes)
            .map_err(|error| failure::image(&error))?;
    }
    let (column, row) = at;
    let far = i64::from(i32::MIN)..=i64::from(i32::MAX);
    image.properties.origin = [column.within("at", far.clone())?, row.within("at", far)?];
    let encoding = if rle { Encoding::Rle } else { Encoding::Raw };
    let options = WriteOptions { encoding, ..WriteOptions::default() };
    let written = detached(py, None, || write_image(&path, &image, &options))?;
    written.map_err(|error| failure::write(&error))
}

/// Refuses indices beyond the table.
fn check_indices(image: &Image) -> PyResult<()> {
    image.resolved().map(drop).map_err(|error| failure::image(&error))
}
