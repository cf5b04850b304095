//! Bricks in `v` courses of `u`, every other course moved by half a brick; the joints are not painted.

use super::lattice::{on_line, split};
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "brick",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "joint", default: 0.15, range: Range::Within(0.0, 1.0) },
    ],
    weight: |arguments, p| {
        let (course, _) = split(p.y * arguments[1]);
        let moved = if libm::fmod(course, 2.0).abs() < 0.5 { 0.0 } else { 0.5 };
        // A joint is as wide in u as in v.
        let upright = arguments[2] * arguments[0] / arguments[1];
        let joint = on_line(p.x * arguments[0] + moved, upright)
            || on_line(p.y * arguments[1], arguments[2]);
        if joint { 0.0 } else { 1.0 }
    },
};
