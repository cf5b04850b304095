//! The expression of what a beam of rays can meet, as a list in which operators stand before their operands, with
//! complements taken down to the solids. It gets shorter with the beam (Keeter, "Massively Parallel Rendering of Complex
//! Closed-Form Implicit Surfaces", 2020).

use std::collections::HashMap;

use scene::Bounds;

use super::outline::Outline;
use super::sheet::{Cell, Sheet};
use crate::world::chain::Operator;
use crate::world::hierarchy::Hierarchy;
use crate::world::region::Beam;
use crate::world::{LeafId, Node, NodeId, Step, World};

/// An entry of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Entry {
    /// A solid by its number, or all space but the solid. If all rays of the beam are known to go through it, those of a
    /// part of it need not be asked.
    Solid { solid: u32, complemented: bool, crossed: bool },
    /// The union of operands, or their intersection.
    Join { union: bool, length: u32 },
}

/// What comes of a part of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Nowhere.
    Nothing,
    /// All space.
    Everything,
    /// The last entries of the list.
    Entries,
}

/// A solid of the expression.
#[derive(Debug)]
pub(crate) struct Member {
    /// None for what is known by its box alone: shared classes, and expressions of many turns.
    pub(crate) leaf: Option<LeafId>,
    pub(crate) outline: Outline,
}

/// Lists of one tile, the shorter ones of its parts behind the longer ones of the whole.
#[derive(Debug, Default)]
pub(crate) struct Expression {
    pub(crate) entries: Vec<Entry>,
    pub(crate) members: Vec<Member>,
    /// Least and greatest depth of each member: often all that is asked.
    pub(crate) depths: Vec<[f64; 2]>,
    numbers: HashMap<LeafId, u32>,
}

/// More solids in a tile are not sorted out.
pub(crate) const MOST: usize = 4096;
/// Deeper expressions are known by their boxes alone.
const DEEPEST: u32 = 64;
/// Longer chains, as well.
const LONGEST: usize = 24;

/// What an expression is made for.
pub(crate) struct Scope<'a> {
    pub(crate) world: &'a World,
    pub(crate) sheet: &'a Sheet,
    pub(crate) beam: &'a Beam,
    /// Points are asked for up to so far off the rays.
    pub(crate) slack: f64,
}

impl Scope<'_> {
    fn meets(&self, bounds: &Bounds) -> bool {
        !self.beam.misses(bounds, self.slack)
    }

    /// Items of a tree that the beam meets, in order.
    fn met(&self, tree: &Hierarchy) -> Vec<u32> {
        let cut = tree.cut_down(|bounds| self.meets(bounds), usize::MAX);
        let mut items = cut.map(|(_, items)| items).unwrap_or_default();
        items.sort_unstable();
        items
    }
}

impl Expression {
    /// The union of solids as a list that replaces what was there; of no use if it has more than [`MOST`] members.
    pub(crate) fn fill(&mut self, scope: &Scope<'_>, roots: impl Iterator<Item = NodeId>) -> Kept {
        self.entries.clear();
        self.members.clear();
        self.depths.clear();
        self.numbers.clear();
        let mut group = Group::open(&mut self.entries, true);
        for root in roots {
            let kept = self.node(scope, root, false, 0);
            if !group.take(&mut self.entries, kept) {
                break;
            }
        }
        group.close(&mut self.entries)
    }

