//! A picture at one place of the surface, once.

use glam::DVec2;

use super::lattice::split;
use super::parameter::whole;
use super::site::{MAPPINGS, mapped};
use super::{Domain, Edge, Function, Parameter, Placed, Range, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "decal",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "mapping", default: 0.0, range: Range::Word(MAPPINGS) },
        Parameter { name: "u", default: 0.5, range: Range::Any },
        Parameter { name: "v", default: 0.5, range: Range::Any },
        Parameter { name: "width", default: 0.5, range: Range::Above(0.0) },
        Parameter { name: "height", default: 0.5, range: Range::Above(0.0) },
    ],
    weight: Weight::Picture(|arguments, site| {
        let mapped = mapped(whole(arguments[0]), site);
        if !mapped.faces {
            return None;
        }
        let (mut away, size) = (
            mapped.uv - DVec2::new(arguments[1], arguments[2]),
            DVec2::new(arguments[3], arguments[4]),
        );
        if mapped.closed {
            // The shorter way round.
            away.x -= split(away.x + 0.5).0;
        }
        Some(Placed {
            place: away / size + 0.5,
            edges: [Edge::Once; 2],
            period: if mapped.closed { 1.0 / size.x } else { f64::INFINITY },
        })
    }),
};
