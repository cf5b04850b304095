//! Which points of a pixel are looked at.

use glam::DVec3;
use scene::View;

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

/// The direction through a place in a picture of `size` pixels; (0, 0) is its top left corner.
#[inline]
pub(crate) fn direction(view: &View, place: (f64, f64), size: (u32, u32)) -> DVec3 {
    let x = place.0 / f64::from(size.0) * 2.0 - 1.0;
    let y = 1.0 - place.1 / f64::from(size.1) * 2.0;
    view.direction(x, y)
}

/// How far apart the rays through neighbouring pixels in the middle of a picture are at a distance of 1.
pub(crate) fn spread(view: &View, size: (u32, u32)) -> f64 {
    let middle = (0.5 * f64::from(size.0), 0.5 * f64::from(size.1));
    let ray = |place| direction(view, place, size);
    (ray((middle.0 + 0.5, middle.1)) - ray((middle.0 - 0.5, middle.1))).length()
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
