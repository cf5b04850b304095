//! Any image format to any other, and what texture scripts need on the way: channels, crop, border,
//! shift, resize, flip, rotate, tile, levels of detail, colours under holes; windows put together.
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
mod canvas;
mod channels;
pub mod command;
mod fill;
mod join;
mod mix;
pub mod resize;
mod seamless;
mod stream;
mod words;

use std::error::Error;
use std::fmt;

use idf::{Depth, Image, ImageError, Kind, MOST_SAMPLES, Matte, check_memory};

pub use arrange::{Axis, Region, Turn};
pub use canvas::{Border, Extent};
pub use channels::{Pick, Source};
pub use join::joined;
pub use resize::{Filter, resized};

/// What to do on the way, in the order of the fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Channels to keep, in this order; without it, all.
    pub channels: Option<Vec<Pick>>,
    /// The part to keep.
    pub crop: Option<Region>,
    /// Where a border about the picture ends, and what it is.
    pub extend: Option<(Extent, Border)>,
    /// How far the picture is moved to the right and down, around its edges.
    pub shift: [i32; 2],
    /// Blend opposite edges so that they meet; see [`copied`].
    pub tileable: bool,
    /// Columns and rows to resample to.
    pub resize: Option<[u32; 2]>,
    /// How to resample, here and for levels of detail.
    pub filter: Filter,
    /// The axis that is reversed.
    pub flip: Option<Axis>,
    /// Clockwise turn.
    pub rotate: Option<Turn>,
    /// How often the picture is repeated, across and down.
    pub tile: [u32; 2],
    /// Colours where nothing is covered, from those about; light becomes straight.
    pub fill: bool,
    /// What to paint where coverage is below 1.
    pub flatten: Option<Behind>,
    /// How light and coverage go together.
    pub matte: Option<Matte>,
    /// Depth of light and coverage. A deeper one is taken first, before samples are mixed.
    pub depth: Option<Depth>,
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
    /// There is no picture to put together.
    NoImage,
    /// Pictures to put together have different channels.
    Channels {
        /// Those of the first.
        first: Vec<Kind>,
        /// Those of another.
        other: Vec<Kind>,
    },
    /// Pictures to put together have different colour tables.
    Tables,
    /// Pictures to put together have a channel in different depths.
    Depths {
        /// The channel.
        kind: Kind,
        /// The depths.
        depths: [Depth; 2],
    },
}

impl Default for Options {
    fn default() -> Self {
        Self {
            channels: None,
            crop: None,
            extend: None,
            shift: [0, 0],
            tileable: false,
            resize: None,
            filter: Filter::default(),
            flip: None,
            rotate: None,
            tile: [1, 1],
            fill: false,
            flatten: None,
            matte: None,
            depth: None,
        }
    }
}

impl Options {
    /// The same for measured values: pixels go to their places, and light is not looked at. Nothing
    /// where all stay.
    fn for_data(&self) -> Option<Self> {
        let light = Self {
            channels: None,
            fill: false,
            flatten: None,
            matte: None,
            depth: None,
            ..self.clone()
        };
        let filter = Filter::default();
        Some(light).filter(|light| Self { filter, ..light.clone() } != Self::default())
    }

    /// Whether the work needs coverage that the copy is not to have: what is not covered gets light.
    fn hides_coverage(&self) -> bool {
        let is_left_out = |picks: &Vec<Pick>| picks.iter().all(|pick| pick.to != Kind::Cvg);
        (self.fill || self.flatten.is_some()) && self.channels.as_ref().is_some_and(is_left_out)
    }

    /// Whether samples are mixed, or those of the border are new.
    fn mixes(&self) -> bool {
        self.tileable || self.resize.is_some()
    }
}

/// The image as `options` want it.
///
/// To make it tileable, it is mixed, first across, then down, with itself shifted by half its
/// length, whose seam is in the middle: at an edge all is the shifted picture, from a quarter of
/// the length on all is the picture itself, between lies a smooth step.
///
/// # Errors
///
/// If a channel is missing, the part lies outside, or the size would be beyond an image's.
pub fn copied(image: &Image, options: &Options) -> Result<Image, CopyError> {
    finished(placed(image, options)?, options)
}

/// The image as `options` want it, and its levels of detail: each has half the columns and rows of
/// the one before, rounded down, to one pixel. All are resampled from the first, before holes are
/// filled and samples rounded to a lesser depth.
///
/// # Errors
///
/// As [`copied`].
pub fn levels(image: &Image, options: &Options) -> Result<Vec<Image>, CopyError> {
    let base = placed(image, options)?;
    let mut levels = vec![finished(base.clone(), options)?];
    let mut size = base.size();
    while size != [1, 1] {
        size = size.map(|length| (length / 2).max(1));
        levels.push(finished(resized(&base, size, options.filter)?, options)?);
    }
    Ok(levels)
}

