//! Which points of a pixel are looked at.

use glam::DVec3;
use scene::{Sight, View};

use crate::shade::footprint::Cone;

/// A point of a pixel and the half of the picture its sample belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Position within the pixel, 0…1 each way.
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) half: usize,
}

/// The centres of a `side` × `side` grid over a pixel; neighbours belong to different halves.
pub(crate) fn grid(side: u32) -> Vec<Sample> {
    let step = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let point = |i: u32| Sample {
        x: step(i % side),
        y: step(i / side),
        half: ((i % side + i / side) % 2) as usize,
    };
    (0..side * side).map(point).collect()
}

/// The ray through a place in a picture of `size` pixels; (0, 0) is its top left corner.
#[inline]
pub(crate) fn sight(view: &View, place: (f64, f64), size: (u32, u32)) -> Sight {
    let x = place.0 / f64::from(size.0) * 2.0 - 1.0;
    let y = 1.0 - place.1 / f64::from(size.1) * 2.0;
    view.sight(x, y)
}

/// What a ray stands for in the middle of a picture whose pixels have `grid` rays each way.
pub(crate) fn cone(view: &View, size: (u32, u32), grid: u32) -> Cone {
    let middle = (0.5 * f64::from(size.0), 0.5 * f64::from(size.1));
    let ray = |place| sight(view, place, size);
    let (right, left) = (ray((middle.0 + 0.5, middle.1)), ray((middle.0 - 0.5, middle.1)));
    let apart = |a: DVec3, b: DVec3| (a - b).length() / f64::from(grid);
    Cone { width: apart(right.offset, left.offset), spread: apart(right.direction, left.direction) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_at_the_centre_and_halves_share_the_rest() {
        let one = grid(1);
        assert_eq!((one.len(), one[0].x, one[0].y, one[0].half), (1, 0.5, 0.5, 0), "centre");
        let sixteen = grid(4);
        assert_eq!(sixteen.iter().filter(|s| s.half == 0).count(), 8, "halves");
        let mean: f64 = sixteen.iter().map(|s| s.x + s.y).sum::<f64>() / 32.0;
        assert!((mean - 0.5).abs() < 1e-15, "balanced about the centre: {mean}");
    }
}
