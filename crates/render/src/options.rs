//! What can be chosen about a render, as plain data.

use std::time::Duration;

pub use crate::sampling::filter::Filter;

/// How boundaries are found along a ray. All ways give the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accel {
    /// The paper's span lists of every object, for every ray.
    None,
    /// Span lists, and bounding boxes that pass over what a ray misses.
    Boxes,
    /// The same without the trees of boxes over the terms of large unions: every term is asked. To measure what trees bring.
    Flat,
    /// Span lists, and boxes with their corners cut off. To measure whether a tighter volume pays.
    Slanted,
    /// Span lists, boxes, rectangles in the picture, and boxes that the ray before was in taken as met.
    Coherence,
    /// The same without rectangles. To measure what they bring.
    Remembered,
    /// Lazy seeking through hierarchies of boxes.
    #[default]
    Bvh,
}

/// Which points of a pixel are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// The centres of a grid of so many squares along each side of a pixel, 1…256.
    Grid(u32),
    /// The corners of pixels, which neighbours share. A square whose corners differ, by colour or by object, is divided
    /// into four (Whitted, "An Improved Illumination Model for Shaded Display", 1980).
    Subdivided {
        /// How often at most, 0…[`Sampling::MOST_LEVELS`].
        levels: u32,
    },
    /// Points drawn by lot, but evenly spread.
    Stochastic(Rate),
}

/// How many samples there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// So many in each pixel, 1…[`Rate::MOST_SAMPLES`].
    Samples(u32),
    /// As many as it takes until the root of the mean square error of the picture is estimated to be at most this, in
    /// display steps of 1/255; above 0. Samples differ from pixel to pixel.
    Error(f64),
    /// As many as there is time for, from the start of the render. Other runs give other pictures.
    Time(Duration),
}

impl Sampling {
    /// Squares of a pixel divided so often have sides of 1/16.
    pub const MOST_LEVELS: u32 = 4;
}

impl Rate {
    /// The largest number of samples in a pixel.
    pub const MOST_SAMPLES: u32 = 65_536;
}

impl Default for Sampling {
    fn default() -> Self {
        Self::Grid(1)
    }
}

/// A render's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Width of the picture in pixels, 1…65535.
    pub columns: u32,
    /// Height of the picture in pixels, 1…65535.
    pub rows: u32,
    /// Which points of a pixel are looked at.
    pub sampling: Sampling,
    /// What can be proved to show one surface, or none, is not looked at for others; the rest is divided down to a 64th
    /// of a pixel. Pixels that show two surfaces have samples of both, by their areas.
    pub certify: bool,
    /// What a sample counts for in the pixels around it.
    pub filter: Filter,
    /// What samples are drawn by; another number gives another picture of the same error.
    pub seed: u32,
    /// Rays of the tree past this depth return the background; at most [`Options::DEPTH_LIMIT`].
    pub depth: u32,
    /// Rays that can add less than this to a channel are left out.
    pub min_weight: f64,
    /// How boundaries are found.
    pub accel: Accel,
    /// Samples are clamped to display white before they are averaged; not for pictures in floating point.
    pub clamp: bool,
    /// Threads to use; 0 for as many as there are processors.
    pub threads: usize,
}

impl Options {
    /// The largest depth: each level of the ray tree takes stack.
    pub const DEPTH_LIMIT: u32 = 10_000;
    /// The largest number of columns or rows.
    pub const SIDE_LIMIT: u32 = 65_535;
}

impl Default for Options {
    fn default() -> Self {
        Self {
            columns: 512,
            rows: 512,
            sampling: Sampling::default(),
            certify: false,
            filter: Filter::default(),
            seed: 0,
            depth: 15,
            min_weight: 1.0 / 256.0,
            accel: Accel::default(),
            clamp: true,
            threads: 0,
        }
    }
}
