//! Rays through a lens of some width instead of a pinhole (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984).

use scene::transform::unit;
use scene::{Camera, Lens, Sight, View};

use super::disc::on_disc;

/// A lens about the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadedLens {
    /// In scene units.
    pub(crate) radius: f64,
    /// From the eye to the plane that is sharp, along the middle of the picture.
    pub(crate) distance: f64,
}

impl LoadedLens {
    pub(crate) fn new(lens: &Lens, camera: &Camera) -> Self {
        let forward = unit(camera.target - camera.position);
        Self {
            radius: lens.radius(camera.focal_length_mm),
            distance: (lens.focus - camera.position).dot(forward),
        }
    }

    /// The ray through a point of the lens, from a square, to what the pinhole's ray meets in the sharp plane.
    pub(crate) fn through(&self, view: &View, pinhole: Sight, point: [f64; 2]) -> Sight {
        let [x, y] = on_disc(point).map(|at| self.radius * at);
        let offset = x * view.right + y * view.up;
        let sharp = self.distance / pinhole.direction.dot(view.forward) * pinhole.direction;
        Sight { offset, direction: unit(sharp - offset) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn all_rays_of_a_place_meet_where_it_is_sharp() {
        let camera = Camera {
            position: DVec3::ZERO,
            target: DVec3::new(0.0, 0.0, -7.0),
            focal_length_mm: 50.0,
            parallel: false,
        };
        let view = camera.view(100, 100);
        let lens = LoadedLens { radius: 0.5, distance: 4.0 };
        for place in [(0.0, 0.0), (0.7, -0.3), (-1.0, 1.0)] {
            let pinhole = view.sight(place.0, place.1);
            let sharp = pinhole.direction * (4.0 / -pinhole.direction.z);
            for point in [[0.5, 0.5], [0.0, 0.0], [1.0, 0.5], [0.2, 0.9]] {
                let Sight { offset, direction } = lens.through(&view, pinhole, point);
                assert!(offset.length() <= 0.5 + 1e-12 && offset.z.abs() < 1e-15, "{offset}");
                let t = (-4.0 - offset.z) / direction.z;
                let met = offset + t * direction;
                assert!(met.abs_diff_eq(sharp, 1e-12), "{place:?} {point:?}: {met}, not {sharp}");
            }
        }
        let rim = lens.through(&view, view.sight(0.0, 0.0), [1.0, 0.5]).offset;
        assert!(
            rim.abs_diff_eq(DVec3::new(0.5, 0.0, 0.0), 1e-12),
            "the rim is a radius away: {rim}"
        );
    }
}
