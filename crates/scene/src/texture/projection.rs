//! A picture thrown from a place, through the whole solid.

use glam::{DVec2, DVec3};

use super::{Domain, Edge, Function, Parameter, Placed, Range, Weight};
use crate::transform::{sin_cos_degrees, unit};

pub(super) const FUNCTION: Function = Function {
    keyword: "projection",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "at", default: 0.0, range: Range::Coordinate(0) },
        Parameter { name: "at", default: 0.0, range: Range::Coordinate(1) },
        Parameter { name: "at", default: 4.0, range: Range::Coordinate(2) },
        Parameter { name: "toward", default: 0.0, range: Range::Coordinate(0) },
        Parameter { name: "toward", default: 0.0, range: Range::Coordinate(1) },
        Parameter { name: "toward", default: 0.0, range: Range::Coordinate(2) },
        Parameter { name: "angle", default: 30.0, range: Range::Within(0.01, 170.0) },
    ],
    weight: Weight::Picture(|arguments, site| {
        let at = DVec3::new(arguments[0], arguments[1], arguments[2]);
        let toward = DVec3::new(arguments[3], arguments[4], arguments[5]);
        let way = toward - at;
        if !way.is_finite() || way == DVec3::ZERO {
            return None;
        }
        let forward = unit(way);
        // Upright; straight up and down its foot is at the front.
        let side = forward.cross(DVec3::Y);
        let right = if side == DVec3::ZERO { DVec3::X } else { unit(side) };
        let up = right.cross(forward);
        let away = site.point - at;
        let depth = away.dot(forward);
        if depth <= 0.0 {
            return None;
        }
        let (sine, cosine) = sin_cos_degrees(0.5 * arguments[6]);
        let half = depth * sine / cosine;
        let place = DVec2::new(away.dot(right) / half, away.dot(up) / (half * site.aspect));
        Some(Placed { place: 0.5 * (place + 1.0), edges: [Edge::Once; 2], period: f64::INFINITY })
    }),
};
