//! Bricks in `v` courses of `u`, every other course moved by half a brick; the joints are not painted.

use super::filter::{alternating, lines};
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "brick",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "u", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "joint", default: 0.15, range: Range::Within(0.0, 1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (along, along_width) = (p.x * arguments[0], width.x * arguments[0]);
        let (up, up_width) = (p.y * arguments[1], width.y * arguments[1]);
        // A joint is as wide in u as in v.
        let upright = arguments[2] * arguments[0] / arguments[1];
        let upright = if upright < 1.0 { upright } else { 1.0 };
        // Share of the courses that are not moved.
        let even = 0.5 + 0.5 * alternating(up, up_width);
        let joint = even * lines(along, along_width, upright)
            + (1.0 - even) * lines(along + 0.5, along_width, upright);
        (1.0 - joint) * (1.0 - lines(up, up_width, arguments[2]))
    }),
};
