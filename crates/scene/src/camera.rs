//! The camera: a pinhole with a 35 mm lens, or parallel rays.

use glam::DVec3;

use crate::transform::unit;

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub position: DVec3,
    /// What it looks at; not `position`.
    pub target: DVec3,
    /// Lens of a 35 mm camera; above 0.
    pub focal_length_mm: f64,
    /// All rays run as the one through the middle, from the plane through `position` across it. The picture is as wide
    /// as what the lens shows of the plane through `target`.
    pub parallel: bool,
}

/// A lens of some width, which shows one plane sharp. A scene unit is a millimetre to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The f-number: focal length by diameter; above 0.
    pub aperture: f64,
    /// A point of the plane that is sharp, in front of the camera.
    pub focus: DVec3,
}

impl Lens {
    /// Half the width of the opening of a lens of a focal length.
    #[must_use]
    pub fn radius(&self, focal_length_mm: f64) -> f64 {
        focal_length_mm / (2.0 * self.aperture)
    }
}

impl Camera {
    /// The default lens.
    pub const FOCAL_LENGTH_MM: f64 = 50.0;
}

/// A camera with the shape of its picture: everything a primary ray needs but the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to its top.
    pub up: DVec3,
    /// Unit vector into the scene.
    pub forward: DVec3,
    /// Half the picture's width and height: on the plane one unit in front of the eye, or of all of it where rays are
    /// parallel.
    pub half: [f64; 2],
    /// Rays are parallel.
    pub parallel: bool,
}

/// The start of a ray of a picture, from the eye, and its unit direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// 0 for a pinhole.
    pub offset: DVec3,
    /// Unit.
    pub direction: DVec3,
}

/// The picture within a 36 × 24 mm frame: the largest rectangle of its aspect; upright pictures turn the frame.
#[must_use]
pub fn frame_mm(columns: u32, rows: u32) -> [f64; 2] {
    let aspect = f64::from(columns) / f64::from(rows);
    if aspect >= 1.5 {
        [36.0, 36.0 / aspect]
    } else if aspect >= 1.0 {
        [24.0 * aspect, 24.0]
    } else if aspect > 1.0 / 1.5 {
        [24.0, 24.0 / aspect]
    } else {
        [36.0 * aspect, 36.0]
    }
}

impl Camera {
    /// The view of a picture of `columns` by `rows` pixels.
    ///
    /// Up is +y; a camera that looks straight up or down has the top of its picture toward +z or −z.
    #[must_use]
    pub fn view(&self, columns: u32, rows: u32) -> View {
        let forward = unit(self.target - self.position);
        let level = forward.cross(DVec3::Y);
        // Within 1e-9 of the vertical the horizon is decided by rounding alone.
        let right = if level.length() > 1e-9 {
            unit(level)
        } else {
            let top = if forward.y > 0.0 { DVec3::Z } else { DVec3::NEG_Z };
            unit(forward.cross(top))
        };
        let parallel = self.parallel;
        let distance = if parallel { (self.target - self.position).length() } else { 1.0 };
        let half =
            frame_mm(columns, rows).map(|side| side / (2.0 * self.focal_length_mm) * distance);
        View { right, up: right.cross(forward), forward, half, parallel }
    }
}

impl View {
    /// The ray through a point of the picture: (−1, 1) is its top left corner, (1, −1) bottom right.
    #[must_use]
    #[inline]
    pub fn sight(&self, x: f64, y: f64) -> Sight {
        let [across, along] = [(x * self.half[0]) * self.right, (y * self.half[1]) * self.up];
        if self.parallel {
            return Sight { offset: across + along, direction: self.forward };
        }
        Sight { offset: DVec3::ZERO, direction: unit(self.forward + across + along) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_follows_the_aspect() {
        for ((columns, rows), expected) in [
            ((512, 512), [24.0, 24.0]),
            ((720, 480), [36.0, 24.0]),
            ((1024, 512), [36.0, 18.0]),
            ((640, 512), [30.0, 24.0]),
            ((480, 720), [24.0, 36.0]),
            ((512, 1024), [18.0, 36.0]),
            ((512, 640), [24.0, 30.0]),
        ] {
            let frame = frame_mm(columns, rows);
            assert!(
                (frame[0] - expected[0]).abs() < 1e-12 && (frame[1] - expected[1]).abs() < 1e-12,
                "{columns}×{rows}: {frame:?}"
            );
        }
    }

    #[test]
    fn the_listing_sees_its_set() {
        // Where the rays of the paper's camera meet the set, worked out in the reference page on the camera.
        let camera = Camera {
            position: DVec3::new(0.0, 1500.0, 4000.0),
            target: DVec3::new(0.0, 400.0, 0.0),
            focal_length_mm: Camera::FOCAL_LENGTH_MM,
            parallel: false,
        };
        let view = camera.view(512, 512);
        assert!(
            view.forward.abs_diff_eq(DVec3::new(0.0, -0.265_157, -0.964_205), 1e-6),
            "{}",
            view.forward
        );
        let bottom = view.sight(0.0, -1.0).direction;
        let floor = camera.position - bottom * (1500.0 / bottom.y);
        assert!((floor.z - 1279.6).abs() < 0.1, "floor at z = {}", floor.z);
        let top = view.sight(0.0, 1.0).direction;
        let backdrop = camera.position + top * (-5980.0 / top.z);
        assert!((backdrop.y - 1303.7).abs() < 0.1, "backdrop at y = {}", backdrop.y);
    }

    #[test]
    fn parallel_rays_start_side_by_side() {
        // 24 × distance / F wide: 24 · 10 / 60 = 4.
        let camera = Camera {
            position: DVec3::new(0.0, 0.0, 10.0),
            target: DVec3::ZERO,
            focal_length_mm: 60.0,
            parallel: true,
        };
        let view = camera.view(100, 100);
        for (x, y) in [(-1.0, 1.0), (0.0, 0.0), (0.25, -1.0)] {
            let Sight { offset, direction } = view.sight(x, y);
            assert!(offset.abs_diff_eq(DVec3::new(2.0 * x, 2.0 * y, 0.0), 1e-15), "{offset}");
            assert_eq!(direction, DVec3::NEG_Z, "all the same way");
        }
    }

    #[test]
    fn straight_down_has_a_top() {
        for (y, up) in [(5.0, DVec3::NEG_Z), (-5.0, DVec3::Z)] {
            let camera = Camera {
                position: DVec3::new(1.0, y, 2.0),
                target: DVec3::new(1.0, 0.0, 2.0),
                focal_length_mm: 50.0,
                parallel: false,
            };
            let view = camera.view(64, 64);
            assert_eq!(view.up, up, "from y = {y}");
            assert_eq!(view.right.cross(view.forward), view.up, "right-handed from y = {y}");
        }
    }
}
