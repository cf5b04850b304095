//! Planes that are filled a rectangle at a time.

use std::ops::Range;

use super::PartError;
use crate::image::{Image, ImageError, Plane, Window, checked_size};
use crate::memory::check;
use crate::plane::Kind;
use crate::samples::{Depth, Samples};

/// Planes of one size, 0 where nothing was put.
#[derive(Clone, Debug)]
pub struct Canvas {
    window: Window,
    planes: Vec<Plane>,
}

impl Canvas {
    /// One without planes that lies at `window`.
    ///
    /// # Errors
    ///
    /// If the window has no pixels, or more than an image may have.
    pub fn new(window: Window) -> Result<Self, ImageError> {
        checked_size(window.columns, window.rows)?;
        Ok(Self { window, planes: Vec::new() })
    }

    /// Makes the plane of a kind, if it is not there.
    ///
    /// # Errors
    ///
    /// If there is no memory for it.
    pub fn make(&mut self, kind: Kind, depth: Depth) -> Result<(), PartError> {
        self.plane(kind, depth).map(drop)
    }

    /// Copies the rectangle `part` of a plane that lies at `window` to the plane of its kind, which is
    /// made if it is not there.
    ///
    /// # Errors
    ///
    /// If there is no memory for a plane, or that of this kind has another depth.
    ///
    /// # Panics
    ///
    /// If `part` is not within both windows, or `samples` do not fill theirs.
    pub fn put(
        &mut self,
        kind: Kind,
        samples: &Samples,
        window: Window,
        part: Window,
    ) -> Result<(), PartError> {
        let depth = samples.depth();
        let own = self.window;
        let plane = self.plane(kind, depth)?;
        let lines = lines(own, part).zip(lines(window, part));
        match (&mut plane.samples, samples) {
            (Samples::U8(all), Samples::U8(some)) => copy(all, some, lines),
            (Samples::U16(all), Samples::U16(some)) => copy(all, some, lines),
            (Samples::F32(all), Samples::F32(some)) => copy(all, some, lines),
            (all, _) => return Err(PartError::Depth { kind, depths: [all.depth(), depth] }),
        }
        Ok(())
    }

    /// Fills the rectangle `part` of a coverage with its largest value.
    ///
    /// # Errors
    ///
    /// As [`Canvas::put`].
    pub fn cover(&mut self, depth: Depth, part: Window) -> Result<(), PartError> {
        let own = self.window;
        let plane = self.plane(Kind::Cvg, depth)?;
        for line in lines(own, part) {
            match &mut plane.samples {
                Samples::U8(all) => all[line].fill(u8::MAX),
                Samples::U16(all) => all[line].fill(u16::MAX),
                Samples::F32(all) => all[line].fill(1.0),
            }
        }
        Ok(())
    }

    fn plane(&mut self, kind: Kind, depth: Depth) -> Result<&mut Plane, PartError> {
        let at = self.planes.iter().position(|plane| plane.kind == kind);
        let at = match at {
            Some(at) => at,
            None => {
                let pixels = u64::from(self.window.columns) * u64::from(self.window.rows);
                check(pixels * depth.bytes() as u64).map_err(PartError::Memory)?;
                let length = usize::try_from(pixels).expect("at most 2³¹");
                let samples = match depth {
                    Depth::U8 => Samples::U8(vec![0; length]),
                    Depth::U16 => Samples::U16(vec![0; length]),
                    Depth::F32 => Samples::F32(vec![0.0; length]),
                };
                self.planes.push(Plane { kind, samples });
                self.planes.len() - 1
            }
        };
        Ok(&mut self.planes[at])
    }

    /// The planes as an image that lies where the canvas does, in the order of `kinds`; others follow.
    ///
    /// # Errors
    ///
    /// As [`Image::new`].
    pub fn into_image(self, kinds: &[Kind]) -> Result<Image, ImageError> {
        let Self { window, mut planes } = self;
        let rank = |kind: Kind| kinds.iter().position(|&k| k == kind).unwrap_or(kinds.len());
        planes.sort_by_key(|plane| rank(plane.kind));
        let mut image = Image::new(window.columns, window.rows, planes)?;
        image.properties.origin = [window.column, window.row];
        Ok(image)
    }
}

/// Where the rows of `part` are among the samples of `window`.
pub(super) fn lines(window: Window, part: Window) -> impl Iterator<Item = Range<usize>> {
    let left = part.column.abs_diff(window.column) as usize;
    let top = part.row.abs_diff(window.row) as usize;
    let (columns, width) = (part.columns as usize, window.columns as usize);
    (0..part.rows as usize).map(move |row| {
        let start = (top + row) * width + left;
        start..start + columns
    })
}

fn copy<T: Copy>(
    all: &mut [T],
    some: &[T],
    lines: impl Iterator<Item = (Range<usize>, Range<usize>)>,
) {
    for (to, from) in lines {
        all[to].copy_from_slice(&some[from]);
    }
}
