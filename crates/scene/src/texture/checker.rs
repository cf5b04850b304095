//! Fields in the surface, `u` by `v` of them, every other one painted.

use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "checker",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
    ],
    weight: |arguments, p| {
        let fields = libm::floor(p.x * arguments[0]) + libm::floor(p.y * arguments[1]);
        if libm::fmod(fields, 2.0).abs() < 0.5 { 0.0 } else { 1.0 }
    },
};
