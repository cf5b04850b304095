//! Veins across x, stirred by turbulence.

use super::filter::wave_left;
use super::lattice::{CREASED, octaves, split};
use super::{Domain, Function, Parameter, Range, Spot, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "marble",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "stir", default: 5.0, range: Range::Above(-1.0) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let (p, width) = (p * arguments[0], width * arguments[0]);
        let (stirred, variance) = octaves(p, width, 6, &CREASED);
        let (_, turn) = split(p.x + 0.5 * arguments[1] * stirred);
        let angle = std::f64::consts::TAU * turn;
        let stir = std::f64::consts::PI * arguments[1];
        // What overflows meets no variance where nothing is left out.
        let jitter = if variance > 0.0 { stir * stir * variance } else { 0.0 };
        // Thin veins on a clear ground: (½ + ½ sin)³, by its multiples of the angle. A pixel takes in a part of each, and
        // what is left out of the octaves scatters the angle.
        let scattered = libm::exp(-0.5 * jitter);
        let left = |multiple: f64| wave_left(multiple * width.x);
        let (sine, cube) = (libm::sin(angle), scattered * scattered * scattered);
        let first = scattered * left(1.0) * sine;
        let second = cube * scattered * left(2.0) * (1.0 - 2.0 * sine * sine);
        let third = cube * cube * cube * left(3.0) * (3.0 - 4.0 * sine * sine) * sine;
        let sum = 0.3125 + 0.468_75 * first - 0.1875 * second - 0.031_25 * third;
        sum.clamp(0.0, 1.0)
    }),
};
