//! Cone with its apex at the origin, opening along +x to radius 1 at x = 1.

use glam::{DMat3, DVec2, DVec3};

use super::cylinder::disc_half_extent;
use super::{Face, Level, turn};
use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

const BASE: u8 = 1;

/// Solves `a t² + 2 b t + c = 0` for y² + z² = x² and keeps the nappe x ≥ 0.
///
/// It is solved from the point of the line nearest the apex, so a distant origin does not enter `c`. The discriminant b² − ac is written as a sum of 2×2 minors (Lagrange's identity), so the large terms never meet;
/// the second root comes from the first by Vieta.
#[inline(always)]
pub(super) fn span<L: Lanes>(ray: &Ray<L>) -> FacedSpan<L> {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    let closest = -(ox * dx + oy * dy + oz * dz) / (dx * dx + dy * dy + dz * dz);
    let (px, py, pz) = (ox + closest * dx, oy + closest * dy, oz + closest * dz);
    let zero = L::splat(0.0);
    let a = dy * dy + dz * dz - dx * dx;
    let b = py * dy + pz * dz - px * dx;
    let c = py * py + pz * pz - px * px;
    let (xy, xz, yz) = (px * dy - py * dx, px * dz - pz * dx, py * dz - pz * dy);
    let discriminant = xy * xy + xz * xz - yz * yz;
    let across = zero.less(a);
    let steep = a.less(zero);
    let real = zero.less(discriminant);
    let root = L::select(real, discriminant, zero).sqrt();
    let q = -(b + L::select(b.less(zero), -root, root));
    let one = L::splat(1.0);
    // q = 0 only where b and the root vanish: through the apex, both roots at 0; or along a generator.
    let moves = L::or(q.less(zero), zero.less(q));
    let curved = L::or(across, steep);
    let first = q / L::select(curved, a, one);
    let second = L::select(moves, c / L::select(moves, q, one), zero);
    let (low, high) = (first.min(second), first.max(second));
    let (start, end) = (L::splat(f64::NEG_INFINITY), L::splat(f64::INFINITY));
    // Steeper than the generators, the line is inside beyond either root: keep the nappe ahead or behind. Parallel to
    // a generator there is one root, and the inside lies where the quadric falls.
    let ahead = L::select(steep, high, second);
    let behind = L::select(steep, low, second);
    let up = L::or(L::and(steep, zero.less(dx)), L::and(L::not(steep), b.less(zero)));
    let inside = FacedSpan {
        from: closest + L::select(across, low, L::select(up, ahead, start)),
        to: closest + L::select(across, high, L::select(up, end, behind)),
        ..FacedSpan::line()
    };
    // A steep line meets both nappes whatever rounding says of the discriminant.
    let hit = L::or(steep, L::and(L::or(real, L::not(across)), L::or(across, moves)));
    inside.only(hit).clip(FacedSpan::slab(ox, dx, 0.0, 1.0, 0, BASE))
}

#[inline(always)]
pub(super) fn contains<L: Lanes>([x, y, z]: [L; 3]) -> L::Mask {
    let between = L::and(L::splat(0.0).at_most(x), x.at_most(L::splat(1.0)));
    L::and(between, (y * y + z * z).at_most(x * x))
}

/// At the apex, where the gradient vanishes, the direction of the axis.
#[inline]
pub(super) fn gradient<L: Lanes>([x, y, z]: [L; 3], face: L) -> [L; 3] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let base = face.is(f64::from(BASE));
    let apex = L::and(x.is(0.0), L::and(y.is(0.0), z.is(0.0)));
    let across = |value: L| L::select(base, zero, value);
    [L::select(base, one, L::select(apex, -one, -x)), across(y), across(z)]
}

/// On the side u turns about the axis and v runs along it from the apex; on the base v is the distance from the axis.
pub(super) fn texture_coordinates(p: DVec3, face: Face) -> DVec2 {
    let v = if face.0 == 0 { p.x } else { (p.y * p.y + p.z * p.z).sqrt() };
    DVec2::new(turn(p.y, p.z), v)
}

pub(super) fn bounds(m: &DMat3, place: DVec3) -> Bounds {
    let end = place + m.x_axis;
    let radius = disc_half_extent(m);
    Bounds { low: place.min(end - radius), high: place.max(end + radius) }
}

/// On the rim, or at the apex.
pub(super) fn support(n: DVec3) -> DVec3 {
    let rim = DVec2::new(n.y, n.z).normalize_or_zero();
    let rim = DVec3::new(1.0, rim.x, rim.y);
    if n.dot(rim) < 0.0 { DVec3::ZERO } else { rim }
}

/// The plane x = 0 keeps the other nappe out.
pub(super) fn levels(p: DVec3) -> [Level; 3] {
    [
        Level {
            value: 0.5 * (p.y * p.y + p.z * p.z - p.x * p.x),
            gradient: DVec3::new(-p.x, p.y, p.z),
        },
        Level { value: p.x - 1.0, gradient: DVec3::X },
        Level { value: -p.x, gradient: DVec3::NEG_X },
    ]
}
