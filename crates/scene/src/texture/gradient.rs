//! From 0 at y = 0 to 1 at y = `height`.

use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "gradient",
    domain: Domain::Solid,
    parameters: &[Parameter { name: "height", default: 1.0, range: Range::Above(0.0) }],
    weight: Weight::Formula(|arguments, Spot { point: p, .. }| {
        let share = p.y / arguments[0];
        if share <= 0.0 {
            0.0
        } else if share < 1.0 {
            share
        } else {
            1.0
        }
    }),
};
