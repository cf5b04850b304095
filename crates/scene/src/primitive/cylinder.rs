//! Cylinder of radius 1 about the x axis, from x = 0 to x = 1.

use glam::{DMat3, DVec2, DVec3};

use super::{Face, Level, about_closest, turn};
use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

const START: u8 = 1;
const END: u8 = 2;

#[inline(always)]
pub(super) fn span<L: Lanes>(ray: &Ray<L>) -> FacedSpan<L> {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let a = dy * dy + dz * dz;
    let slanted = zero.less(a);
    let a = L::select(slanted, a, one);
    let closest = -(oy * dy + oz * dz) / a;
    let (y, z) = (oy + closest * dy, oz + closest * dz);
    let side = about_closest(a, closest, y * y + z * z - one);
    // A line along the axis is inside all the way or not at all.
    let inside = L::not(one.less(oy * oy + oz * oz));
    let along = FacedSpan::line().only(inside);
    let side = FacedSpan {
        from: L::select(slanted, side.from, along.from),
        to: L::select(slanted, side.to, along.to),
        ..side
    };
    side.clip(FacedSpan::slab(ox, dx, 0.0, 1.0, START, END))
}

#[inline(always)]
pub(super) fn contains<L: Lanes>([x, y, z]: [L; 3]) -> L::Mask {
    let one = L::splat(1.0);
    let between = L::and(L::splat(0.0).at_most(x), x.at_most(one));
    L::and(between, (y * y + z * z).at_most(one))
}

#[inline]
pub(super) fn gradient<L: Lanes>([_, y, z]: [L; 3], face: L) -> [L; 3] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (start, end) = (face.is(f64::from(START)), face.is(f64::from(END)));
    let flat = L::or(start, end);
    let along = L::select(start, -one, L::select(end, one, zero));
    [along, L::select(flat, zero, y), L::select(flat, zero, z)]
}

/// On the side u turns about the axis and v runs along it; on the caps v is the distance from the axis.
pub(super) fn texture_coordinates(p: DVec3, face: Face) -> DVec2 {
    let v = if face.0 == 0 { p.x } else { (p.y * p.y + p.z * p.z).sqrt() };
    DVec2::new(turn(p.y, p.z), v)
}

pub(super) fn bounds(m: &DMat3, place: DVec3) -> Bounds {
    let end = place + m.x_axis;
    let radius = disc_half_extent(m);
    Bounds { low: place.min(end) - radius, high: place.max(end) + radius }
}

/// How far the unit disc in the plane x = 0 reaches along each outer axis.
pub(super) fn disc_half_extent(m: &DMat3) -> DVec3 {
    let square = m.y_axis * m.y_axis + m.z_axis * m.z_axis;
    DVec3::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt())
}

pub(super) fn support(n: DVec3) -> DVec3 {
    let rim = DVec2::new(n.y, n.z).normalize_or_zero();
    DVec3::new(if n.x < 0.0 { 0.0 } else { 1.0 }, rim.x, rim.y)
}

pub(super) fn levels(p: DVec3) -> [Level; 3] {
    [
        Level { value: 0.5 * (p.y * p.y + p.z * p.z - 1.0), gradient: DVec3::new(0.0, p.y, p.z) },
        Level { value: -p.x, gradient: DVec3::NEG_X },
        Level { value: p.x - 1.0, gradient: DVec3::X },
    ]
}
