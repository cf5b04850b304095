//! Bands along u, `count` of them from v = 0 to v = 1, every other one painted.

use super::filter::alternating;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "stripes",
    domain: Domain::Surface,
    parameters: &[Parameter { name: "count", default: 8.0, range: Range::Above(0.0) }],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        0.5 - 0.5 * alternating(p.y * arguments[0], width.y * arguments[0])
    }),
};
