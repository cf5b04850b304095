//! Placement as the language writes it, and the pair of maps that comes of it.

use glam::{DMat3, DVec3};

use crate::lanes::Lanes;
use crate::ray::Ray;

/// Scale, then rotate about x, then y, then z, then move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Factor along each local axis; never 0, negative mirrors.
    pub scale: DVec3,
    /// Angles about x, y and z, in degrees.
    pub rotation_degrees: DVec3,
    /// Where the local origin comes to stand.
    pub place: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: DVec3::ONE, rotation_degrees: DVec3::ZERO, place: DVec3::ZERO }
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
#[must_use]
pub fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    // `%` is exact, so any angle is first brought into one turn without rounding.
    let turn = angle % 360.0;
    let turn = if turn < 0.0 { turn + 360.0 } else { turn };
    // Reduced to an eighth of a turn: symmetric angles get the same bits, and 45° gives sine equal to cosine.
    let quarter = libm::floor(turn / 90.0);
    let rest = turn - 90.0 * quarter;
    let radians = |degrees: f64| degrees * (std::f64::consts::PI / 180.0);
    let (s, c) = if rest <= 0.0 {
        (0.0, 1.0)
    } else if rest <= 45.0 {
        (libm::sin(radians(rest)), libm::cos(radians(rest)))
    } else {
        (libm::cos(radians(90.0 - rest)), libm::sin(radians(90.0 - rest)))
    };
    if !(0.5..=3.5).contains(&quarter) {
        (s, c)
    } else if quarter < 1.5 {
        (c, 0.0 - s)
    } else if quarter < 2.5 {
        (0.0 - s, 0.0 - c)
    } else {
        (0.0 - c, s)
    }
}

impl Placement {
    /// The rotation alone.
    #[must_use]
    pub fn rotation(&self) -> DMat3 {
        // What the products below come to, to the sign of each zero; most solids are not turned.
        if self.rotation_degrees == DVec3::ZERO {
            return DMat3::IDENTITY;
        }
        let (sx, cx) = sin_cos_degrees(self.rotation_degrees.x);
        let (sy, cy) = sin_cos_degrees(self.rotation_degrees.y);
        let (sz, cz) = sin_cos_degrees(self.rotation_degrees.z);
        let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
        let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
        let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
        product(&about_z, &product(&about_y, &about_x))
    }

    /// Both directions of this placement.
    #[must_use]
    pub fn map(&self) -> Map {
        let r = self.rotation();
        let s = self.scale;
        let linear = DMat3::from_cols(r.x_axis * s.x, r.y_axis * s.y, r.z_axis * s.z);
        // The inverse of a rotation is its transpose; rows are divided by the scale. Nothing is inverted numerically.
        let inverse = DMat3::from_cols(r.x_axis / s.x, r.y_axis / s.y, r.z_axis / s.z).transpose();
        Map {
            linear,
            inverse,
            place: self.place,
            mirrored: (s.x < 0.0) ^ (s.y < 0.0) ^ (s.z < 0.0),
            magnitude: self.place.abs().max_element(),
        }
    }

    /// True if it changes nothing.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self::default()
    }
}

/// `v` at unit length. Vectors whose square would leave the range of numbers are first brought to size by their
/// largest coordinate; a zero vector gives NaN.
#[inline(always)]
#[must_use]
pub fn unit(v: DVec3) -> DVec3 {
    let square = v.length_squared();
    if square > 1e-200 && square < 1e200 {
        return v * (1.0 / square.sqrt());
    }
    let v = v / v.abs().max_element();
    v * (1.0 / v.length())
}

/// Product of two matrices as plain products and sums: the same bits whatever the build makes of vectors.
fn product(a: &DMat3, b: &DMat3) -> DMat3 {
    let column = |c: DVec3| apply(a, c);
    DMat3::from_cols(column(b.x_axis), column(b.y_axis), column(b.z_axis))
}

/// Matrix times vector as plain products and sums.
#[inline(always)]
#[must_use]
pub fn apply(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(
        m.x_axis.x * v.x + m.y_axis.x * v.y + m.z_axis.x * v.z,
        m.x_axis.y * v.x + m.y_axis.y * v.y + m.z_axis.y * v.z,
        m.x_axis.z * v.x + m.y_axis.z * v.y + m.z_axis.z * v.z,
    )
}

