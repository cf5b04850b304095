//! Objects that no ray of a picture can meet.

use glam::DVec3;
use scene::{Bounds, Camera, Index, LightKind, Optics};

use super::{Pass, gap, parted};
use crate::world::build::Builder;
use crate::world::region::Beam;
use crate::world::{LoadedLight, Node, NodeId, Part};

pub(super) static PASS: Pass = Pass {
    name: "unreached",
    what: "objects",
    reason: "they are out of view, nothing mirrors or bends light, and they cast no shadow on what is seen",
};

/// Takes objects, and their parts, out of the lists that the picture of a camera of this size shows nothing of. Rays
/// start at `eye`: of those through a lens nothing is said. Rays that wander may meet anything.
pub(in crate::world) fn leave_out_what_is_unreached(
    builder: &mut Builder,
    (camera, size, eye): (&Camera, (u32, u32), DVec3),
    wanders: bool,
    lights: &[LoadedLight],
    objects: &mut Vec<NodeId>,
    parts: &mut Vec<Part>,
) {
    let seen = objects.len();
    let node = |node: NodeId| &builder.nodes[node as usize];
    let beam = beam(camera, size, eye);
    let is_seen = |node: &Node| !beam.misses(&node.bounds(), gap(node.magnitude, 0.0));
    let view = objects.iter().map(|&root| node(root)).filter(|root| is_seen(root));
    let (shown, magnitude) = view.fold((Bounds::EMPTY, 0.0), |(hull, most), node| {
        (hull.hull(node.bounds()), f64::max(most, node.magnitude))
    });
    let shadows = lights.iter().filter(|light| light.shadows);
    let ways: Vec<Bounds> = shadows.map(|light| toward_light(&shown, light)).collect();
    let is_met = |node: &Node| {
        let gap = gap(node.magnitude, magnitude);
        is_seen(node) || ways.iter().any(|way| !parted(way, &node.bounds(), gap))
    };
    let met: Vec<bool> = objects.iter().map(|&root| wanders || is_met(node(root))).collect();
    let taken = met.iter().filter(|&&met| !met).count();
    if !builder.ledger.keeps(&PASS) && taken > 0 {
        let mut met = met.into_iter();
        objects.retain(|_| met.next() == Some(true));
        parts.retain(|part| is_met(&builder.nodes[part.node as usize]));
    }
    builder.ledger.note(&PASS, seen, taken);
}

/// True if rays spring from a surface in other directions than those they came in: from a rough one where facets are
/// drawn.
pub(in crate::world) fn sends_rays_elsewhere(optics: &Optics, glossy: bool) -> bool {
    match optics.transparency {
        Some(body) => body.index != Index::Fake,
        None => optics.shininess > 0.0 && (glossy || optics.smoothness <= 0.0),
    }
}

/// All rays of the picture, and a margin for what looks beyond its rim.
fn beam(camera: &Camera, (columns, rows): (u32, u32), eye: DVec3) -> Beam {
    let view = camera.view(columns, rows);
    let margin = |side: u32| 1.25 + 16.0 / f64::from(side);
    let (x, y) = (margin(columns), margin(rows));
    let sights = [(-x, y), (x, y), (x, -y), (-x, -y)].map(|(x, y)| view.sight(x, y));
    if view.parallel {
        return Beam::parallel(sights.map(|sight| eye + sight.offset), view.forward);
    }
    Beam::new(eye, sights.map(|sight| sight.direction))
}

/// A box about all ways from points of a box to a light.
pub(super) fn toward_light(bounds: &Bounds, light: &LoadedLight) -> Bounds {
    let endless = |low: f64, high: f64, along: f64| {
        let low = if along > 0.0 { f64::NEG_INFINITY } else { low };
        (low, if along < 0.0 { f64::INFINITY } else { high })
    };
    match light.kind {
        LightKind::Point { at } | LightKind::Spot { at, .. } => {
            bounds.hull(Bounds { low: at - light.radius, high: at + light.radius })
        }
        LightKind::Beam { .. } if light.radius > 0.0 => {
            // Its rays run in many directions.
            Bounds { low: DVec3::NEG_INFINITY, high: DVec3::INFINITY }
        }
        LightKind::Beam { .. } => {
            let (low, high, axis) = (bounds.low, bounds.high, light.axis);
            let (x, y, z) = (
                endless(low.x, high.x, axis.x),
                endless(low.y, high.y, axis.y),
                endless(low.z, high.z, axis.z),
            );
            Bounds { low: DVec3::new(x.0, y.0, z.0), high: DVec3::new(x.1, y.1, z.1) }
        }
    }
}
