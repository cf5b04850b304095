//! Bands along u, `count` of them from v = 0 to v = 1, every other one painted.

use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "stripes",
    domain: Domain::Surface,
    parameters: &[Parameter { name: "count", default: 8.0, range: Range::Above(0.0) }],
    weight: |arguments, p| {
        let band = libm::floor(p.y * arguments[0]);
        if libm::fmod(band, 2.0).abs() < 0.5 { 0.0 } else { 1.0 }
    },
};
