//! Block from −1 to 1 along each axis.

use glam::{DMat3, DVec2, DVec3};

use super::{Face, Level};
use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

#[inline(always)]
pub(super) fn span<L: Lanes>(ray: &Ray<L>) -> FacedSpan<L> {
    let slab = |axis: usize, low_face: u8| {
        FacedSpan::slab(ray.origin[axis], ray.direction[axis], -1.0, 1.0, low_face, low_face + 1)
    };
    slab(0, 0).clip(slab(1, 2)).clip(slab(2, 4))
}

#[inline(always)]
pub(super) fn contains<L: Lanes>([x, y, z]: [L; 3]) -> L::Mask {
    let (low, high) = (L::splat(-1.0), L::splat(1.0));
    let between = |x: L| L::and(low.at_most(x), x.at_most(high));
    L::and(L::and(between(x), between(y)), between(z))
}

/// Faces are numbered −x, +x, −y, +y, −z, +z.
#[inline]
pub(super) fn gradient<L: Lanes>(_point: [L; 3], face: L) -> [L; 3] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    [(0.0, 1.0), (2.0, 3.0), (4.0, 5.0)]
        .map(|(low, high)| L::select(face.is(low), -one, L::select(face.is(high), one, zero)))
}

/// Each face is the whole square; u runs to the right and v up as the face is seen from outside, so that what is written
/// on it can be read.
pub(super) fn texture_coordinates(p: DVec3, face: Face) -> DVec2 {
    let (u, v) = match face.0 {
        0 => (p.z, p.y),
        1 => (-p.z, p.y),
        2 => (p.x, p.z),
        3 => (p.x, -p.z),
        4 => (-p.x, p.y),
        _ => (p.x, p.y),
    };
    DVec2::new(0.5 * (u + 1.0), 0.5 * (v + 1.0))
}

pub(super) fn bounds(m: &DMat3, place: DVec3) -> Bounds {
    Bounds::about(place, m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs())
}

pub(super) fn support(n: DVec3) -> DVec3 {
    DVec3::select(n.cmplt(DVec3::ZERO), DVec3::NEG_ONE, DVec3::ONE)
}

pub(super) fn levels(p: DVec3) -> [Level; 3] {
    DVec3::AXES.map(|axis| {
        let along = p.dot(axis);
        let sign = if along < 0.0 { -axis } else { axis };
        Level { value: along.abs() - 1.0, gradient: sign }
    })
}
