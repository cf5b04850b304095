//! Numbers a primitive is written in: one `f64`, or in time several, or a double-double in tests.

use std::ops::{Add, Div, Mul, Neg, Sub};

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
    /// Where `mask` holds `yes`, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Both hold.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either holds.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// It does not hold.
    fn not(a: Self::Mask) -> Self::Mask;

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
}
