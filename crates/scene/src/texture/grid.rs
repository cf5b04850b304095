//! Lines between fields of the surface, `u` by `v` of them.

use super::lattice::on_line;
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "grid",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "width", default: 0.1, range: Range::Within(0.0, 1.0) },
    ],
    weight: |arguments, p| {
        let line = on_line(p.x * arguments[0], arguments[2]);
        if line || on_line(p.y * arguments[1], arguments[2]) { 1.0 } else { 0.0 }
    },
};
