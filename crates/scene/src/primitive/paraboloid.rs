//! Paraboloid with its apex at the origin, opening along +x to radius 1 at x = 1.

use glam::{DMat3, DVec2, DVec3};

use super::{Face, Level, boxed, turn};
use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

const BASE: u8 = 1;

/// Solves `a t² + 2 b t + c = 0` for y² + z² = x from the point of the line nearest the apex.
///
/// The discriminant is written with 2×2 minors (Lagrange's identity), so the squares of distances do not enter; the
/// second root comes from the first by Vieta. A line along the axis has one root and is inside ahead or behind of it.
#[inline(always)]
pub(super) fn span<L: Lanes>(ray: &Ray<L>) -> FacedSpan<L> {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
    let closest = -(ox * dx + oy * dy + oz * dz) / (dx * dx + dy * dy + dz * dz);
    let (px, py, pz) = (ox + closest * dx, oy + closest * dy, oz + closest * dz);
    let a = dy * dy + dz * dz;
    let b = py * dy + pz * dz - half * dx;
    let c = py * py + pz * pz - px;
    let (xy, xz, yz) = (px * dy - py * dx, px * dz - pz * dx, py * dz - pz * dy);
    let discriminant = L::splat(0.25) * dx * dx + dy * xy + dz * xz - yz * yz;
    let real = zero.less(discriminant);
    let root = L::select(real, discriminant, zero).sqrt();
    let up = b.less(zero);
    let q = -(b + L::select(up, -root, root));
    let slanted = zero.less(a);
    let (start, end) = (L::splat(f64::NEG_INFINITY), L::splat(f64::INFINITY));
    let beyond = L::select(up, end, start);
    let first = L::select(slanted, q / L::select(slanted, a, one), beyond);
    // q is 0 only for a line that touches, which is dropped.
    let second = c / L::select(real, q, one);
    let inside = FacedSpan {
        from: closest + first.min(second),
        to: closest + first.max(second),
        ..FacedSpan::line()
    };
    inside.only(real).clip(FacedSpan::slab(ox, dx, 0.0, 1.0, 0, BASE))
}

#[inline(always)]
pub(super) fn contains<L: Lanes>([x, y, z]: [L; 3]) -> L::Mask {
    L::and(x.at_most(L::splat(1.0)), (y * y + z * z).at_most(x))
}

#[inline]
pub(super) fn gradient<L: Lanes>([_, y, z]: [L; 3], face: L) -> [L; 3] {
    let base = face.is(f64::from(BASE));
    let across = |value: L| L::select(base, L::splat(0.0), value);
    [L::select(base, L::splat(1.0), L::splat(-0.5)), across(y), across(z)]
}

/// On the side u turns about the axis and v runs along it from the apex; on the base v is the distance from the axis.
pub(super) fn texture_coordinates(p: DVec3, face: Face) -> DVec2 {
    let v = if face.0 == 0 { p.x } else { (p.y * p.y + p.z * p.z).sqrt() };
    DVec2::new(turn(p.y, p.z), v)
}

pub(super) fn bounds(m: &DMat3, place: DVec3) -> Bounds {
    boxed(m, place, support)
}

/// On the rim, unless the side faces that way at a smaller radius.
pub(super) fn support(n: DVec3) -> DVec3 {
    let across = (n.y * n.y + n.z * n.z).sqrt();
    if across <= 0.0 {
        return if n.x < 0.0 { DVec3::ZERO } else { DVec3::X };
    }
    let radius = if -2.0 * n.x > across { across / (-2.0 * n.x) } else { 1.0 };
    DVec3::new(radius * radius, radius * n.y / across, radius * n.z / across)
}

pub(super) fn levels(p: DVec3) -> [Level; 2] {
    [
        Level { value: 0.5 * (p.y * p.y + p.z * p.z - p.x), gradient: DVec3::new(-0.5, p.y, p.z) },
        Level { value: p.x - 1.0, gradient: DVec3::X },
    ]
}