/// [`apply`] in lanes.
#[inline(always)]
fn apply_lanes<L: Lanes>(m: &DMat3, [x, y, z]: [L; 3]) -> [L; 3] {
    let row = |a: f64, b: f64, c: f64| L::splat(a) * x + L::splat(b) * y + L::splat(c) * z;
    [
        row(m.x_axis.x, m.y_axis.x, m.z_axis.x),
        row(m.x_axis.y, m.y_axis.y, m.z_axis.y),
        row(m.x_axis.z, m.y_axis.z, m.z_axis.z),
    ]
}

/// Transposed matrix times vector: takes gradients outward when `m` takes points inward.
#[inline(always)]
#[must_use]
pub fn apply_transposed(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(
        m.x_axis.x * v.x + m.x_axis.y * v.y + m.x_axis.z * v.z,
        m.y_axis.x * v.x + m.y_axis.y * v.y + m.y_axis.z * v.z,
        m.z_axis.x * v.x + m.z_axis.y * v.y + m.z_axis.z * v.z,
    )
}

/// An affine map and its inverse, composed side by side.
///
/// `outer = linear · inner + place` and `inner = inverse · (outer − place)`: the place is taken off first, so a solid
/// far from the origin loses nothing in the product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Outer from inner, without the move.
    pub linear: DMat3,
    /// Inner from outer, without the move.
    pub inverse: DMat3,
    /// Where the inner origin stands.
    pub place: DVec3,
    /// The map turns left hands into right ones, from the signs of the scale.
    pub mirrored: bool,
    /// The largest coordinate that entered the composition, in outer units: bounds the rounding in `place`.
    pub magnitude: f64,
}

