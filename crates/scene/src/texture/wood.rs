//! Rings about the x axis, `scale` of them a unit, wavering along the grain.

use glam::DVec3;

use super::lattice::{noise, split};
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "wood",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "waver", default: 0.3, range: Range::Above(-1.0) },
    ],
    weight: |arguments, p| {
        let radius = (p.y * p.y + p.z * p.z).sqrt() * arguments[0];
        let along = DVec3::new(p.x * 0.5, p.y, p.z) * arguments[0] * 0.5;
        let ring = radius + arguments[1] * noise(along);
        let (_, share) = split(ring);
        // Early wood fades slowly into late wood, which ends sharply.
        share * share
    },
};
