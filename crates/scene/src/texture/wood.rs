//! Rings about the x axis, `scale` of them a unit, wavering along the grain.

use glam::DVec3;

use super::filter::{is_point, rising};
use super::lattice::{SMOOTH, octaves, split};
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "wood",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "waver", default: 0.3, range: Range::Above(-1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let radius = (p.y * p.y + p.z * p.z).sqrt() * arguments[0];
        let stretched = |v: DVec3| DVec3::new(v.x * 0.5, v.y, v.z) * arguments[0] * 0.5;
        let (wavering, variance) = octaves(stretched(p), stretched(width), 1, &SMOOTH);
        let ring = radius + arguments[1] * wavering;
        // What a pixel takes in across the rings, and what the wavering left out adds to it: a box of its variance.
        let (y, z) = (p.y * width.y, p.z * width.z);
        let wide = if radius > 0.0 { (y * y + z * z).sqrt() / radius } else { 0.0 };
        let wide = wide * arguments[0] * arguments[0];
        let wide = (wide * wide + 12.0 * variance * arguments[1] * arguments[1]).sqrt();
        // Early wood fades slowly into late wood, which ends sharply.
        if is_point(ring, wide) {
            let (_, share) = split(ring);
            return share * share;
        }
        // Rounding alone takes it out of range.
        rising(ring, wide, |share| share * share * share / 3.0).clamp(0.0, 1.0)
    }),
};
