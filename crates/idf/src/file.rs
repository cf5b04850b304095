//! Whole files in and out: nothing is read beyond its length, nothing is half written.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile, TempPath};

use crate::error::{ReadError, WriteError};

/// Bytes of a file; an error where it is a folder, a device or a pipe.
pub(crate) fn length(path: &Path) -> Result<u64, ReadError> {
    let io = |source| ReadError::Io { path: path.into(), source };
    let metadata = fs::metadata(path).map_err(io)?;
    if metadata.is_file() {
        Ok(metadata.len())
    } else {
        Err(ReadError::NotAFile { path: path.into() })
    }
}

/// The `length` bytes of a file.
pub(crate) fn contents(path: &Path, length: u64) -> Result<Vec<u8>, ReadError> {
    let io = |source| ReadError::Io { path: path.into(), source };
    let mut file = File::open(path).map_err(io)?.take(length.saturating_add(1));
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    file.read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 == length {
        return Ok(bytes);
    }
    Err(ReadError::Length {
        path: path.into(),
        found: bytes.len() as u64,
        expected: format!("{length}, as when it was opened"),
    })
}

/// A text file of at most `most` bytes.
pub(crate) fn text(path: &Path, most: u64) -> Result<String, ReadError> {
    let length = length(path)?;
    if length > most {
        let expected = format!("a text of at most {most}");
        return Err(ReadError::Length { path: path.into(), found: length, expected });
    }
    let bytes = contents(path, length)?;
    String::from_utf8(bytes).map_err(|_| ReadError::Text { path: path.into() })
}

/// The folder that holds `path`.
pub(crate) fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// Fails where `path` is there but is no file, so that a rename would not replace it, or would
/// replace a device.
pub(crate) fn check_target(path: &Path) -> Result<(), WriteError> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => Err(WriteError::NotAFile { path: path.into() }),
        _ => Ok(()),
    }
}

/// Writes `bytes` beside `path`, under a temporary name that is removed unless it is kept.
pub(crate) fn stage(path: &Path, bytes: &[u8]) -> Result<TempPath, WriteError> {
    let (mut file, io) = (create_beside(path)?, |source| io_error(path, source));
    file.write_all(bytes).map_err(io)?;
    seal(file, path)
}

/// A new file beside `path`.
pub(crate) fn create_beside(path: &Path) -> Result<NamedTempFile, WriteError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{name}.");
    // Opened as any new file is, so that others may read it where the system says so.
    let file = Builder::new().prefix(&prefix).make_in(folder(path), |p| File::create_new(p));
    file.map_err(|source| io_error(path, source))
}

/// What was written is on the disk before a rename can be.
pub(crate) fn seal(file: NamedTempFile, path: &Path) -> Result<TempPath, WriteError> {
    file.as_file().sync_data().map_err(|source| io_error(path, source))?;
    Ok(file.into_temp_path())
}

/// Writes a file beside its name and then renames it.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    check_target(path)?;
    rename(stage(path, bytes)?, path)
}

/// Gives a staged file its name.
pub(crate) fn rename(staged: TempPath, path: &Path) -> Result<(), WriteError> {
    staged.persist(path).map_err(|error| io_error(path, error.error))
}

pub(crate) fn io_error(path: &Path, source: std::io::Error) -> WriteError {
    WriteError::Io { path: PathBuf::from(path), source }
}
