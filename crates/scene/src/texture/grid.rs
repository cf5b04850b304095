//! Lines between fields of the surface, `u` by `v` of them.

use super::filter::lines;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "grid",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "width", default: 0.1, range: Range::Within(0.0, 1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let free = 1.0 - lines(p.x * arguments[0], width.x * arguments[0], arguments[2]);
        1.0 - free * (1.0 - lines(p.y * arguments[1], width.y * arguments[1], arguments[2]))
    }),
};
