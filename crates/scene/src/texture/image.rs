//! A picture over the surface, `u` by `v` times.

use glam::DVec2;

use super::parameter::whole;
use super::site::{MAPPINGS, mapped};
use super::{Domain, Edge, Function, Parameter, Placed, Range, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "image",
    domain: Domain::Surface,
    parameters: &[
        Parameter { name: "mapping", default: 0.0, range: Range::Word(MAPPINGS) },
        Parameter { name: "u", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "v", default: 1.0, range: Range::Above(0.0) },
    ],
    weight: Weight::Picture(|arguments, site| {
        let mapped = mapped(whole(arguments[0]), site);
        let times = DVec2::new(arguments[1], arguments[2]);
        let [u, v] = mapped.bounded;
        let edge = |bounded, times| if bounded { Edge::Held(times) } else { Edge::Tiled };
        Some(Placed {
            place: mapped.uv * times,
            edges: [edge(u && !mapped.closed, times.x), edge(v, times.y)],
            period: if mapped.closed { times.x } else { f64::INFINITY },
        })
    }),
};
