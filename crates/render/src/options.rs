//! What can be chosen about a render, as plain data.

/// How boundaries are found along a ray. All ways give the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accel {
    /// The paper's span lists of every object, for every ray.
    None,
    /// Span lists, and bounding boxes that pass over what a ray misses.
    Boxes,
    /// Span lists, boxes, rectangles in the picture, and boxes that the ray before was in taken as met.
    Coherence,
    /// Lazy seeking through hierarchies of boxes.
    #[default]
    Bvh,
}

/// A render's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Width of the picture in pixels, 1…65535.
    pub columns: u32,
    /// Height of the picture in pixels, 1…65535.
    pub rows: u32,
    /// Samples along each side of a pixel, at least 1: on a fixed grid, one at the centre.
    pub grid: u32,
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
            grid: 1,
            depth: 15,
            min_weight: 1.0 / 256.0,
            accel: Accel::default(),
            clamp: true,
            threads: 0,
        }
    }
}