/// Everything that gives pixels their places.
fn placed(image: &Image, options: &Options) -> Result<Image, CopyError> {
    check_memory(working_bytes(image, options)).map_err(ImageError::from)?;
    let mut copy = match (&options.channels, options.crop) {
        (Some(picks), _) => {
            let hidden = options.hides_coverage().then_some(Kind::Cvg);
            let coverage = hidden.filter(|&kind| image.plane(kind).is_some());
            let coverage = coverage.map(|kind| Pick { to: kind, from: kind.into() });
            let picks: Vec<Pick> = picks.iter().copied().chain(coverage).collect();
            channels::picked(image, &picks)?
        }
        // Samples that are not kept are not copied.
        (None, Some(region)) => arrange::cropped(image, region)?,
        (None, None) => image.clone(),
    };
    if let Some(depth) = options.depth.filter(|&depth| depth > copy.depth()) {
        copy = copy.at_depth(depth)?;
    }
    if let Some(region) = options.crop.filter(|_| options.channels.is_some()) {
        copy = arrange::cropped(&copy, region)?;
    }
    if let Some((extent, border)) = options.extend {
        copy = canvas::extended(&copy, extent, border)?;
    }
    if options.shift != [0, 0] {
        copy = arrange::shifted(&copy, options.shift)?;
    }
    if options.tileable {
        copy = seamless::seamless(&copy)?;
    }
    if let Some(size) = options.resize {
        copy = resized(&copy, size, options.filter)?;
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
    Ok(copy)
}

/// Bytes that the work takes beside the image: a copy of it, and the next one.
fn working_bytes(image: &Image, options: &Options) -> u64 {
    let pixels = |[columns, rows]: [u32; 2]| u64::from(columns) * u64::from(rows);
    let own = pixels(image.size());
    let placed = options.resize.map_or(own, pixels).saturating_mul(pixels(options.tile));
    if placed > MOST_SAMPLES {
        // No picture is so large, as is said where it would be made.
        return 0;
    }
    // Mixed planes are values on the way, one after the other: as they are, across and down.
    let values = if options.mixes() { 3 * size_of::<f32>() as u64 * own.max(placed) } else { 0 };
    let after = (image.bytes() / own).saturating_mul(placed);
    image.bytes().saturating_add(after).saturating_add(values)
}

/// Everything that says how light is stored.
fn finished(mut copy: Image, options: &Options) -> Result<Image, CopyError> {
    if options.fill {
        copy = fill::filled(&copy)?;
    }
    match options.flatten {
        None => {}
        Some(Behind::Own) => copy = copy.flattened(None)?,
        Some(Behind::Color(color)) => copy = copy.flattened(Some(color))?,
    }
    if options.hides_coverage() && copy.plane(Kind::Cvg).is_some() {
        let kept = copy.planes().iter().filter(|plane| plane.kind != Kind::Cvg).cloned().collect();
        copy = copy.with_planes(copy.columns(), copy.rows(), kept)?;
    }
    if let Some(matte) = options.matte {
        copy = copy.with_matte(matte)?;
    }
    if let Some(depth) = options.depth.filter(|&depth| depth != copy.depth()) {
        copy = copy.at_depth(depth)?;
    }
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
            Self::NoImage => f.write_str("expected a picture, found none"),
            Self::Channels { first, other } => {
                let words = |kinds: &[Kind]| {
                    kinds.iter().map(|kind| kind.word()).collect::<Vec<_>>().join(" ")
                };
                let (first, other) = (words(first), words(other));
                write!(f, "expected pictures of the same channels, found {first} and {other}")
            }
            Self::Tables => f.write_str("expected pictures of one colour table, found two"),
            Self::Depths { kind, depths: [a, b] } => {
                let (a, b) = (a.word(), b.word());
                write!(f, "expected `{kind}` of one depth, found {a} and {b}")
            }
        }
    }
}

impl Error for CopyError {}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Plane, Samples};

    fn grey(columns: u32, samples: &[u8]) -> Image {
        let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples.into()) };
        let rows = u32::try_from(samples.len()).unwrap() / columns;
        Image::new(columns, rows, vec![plane]).unwrap()
    }

    #[test]
    fn samples_are_mixed_at_the_deeper_depth() {
        let options = Options { resize: Some([1, 1]), ..Options::default() };
        let half = |depth| {
            let options = Options { depth, ..options.clone() };
            let samples = copied(&grey(2, &[128, 0]), &options).unwrap();
            samples.plane(Kind::Grg).cloned().unwrap()
        };
        // 128 is 0.2158605 of linear light; half of that is stored as 92.37 of 255.
        assert_eq!(half(None), Samples::U8(vec![92]));
        assert_eq!(half(Some(Depth::U16)), Samples::U16(vec![23_740]));
    }

    #[test]
    fn levels_halve_to_one_pixel() {
        let image = grey(6, &(0..18).collect::<Vec<u8>>()).at_depth(Depth::F32).unwrap();
        let levels = levels(&image, &Options::default()).unwrap();
        let sizes: Vec<[u32; 2]> = levels.iter().map(Image::size).collect();
        assert_eq!(sizes, [[6, 3], [3, 1], [1, 1]]);
        // The mean of all is in the last.
        let values = image.decoded(Kind::Grg).unwrap();
        let mean = values.iter().sum::<f32>() / 18.0;
        let last = levels[2].decoded(Kind::Grg).unwrap()[0];
        assert!((last - mean).abs() < 1e-6, "{last} {mean}");
    }
}
