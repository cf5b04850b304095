//! The table of convex solids. A solid is one file here and one row; the parser, the tracer and the tests take it from
//! there. Solids with arguments are in [`crate::form`].
//!
//! Each solid stands in its canonical local space and is convex, so a line has one span in it.

mod block;
mod cone;
mod cylinder;
mod paraboloid;
mod sphere;

use glam::{DMat3, DVec2, DVec3};

use crate::lanes::Lanes;
use crate::ray::{Bounds, FacedSpan, Ray};

/// A face of a solid: 0 is the curved one, or the first of a block; prisms have as many as they have edges, and two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face(pub u32);

impl Face {
    /// The number that travels through lanes.
    #[must_use]
    pub fn number(self) -> f64 {
        f64::from(self.0)
    }

    /// The face from the number that travels through lanes.
    #[must_use]
    pub(crate) fn from_number(number: f64) -> Self {
        // Spans carry small whole numbers only.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a face")]
        Self(number as u32)
    }
}

/// One level surface of a solid at a point: the value of its function there, negative inside, and its gradient.
pub(crate) struct Level {
    value: f64,
    gradient: DVec3,
}

macro_rules! primitives {
    ($($(#[$doc:meta])* $($keyword:literal)|+ => $name:ident in $module:ident,)+) => {
        /// A solid the language knows by name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Primitive { $($(#[$doc])* $name,)+ }

        impl Primitive {
            /// Every solid, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$name,)+];

            /// The words for this solid; the first is the one that is printed.
            #[must_use]
            pub fn keywords(self) -> &'static [&'static str] {
                match self { $(Self::$name => &[$($keyword,)+],)+ }
            }

            /// Where the line of `ray`, given in local space, is inside; the whole line, not only `t ≥ 0`.
            #[inline(always)]
            #[must_use]
            pub fn span<L: Lanes>(self, ray: &Ray<L>) -> FacedSpan<L> {
                match self { $(Self::$name => $module::span(ray),)+ }
            }

            /// True if the local `point` is inside or on the surface.
            #[inline(always)]
            #[must_use]
            pub fn contains<L: Lanes>(self, point: [L; 3]) -> L::Mask {
                match self { $(Self::$name => $module::contains(point),)+ }
            }

            /// The outward gradient at a local point of `face`, a [`Face`] as a number; of any length but 0.
            #[inline(always)]
            #[must_use]
            pub fn gradient<L: Lanes>(self, point: [L; 3], face: L) -> [L; 3] {
                match self { $(Self::$name => $module::gradient(point, face),)+ }
            }

            /// Where a local point of `face` lies in the surface: u and v in 0…1.
            #[must_use]
            pub fn texture_coordinates(self, point: DVec3, face: Face) -> DVec2 {
                match self { $(Self::$name => $module::texture_coordinates(point, face),)+ }
            }

            /// The least box about the solid under the map `linear · p + place`, up to rounding.
            #[must_use]
            pub fn bounds(self, linear: &DMat3, place: DVec3) -> Bounds {
                match self { $(Self::$name => $module::bounds(linear, place),)+ }
            }

            /// The local point of the solid that is farthest along `direction`; one of them if there are several.
            #[must_use]
            pub fn support(self, direction: DVec3) -> DVec3 {
                match self { $(Self::$name => $module::support(direction),)+ }
            }

            /// Signed distance of a local point to the surface, to first order, in the units of `length`, which
            /// measures a local gradient there (the length of the gradient in scene units). Negative inside.
            #[must_use]
            pub fn distance(self, point: DVec3, length: impl Fn(DVec3) -> f64) -> f64 {
                match self { $(Self::$name => farthest(&$module::levels(point), length),)+ }
            }
        }
    };
}

primitives! {
    /// Radius 1 about the origin.
    "sphere" => Sphere in sphere,
    /// Radius 1 about the x axis, 0 ≤ x ≤ 1.
    "cylinder" => Cylinder in cylinder,
    /// Apex at the origin, opening along +x to radius 1 at x = 1.
    "cone" => Cone in cone,
    /// −1 ≤ x, y, z ≤ 1.
    "block" | "cube" => Block in block,
    /// Apex at the origin, opening along +x to radius 1 at x = 1: y² + z² ≤ x.
    "paraboloid" => Paraboloid in paraboloid,
}

impl Primitive {
    /// The solid called `word`, in any case.
    #[must_use]
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|solid| solid.keywords().iter().any(|keyword| keyword.eq_ignore_ascii_case(word)))
    }
}

/// The greatest distance to any of the levels, which all have to be negative inside.
fn farthest(levels: &[Level], length: impl Fn(DVec3) -> f64) -> f64 {
    levels.iter().fold(f64::NEG_INFINITY, |farthest, level| {
        let slope = length(level.gradient);
        // Where the gradient vanishes (an axis, an apex) the sign is all there is to say.
        let distance = if slope > 0.0 { level.value / slope } else { level.value * f64::INFINITY };
        if distance > farthest { distance } else { farthest }
    })
}

/// Where `a t² + 2 b t + c < 0` for a quadric that is convex along the line, by the closest approach.
///
/// `a` is positive, `closest` the parameter of the closest approach and `value` the quadric's value there: the span is
/// `closest ± √(−value / a)`, and neither end subtracts nearly equal numbers (Haines et al., "Precision Improvements
/// for Ray/Sphere Intersection", 2019). A grazing line encloses no volume and is dropped.
#[inline(always)]
fn about_closest<L: Lanes>(a: L, closest: L, value: L) -> FacedSpan<L> {
    let zero = L::splat(0.0);
    let hit = value.less(zero);
    let half = (L::select(hit, -value, zero) / a).sqrt();
    FacedSpan { from: closest - half, to: closest + half, ..FacedSpan::line() }.only(hit)
}

/// The box about a solid under a map, by its farthest points along the outer axes.
pub(crate) fn boxed(m: &DMat3, place: DVec3, support: impl Fn(DVec3) -> DVec3) -> Bounds {
    let rows = m.transpose();
    let reach = |row: DVec3| {
        let unit = row.abs().max_element();
        if unit > 0.0 { row.dot(support(row / unit)) } else { 0.0 }
    };
    let reaches = |sign: f64| {
        DVec3::new(reach(sign * rows.x_axis), reach(sign * rows.y_axis), reach(sign * rows.z_axis))
    };
    Bounds { low: place - reaches(-1.0), high: place + reaches(1.0) }
}

/// Angle of (y, z) about the x axis as a share of a turn in 0…1, from +y toward +z.
pub(crate) fn turn(y: f64, z: f64) -> f64 {
    let turn = libm::atan2(z, y) / std::f64::consts::TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}

#[cfg(test)]
mod conformance;
#[cfg(test)]
mod double;
#[cfg(test)]
mod tests;
