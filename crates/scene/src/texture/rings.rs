//! Circles in the surface about one place of it, `count` of them to the edge, every other one painted.

use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "rings",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "count", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "u", default: 0.5, range: Range::Within(0.0, 1.0) },
        Parameter { name: "v", default: 0.5, range: Range::Within(0.0, 1.0) },
    ],
    weight: |arguments, p| {
        let (u, v) = (p.x - arguments[1], p.y - arguments[2]);
        // The edge is half the surface away from its middle.
        let ring = libm::floor(2.0 * arguments[0] * (u * u + v * v).sqrt());
        if libm::fmod(ring, 2.0).abs() < 0.5 { 0.0 } else { 1.0 }
    },
};
