//! Errors of the libraries as those of Python.

use std::io;

use idf::{ImageError, ReadError, WriteError};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::argument::value;

/// An image that cannot be, or has not what the work needs.
pub(crate) fn image(error: &ImageError) -> PyErr {
    value(error.to_string())
}

/// `OSError` and its kinds for what the system refused, else `ValueError`.
pub(crate) fn read(error: &ReadError) -> PyErr {
    match error {
        ReadError::Io { source, .. } => system(source, error.to_string()),
        ReadError::NotAFile { .. } => system(&io::Error::other(""), error.to_string()),
        ReadError::Memory { .. } => PyMemoryError::new_err(error.to_string()),
        _ => value(chain(error)),
    }
}

/// The same for what is written.
pub(crate) fn write(error: &WriteError) -> PyErr {
    match error {
        WriteError::Io { source, .. } => system(source, error.to_string()),
        _ => value(chain(error)),
    }
}

/// A refusal of the system, as the kind of `OSError` that it is.
pub(crate) fn system(source: &io::Error, message: String) -> PyErr {
    // The library's message has the path already, and the reason too.
    io::Error::new(source.kind(), message).into()
}

/// The message with those of its causes that it does not tell itself.
fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let said = cause.to_string();
        if !text.contains(&said) {
            text = format!("{text}: {said}");
        }
        next = cause.source();
    }
    text
}
