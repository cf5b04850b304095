//! Cubes in space with edges of `1 / scale`, every other one painted.

use super::filter::alternating;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "checker3d",
    domain: Domain::Solid,
    parameters: &[Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) }],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (p, width) = (p * arguments[0], width * arguments[0]);
        let plane = alternating(p.x, width.x) * alternating(p.y, width.y);
        0.5 - 0.5 * plane * alternating(p.z, width.z)
    }),
};
