//! Objects that stand where an equal one stands.

use scene::{Bounds, Object, Solid};

/// Objects that are compared, the first of the scene: more take time that nothing is said for.
const COMPARED: usize = 1 << 17;

/// Each object with an earlier one of the same shape in the same place, and that one.
pub(super) fn duplicates(objects: &[Object], bounds: &[Bounds]) -> Vec<(usize, usize)> {
    let mut keys: Vec<(u64, usize)> = bounds
        .iter()
        .take(COMPARED)
        .enumerate()
        .filter(|(_, bounds)| !bounds.is_empty())
        .map(|(object, bounds)| (key(bounds), object))
        .collect();
    keys.sort_unstable();
    let mut found = Vec::new();
    // Of equal objects the first has the least index.
    for run in keys.chunk_by(|a, b| a.0 == b.0) {
        let first = run[0].1;
        let same = |&&(_, object): &&(u64, usize)| {
            same_shape(&objects[first].solid, &objects[object].solid)
        };
        found.extend(run[1..].iter().filter(same).map(|&(_, object)| (object, first)));
    }
    found.sort_unstable();
    found
}

/// A number that equal boxes share; few others do.
fn key(bounds: &Bounds) -> u64 {
    let corners = bounds.low.to_array().into_iter().chain(bounds.high.to_array());
    corners.fold(0, |key: u64, coordinate| {
        // −0 is 0.
        let bits = (coordinate + 0.0).to_bits();
        (key.rotate_left(23) ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

/// The same expression of the same solids in the same places, whatever they look like.
fn same_shape(a: &Solid, b: &Solid) -> bool {
    let places = |solid: &Solid| {
        let frames = solid.frames.iter().map(|frame| (frame.parent, frame.placement));
        frames.collect::<Vec<_>>()
    };
    a.nodes == b.nodes && a.forms == b.forms && places(a) == places(b)
}
