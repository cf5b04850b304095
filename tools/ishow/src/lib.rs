//! An image in the terminal: by the kitty graphics protocol, as sixel, or in half blocks.

mod answers;
mod blocks;
pub mod command;
mod kitty;
mod layout;
mod signals;
mod terminal;

use std::error::Error;
use std::fmt;

use icopy::{CopyError, Options, copied};
use idf::{Image, ImageError};
use iencode::dither;
use ilut::{Metric, Pixels, TableError};

pub use blocks::Colors;
pub use layout::Screen;

/// How a picture gets to the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// The kitty graphics protocol: a PNG in escape sequences.
    Kitty,
    /// Sixel: at most 256 colours.
    Sixel,
    /// Characters, each of two blocks one above the other.
    Blocks,
}

/// What draws a picture, in pieces between which drawing may end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// To be written one after the other.
    pub pieces: Vec<String>,
    /// What brings the terminal back to text where not all pieces are written.
    pub closing: &'static str,
}

/// Why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShowError {
    /// It cannot be resized or flattened.
    Image(CopyError),
    /// It cannot be quantised.
    Table(TableError),
    /// It cannot be coded.
    Code(String),
}

/// What draws `image` on `screen`, over `behind` (display values, 0 to 1).
///
/// # Errors
///
/// If the image has no light, or a sample is not a number.
pub fn drawing(
    image: &Image,
    behind: [f64; 3],
    screen: &Screen,
    protocol: Protocol,
) -> Result<Drawing, ShowError> {
    let size = match protocol {
        Protocol::Blocks => screen.blocks(image.size()),
        Protocol::Kitty | Protocol::Sixel => screen.pixels(image.size()),
    };
    let flat = image.flattened(Some(behind))?;
    let resize = Some(size).filter(|&size| size != image.size());
    let fitted = copied(&flat, &Options { resize, ..Options::default() })?;
    let pixels = Pixels::of(&fitted, None)?;
    match protocol {
        Protocol::Kitty => kitty::drawing(&pixels),
        Protocol::Sixel => sixel(&pixels, screen.registers),
        Protocol::Blocks => Ok(blocks::drawing(&pixels, screen.colors)),
    }
}

/// Dithered to the eye, in as many colours as the terminal has registers.
fn sixel(pixels: &Pixels, registers: usize) -> Result<Drawing, ShowError> {
    let table = ilut::Options {
        colors: registers.clamp(2, 256),
        metric: Metric::Oklab,
        ..ilut::Options::default()
    };
    let dither = &dither::FLOYD_STEINBERG;
    let options = iencode::Options { table, dither, ..iencode::Options::default() };
    let encoded = iencode::encoded(&[pixels], None, &options).map_err(ShowError::Table)?;
    let columns = pixels.columns() as usize;
    let text = iencode::sixel::encode(columns, &encoded.indices[0], encoded.table.colors());
    let mut pieces: Vec<String> = text.split_inclusive('-').map(str::to_owned).collect();
    pieces.push("\n".into());
    Ok(Drawing { pieces, closing: "\x1b\\\n" })
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Kitty => "kitty graphics",
            Self::Sixel => "sixel",
            Self::Blocks => "half blocks",
        })
    }
}

impl From<CopyError> for ShowError {
    fn from(error: CopyError) -> Self {
        Self::Image(error)
    }
}

impl From<ImageError> for ShowError {
    fn from(error: ImageError) -> Self {
        Self::Image(error.into())
    }
}

impl fmt::Display for ShowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Table(error) => error.fmt(f),
            Self::Code(error) => f.write_str(error),
        }
    }
}

impl Error for ShowError {}
