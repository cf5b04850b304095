//! Cubes in space with edges of `1 / scale`, every other one painted.

use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "checker3d",
    domain: Domain::Solid,
    parameters: &[Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) }],
    weight: |arguments, p| {
        let p = p * arguments[0];
        let cubes = libm::floor(p.x) + libm::floor(p.y) + libm::floor(p.z);
        if libm::fmod(cubes, 2.0).abs() < 0.5 { 0.0 } else { 1.0 }
    },
};
