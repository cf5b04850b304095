//! The rays of a picture as linear functions of their place in it.
//!
//! A ray is given by its depth, the distance along the middle of the picture: then its points are linear in the place, and
//! a plane through the eye is a straight line of the picture.

use glam::DVec3;
use scene::{Four, Ray, View};

/// A square of the picture, in pixels; (0, 0) is its top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) middle: [f64; 2],
    /// Half its side.
    pub(crate) half: f64,
}

impl Cell {
    pub(crate) fn corners(&self) -> [[f64; 2]; 4] {
        let ([x, y], h) = (self.middle, self.half);
        [[x - h, y - h], [x + h, y - h], [x - h, y + h], [x + h, y + h]]
    }

    pub(crate) fn quarters(&self) -> [Self; 4] {
        let half = 0.5 * self.half;
        Self { half, ..*self }.corners_at(half)
    }

    fn corners_at(&self, off: f64) -> [Self; 4] {
        Self { middle: self.middle, half: off }
            .corners()
            .map(|middle| Self { middle, half: self.half })
    }

    /// If a place is in it, the right and the bottom edge left out: squares side by side share no place.
    pub(crate) fn holds(&self, place: [f64; 2]) -> bool {
        (0..2).all(|k| {
            let off = place[k] - self.middle[k];
            off >= -self.half && off < self.half
        })
    }
}

/// A number for each place: its value at one, and by how much it grows with each pixel to the right and down.
pub(crate) type Form<T = f64> = [T; 3];

/// A linear function of points: a vector to multiply with, and a number to add.
pub(crate) type Covector = (DVec3, f64);

/// All rays of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// Of rays at (0, 0), and by how much they change.
    pub(crate) origin: Form<DVec3>,
    /// Of rays; a depth of 1 long.
    pub(crate) direction: Form<DVec3>,
    pub(crate) parallel: bool,
    /// Of points: column and row multiplied by the third; the third is the depth, or 1 where rays are parallel.
    pub(crate) image: [Covector; 3],
    /// Of points.
    pub(crate) depth: Covector,
    /// Columns and rows.
    pub(crate) size: [f64; 2],
}

impl Sheet {
    pub(crate) fn new(eye: DVec3, view: &View, (columns, rows): (u32, u32)) -> Self {
        let View { right, up, forward, half, parallel } = *view;
        let size = [f64::from(columns), f64::from(rows)];
        let corner = -half[0] * right + half[1] * up;
        let across = [2.0 * half[0] / size[0] * right, -2.0 * half[1] / size[1] * up];
        let [x, y] = [size[0] / (2.0 * half[0]), size[1] / (2.0 * half[1])];
        let at = |v: DVec3, more: f64| (v, more - v.dot(eye));
        let depth = at(forward, 0.0);
        if parallel {
            return Self {
                origin: [eye + corner, across[0], across[1]],
                direction: [forward, DVec3::ZERO, DVec3::ZERO],
                parallel,
                image: [at(x * right, x * half[0]), at(-y * up, y * half[1]), (DVec3::ZERO, 1.0)],
                depth,
                size,
            };
        }
        Self {
            origin: [eye, DVec3::ZERO, DVec3::ZERO],
            direction: [forward + corner, across[0], across[1]],
            parallel,
            image: [
                at(x * (right + half[0] * forward), 0.0),
                at(y * (half[1] * forward - up), 0.0),
                depth,
            ],
            depth,
            size,
        }
    }

    /// The ray of a place.
    pub(crate) fn ray(&self, place: [f64; 2]) -> Ray {
        Ray::new(at(&self.origin, place), at(&self.direction, place))
    }

    /// The rays of the corners of a cell.
    pub(crate) fn corner_rays(&self, cell: &Cell) -> Ray<Four> {
        let rays = cell.corners().map(|corner| self.ray(corner));
        let lanes = |number: &dyn Fn(&Ray) -> f64| {
            Four::new([number(&rays[0]), number(&rays[1]), number(&rays[2]), number(&rays[3])])
        };
        Ray {
            origin: std::array::from_fn(|k| lanes(&|ray| ray.origin[k])),
            direction: std::array::from_fn(|k| lanes(&|ray| ray.direction[k])),
        }
    }

    /// Column and row of a point times its weight, and the weight: above 0 ahead of the eye.
    pub(crate) fn seen(&self, point: DVec3) -> DVec3 {
        let [x, y, w] = self.image.map(|covector| value(&covector, point));
        DVec3::new(x, y, w)
    }

    /// The depth of a point.
    pub(crate) fn depth_of(&self, point: DVec3) -> f64 {
        value(&self.depth, point)
    }
}

pub(crate) fn value(covector: &Covector, point: DVec3) -> f64 {
    covector.0.dot(point) + covector.1
}

fn at(form: &Form<DVec3>, [x, y]: [f64; 2]) -> DVec3 {
    form[0] + x * form[1] + y * form[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::place::sight;
    use scene::Camera;

    #[test]
    fn rays_are_those_of_the_picture_and_points_are_seen_where_rays_meet_them() {
        let eye = DVec3::new(0.5, -0.25, 3.0);
        for parallel in [false, true] {
            let camera = Camera {
                position: DVec3::ZERO,
                target: DVec3::new(1.0, -2.0, -5.0),
                focal_length_mm: 35.0,
                parallel,
            };
            let view = camera.view(60, 40);
            let sheet = Sheet::new(eye, &view, (60, 40));
            for place in [[0.0, 0.0], [60.0, 40.0], [12.5, 33.25]] {
                let ray = sheet.ray(place);
                let expected = sight(&view, place.into(), (60, 40));
                let direction = DVec3::from_array(ray.direction);
                assert!(direction.normalize().abs_diff_eq(expected.direction, 1e-14), "{place:?}");
                assert!((direction.dot(view.forward) - 1.0).abs() < 1e-14, "by depth");
                let start = DVec3::from_array(ray.origin);
                assert!(start.abs_diff_eq(eye + expected.offset, 1e-13), "{place:?}");
                for depth in [0.1, 7.0] {
                    let seen = sheet.seen(ray.at(depth));
                    assert!((seen.x / seen.z - place[0]).abs() < 1e-10, "{place:?}: {seen}");
                    assert!((seen.y / seen.z - place[1]).abs() < 1e-10, "{place:?}: {seen}");
                    assert!((sheet.depth_of(ray.at(depth)) - depth).abs() < 1e-12, "{depth}");
                    assert!(seen.z > 0.0, "ahead");
                }
            }
        }
    }

    #[test]
    fn quarters_share_no_place() {
        let cell = Cell { middle: [8.0, 24.0], half: 4.0 };
        for place in [[4.0, 20.0], [8.0, 24.0], [7.9, 24.0], [11.9, 27.9]] {
            assert!(cell.holds(place), "{place:?}");
            let held = cell.quarters().iter().filter(|quarter| quarter.holds(place)).count();
            assert_eq!(held, 1, "{place:?}");
        }
        assert!(!cell.holds([12.0, 24.0]), "its right edge is another's");
    }
}
