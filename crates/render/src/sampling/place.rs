//! Where in the scene a place of the picture looks, and what a ray there stands for.

use glam::DVec3;
use scene::{Sight, View};

use crate::shade::footprint::Cone;

/// The ray through a place in a picture of `size` pixels; (0, 0) is its top left corner.
#[inline]
pub(crate) fn sight(view: &View, place: (f64, f64), size: (u32, u32)) -> Sight {
    let x = place.0 / f64::from(size.0) * 2.0 - 1.0;
    let y = 1.0 - place.1 / f64::from(size.1) * 2.0;
    view.sight(x, y)
}

/// What a ray stands for in the middle of a picture if it is alone in its pixel.
pub(crate) fn cone(view: &View, size: (u32, u32)) -> Cone {
    let middle = (0.5 * f64::from(size.0), 0.5 * f64::from(size.1));
    let ray = |place| sight(view, place, size);
    let (right, left) = (ray((middle.0 + 0.5, middle.1)), ray((middle.0 - 0.5, middle.1)));
    let apart = |a: DVec3, b: DVec3| (a - b).length();
    Cone { width: apart(right.offset, left.offset), spread: apart(right.direction, left.direction) }
}