impl Map {
    /// Changes nothing.
    pub const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        inverse: DMat3::IDENTITY,
        place: DVec3::ZERO,
        mirrored: false,
        magnitude: 0.0,
    };

    /// The map that goes through `inner` first.
    #[must_use]
    pub fn then_inner(&self, inner: &Self) -> Self {
        let offset = apply(&self.linear, inner.place);
        Self {
            linear: product(&self.linear, &inner.linear),
            inverse: product(&inner.inverse, &self.inverse),
            place: self.place + offset,
            mirrored: self.mirrored ^ inner.mirrored,
            magnitude: self
                .magnitude
                .max(self.stretch() * inner.magnitude)
                .max((self.place + offset).abs().max_element()),
        }
    }

    /// True if both directions are within the range of numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.inverse.is_finite() && self.place.is_finite()
    }

    /// The largest factor by which a coordinate can grow outward (the maximum row sum).
    #[must_use]
    pub fn stretch(&self) -> f64 {
        let m = self.linear;
        (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element()
    }

    /// A point taken outward.
    #[inline(always)]
    #[must_use]
    pub fn outward(&self, point: DVec3) -> DVec3 {
        apply(&self.linear, point) + self.place
    }

    /// A point taken inward.
    #[inline(always)]
    #[must_use]
    pub fn inward(&self, point: DVec3) -> DVec3 {
        apply(&self.inverse, point - self.place)
    }

    /// A ray taken inward; `t` keeps its meaning.
    #[inline(always)]
    #[must_use]
    pub fn ray_inward<L: Lanes>(&self, ray: &Ray<L>) -> Ray<L> {
        Ray {
            origin: self.inward_lanes(ray.origin),
            direction: apply_lanes(&self.inverse, ray.direction),
        }
    }

    /// [`Map::inward`] in lanes.
    #[inline(always)]
    #[must_use]
    pub fn inward_lanes<L: Lanes>(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let place = self.place;
        let offset = [x - L::splat(place.x), y - L::splat(place.y), z - L::splat(place.z)];
        apply_lanes(&self.inverse, offset)
    }

    /// An inner gradient as an outer one, not normalised. It points the same way out in mirrored maps, too.
    #[inline(always)]
    #[must_use]
    pub fn gradient_outward(&self, gradient: DVec3) -> DVec3 {
        apply_transposed(&self.inverse, gradient)
    }

    /// [`Map::gradient_outward`] in lanes.
    #[inline(always)]
    #[must_use]
    pub fn gradient_outward_lanes<L: Lanes>(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let m = &self.inverse;
        let row = |r: DVec3| L::splat(r.x) * x + L::splat(r.y) * y + L::splat(r.z) * z;
        [row(m.x_axis), row(m.y_axis), row(m.z_axis)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        for (angle, expected) in [
            (0.0, (0.0, 1.0)),
            (90.0, (1.0, 0.0)),
            (-90.0, (-1.0, 0.0)),
            (180.0, (0.0, -1.0)),
            (270.0, (-1.0, 0.0)),
            (-720.0, (0.0, 1.0)),
            (36_000_090.0, (1.0, 0.0)),
        ] {
            assert_eq!(sin_cos_degrees(angle), expected, "{angle}");
        }
        let (s, c) = sin_cos_degrees(45.0);
        assert!((s - c).abs() < 2e-16, "diagonal: {s} {c}");
        let (s, c) = sin_cos_degrees(30.0);
        assert!((s - 0.5).abs() < 1e-16 && (c - 0.75_f64.sqrt()).abs() < 2e-16, "30°: {s} {c}");
        let (s, c) = sin_cos_degrees(-210.0);
        assert!((s - 0.5).abs() < 2e-16 && (c + 0.75_f64.sqrt()).abs() < 2e-16, "-210°: {s} {c}");
    }

    #[test]
    fn what_is_not_turned_has_the_bits_of_a_whole_turn() {
        let rotation = |degrees: f64| {
            let rotation_degrees = DVec3::splat(degrees);
            let placement = Placement { rotation_degrees, ..Placement::default() };
            placement.rotation().to_cols_array().map(f64::to_bits)
        };
        for degrees in [0.0, -0.0] {
            assert_eq!(rotation(degrees), rotation(360.0), "{degrees:?}");
        }
    }

    #[test]
    fn unit_vectors_at_any_size() {
        for k in [-1000, -320, -20, 0, 20, 330, 1000] {
            let v = unit(DVec3::new(3.0, -4.0, 12.0) * libm::scalbn(1.0, k));
            assert!(v.abs_diff_eq(DVec3::new(3.0, -4.0, 12.0) / 13.0, 2e-16), "2^{k}: {v}");
        }
    }

    #[test]
    fn scale_then_rotate_then_move() {
        // The matrix worked out in the reference page on bounds.
        let map = Placement {
            scale: DVec3::new(2.0, 1.0, 0.5),
            rotation_degrees: DVec3::new(30.0, 40.0, 50.0),
            place: DVec3::new(1.0, 2.0, 3.0),
        }
        .map();
        let expected = DMat3::from_cols_array(&[
            0.984_807_753,
            1.173_648_178,
            -1.285_575_219,
            -0.456_825_993,
            0.802_872_337,
            0.383_022_222,
            0.370_421_528,
            0.052_520_231,
            0.331_706_974,
        ]);
        assert!(map.linear.abs_diff_eq(expected, 1e-9), "{:?}", map.linear);
        let point = DVec3::new(0.3, -0.7, 1.9);
        assert!(map.inward(map.outward(point)).abs_diff_eq(point, 1e-15), "inverse");
    }

    #[test]
    fn composed_inverses_stay_inverse_over_many_decades() {
        for decade in -12..=12 {
            let unit = libm::exp10(f64::from(decade));
            let outer = Placement {
                scale: DVec3::new(2.0, -3.0, 0.1) * unit,
                rotation_degrees: DVec3::new(10.0, 20.0, 30.0),
                place: DVec3::new(5.0, 6.0, 7.0) * unit,
            };
            let inner = Placement {
                scale: DVec3::new(0.5, 1.0, 4.0),
                rotation_degrees: DVec3::new(-70.0, 0.0, 190.0),
                place: DVec3::new(-1.0, 0.5, 2.0),
            };
            let map = outer.map().then_inner(&inner.map());
            assert!(map.mirrored, "one negative factor");
            let point = DVec3::new(0.1, 0.2, -0.3);
            assert!(map.inward(map.outward(point)).abs_diff_eq(point, 1e-13), "1e{decade}");
            assert!(map.magnitude >= map.place.abs().max_element(), "magnitude covers the place");
        }
    }
}
