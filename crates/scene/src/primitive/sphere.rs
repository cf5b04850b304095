//! Unit sphere centred on the origin.

use glam::{DMat3, DVec2, DVec3};

use super::{Face, Level, about_closest, turn};
use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

#[inline(always)]
pub(super) fn span<L: Lanes>(ray: &Ray<L>) -> FacedSpan<L> {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    let a = dx * dx + dy * dy + dz * dz;
    let closest = -(ox * dx + oy * dy + oz * dz) / a;
    let (x, y, z) = (ox + closest * dx, oy + closest * dy, oz + closest * dz);
    about_closest(a, closest, x * x + y * y + z * z - L::splat(1.0))
}

#[inline(always)]
pub(super) fn contains<L: Lanes>([x, y, z]: [L; 3]) -> L::Mask {
    (x * x + y * y + z * z).at_most(L::splat(1.0))
}

#[inline]
pub(super) fn gradient<L: Lanes>(point: [L; 3], _face: L) -> [L; 3] {
    point
}

/// u turns about the y axis, v rises from the south pole to the north.
pub(super) fn texture_coordinates(p: DVec3, _face: Face) -> DVec2 {
    let across = (p.x * p.x + p.z * p.z).sqrt();
    DVec2::new(turn(p.x, -p.z), 0.5 + libm::atan2(p.y, across) / std::f64::consts::PI)
}

pub(super) fn bounds(m: &DMat3, place: DVec3) -> Bounds {
    let square = m.x_axis * m.x_axis + m.y_axis * m.y_axis + m.z_axis * m.z_axis;
    Bounds::about(place, DVec3::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt()))
}

pub(super) fn support(n: DVec3) -> DVec3 {
    n.normalize_or_zero()
}

pub(super) fn levels(p: DVec3) -> [Level; 1] {
    [Level { value: 0.5 * (p.length_squared() - 1.0), gradient: p }]
}
