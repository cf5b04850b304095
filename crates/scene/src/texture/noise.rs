//! Clouds: smooth noise, and finer noise over it, about one half.

use super::lattice::{SMOOTH, octaves};
use super::whole;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "noise",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "octaves", default: 1.0, range: Range::Whole(1, 16) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (p, width) = (p * arguments[0], width * arguments[0]);
        let (sum, _) = octaves(p, width, whole(arguments[1]), &SMOOTH);
        // Noise has a deviation of 0.27; few places of several octaves lie beyond 1, and are cut.
        (0.5 + 0.5 * sum).clamp(0.0, 1.0)
    }),
};
