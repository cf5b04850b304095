//! Images on disk: a description, and one file for each channel.
//!
//! An image `glass` is a text file `glass.idf` that names data files:
//!
//! ```text
//! idf 1
//! size 4 2                  # columns rows
//! window 0 0 4 2            # where the picture lies on a larger one: column row columns rows
//! transfer srgb             # how light is stored: srgb, linear, or gamma and a number
//! matte premultiplied       # or straight: how colour and coverage go together
//! background 0.8 0.8 0.8    # display values, put behind where coverage is below 1
//! grg  glass.grg  4 2 8 rle
//! cvg  glass.cvg  4 2 8 raw
//! log  glass.log
//! ```
//!
//! Only `idf` and `size` are required. A channel line has the kind of the channel (the words of
//! [`plane::TABLE`]), its file (in quotes where the name has blanks), columns and rows, the depth
//! of a sample (`8`, `16`, `32f`) and the encoding (`raw` samples, little-endian, or `rle`, see
//! [`rle`]). The text may be edited by hand: a channel is dropped or borrowed by changing a line,
//! and lines with other keys or comments alone are kept as they are.
//!
//! Light is stored by the transfer after it was multiplied by coverage, so decoded samples are
//! what compositing works on. Floating point is linear unless the description says otherwise.
//!
//! ```
//! use idf::{Image, Kind, Plane, ReadOptions, Samples, WriteOptions};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("glass");
//! let planes = vec![
//!     Plane { kind: Kind::Grg, samples: Samples::U8(vec![200; 8]) },
//!     Plane { kind: Kind::Cvg, samples: Samples::U8(vec![0, 85, 170, 255, 0, 85, 170, 255]) },
//! ];
//! let mut image = Image::new(4, 2, planes)?;
//! image.properties.background = Some([0.8; 3]);
//! idf::write(&path, &image, &WriteOptions::default())?;
//!
//! assert_eq!(
//!     std::fs::read_to_string(path.with_extension("idf"))?,
//!     "idf 1\nsize 4 2\nmatte premultiplied\nbackground 0.8 0.8 0.8\n\
//!      grg glass.grg 4 2 8 raw\ncvg glass.cvg 4 2 8 raw\n"
//! );
//! assert_eq!(idf::read(&path, &ReadOptions::default())?, image);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channel;
#[cfg(feature = "command")]
pub mod command;
mod convert;
pub mod description;
mod error;
#[cfg(feature = "exchange")]
pub mod exchange;
mod file;
pub mod history;
mod image;
mod lut;
mod memory;
pub mod part;
pub mod plane;
mod read;
pub mod rle;
pub mod rows;
mod samples;
pub mod transfer;
mod write;

pub use convert::Form;
pub use description::{Description, Encoding};
pub use error::{Cause, ReadError, WriteError};
pub use image::{
    Image, ImageError, MOST_COLUMNS, MOST_SAMPLES, Matte, Plane, Properties, Window, checked_size,
};
pub use lut::Lut;
pub use memory::{MemoryError, check as check_memory};
pub use plane::Kind;
pub use read::{Ask, ReadOptions, description_path, read, read_description};
pub use samples::{Depth, Samples};
pub use transfer::{Quantizer, Transfer, srgb8};
pub use write::{WriteOptions, add, write};
