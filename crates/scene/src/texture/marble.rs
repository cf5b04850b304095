//! Veins across x, stirred by turbulence.

use super::lattice::octaves;
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "marble",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "stir", default: 5.0, range: Range::Above(-1.0) },
    ],
    weight: |arguments, p| {
        let p = p * arguments[0];
        let angle = std::f64::consts::PI * (p.x * 2.0 + arguments[1] * octaves(p, 6, f64::abs));
        // Infinitely many turns are none.
        let sine = if angle.is_finite() { libm::sin(angle) } else { 0.0 };
        let wave = 0.5 + 0.5 * sine;
        // Thin veins on a clear ground.
        wave * wave * wave
    },
};
