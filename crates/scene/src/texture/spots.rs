//! Balls, one anywhere in every cube with edges of `1 / scale`.

use super::lattice::{ball, sites};
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "spots",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 2.0, range: Range::Above(0.0) },
        Parameter { name: "radius", default: 0.4, range: Range::Within(0.0, 0.5) },
        Parameter { name: "soft", default: 0.2, range: Range::Within(0.0, 1.0) },
    ],
    weight: |arguments, p| {
        sites(p * arguments[0]).into_iter().fold(0.0, |most, site| {
            let weight = ball(site.distance, arguments[1], arguments[2]);
            if weight > most { weight } else { most }
        })
    },
};
