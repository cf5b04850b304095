//! Veins across x, stirred by turbulence.

use super::noise::turbulence;
use super::{Domain, Function, Parameter};

pub(super) const FUNCTION: Function = Function {
    keyword: "marble",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, above: 0.0 },
        Parameter { name: "stir", default: 5.0, above: -1.0 },
    ],
    weight: |arguments, p| {
        let p = p * arguments[0];
        let phase = p.x * 2.0 + arguments[1] * turbulence(p, 6);
        let wave = 0.5 + 0.5 * libm::sin(std::f64::consts::PI * phase);
        // Thin veins on a clear ground.
        wave * wave * wave
    },
};
