//! Balls, one anywhere in every cube with edges of `1 / scale`.

use super::lattice::{CREASED_FINENESS, ball, left, sites};
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "spots",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 2.0, range: Range::Above(0.0) },
        Parameter { name: "radius", default: 0.4, range: Range::Within(0.0, 0.5) },
        Parameter { name: "soft", default: 0.2, range: Range::Within(0.0, 1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (radius, soft) = (arguments[1], arguments[2]);
        let mean = covered(radius, soft);
        let left = left(width * arguments[0], CREASED_FINENESS);
        if left <= 0.0 {
            return mean;
        }
        let weight = sites(p * arguments[0]).into_iter().fold(0.0, |most, site| {
            let weight = ball(site.distance, radius, soft);
            if weight > most { weight } else { most }
        });
        mean + left * (weight - mean)
    }),
};

/// Mean of the weight: balls anywhere in their cells reach into eight of them, and cover their volume but for what they
/// share.
fn covered(radius: f64, soft: f64) -> f64 {
    // The integral of a ball's weight over space; of its rim by the moments of the fade, 1/2, 5/14 and 23/84.
    let (core, rim) = (radius * (1.0 - soft), radius * soft);
    let square =
        radius * radius * 0.5 - 2.0 * radius * rim * (5.0 / 14.0) + rim * rim * (23.0 / 84.0);
    let volume = 4.0 * std::f64::consts::PI * (core * core * core / 3.0 + rim * square);
    let free = 1.0 - 0.125 * volume;
    let four = free * free * free * free;
    1.0 - four * four
}
