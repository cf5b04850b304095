//! What lies inside of an opaque body: no ray gets there.

use glam::DVec3;

use super::{Pass, gap};
use crate::world::build::Builder;
use crate::world::{MediumId, NodeId, Part, Step};

pub(super) static PASS: Pass = Pass {
    name: "inside",
    what: "solids of one medium",
    reason: "they lie wholly inside of an opaque primitive",
};

/// Only the largest bodies are looked into.
const MOST_BODIES: usize = 32;

/// Takes objects and parts inside of opaque primitives out of the lists. Rays start at the origin.
pub(in crate::world) fn leave_out_what_is_inside(
    builder: &mut Builder,
    objects: &mut Vec<NodeId>,
    parts: &mut Vec<Part>,
) {
    let seen = parts.len();
    let hidden = {
        let bodies = bodies(builder, parts);
        let hidden = |node: NodeId| bodies.iter().any(|&body| holds(builder, body, node));
        let hide = |nodes: &mut dyn Iterator<Item = NodeId>| nodes.map(hidden).collect::<Vec<_>>();
        (hide(&mut objects.iter().copied()), hide(&mut parts.iter().map(|part| part.node)))
    };
    let ledger = &mut builder.ledger;
    ledger.note(&PASS, seen, hidden.1.iter().filter(|&&hidden| hidden).count());
    if !ledger.keeps(&PASS) {
        let mut hidden = (hidden.0.into_iter(), hidden.1.into_iter());
        objects.retain(|_| hidden.0.next() == Some(false));
        parts.retain(|_| hidden.1.next() == Some(false));
    }
}

/// Opaque convex primitives that the eye is not in, the largest ones.
fn bodies(builder: &Builder, parts: &[Part]) -> Vec<NodeId> {
    let size = |node: NodeId| {
        let bounds = builder.nodes[node as usize].bounds();
        (bounds.high - bounds.low).min_element()
    };
    let is_body = |part: &&Part| {
        let node = &builder.nodes[part.node as usize];
        let Step::Leaf(leaf) = node.step else { return false };
        let leaf = &builder.leaves[leaf as usize];
        let beside = !node.box32.nears(DVec3::ZERO, gap(leaf.magnitude, 0.0));
        part.medium == MediumId::OPAQUE && leaf.is_convex() && beside
    };
    let mut bodies: Vec<NodeId> = parts.iter().filter(is_body).map(|part| part.node).collect();
    bodies.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    bodies.truncate(MOST_BODIES);
    bodies
}

/// True if a body holds the box of a solid, with room for rounding all around it.
fn holds(builder: &Builder, body: NodeId, node: NodeId) -> bool {
    let (outer, inner) = (&builder.nodes[body as usize], &builder.nodes[node as usize]);
    let Step::Leaf(leaf) = outer.step else { return false };
    let (within, around) = (inner.bounds(), outer.bounds());
    if !(around.contains(within.low) && around.contains(within.high)) {
        return false;
    }
    let leaf = &builder.leaves[leaf as usize];
    let box_and_room = within.widened(gap(outer.magnitude, inner.magnitude));
    box_and_room.corners().into_iter().all(|corner| leaf.contains(corner.to_array()))
}
