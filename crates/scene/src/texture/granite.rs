//! Grains of many shades, and finer grains over them, on a ground of one half.

use super::lattice::{CREASED_FINENESS, ball, left, sites};
use super::whole;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

/// Mean share of a place that grains of one octave cover.
const COVERED: f64 = 0.285;

pub(super) const FUNCTION: Function = Function {
    keyword: "granite",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "octaves", default: 3.0, range: Range::Whole(1, 16) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let mut scale = arguments[0];
        let mut shade = 0.5;
        for octave in 0..whole(arguments[1]) {
            // Moved by whole cells: octaves do not share their grains.
            let before = shade;
            let left = left(width * scale, CREASED_FINENESS);
            if left > 0.0 {
                for site in sites(p * scale + f64::from(octave) * 17.0) {
                    shade += ball(site.distance, 0.5, 0.3) * (site.share - shade);
                }
            }
            // Grains too fine to be seen are a mist of one half.
            let misted = before + COVERED * (0.5 - before);
            shade = misted + left * (shade - misted);
            scale *= 2.0;
        }
        shade
    }),
};
