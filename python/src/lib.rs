//! The suite for Python: renders, compiles, quantises, composites, and reads and writes images as `numpy` arrays.
//!
//! This is the native half, `portray._core`: it takes plain values, says what is wrong with them, and lets go of the
//! interpreter while it works. `portray/` is what users see: classes, defaults, documentation.
//!
//! Arrays of integers hold display values (sRGB) and straight coverage, as PNG does; arrays of `float32` linear light,
//! multiplied by coverage, as `OpenEXR` does.

mod argument;
mod array;
mod composite;
mod failure;
mod file;
mod quantize;
mod render;
mod sampling;
mod scene;
mod tone;

/// The native module.
#[pyo3::pymodule]
mod _core {
    use pyo3::exceptions::PyImportError;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::composite::composite;
    #[pymodule_export]
    use crate::file::{read, write};
    #[pymodule_export]
    use crate::quantize::quantize;
    #[pymodule_export]
    use crate::render::render_scene;
    #[pymodule_export]
    use crate::scene::compile_scene;
    #[pymodule_export]
    use crate::tone::tone;

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        processor::check().map_err(PyImportError::new_err)
    }
}