    fn node(&mut self, scope: &Scope<'_>, node: NodeId, complemented: bool, depth: u32) -> Kept {
        let world = scope.world;
        let whole = world.node(node);
        let nothing = if complemented { Kept::Everything } else { Kept::Nothing };
        // With more than can be sorted out, the list is of no use.
        if self.members.len() > MOST || !scope.meets(&whole.bounds()) {
            return nothing;
        }
        if depth >= DEEPEST {
            return self.boxed(scope, whole, complemented);
        }
        match whole.step {
            Step::Leaf(leaf) => {
                let next = u32::try_from(self.members.len()).expect("fewer than leaves");
                let solid = *self.numbers.entry(leaf).or_insert(next);
                if solid == next {
                    let outline = Outline::of_leaf(
                        scope.sheet,
                        &world.leaves[leaf as usize],
                        &whole.bounds(),
                    );
                    self.depths.push(outline.depth);
                    self.members.push(Member { leaf: Some(leaf), outline });
                }
                self.entries.push(Entry::Solid { solid, complemented, crossed: false });
                Kept::Entries
            }
            Step::Instance(_) => self.boxed(scope, whole, complemented),
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let mut group = Group::open(&mut self.entries, !complemented);
                let met = hierarchy.map(|tree| scope.met(&world.hierarchies[tree as usize]));
                let mut take = |item: usize| {
                    let kept = self.node(scope, children[item].node, complemented, depth + 1);
                    group.take(&mut self.entries, kept)
                };
                match met {
                    Some(met) => met.into_iter().all(|item| take(item as usize)),
                    None => (0..children.len()).all(take),
                };
                group.close(&mut self.entries)
            }
            Step::And { first, count } => {
                let mut group = Group::open(&mut self.entries, complemented);
                for child in world.children(first, count) {
                    let turned = child.complemented != complemented;
                    let kept = self.node(scope, child.node, turned, depth + 1);
                    if !group.take(&mut self.entries, kept) {
                        break;
                    }
                }
                group.close(&mut self.entries)
            }
            Step::Chain(number) => {
                let chain = &world.chains[number as usize];
                let mut met = Vec::new();
                let local = |tree: &Hierarchy, take: &mut dyn FnMut(u32)| {
                    for item in scope.met(tree) {
                        take(item);
                    }
                };
                chain.deciding(&mut met, local, |node| scope.meets(&world.node(node).bounds()));
                if met.len() > LONGEST {
                    return self.boxed(scope, whole, complemented);
                }
                self.links(scope, &mut met, number, complemented, depth + 1)
            }
        }
    }

    /// A chain of the links in `met`: the last joined to all before it.
    fn links(
        &mut self,
        scope: &Scope<'_>,
        met: &mut Vec<u32>,
        number: u32,
        complemented: bool,
        depth: u32,
    ) -> Kept {
        let nothing = if complemented { Kept::Everything } else { Kept::Nothing };
        let Some(last) = met.pop() else { return nothing };
        let link = scope.world.chains[number as usize].links[last as usize];
        let mut group =
            Group::open(&mut self.entries, (link.operator == Operator::Add) != complemented);
        let before = self.links(scope, met, number, complemented, depth + 1);
        if group.take(&mut self.entries, before) {
            let cut = link.operator == Operator::Cut;
            let kept = self.node(scope, link.node, cut != complemented, depth + 1);
            group.take(&mut self.entries, kept);
        }
        group.close(&mut self.entries)
    }

    fn boxed(&mut self, scope: &Scope<'_>, node: &Node, complemented: bool) -> Kept {
        let solid = u32::try_from(self.members.len()).expect("fewer than nodes");
        let outline = Outline::of_box(scope.sheet, &node.bounds(), node.magnitude);
        self.depths.push(outline.depth);
        self.members.push(Member { leaf: None, outline });
        self.entries.push(Entry::Solid { solid, complemented, crossed: false });
        Kept::Entries
    }

    /// Appends what is left of the list at `at` without the solids that no ray of the cell meets at or before `cover`.
    pub(crate) fn prune(&mut self, at: usize, cell: &Cell, cover: f64) -> Kept {
        match self.entries[at] {
            Entry::Solid { solid, complemented, crossed } => {
                let number = solid as usize;
                let misses = || !crossed && self.members[number].outline.is_missed(cell);
                if self.depths[number][0] > cover || misses() {
                    return if complemented { Kept::Everything } else { Kept::Nothing };
                }
                self.entries.push(Entry::Solid { solid, complemented, crossed });
                Kept::Entries
            }
            Entry::Join { union, length } => {
                let end = at + length as usize;
                let mut group = Group::open(&mut self.entries, union);
                let mut operand = at + 1;
                while operand < end {
                    let next = operand + self.length(operand);
                    let kept = self.prune(operand, cell, cover);
                    if !group.take(&mut self.entries, kept) {
                        break;
                    }
                    operand = next;
                }
                group.close(&mut self.entries)
            }
        }
    }

    /// The numbers of the solids of the last list, which begins at `start`.
    pub(crate) fn solids(&self, start: usize) -> impl Iterator<Item = u32> + '_ {
        self.entries[start..].iter().filter_map(|entry| match *entry {
            Entry::Solid { solid, .. } => Some(solid),
            Entry::Join { .. } => None,
        })
    }

    /// Entries of the operand at a place.
    pub(crate) fn length(&self, at: usize) -> usize {
        match self.entries[at] {
            Entry::Solid { .. } => 1,
            Entry::Join { length, .. } => length as usize,
        }
    }
}

/// An operator whose operands are being appended.
struct Group {
    start: usize,
    union: bool,
    count: usize,
    /// An operand decided alone.
    whole: Option<Kept>,
}

impl Group {
    fn open(entries: &mut Vec<Entry>, union: bool) -> Self {
        let start = entries.len();
        entries.push(Entry::Join { union, length: 0 });
        Self { start, union, count: 0, whole: None }
    }

    /// Takes an operand in; false if the others make no difference.
    fn take(&mut self, entries: &mut Vec<Entry>, kept: Kept) -> bool {
        let decides = if self.union { Kept::Everything } else { Kept::Nothing };
        if kept == decides {
            entries.truncate(self.start + 1);
            self.whole = Some(kept);
            return false;
        }
        self.count += usize::from(kept == Kept::Entries);
        true
    }

    fn close(self, entries: &mut Vec<Entry>) -> Kept {
        match (self.whole, self.count) {
            (Some(kept), _) => {
                entries.truncate(self.start);
                kept
            }
            (None, 0) => {
                entries.truncate(self.start);
                if self.union { Kept::Nothing } else { Kept::Everything }
            }
            (None, 1) => {
                entries.remove(self.start);
                Kept::Entries
            }
            (None, _) => {
                let length = u32::try_from(entries.len() - self.start).expect("fewer than nodes");
                entries[self.start] = Entry::Join { union: self.union, length };
                Kept::Entries
            }
        }
    }
}
