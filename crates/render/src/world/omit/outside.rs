//! Terms of a union outside of what it is intersected with: the box of an intersection is handed down to its operands.

use scene::Bounds;

use super::{Ledger, Pass, gap, parted};
use crate::world::Node;

pub(super) static PASS: Pass = Pass {
    name: "outside",
    what: "terms of unions in intersections",
    reason: "their boxes do not touch what the union is intersected with",
};

/// The places of those of `terms` that can be left out of a union intersected with something in the box `zone`.
pub(in crate::world) fn outside_terms<'n>(
    ledger: &mut Ledger,
    terms: impl ExactSizeIterator<Item = &'n Node>,
    zone: &Bounds,
    magnitude: f64,
) -> Vec<bool> {
    let seen = terms.len();
    let outside = |term: &Node| parted(&term.bounds(), zone, gap(term.magnitude, magnitude));
    let mut found: Vec<bool> = terms.map(outside).collect();
    ledger.note(&PASS, seen, found.iter().filter(|&&outside| outside).count());
    if ledger.keeps(&PASS) {
        found.fill(false);
    }
    found
}
