//! Terms of a union that stand twice in the same place: the first fills the space of all.
//!
//! Copies of a shared class may coincide although no term is written twice: in rows of rows, each a step from the last,
//! two of the inner ones stand in the same place, and the ways a ray can take double with each level. So the copies that
//! a class stands for are looked at some levels deep before it is kept.

use std::collections::{HashMap, HashSet};

use scene::Map;

use super::{Ledger, Pass};
use crate::world::build::Builder;
use crate::world::{Kind, Leaf, NodeId, Step};

pub(super) static PASS: Pass = Pass {
    name: "repeated",
    what: "terms of unions",
    reason: "an equal one stands in their place",
};

/// Coordinates as bits, 0 and −0 alike.
type Bits<const N: usize> = [u64; N];

fn bits<const N: usize>(values: [f64; N]) -> Bits<N> {
    values.map(|value| (value + 0.0).to_bits())
}

/// Everything of a leaf but its place and its rank: kind, arguments, surface, medium.
type Make = (&'static str, Vec<u64>, u32, u32);

fn make(leaf: &Leaf) -> Make {
    let (word, arguments) = match leaf.kind {
        Kind::Convex(kind) => (kind.keywords()[0], &[][..]),
        Kind::Form => (leaf.form().row().keyword, leaf.form().arguments()),
    };
    let arguments = arguments.iter().map(|argument| argument.to_bits()).collect();
    (word, arguments, leaf.surface, leaf.medium.0)
}

/// Terms of a union by the boxes they fill.
#[derive(Debug, Default)]
pub(in crate::world) struct Twins {
    by_box: HashMap<Bits<6>, Vec<NodeId>>,
}

impl Twins {
    /// True if a term equal to `node` has been met; else this one is from now on.
    fn met(&mut self, builder: &Builder, node: NodeId) -> bool {
        let bounds = builder.nodes[node as usize].bounds();
        let ([a, b, c], [d, e, f]) = (bounds.low.to_array(), bounds.high.to_array());
        let met = self.by_box.entry(bits([a, b, c, d, e, f])).or_default();
        if met.iter().any(|&other| same(builder, node, other)) {
            return true;
        }
        met.push(node);
        false
    }

    /// Which of `terms` can be left out.
    pub(in crate::world) fn among(
        builder: &Builder,
        ledger: &mut Ledger,
        terms: impl ExactSizeIterator<Item = NodeId>,
    ) -> Vec<bool> {
        let mut twins = Self::default();
        let mut found: Vec<bool> = terms.map(|node| twins.met(builder, node)).collect();
        ledger.note(&PASS, found.len(), found.iter().filter(|&&twin| twin).count());
        if ledger.keeps(&PASS) {
            found.fill(false);
        }
        found
    }
}

/// True if two terms fill the same space with the same stuff, unpainted.
fn same(builder: &Builder, a: NodeId, b: NodeId) -> bool {
    let step = |node: NodeId| builder.nodes[node as usize].step;
    match (step(a), step(b)) {
        (Step::Leaf(a), Step::Leaf(b)) => {
            let (a, b) = (&builder.leaves[a as usize], &builder.leaves[b as usize]);
            a.paint.is_none() && b.paint.is_none() && a.place == b.place && make(a) == make(b)
        }
        (Step::Instance(a), Step::Instance(b)) => {
            let (a, b) = (&builder.instances[a as usize], &builder.instances[b as usize]);
            a.paint.is_none() && b.paint.is_none() && a.root == b.root && a.map == b.map
        }
        _ => false,
    }
}

/// Copies of a class are looked at until there are this many.
const MOST_COPIES: usize = 4096;

/// One of the solids that a union stands for, some levels of instances down.
#[derive(Clone, Debug)]
struct Copy {
    /// What stands there, in the space of the last instance on the way.
    node: NodeId,
    /// Numbers of the instances on the way, from outside.
    way: Vec<u32>,
    map: Map,
    is_painted: bool,
}

impl Copy {
    fn of(builder: &Builder, node: NodeId) -> Self {
        let copy = Self { node, way: Vec::new(), map: Map::IDENTITY, is_painted: false };
        copy.entered(builder)
    }

    /// Inside of the instance that it is, if it is one.
    fn entered(mut self, builder: &Builder) -> Self {
        while let Step::Instance(number) = builder.nodes[self.node as usize].step {
            let instance = &builder.instances[number as usize];
            self.map = self.map.then_inner(&instance.map);
            self.is_painted |= instance.paint.is_some();
            self.node = instance.root;
            self.way.push(number);
        }
        self
    }

    /// The terms of the union that it is; itself if it is none.
    fn opened(&self, builder: &Builder, into: &mut Vec<Self>) -> bool {
        let Step::Or { first, count, .. } = builder.nodes[self.node as usize].step else {
            into.push(self.clone());
            return false;
        };
        let terms = &builder.children[first as usize..first as usize + count as usize];
        into.extend(
            terms.iter().map(|term| Self { node: term.node, ..self.clone() }.entered(builder)),
        );
        true
    }

    /// Equal for copies that coincide; none for those that equal no other.
    fn key(&self, builder: &Builder) -> Option<(Result<NodeId, Make>, Bits<12>)> {
        let (map, make) = match builder.nodes[self.node as usize].step {
            Step::Leaf(leaf) => {
                let leaf = &builder.leaves[leaf as usize];
                if leaf.paint.is_some() {
                    return None;
                }
                (self.map.then_inner(&leaf.place.map()), Err(make(leaf)))
            }
            _ => (self.map, Ok(self.node)),
        };
        let columns = map.linear.to_cols_array();
        let mut values = [0.0; 12];
        values[..9].copy_from_slice(&columns);
        values[9..].copy_from_slice(&map.place.to_array());
        (!self.is_painted).then(|| (make, bits(values)))
    }

    /// Makes a node of it again, through the same instances: a ray that goes there finds the same numbers.
    fn close(&self, builder: &mut Builder) -> NodeId {
        self.way.iter().rev().fold(self.node, |root, &number| builder.entrance(number, root))
    }
}

/// The terms of a union of a shared class. If a quarter of the copies that they stand for, some levels deep, coincide
/// with others, the copies that are left take their place.
pub(in crate::world) fn coinciding(builder: &mut Builder, terms: Vec<NodeId>) -> Vec<NodeId> {
    let node = |&term: &NodeId| &builder.nodes[term as usize];
    let overlap = |(k, a): (usize, &NodeId)| {
        terms[..k].iter().any(|b| !node(a).bounds().overlap(node(b).bounds()).is_empty())
    };
    if builder.ledger.keeps(&PASS)
        || terms.len() > MOST_COPIES
        || terms.iter().any(|term| node(term).medium.is_none())
        || !terms.iter().enumerate().any(overlap)
    {
        return terms;
    }
    let mut copies: Vec<Copy> = terms.iter().map(|&term| Copy::of(builder, term)).collect();
    while copies.len() <= MOST_COPIES {
        let mut met = HashSet::new();
        let is_first: Vec<bool> =
            copies.iter().map(|copy| copy.key(builder).is_none_or(|key| met.insert(key))).collect();
        let left = is_first.iter().filter(|&&first| first).count();
        if 4 * left <= 3 * copies.len() {
            builder.ledger.note(&PASS, copies.len(), copies.len() - left);
            let kept = copies.iter().zip(is_first).filter(|(_, first)| *first);
            return kept.map(|(copy, _)| copy.close(builder)).collect();
        }
        let mut opened = Vec::new();
        let mut is_deeper = false;
        for copy in &copies {
            is_deeper |= copy.opened(builder, &mut opened);
        }
        if !is_deeper {
            break;
        }
        copies = opened;
    }
    terms
}
