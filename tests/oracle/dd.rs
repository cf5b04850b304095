//! Double-double arithmetic: numbers as unevaluated sums of two `f64`, about 106 bits (Dekker, "A Floating-Point
//! Technique for Extending the Available Precision", 1971).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Dd {
    high: f64,
    low: f64,
}

/// A point or a direction.
pub(crate) type Vec3 = [Dd; 3];

fn two_sum(a: f64, b: f64) -> Dd {
    let high = a + b;
    let part = high - a;
    Dd { high, low: (a - (high - part)) + (b - part) }
}

/// The same for `a` not smaller than `b`.
fn quick_sum(a: f64, b: f64) -> Dd {
    let high = a + b;
    Dd { high, low: b - (high - a) }
}

fn split(a: f64) -> (f64, f64) {
    // 2²⁷ + 1 cuts 53 bits into halves whose products are exact.
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> Dd {
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    Dd { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl Dd {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(crate) const ONE: Self = Self { high: 1.0, low: 0.0 };
    /// π / 180.
    const DEGREE: Self = Self { high: 0.017_453_292_519_943_295, low: 2.948_652_270_870_168_7e-19 };

    /// The nearest `f64`.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// The square root; 0 below 0.
    pub(crate) fn sqrt(self) -> Self {
        if self <= Self::ZERO {
            return Self::ZERO;
        }
        // Two Newton steps from 53 bits.
        let mut root = Self::from(self.high.sqrt());
        for _ in 0..2 {
            root = (root + self / root) * Self::from(0.5);
        }
        root
    }
}

impl From<u32> for Dd {
    fn from(whole: u32) -> Self {
        Self::from(f64::from(whole))
    }
}

impl From<f64> for Dd {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Dd {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_sum(high.high, high.low + low.high);
        quick_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        quick_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Dd {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        quick_sum(first, second) + Self::from(rest.high / other.high)
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
pub(crate) fn sin_cos_degrees(angle: f64) -> (Dd, Dd) {
    let turn = angle % 360.0;
    let quarters = (turn / 90.0).trunc();
    let rest = Dd::from(turn) - Dd::from(90.0 * quarters);
    let (mut s, mut c) = sin_cos(rest * Dd::DEGREE);
    let mut left = quarters;
    while left > 0.5 {
        (s, c) = (c, -s);
        left -= 1.0;
    }
    while left < -0.5 {
        (s, c) = (-c, s);
        left += 1.0;
    }
    (s, c)
}

/// Taylor series for angles below a quarter turn: 2¹⁰⁶ is passed by π/2 to the 28th over 28!.
fn sin_cos(angle: Dd) -> (Dd, Dd) {
    let (mut sine, mut cosine) = (Dd::ZERO, Dd::ZERO);
    let mut term = Dd::ONE;
    for k in 0..30 {
        match k % 4 {
            0 => cosine = cosine + term,
            1 => sine = sine + term,
            2 => cosine = cosine - term,
            _ => sine = sine - term,
        }
        term = term * angle / Dd::from(f64::from(k + 1));
    }
    (sine, cosine)
}

pub(crate) fn vector(v: glam::DVec3) -> Vec3 {
    v.to_array().map(Dd::from)
}

pub(crate) fn dot(a: &Vec3, b: &Vec3) -> Dd {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + s b`.
pub(crate) fn along(a: &Vec3, s: Dd, b: &Vec3) -> Vec3 {
    std::array::from_fn(|k| a[k] + s * b[k])
}

pub(crate) fn minus(a: &Vec3, b: &Vec3) -> Vec3 {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn unit(v: &Vec3) -> Vec3 {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// The largest coordinate, unsigned.
pub(crate) fn largest(v: &Vec3) -> f64 {
    v.iter().fold(0.0, |most, x| f64::max(most, x.value().abs()))
}
