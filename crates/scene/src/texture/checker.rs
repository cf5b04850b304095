//! Fields in the surface, `u` by `v` of them, every other one painted.

use super::filter::alternating;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "checker",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let along = alternating(p.x * arguments[0], width.x * arguments[0]);
        0.5 - 0.5 * along * alternating(p.y * arguments[1], width.y * arguments[1])
    }),
};
