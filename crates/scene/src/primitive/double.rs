//! A number of twice the precision, as lanes: the oracle for spans in `f64`.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::lanes::Lanes;

/// An unevaluated sum: about 32 digits (Dekker, "A floating-point technique for extending the available precision",
/// 1971). The second part is below half a unit in the last place of the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double(f64, f64);

/// The exact sum of two numbers.
fn sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let b_part = s - a;
    Double(s, (a - (s - b_part)) + (b - b_part))
}

/// The exact product of two numbers that are not huge.
fn product(a: f64, b: f64) -> Double {
    let halves = |x: f64| {
        let shifted = 134_217_729.0 * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    let p = a * b;
    Double(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Double {
    pub(super) fn new(x: f64) -> Self {
        Self(x, 0.0)
    }

    pub(super) fn value(self) -> f64 {
        self.0
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = sum(self.0, other.0);
        if !high.0.is_finite() {
            return Self::new(high.0);
        }
        let low = sum(self.1, other.1);
        let high = sum(high.0, high.1 + low.0);
        sum(high.0, high.1 + low.1)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = product(self.0, other.0);
        sum(high.0, high.1 + (self.0 * other.1 + self.1 * other.0))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self - other * Self::new(first);
        let second = rest.0 / other.0;
        let rest = rest - other * Self::new(second);
        sum(first, second) + Self::new(rest.0 / other.0)
    }
}

impl Lanes for Double {
    type Mask = bool;

    fn splat(value: f64) -> Self {
        Self::new(value)
    }
    fn sqrt(self) -> Self {
        let first = self.0.sqrt();
        if first <= 0.0 {
            return Self::new(first);
        }
        let rest = self - product(first, first);
        sum(first, rest.0 / (2.0 * first))
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0 || (self.0 <= other.0 && self.1 < other.1)
    }
    fn at_most(self, other: Self) -> bool {
        !other.less(self)
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    fn and(a: bool, b: bool) -> bool {
        a & b
    }
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    fn not(a: bool) -> bool {
        !a
    }
    fn each<const N: usize, const M: usize>(
        from: [Self; N],
        mut function: impl FnMut([f64; N]) -> [f64; M],
    ) -> [Self; M] {
        function(from.map(Self::value)).map(Self::new)
    }
}

#[test]
fn a_third_and_a_root_have_thirty_digits() {
    let third = Double::new(1.0) / Double::new(3.0);
    let one = third + third + third - Double::new(1.0);
    assert!(one.value().abs() < 1e-31, "{one:?}");
    let two = Double::new(2.0);
    let root = Lanes::sqrt(two);
    assert!((root * root - two).value().abs() < 1e-30, "{root:?}");
}
