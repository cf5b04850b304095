//! Which points of a pixel are looked at.

use scene::View;

use glam::DVec3;

/// A point of a pixel and the half of the picture its sample belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Position within the pixel, 0…1 each way.
    x: f64,
    y: f64,
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

impl Sample {
    /// The direction through this point of pixel (`column`, `row`) in a picture of `size` pixels.
    pub(crate) fn direction(
        &self,
        view: &View,
        column: u32,
        row: u32,
        size: (u32, u32),
    ) -> DVec3 {
        let x = (f64::from(column) + self.x) / f64::from(size.0) * 2.0 - 1.0;
        let y = 1.0 - (f64::from(row) + self.y) / f64::from(size.1) * 2.0;
        view.direction(x, y)
    }
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
