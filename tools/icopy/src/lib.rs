//! Any image format to any other, and what texture scripts need on the way: crop, resize, flip,
//! rotate, tile, pick and rename channels.
//!
//! ```
//! use icopy::{Options, copied};
//! use idf::{Image, Kind, Plane, Samples};
//!
//! let grey = Plane { kind: Kind::Grg, samples: Samples::U8(vec![1, 2]) };
//! let image = Image::new(2, 1, vec![grey])?;
//! let tiled = copied(&image, &Options { tile: [2, 1], ..Options::default() })?;
//! assert_eq!(tiled.plane(Kind::Grg), Some(&Samples::U8(vec![1, 2, 1, 2])));
//! # Ok::<(), icopy::CopyError>(())
//! ```

mod arrange;
pub mod command;
mod resize;

use std::error::Error;
use std::fmt;

use idf::{Depth, Image, ImageError, Kind, Matte, Plane};

pub use arrange::{Axis, Region, Turn};

/// What to do on the way, in the order of the fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Channels to keep, in this order; without it, all.
    pub channels: Option<Vec<Pick>>,
    /// The part to keep.
    pub crop: Option<Region>,
    /// Columns and rows to resample to.
    pub resize: Option<[u32; 2]>,
    /// The axis that is reversed.
    pub flip: Option<Axis>,
    /// Clockwise turn.
    pub rotate: Option<Turn>,
    /// How often the picture is repeated, across and down.
    pub tile: [u32; 2],
    /// What to paint where coverage is below 1.
    pub flatten: Option<Behind>,
    /// How light and coverage go together.
    pub matte: Option<Matte>,
    /// Depth of light and coverage. A deeper one is taken first, before samples are mixed.
    pub depth: Option<Depth>,
}

/// A channel to keep, and its new kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pick {
    /// Kind in the copy.
    pub to: Kind,
    /// Kind in the original.
    pub from: Kind,
}

/// What to paint where coverage is below 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behind {
    /// The image's own background, or black.
    Own,
    /// Display values.
    Color([f64; 3]),
}

/// Why an image cannot be copied so.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CopyError {
    /// The samples do not allow it.
    Image(ImageError),
    /// The part is not inside the picture.
    Region {
        /// The part.
        found: Region,
        /// Columns and rows of the picture.
        size: [u32; 2],
    },
}

impl Default for Options {
    fn default() -> Self {
        Self {
            channels: None,
            crop: None,
            resize: None,
            flip: None,
            rotate: None,
            tile: [1, 1],
            flatten: None,
            matte: None,
            depth: None,
        }
    }
}

/// The image as `options` want it.
///
/// # Errors
///
/// If a channel is missing, the part lies outside, or the size would be beyond an image's.
pub fn copied(image: &Image, options: &Options) -> Result<Image, CopyError> {
    let mut copy = match &options.channels {
        Some(picks) => picked(image, picks)?,
        None => image.clone(),
    };
    if let Some(depth) = options.depth.filter(|&depth| depth > copy.depth()) {
        copy = copy.at_depth(depth)?;
    }
    if let Some(region) = options.crop {
        copy = arrange::cropped(&copy, region)?;
    }
    if let Some(size) = options.resize {
        copy = resize::resized(&copy, size)?;
    }
    if let Some(axis) = options.flip {
        copy = arrange::flipped(&copy, axis)?;
    }
    if let Some(turn) = options.rotate {
        copy = arrange::rotated(&copy, turn)?;
    }
    if options.tile != [1, 1] {
        copy = arrange::tiled(&copy, options.tile)?;
    }
    match options.flatten {
        None => {}
        Some(Behind::Own) => copy = copy.flattened(None)?,
        Some(Behind::Color(color)) => copy = copy.flattened(Some(color))?,
    }
    if let Some(matte) = options.matte {
        copy = copy.with_matte(matte)?;
    }
    if let Some(depth) = options.depth.filter(|&depth| depth != copy.depth()) {
        copy = copy.at_depth(depth)?;
    }
    Ok(copy)
}

/// Only the channels of `picks`, under their new kinds.
fn picked(image: &Image, picks: &[Pick]) -> Result<Image, CopyError> {
    let mut planes = Vec::new();
    for pick in picks.iter().filter(|pick| pick.from != Kind::Lut) {
        let samples = image.needed(pick.from)?.clone();
        planes.push(Plane { kind: pick.to, samples });
    }
    let wants_lut = picks.iter().any(|pick| pick.from == Kind::Lut);
    if wants_lut && image.lut.is_none() {
        let present = image.kinds();
        return Err(ImageError::Missing { kind: Kind::Lut, present }.into());
    }
    let mut copy = image.with_planes(image.columns(), image.rows(), planes)?;
    copy.lut = copy.lut.filter(|_| wants_lut);
    Ok(copy)
}

impl From<ImageError> for CopyError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

impl fmt::Display for CopyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Region {
                found: Region { column, row, columns, rows },
                size: [width, height],
            } => {
                write!(
                    f,
                    "expected a part of {width} x {height} pixels, found {columns} x {rows} at \
                     column {column}, row {row}"
                )
            }
        }
    }
}

impl Error for CopyError {}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Lut, Samples};

    fn image() -> Image {
        let plane = |kind, samples: [u8; 2]| Plane { kind, samples: Samples::U8(samples.into()) };
        let planes = vec![plane(Kind::Enc, [0, 1]), plane(Kind::Grg, [128, 0])];
        let mut image = Image::new(2, 1, planes).unwrap();
        image.lut = Lut::new(vec![[1, 2, 3]; 2]);
        image
    }

    fn picked(picks: &[(Kind, Kind)]) -> Result<Image, CopyError> {
        let picks = picks.iter().map(|&(to, from)| Pick { to, from }).collect();
        copied(&image(), &Options { channels: Some(picks), ..Options::default() })
    }

    #[test]
    fn channels_are_picked_and_renamed() {
        let copy = picked(&[(Kind::Cvg, Kind::Grg), (Kind::Grg, Kind::Grg)]).unwrap();
        assert_eq!(copy.kinds(), [Kind::Cvg, Kind::Grg]);
        assert_eq!(copy.plane(Kind::Cvg), Some(&Samples::U8(vec![128, 0])));
        let copy = picked(&[(Kind::Lut, Kind::Lut), (Kind::Enc, Kind::Enc)]).unwrap();
        assert_eq!(copy.kinds(), [Kind::Enc, Kind::Lut]);
        let present = vec![Kind::Enc, Kind::Grg, Kind::Lut];
        let missing = ImageError::Missing { kind: Kind::Red, present };
        assert_eq!(picked(&[(Kind::Red, Kind::Red)]), Err(CopyError::Image(missing)));
        let twice = picked(&[(Kind::Cvg, Kind::Grg), (Kind::Cvg, Kind::Grg)]);
        assert_eq!(twice, Err(CopyError::Image(ImageError::Twice(Kind::Cvg))));
    }

    #[test]
    fn samples_are_mixed_at_the_deeper_depth() {
        let options = Options { resize: Some([1, 1]), ..Options::default() };
        let grey = |depth| {
            let options = Options { depth, ..options.clone() };
            let samples = copied(&image(), &options).unwrap().plane(Kind::Grg).cloned();
            samples.unwrap()
        };
        // 128 is 0.2158605 of linear light; half of that is stored as 92.37 of 255.
        assert_eq!(grey(None), Samples::U8(vec![92]));
        assert_eq!(grey(Some(Depth::U16)), Samples::U16(vec![23_740]));
    }
}
