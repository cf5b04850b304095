//! Parts of one clear medium that fill nearly the same space, one after the other in the source, are sought as one.
//!
//! A ray inside of a thousand balls of glass whose radii differ by a rounding leaves them one by one: each is a boundary at
//! which nothing changes, that takes as long to find out about as there are balls. As one part they are left where the
//! last of them ends. Parts that other media stand between stay apart, as [`super::parts`] says; opaque ones need no
//! such care, since the first of them ends a ray.

use scene::Bounds;

use super::build::{Builder, Operand};
use super::{MediumId, Part};

/// No fewer parts make a pile: a few are found out about as quickly one by one.
const FEWEST: usize = 8;
/// Boxes whose corners differ by at most this share of the larger one fill nearly the same space.
const ALIKE: f64 = 0.125;

/// Joins piles among the parts of a scene.
pub(super) fn join_piles(builder: &mut Builder, parts: &mut Vec<Part>) {
    let mut joined = Vec::with_capacity(parts.len());
    let mut rest = parts.as_slice();
    while let Some(first) = rest.first() {
        let bounds = builder.nodes[first.node as usize].bounds();
        let same = |part: &&Part| {
            part.medium == first.medium
                && are_alike(&bounds, &builder.nodes[part.node as usize].bounds())
        };
        let clear = first.medium != MediumId::OPAQUE && first.medium != MediumId::AIR;
        // Not even itself has a box like that of what is boundless, or holds nothing.
        let count = if clear { 1 + rest[1..].iter().take_while(same).count() } else { 1 };
        let (pile, later) = rest.split_at(count);
        rest = later;
        if count < FEWEST {
            joined.extend_from_slice(pile);
            continue;
        }
        let union = builder.union(pile.iter().map(|part| Operand::Node(part.node)));
        let node = builder.finish(union);
        joined.extend(node.map(|node| Part { node, medium: first.medium }));
    }
    *parts = joined;
}

fn are_alike(a: &Bounds, b: &Bounds) -> bool {
    let most = ALIKE * (a.high - a.low).max(b.high - b.low);
    (a.low - b.low).abs().cmple(most).all() && (a.high - b.high).abs().cmple(most).all()
}

#[cfg(all(test, feature = "command"))]
mod tests;
