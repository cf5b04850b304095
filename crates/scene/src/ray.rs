//! Rays, the span of a ray inside a solid, and boxes.

use glam::DVec3;

use crate::lanes::Lanes;
use crate::primitive::Face;

/// A half-line; the direction need not be of unit length, so that `t` is the same in every local space.
#[derive(Clone, Copy, Debug)]
pub struct Ray<L = f64> {
    /// Where it starts.
    pub origin: [L; 3],
    /// Where it goes.
    pub direction: [L; 3],
}

impl Ray<f64> {
    /// A ray from vectors.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin: origin.to_array(), direction: direction.to_array() }
    }

    /// The point at parameter `t`.
    #[must_use]
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        DVec3::from_array(self.origin) + t * DVec3::from_array(self.direction)
    }
}

/// The part `[from, to)` of a line inside a convex solid, and the faces at its ends; empty unless `from < to`.
#[derive(Clone, Copy, Debug)]
pub struct FacedSpan<L = f64> {
    /// Where the line enters.
    pub from: L,
    /// Where it leaves.
    pub to: L,
    /// The face entered, a [`Face`] as a number.
    pub from_face: L,
    /// The face left.
    pub to_face: L,
}

impl<L: Lanes> FacedSpan<L> {
    /// The whole line.
    #[inline(always)]
    #[must_use]
    pub fn line() -> Self {
        let zero = L::splat(0.0);
        Self {
            from: L::splat(f64::NEG_INFINITY),
            to: L::splat(f64::INFINITY),
            from_face: zero,
            to_face: zero,
        }
    }

    /// What this span and `other` share.
    #[inline(always)]
    #[must_use]
    pub fn clip(self, other: Self) -> Self {
        let later = self.from.less(other.from);
        let sooner = other.to.less(self.to);
        Self {
            from: L::select(later, other.from, self.from),
            from_face: L::select(later, other.from_face, self.from_face),
            to: L::select(sooner, other.to, self.to),
            to_face: L::select(sooner, other.to_face, self.to_face),
        }
    }

    /// This span where `mask` holds, nothing elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn only(self, mask: L::Mask) -> Self {
        Self {
            from: L::select(mask, self.from, L::splat(f64::INFINITY)),
            to: L::select(mask, self.to, L::splat(f64::NEG_INFINITY)),
            ..self
        }
    }

    /// Where `low ≤ origin + t · direction ≤ high`.
    ///
    /// A line parallel to the slab is decided by an inside test: 0 · ∞ never happens.
    #[inline(always)]
    #[must_use]
    pub fn slab(origin: L, direction: L, low: f64, high: f64, low_face: u8, high_face: u8) -> Self {
        let zero = L::splat(0.0);
        let (low, high) = (L::splat(low), L::splat(high));
        let moves = L::or(direction.less(zero), zero.less(direction));
        let inside = L::and(L::not(origin.less(low)), L::not(high.less(origin)));
        let inverse = L::splat(1.0) / L::select(moves, direction, L::splat(1.0));
        let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
        let forward = zero.less(direction);
        let (a_face, b_face) = (L::splat(f64::from(low_face)), L::splat(f64::from(high_face)));
        let crossing = Self {
            from: L::select(forward, a, b),
            to: L::select(forward, b, a),
            from_face: L::select(forward, a_face, b_face),
            to_face: L::select(forward, b_face, a_face),
        };
        let still = Self::line().only(inside);
        Self {
            from: L::select(moves, crossing.from, still.from),
            to: L::select(moves, crossing.to, still.to),
            from_face: crossing.from_face,
            to_face: crossing.to_face,
        }
    }
}

impl FacedSpan<f64> {
    /// The face at the start of the span.
    #[must_use]
    pub fn entered(&self) -> Face {
        Face::from_number(self.from_face)
    }

    /// The face at the end of the span.
    #[must_use]
    pub fn left(&self) -> Face {
        Face::from_number(self.to_face)
    }
}

/// A box aligned with the axes, closed; empty if any `low` is above its `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub low: DVec3,
    /// The greatest corner.
    pub high: DVec3,
}

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
    /// Holds everything.
    pub const ALL: Self = Self { low: DVec3::NEG_INFINITY, high: DVec3::INFINITY };

    /// The box about `center` that reaches `half` to each side.
    #[must_use]
    pub fn about(center: DVec3, half: DVec3) -> Self {
        Self { low: center - half, high: center + half }
    }

    /// True if no point is inside.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.low.x > self.high.x || self.low.y > self.high.y || self.low.z > self.high.z
    }

    /// The least box that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The box that both share; [`Bounds::EMPTY`] if there is none.
    #[must_use]
    pub fn overlap(self, other: Self) -> Self {
        let shared = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        if shared.is_empty() { Self::EMPTY } else { shared }
    }

    /// The box with every face moved outward by `by`; empty stays empty.
    #[must_use]
    pub fn widened(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// True if `point` is inside or on a face.
    #[must_use]
    #[inline]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }

    /// True if `point` is inside, or no farther out than `tolerance` along any axis.
    #[must_use]
    #[inline(always)]
    pub fn nears(&self, point: DVec3, tolerance: f64) -> bool {
        // One axis after the other: most boxes are left at the first.
        point.x >= self.low.x - tolerance
            && point.x <= self.high.x + tolerance
            && point.y >= self.low.y - tolerance
            && point.y <= self.high.y + tolerance
            && point.z >= self.low.z - tolerance
            && point.z <= self.high.z + tolerance
    }

    /// Half the longest side; 0 when empty.
    #[must_use]
    pub fn half_extent(&self) -> f64 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.high - self.low).max_element() }
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.low } else { self.high };
            DVec3::new(pick(0).x, pick(1).y, pick(2).z)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_seen_from_all_sides() {
        let slab = |o, d| FacedSpan::<f64>::slab(o, d, -1.0, 1.0, 2, 3);
        let s = slab(-3.0, 2.0);
        assert_eq!((s.from, s.to, s.from_face, s.to_face), (1.0, 2.0, 2.0, 3.0), "forward");
        let s = slab(-3.0, -2.0);
        assert_eq!((s.from, s.to, s.from_face, s.to_face), (-2.0, -1.0, 3.0, 2.0), "backward");
        for zero in [0.0, -0.0] {
            let s = slab(1.0, zero);
            assert_eq!((s.from, s.to), (f64::NEG_INFINITY, f64::INFINITY), "in the face");
            let s = slab(1.5, zero);
            assert!(s.from >= s.to, "beside it");
        }
    }

    #[test]
    fn boxes_join_and_overlap() {
        let a = Bounds { low: DVec3::ZERO, high: DVec3::ONE };
        let b = Bounds { low: DVec3::splat(2.0), high: DVec3::splat(3.0) };
        assert_eq!(a.overlap(b), Bounds::EMPTY, "apart");
        assert_eq!(a.hull(b), Bounds { low: DVec3::ZERO, high: DVec3::splat(3.0) }, "hull");
        assert_eq!(a.hull(Bounds::EMPTY), a, "empty adds nothing");
        assert!(Bounds::EMPTY.is_empty() && !a.is_empty(), "emptiness");
        assert!(Bounds::EMPTY.half_extent() <= 0.0, "empty has no size");
    }
}
