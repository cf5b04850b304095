//! Intersections whose operands share no space.

use scene::Bounds;

use super::{Ledger, Pass, gap};

pub(super) static PASS: Pass = Pass {
    name: "empty",
    what: "intersections",
    reason: "the boxes of their operands have nothing in common",
};

/// Whether an intersection can be left out. `common` is between the greatest of the low corners and the least of the
/// high ones, whichever is above.
pub(in crate::world) fn is_empty(ledger: &mut Ledger, common: &Bounds, magnitude: f64) -> bool {
    let empty = (common.low - common.high).max_element() > gap(magnitude, magnitude);
    ledger.note(&PASS, 1, usize::from(empty));
    empty && !ledger.keeps(&PASS)
}
