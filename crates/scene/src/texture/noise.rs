//! Clouds: smooth noise, and finer noise over it, about one half.

use super::lattice::octaves;
use super::whole;
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "noise",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "octaves", default: 1.0, range: Range::Whole(1, 16) },
    ],
    weight: |arguments, p| {
        let sum = octaves(p * arguments[0], whole(arguments[1]), |noise| noise);
        // Noise has a deviation of 0.27; few places of several octaves lie beyond 1, and are cut.
        (0.5 + 0.5 * sum).clamp(0.0, 1.0)
    },
};
