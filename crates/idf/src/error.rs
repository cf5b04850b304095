//! `ReadError` and `WriteError`: what went wrong, with which file.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::description::SyntaxError;
use crate::image::{ImageError, words};
use crate::memory::MemoryError;
use crate::part::PartError;
use crate::plane::Kind;
use crate::rle::CodeError;

/// An error of the format libraries.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why an image cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ReadError {
    /// The system does not give the file.
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A folder, a device or a pipe.
    NotAFile {
        /// What is no file.
        path: PathBuf,
    },
    /// The description is not what it should be.
    Syntax {
        /// The description.
        path: PathBuf,
        /// The line and what is wrong with it.
        error: SyntaxError,
    },
    /// The description names a file outside its folder.
    Outside {
        /// The description.
        path: PathBuf,
        /// The file, as it names it.
        file: String,
    },
    /// A channel that was asked for is not there.
    Missing {
        /// The description.
        path: PathBuf,
        /// The channel.
        kind: Kind,
        /// What is there.
        present: Vec<Kind>,
    },
    /// Channels that were asked for together differ in size.
    Sizes {
        /// The description.
        path: PathBuf,
        /// One channel, and its columns and rows.
        first: (Kind, [u32; 2]),
        /// Another.
        second: (Kind, [u32; 2]),
    },
    /// A file has not the length that the description or the format gives it.
    Length {
        /// The file.
        path: PathBuf,
        /// Its bytes.
        found: u64,
        /// What was expected, in words.
        expected: String,
    },
    /// Run-length coded rows are damaged.
    Code {
        /// The file.
        path: PathBuf,
        /// How.
        error: CodeError,
    },
    /// A text file is not UTF-8.
    Text {
        /// The file.
        path: PathBuf,
    },
    /// The image takes more memory than there is.
    Memory {
        /// The image.
        path: PathBuf,
        /// How much.
        error: MemoryError,
    },
    /// The planes make no image.
    Image {
        /// The image.
        path: PathBuf,
        /// Why.
        error: ImageError,
    },
    /// The image is not the part of a picture that it should be.
    Part {
        /// The image.
        path: PathBuf,
        /// Why.
        error: PartError,
    },
    /// The ending, or what the file starts with, is of no known format.
    Format {
        /// The file.
        path: PathBuf,
        /// What can be read.
        expected: String,
    },
    /// The file is not what its format demands.
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Cause,
    },
}

/// Why an image cannot be written. The old image, if there was one, is as it was.
#[derive(Debug)]
#[non_exhaustive]
pub enum WriteError {
    /// The system does not take the file.
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// There is something other than a file of this name.
    NotAFile {
        /// What is no file.
        path: PathBuf,
    },
    /// A file name that a description cannot hold.
    Name {
        /// The name.
        path: PathBuf,
    },
    /// The ending is of no known format.
    Format {
        /// The file.
        path: PathBuf,
        /// What can be written.
        expected: String,
    },
    /// The format cannot hold the image.
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        error: ImageError,
    },
    /// The image that was to be added to cannot be read.
    Read(ReadError),
    /// Planes of another size than the image they were to be added to.
    Size {
        /// The image.
        path: PathBuf,
        /// Columns and rows of the planes.
        found: [u32; 2],
        /// Columns and rows of the image.
        expected: [u32; 2],
    },
    /// The encoder refused.
    Encode {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Cause,
    },
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, .. } => write!(f, "cannot read `{}`", path.display()),
            Self::NotAFile { path } => {
                write!(f, "cannot read `{}`: expected a file", path.display())
            }
            Self::Syntax { path, error } => {
                write!(f, "{}:{}: {error}", path.display(), error.line)
            }
            Self::Outside { path, file } => write!(
                f,
                "{}: expected files in its own folder, found `{file}`; if you trust it, say \
                 --outside",
                path.display()
            ),
            Self::Missing { path, kind, present } => {
                write!(f, "{}: no channel `{kind}`, found {}", path.display(), words(present))
            }
            Self::Sizes { path, first: (a, [aw, ah]), second: (b, [bw, bh]) } => write!(
                f,
                "{}: expected channels of one size, found `{a}` with {aw} x {ah} and `{b}` with \
                 {bw} x {bh}; copy one alone with icopy --channels {b} --resize {aw}x{ah}",
                path.display()
            ),
            Self::Length { path, found, expected } => {
                write!(f, "{}: {found} bytes, expected {expected}", path.display())
            }
            Self::Code { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Text { path } => write!(f, "{}: expected UTF-8 text", path.display()),
            Self::Memory { path, error } => write!(
                f,
                "{}: {error}; icopy --crop reads a part of an IDF image alone",
                path.display()
            ),
            Self::Image { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Part { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Format { path, expected } => {
                write!(f, "{}: unknown format, expected {expected}", path.display())
            }
            Self::Decode { path, .. } => write!(f, "cannot decode `{}`", path.display()),
        }
    }
}

impl Error for ReadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Decode { source, .. } => Some(source.as_ref()),
            _ => None,
        }
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, .. } => write!(f, "cannot write `{}`", path.display()),
            Self::NotAFile { path } => {
                write!(f, "cannot write `{}`: expected a file", path.display())
            }
            Self::Name { path } => {
                write!(f, "cannot write `{}`: expected a name of text in one line", path.display())
            }
            Self::Format { path, expected } => {
                write!(f, "cannot write `{}`: expected {expected}", path.display())
            }
            Self::Image { path, error } => {
                write!(f, "cannot write `{}`: {error}", path.display())
            }
            Self::Read(error) => error.fmt(f),
            Self::Size { path, found: [fw, fh], expected: [ew, eh] } => write!(
                f,
                "cannot add to `{}`: planes of {fw} x {fh}, expected {ew} x {eh}",
                path.display()
            ),
            Self::Encode { path, .. } => write!(f, "cannot encode `{}`", path.display()),
        }
    }
}

impl Error for WriteError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Encode { source, .. } => Some(source.as_ref()),
            Self::Read(error) => error.source(),
            _ => None,
        }
    }
}
