//! Flames: noise without its sign, so that it creases where it is 0.

use super::lattice::{CREASED, octaves};
use super::whole;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "turbulence",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "octaves", default: 6.0, range: Range::Whole(1, 16) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (p, width) = (p * arguments[0], width * arguments[0]);
        let (sum, _) = octaves(p, width, whole(arguments[1]), &CREASED);
        // One place in a hundred lies beyond 0.9; what lies beyond 1 is cut.
        if sum < 1.0 { sum } else { 1.0 }
    }),
};
