//! Numbers a primitive is written in: one `f64`, four or eight of them, or a double-double in tests.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f64x4, f64x8};

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

macro_rules! lane_by_lane {
    ($lanes:ident: $($operator:ident $method:ident)*) => {$(
        impl $operator for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )*};
}

/// Makes a type of several numbers side by side, and one of which of them something holds for.
macro_rules! side_by_side {
    ($(#[$about:meta])* $lanes:ident $mask:ident $wide:ident $count:literal) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $lanes($wide);

        /// Which lanes something holds for.
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $mask($wide);

        impl $lanes {
            /// Number of lanes.
            pub const LANES: usize = $count;

            /// The numbers, lane by lane.
            #[inline(always)]
            #[must_use]
            pub fn new(lanes: [f64; $count]) -> Self {
                Self($wide::new(lanes))
            }

            /// The numbers, lane by lane.
            #[inline(always)]
            #[must_use]
            pub fn to_array(self) -> [f64; $count] {
                self.0.to_array()
            }

            /// The magnitude of each lane.
            #[inline(always)]
            #[must_use]
            pub fn abs(self) -> Self {
                Self(self.0.abs())
            }
        }

        impl $mask {
            /// Holds for the first `count` lanes.
            #[must_use]
            pub fn first(count: usize) -> Self {
                Self::of_bits((1 << count) - 1)
            }

            /// Holds for lane k where bit k is set.
            #[inline(always)]
            #[must_use]
            pub fn of_bits(bits: u32) -> Self {
                let set = |lane: usize| if bits >> lane & 1 == 1 { 1.0 } else { 0.0 };
                $lanes::splat(0.5).less($lanes::new(std::array::from_fn(set)))
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

        lane_by_lane! { $lanes: Add add Sub sub Mul mul Div div }

        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Lanes for $lanes {
            type Mask = $mask;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self($wide::splat(value))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline(always)]
            fn less(self, other: Self) -> $mask {
                $mask(self.0.simd_lt(other.0))
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> $mask {
                $mask(self.0.simd_le(other.0))
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self(mask.0.select(yes.0, no.0))
            }
            #[inline(always)]
            fn and(a: $mask, b: $mask) -> $mask {
                $mask(a.0 & b.0)
            }
            #[inline(always)]
            fn or(a: $mask, b: $mask) -> $mask {
                $mask(a.0 | b.0)
            }
            #[inline(always)]
            fn not(a: $mask) -> $mask {
                $mask(!a.0)
            }
            fn each<const N: usize, const M: usize>(
                from: [Self; N],
                mut function: impl FnMut([f64; N]) -> [f64; M],
            ) -> [Self; M] {
                let lanes = from.map(Self::to_array);
                let mut found = [[0.0; $count]; M];
                for lane in 0..$count {
                    let values = function(lanes.map(|numbers| numbers[lane]));
                    for (found, value) in found.iter_mut().zip(values) {
                        found[lane] = value;
                    }
                }
                found.map(Self::new)
            }
        }
    };
}

side_by_side! {
    /// Four numbers side by side: each lane has the bits that one `f64` would have.
    Four FourMask f64x4 4
}

side_by_side! {
    /// Eight numbers side by side: each lane has the bits that one `f64` would have.
    Eight EightMask f64x8 8
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

    /// Tests of one type of lanes.
    macro_rules! lanes_are_alone {
        ($name:ident $lanes:ident $mask:ident) => {
            mod $name {
                use super::*;

                /// Some of the lanes are `a`, some `b`.
                fn mixed(a: f64, b: f64) -> $lanes {
                    $lanes::new(std::array::from_fn(|lane| if lane % 3 == 1 { b } else { a }))
                }

                #[test]
                fn each_lane_has_the_bits_of_one_number() {
                    let one: [fn(f64, f64) -> f64; 7] = [
                        |a, b| a + b,
                        |a, b| a - b,
                        |a, b| a * b,
                        |a, b| a / b,
                        |a, _| a.sqrt(),
                        Lanes::min,
                        Lanes::max,
                    ];
                    let several: [fn($lanes, $lanes) -> $lanes; 7] = [
                        |a, b| a + b,
                        |a, b| a - b,
                        |a, b| a * b,
                        |a, b| a / b,
                        |a, _| a.sqrt(),
                        Lanes::min,
                        Lanes::max,
                    ];
                    for (one, several) in one.iter().zip(several) {
                        for (a, b) in ODD.into_iter().flat_map(|a| ODD.map(|b| (a, b))) {
                            let lanes = several(mixed(a, b), mixed(b, a)).to_array();
                            for (lane, found) in lanes.into_iter().enumerate() {
                                let alone = if lane % 3 == 1 { one(b, a) } else { one(a, b) };
                                let same = found.to_bits() == alone.to_bits()
                                    || found.is_nan() && alone.is_nan();
                                assert!(same, "{a} {b}: {found} {alone}");
                            }
                        }
                    }
                }

                #[test]
                fn choices_and_signs_are_lane_by_lane() {
                    let all = (1 << $lanes::LANES) - 1;
                    for (a, b) in ODD.into_iter().flat_map(|a| ODD.map(|b| (a, b))) {
                        let negated = (-$lanes::splat(a)).to_array();
                        assert!(negated.iter().all(|x| x.to_bits() == (-a).to_bits()), "-{a}");
                        let mask = mixed(a, b).less(mixed(b, a));
                        let mut expected = 0;
                        for lane in 0..$lanes::LANES {
                            let (left, right) = if lane % 3 == 1 { (b, a) } else { (a, b) };
                            expected |= u32::from(left < right) << lane;
                        }
                        assert_eq!(mask.bits(), expected, "{a} {b}");
                        assert_eq!($lanes::not(mask).bits(), !expected & all, "not {a} {b}");
                        let picked =
                            $lanes::select(mask, $lanes::splat(1.0), $lanes::splat(2.0)).to_array();
                        for (lane, value) in picked.into_iter().enumerate() {
                            let yes = expected >> lane & 1 == 1;
                            assert!((value - if yes { 1.0 } else { 2.0 }).abs() < 0.5, "{a} {b}");
                        }
                    }
                    assert_eq!($mask::first(3).bits(), 7, "three lanes");
                    assert_eq!($mask::first($lanes::LANES).bits(), all, "all lanes");
                    for bits in 0..=all {
                        assert_eq!($mask::of_bits(bits).bits(), bits, "{bits:b}");
                    }
                }
            }
        };
    }

    lanes_are_alone! { four Four FourMask }
    lanes_are_alone! { eight Eight EightMask }
}
