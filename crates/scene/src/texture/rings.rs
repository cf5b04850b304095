//! Circles in the surface about one place of it, `count` of them to the edge, every other one painted.

use super::filter::alternating;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "rings",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "count", default: 8.0, range: Range::Above(0.0) },
        Parameter { name: "u", default: 0.5, range: Range::Within(0.0, 1.0) },
        Parameter { name: "v", default: 0.5, range: Range::Within(0.0, 1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (u, v) = (p.x - arguments[1], p.y - arguments[2]);
        let radius = (u * u + v * v).sqrt();
        // What lies across the rings.
        let (along, up) = (u * width.x, v * width.y);
        let across = if radius > 0.0 { (along * along + up * up).sqrt() / radius } else { 0.0 };
        // The edge is half the surface away from its middle.
        let rings = 2.0 * arguments[0];
        0.5 - 0.5 * alternating(rings * radius, rings * across)
    }),
};
