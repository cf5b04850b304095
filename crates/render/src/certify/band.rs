//! At what depths the rays of a cell enter a convex solid and leave it.
//!
//! Taken through the eye, a convex solid stays convex where its points have their place in the picture and the inverse of
//! their depth for coordinates (where rays are parallel, the depth itself). So if the four corners of a cell hit it, all of
//! the cell does; the last to enter is a corner; and since no chord of the surface through the middle of the cell
//! lies before it, the first to enter is at most as far before the middle as the last is behind it.

use scene::{Face, Four, Lanes, Ray};

use super::outline::Outline;
use super::sheet::{Cell, Sheet};
use crate::world::{Leaf, ROUNDING};

/// What all rays of a cell have in common in a solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band {
    /// Every ray goes through it.
    pub(crate) crossed: bool,
    /// Least and greatest depth where rays enter.
    pub(crate) enters: [f64; 2],
    /// Least and greatest depth where rays leave.
    pub(crate) leaves: [f64; 2],
    /// The face where all rays enter, if it is one and smooth.
    pub(crate) front: Option<Face>,
    /// The face where all rays leave.
    pub(crate) back: Option<Face>,
}

/// Surfaces that are nearer to each other than this share of their depth are not told apart.
const NEAR: f64 = 1e-7;

impl Band {
    /// No ray meets it.
    pub(crate) const MISSED: Self = Self {
        crossed: true,
        enters: [f64::INFINITY; 2],
        leaves: [f64::INFINITY; 2],
        front: None,
        back: None,
    };

    /// Rays may be in it somewhere between two depths.
    pub(super) fn unknown([low, high]: [f64; 2]) -> Self {
        Self {
            crossed: false,
            enters: [low, f64::INFINITY],
            leaves: [f64::NEG_INFINITY, high],
            front: None,
            back: None,
        }
    }

    /// Surfaces of solids of a magnitude that are nearer to each other at a depth are not told apart.
    pub(super) fn off(depth: f64, magnitude: f64) -> f64 {
        NEAR * depth.abs() + 64.0 * ROUNDING * magnitude
    }

    /// Of a leaf with this outline, by the rays of the corners and the middle of the cell.
    pub(crate) fn new(
        sheet: &Sheet,
        cell: &Cell,
        rays: &Rays,
        leaf: &Leaf,
        outline: &Outline,
    ) -> Self {
        let off = |depth: f64| Self::off(depth, leaf.magnitude);
        let [near, far] = outline.depth;
        let unknown = Self::unknown([near, far]);
        if !leaf.is_convex() {
            return unknown;
        }
        let corners = leaf.span(&rays.corners, Four::splat(0.0));
        let (from, to) = (corners.from.to_array(), corners.to.to_array());
        if (0..4).any(|k| from[k].is_nan() || to[k].is_nan() || from[k] >= to[k] || to[k] <= 0.0) {
            return unknown;
        }
        let middle = leaf.span(&rays.middle, 0.0);
        if middle.from.is_nan() || middle.from >= middle.to {
            return unknown;
        }
        let inside = from.iter().filter(|&&from| from <= 0.0).count();
        let enters = match inside {
            0 => Some(first_and_last(sheet.parallel, from, middle.from)),
            // The eye is inside of it.
            4 => None,
            _ => return unknown,
        };
        // What leaves last is to the depth what enters first is to the depth turned round.
        let least = to.iter().fold(f64::INFINITY, |least, &to| if to < least { to } else { least });
        let greatest = if sheet.parallel {
            2.0 * middle.to - least
        } else {
            let inverse = 2.0 / middle.to - 1.0 / least;
            if inverse > 0.0 { 1.0 / inverse } else { f64::INFINITY }
        };
        let greatest = if greatest < far { greatest } else { far };
        let enters = enters.map_or([f64::NEG_INFINITY; 2], |[first, last]| {
            let first = if first > near { first } else { near };
            [first - off(first), last + off(last)]
        });
        let leaves = [least - off(least), greatest + off(greatest)];
        let face = |faces: [f64; 4], middle: Face, entered: bool| {
            let same = faces.iter().all(|&face| (face - middle.number()).abs() < 0.5);
            (same && is_one(outline, cell, middle, entered)).then_some(middle)
        };
        let front = (inside == 0)
            .then(|| face(corners.from_face.to_array(), middle.entered(), true))
            .flatten();
        let back = face(corners.to_face.to_array(), middle.left(), false);
        Self { crossed: true, enters, leaves, front, back }
    }
}

/// True if a face that all corners enter by, or leave by, is the only one and has no tip in the cell.
fn is_one(outline: &Outline, cell: &Cell, face: Face, entered: bool) -> bool {
    // Flat faces are convex. The side goes round the caps.
    let wide = Cell { half: 1.0001 * cell.half, ..*cell };
    face.0 != 0
        || outline
            .rims
            .iter()
            .flatten()
            .all(|rim| rim.entered != entered || rim.outside.over(cell).low > 0.0)
            && !outline.apex.is_some_and(|apex| wide.holds(apex))
}

/// The least depth of a convex surface over a cell and the greatest, by its corners and its middle.
fn first_and_last(parallel: bool, corners: [f64; 4], middle: f64) -> [f64; 2] {
    let last = corners.iter().fold(0.0, |last, &from| if from > last { from } else { last });
    let first = if parallel { 2.0 * middle - last } else { 1.0 / (2.0 / middle - 1.0 / last) };
    [first, last]
}

/// The rays of a cell that are looked at.
#[derive(Clone, Debug)]
pub(crate) struct Rays {
    corners: Ray<Four>,
    middle: Ray,
}

impl Rays {
    pub(crate) fn new(sheet: &Sheet, cell: &Cell) -> Self {
        Self { corners: sheet.corner_rays(cell), middle: sheet.ray(cell.middle) }
    }
}
