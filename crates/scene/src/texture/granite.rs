//! Grains of many shades, and finer grains over them, on a ground of one half.

use super::lattice::{ball, sites};
use super::whole;
use super::{Domain, Function, Parameter, Range};

pub(super) const FUNCTION: Function = Function {
    keyword: "granite",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 4.0, range: Range::Above(0.0) },
        Parameter { name: "octaves", default: 3.0, range: Range::Whole(1, 16) },
    ],
    weight: |arguments, p| {
        let mut scale = arguments[0];
        let mut shade = 0.5;
        for octave in 0..whole(arguments[1]) {
            // Moved by whole cells: octaves do not share their grains.
            for site in sites(p * scale + f64::from(octave) * 17.0) {
                shade += ball(site.distance, 0.5, 0.3) * (site.share - shade);
            }
            scale *= 2.0;
        }
        shade
    },
};
