//! Shadows where nothing can stand in the way of a light.

use scene::Bounds;

use super::unreached::toward_light;
use super::{Ledger, Pass, gap, parted};
use crate::world::{LoadedLight, MediumId, Node, Part, Step, World};

pub(super) static PASS: Pass = Pass {
    name: "unstopped",
    what: "lights that cast shadows",
    reason: "no solid stands between another and the light",
};

/// More solids than this are not looked at in pairs.
const MOST: usize = 64;

/// Lets lights shine without asking what stands in their way where nothing can.
pub(in crate::world) fn stop_shadows(ledger: &mut Ledger, world: &mut World) {
    let nodes: Option<Vec<Node>> =
        world.whole.parts.iter().map(|part| plain(world, part)).collect();
    let (mut seen, mut taken) = (0, 0);
    for light in world.lights.iter_mut().filter(|light| light.shadows) {
        seen += 1;
        if nodes.as_ref().is_some_and(|nodes| nodes.len() <= MOST && is_free(light, nodes)) {
            taken += 1;
            light.shadows = ledger.keeps(&PASS);
        }
    }
    ledger.note(&PASS, seen, taken);
}

/// A part that never stands in its own light: a convex opaque primitive.
fn plain(world: &World, part: &Part) -> Option<Node> {
    let node = world.node(part.node);
    let Step::Leaf(leaf) = node.step else { return None };
    let convex = world.leaves[leaf as usize].is_convex();
    (convex && part.medium == MediumId::OPAQUE).then_some(*node)
}

/// True if no solid comes near the way from another to the light.
fn is_free(light: &LoadedLight, nodes: &[Node]) -> bool {
    let is_way_clear = |from: usize| {
        let way: Bounds = toward_light(&nodes[from].bounds(), light);
        nodes.iter().enumerate().all(|(other, node)| {
            let magnitude = nodes[from].magnitude;
            other == from || parted(&node.bounds(), &way, gap(node.magnitude, magnitude))
        })
    };
    (0..nodes.len()).all(is_way_clear)
}
