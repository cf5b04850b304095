//! Lights that have a place or a direction.

use glam::DVec3;

use crate::color::Rgb;

/// Where the light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From `at` in all directions, without fall-off.
    Point {
        /// Where it stands.
        at: DVec3,
    },
    /// Parallel rays along the line from `at` to `toward`; the two differ.
    Beam {
        /// A point the light comes from.
        at: DVec3,
        /// A point it goes to.
        toward: DVec3,
    },
    /// From `at`, strongest toward the point `toward` (Warn, "Lighting Controls for Synthetic Images", 1983).
    Spot {
        /// Where it stands.
        at: DVec3,
        /// A point on its axis, not `at`.
        toward: DVec3,
        /// Exponent of the cosine of the angle off axis; 0 or more.
        concentration: f64,
        /// Nothing is lit beyond this angle off axis; above 0, at most 180.
        half_angle_degrees: f64,
    },
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Kind and place.
    pub kind: LightKind,
    /// Intensity times linear colour: 1 on white matte at normal incidence gives linear 1.
    pub color: Rgb,
    /// Solids stand in its way.
    pub shadows: bool,
    /// Radius of the sphere that light comes from, or of the disc about the start of a beam; 0 for a point, and not below.
    pub radius: f64,
}
