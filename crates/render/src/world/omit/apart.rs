//! What is taken away where there is nothing to take it from.

use scene::Bounds;

use super::{Ledger, Pass, gap, parted};
use crate::world::Node;

pub(super) static PASS: Pass = Pass {
    name: "apart",
    what: "subtrahends",
    reason: "their boxes do not touch what they are taken from",
};

/// Whether a subtrahend can be left out of an intersection whose other operands share the box `common`.
pub(in crate::world) fn is_apart(
    ledger: &mut Ledger,
    subtrahend: &Node,
    common: &Bounds,
    magnitude: f64,
) -> bool {
    let apart = parted(&subtrahend.bounds(), common, gap(subtrahend.magnitude, magnitude));
    ledger.note(&PASS, 1, usize::from(apart));
    apart && !ledger.keeps(&PASS)
}
