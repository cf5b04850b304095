//! Numbers a primitive is written in: one `f64`, four of them, or a double-double in tests.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::f64x4;

/// One or several numbers of at least `f64` precision, worked on alike.
///
/// Comparisons give a mask and choices go through [`Lanes::select`], so that one source serves any lane count. Minimum
/// and maximum are compare-and-select: their result does not depend on the processor. There is no fused product.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of a comparison, lane by lane.
    type Mask: Copy;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;
    /// The square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `self ≤ other`.
    fn at_most(self, other: Self) -> Self::Mask;
    /// `self = value`.
    #[inline(always)]
    fn is(self, value: f64) -> Self::Mask {
        let value = Self::splat(value);
        Self::and(self.at_most(value), value.at_most(self))
    }
    /// Where `mask` holds `yes`, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Both hold.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either holds.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// It does not hold.
    fn not(a: Self::Mask) -> Self::Mask;

    /// Lane by lane: how a few numbers depend on others, one set of them after the other.
    #[must_use]
    fn each<const N: usize, const M: usize>(
        from: [Self; N],
        function: impl FnMut([f64; N]) -> [f64; M],
    ) -> [Self; M];

    /// The smaller; `self` where they are equal or unordered.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::select(other.less(self), other, self)
    }

    /// The larger; `self` where they are equal or unordered.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::select(self.less(other), other, self)
    }
}

impl Lanes for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn not(a: bool) -> bool {
        !a
    }
    #[inline(always)]
    fn each<const N: usize, const M: usize>(
        from: [Self; N],
        mut function: impl FnMut([Self; N]) -> [Self; M],
    ) -> [Self; M] {
        function(from)
    }
}

/// Four numbers side by side: each lane has the bits that one `f64` would have.
#[derive(Clone, Copy, Debug, Default)]
pub struct Four(f64x4);

/// Which of four lanes something holds for.
#[derive(Clone, Copy, Debug, Default)]
pub struct FourMask(f64x4);

impl Four {
    /// Number of lanes.
    pub const LANES: usize = 4;

    /// The four numbers.
    #[inline(always)]
    #[must_use]
    pub fn new(lanes: [f64; 4]) -> Self {
        Self(f64x4::new(lanes))
    }

    /// The four numbers.
    #[inline(always)]
    #[must_use]
    pub fn to_array(self) -> [f64; 4] {
        self.0.to_array()
    }

    /// The smaller; either where they are unordered, or zeros of two signs. For box tests, that have slack.
    #[inline(always)]
    #[must_use]
    pub fn either_min(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }

    /// The larger; either where they are unordered, or zeros of two signs. For box tests, that have slack.
    #[inline(always)]
    #[must_use]
    pub fn either_max(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }

    /// The magnitude of each lane.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0.abs())
    }
}

impl FourMask {
    /// Holds for the first `count` lanes.
    #[must_use]
    pub fn first(count: usize) -> Self {
        let lanes = Four::new([0.0, 1.0, 2.0, 3.0]);
        #[expect(clippy::cast_precision_loss, reason = "at most four")]
        lanes.less(Four::splat(count as f64))
    }

    /// Holds for no lane.
    #[inline(always)]
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// Bit k is set where lane k holds.
    #[inline(always)]
    #[must_use]
    pub fn bits(self) -> u32 {
        self.0.to_bitmask()
    }

    /// Any lane holds.
    #[inline(always)]
    #[must_use]
    pub fn any(self) -> bool {
        self.0.any()
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $method:ident)*) => {$(
        impl $operator for Four {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )*};
}

lane_by_lane! { Add add Sub sub Mul mul Div div }

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Lanes for Four {
    type Mask = FourMask;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(f64x4::splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn less(self, other: Self) -> FourMask {
        FourMask(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> FourMask {
        FourMask(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn select(mask: FourMask, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn and(a: FourMask, b: FourMask) -> FourMask {
        FourMask(a.0 & b.0)
    }
    #[inline(always)]
    fn or(a: FourMask, b: FourMask) -> FourMask {
        FourMask(a.0 | b.0)
    }
    #[inline(always)]
    fn not(a: FourMask) -> FourMask {
        FourMask(!a.0)
    }
    fn each<const N: usize, const M: usize>(
        from: [Self; N],
        mut function: impl FnMut([f64; N]) -> [f64; M],
    ) -> [Self; M] {
        let lanes = from.map(Self::to_array);
        let mut found = [[0.0; Self::LANES]; M];
        for lane in 0..Self::LANES {
            for (found, value) in found.iter_mut().zip(function(lanes.map(|four| four[lane]))) {
                found[lane] = value;
            }
        }
        found.map(Self::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that arithmetic treats in its own way.
    const ODD: [f64; 14] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.1,
        -3.7e5,
        f64::MIN_POSITIVE,
        5e-324,
        f64::MAX,
        -f64::MAX,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        1.0 + f64::EPSILON,
    ];

    #[test]
    fn each_lane_has_the_bits_of_one_number() {
        let operations: [fn(f64, f64) -> f64; 7] = [
            |a, b| a + b,
            |a, b| a - b,
            |a, b| a * b,
            |a, b| a / b,
            |a, _| a.sqrt(),
            Lanes::min,
            Lanes::max,
        ];
        let fours: [fn(Four, Four) -> Four; 7] = [
            |a, b| a + b,
            |a, b| a - b,
            |a, b| a * b,
            |a, b| a / b,
            |a, _| a.sqrt(),
            Lanes::min,
            Lanes::max,
        ];
        for (one, four) in operations.iter().zip(fours) {
            for a in ODD {
                for b in ODD {
                    let lanes = four(Four::new([a, b, 2.0, a]), Four::new([b, a, 3.0, a]));
                    for (lane, alone) in lanes.to_array().into_iter().zip([
                        one(a, b),
                        one(b, a),
                        one(2.0, 3.0),
                        one(a, a),
                    ]) {
                        let same =
                            lane.to_bits() == alone.to_bits() || lane.is_nan() && alone.is_nan();
                        assert!(same, "{a} {b}: {lane} {alone}");
                    }
                }
            }
        }
    }

    #[test]
    fn choices_and_signs_are_lane_by_lane() {
        for a in ODD {
            let negated = (-Four::splat(a)).to_array();
            assert!(negated.iter().all(|lane| lane.to_bits() == (-a).to_bits()), "-{a}");
            for b in ODD {
                let mask = Four::new([a, b, 0.0, 0.0]).less(Four::new([b, a, 1.0, 0.0]));
                let expected = u32::from(a < b) | u32::from(b < a) << 1 | 1 << 2;
                assert_eq!(mask.bits(), expected, "{a} {b}");
                assert_eq!(Four::not(mask).bits(), !expected & 15, "not {a} {b}");
                let picked = Four::select(mask, Four::splat(1.0), Four::splat(2.0)).to_array();
                for (lane, value) in picked.into_iter().enumerate() {
                    let yes = expected >> lane & 1 == 1;
                    assert!((value - if yes { 1.0 } else { 2.0 }).abs() < 0.5, "{a} {b}");
                }
            }
        }
        assert_eq!(FourMask::first(3).bits(), 7, "three of four");
    }
}
