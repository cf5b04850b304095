//! What all rays of a cell see first, if it can be proved to be one surface, or nothing.
//!
//! The expression is asked in ranges of depth: how far ahead all rays are surely outside of it, or surely inside. These two
//! questions are dual to each other as those of the tracer are, but a solid is surely outside only before the first ray of
//! the cell enters it. If all rays stay outside up to where one solid begins to be entered (or left, where it is cut
//! away), they do so to the end of that range but for this solid, and are inside behind its surface all over the
//! range, then that surface is what all of them see.

use scene::Face;

use super::band::{Band, Rays};
use super::expression::{Entry, Expression, Kept};
use super::sheet::{Cell, Sheet};
use crate::world::{LeafId, World};

/// A face of a solid, seen from outside or, where the solid is cut away, from inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Surface {
    pub(crate) leaf: LeafId,
    pub(crate) face: Face,
    pub(crate) from_inside: bool,
}

/// What the rays of a cell see first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Background,
    Surface(Surface),
    /// Cells within this one may be proved.
    Undecided,
    /// A solid without proofs stands in front: no cell within this one is likely to be proved.
    Hopeless,
}

/// What verdicts are of.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub(crate) world: &'a World,
    pub(crate) sheet: &'a Sheet,
    pub(crate) list: &'a Expression,
}

/// The bands of those solids of a cell that have been asked for theirs.
#[derive(Debug, Default)]
pub(crate) struct Bands {
    bands: Vec<Band>,
    /// Numbers of the solids that have one.
    known: Vec<u32>,
    /// For each solid, the latest cell in which it has a band.
    latest: Vec<u32>,
    number: u32,
    cell: Option<(Cell, Rays)>,
}

impl Bands {
    /// Begins with the solids of another tile.
    pub(crate) fn start(&mut self, count: usize) {
        self.bands.clear();
        self.bands.resize(count, Band::MISSED);
        self.latest.clear();
        self.latest.resize(count, 0);
        self.number = 0;
    }

    /// Begins with another cell.
    pub(crate) fn enter(&mut self, sheet: &Sheet, cell: &Cell) {
        self.number += 1;
        self.known.clear();
        self.cell = Some((*cell, Rays::new(sheet, cell)));
    }

    /// The numbers of the solids that have been asked for.
    pub(crate) fn solids(&self) -> &[u32] {
        &self.known
    }

    /// If all rays are known to go through a solid.
    pub(crate) fn is_crossed(&self, solid: u32) -> bool {
        self.is_known(solid) && self.bands[solid as usize].crossed
    }

    /// Tells the entries of a list which solids all rays go through.
    pub(crate) fn note_crossed(&self, entries: &mut [Entry]) {
        for entry in entries {
            if let Entry::Solid { solid, crossed, .. } = entry {
                *crossed |= self.is_crossed(*solid);
            }
        }
    }

    fn is_known(&self, solid: u32) -> bool {
        self.latest[solid as usize] == self.number
    }

    fn band(&mut self, look: &Look<'_>, solid: u32) -> Band {
        let number = solid as usize;
        if !self.is_known(solid) {
            self.latest[number] = self.number;
            self.known.push(solid);
            let member = &look.list.members[number];
            self.bands[number] = match (member.leaf, &self.cell) {
                (Some(leaf), Some((cell, rays))) => {
                    let leaf = &look.world.leaves[leaf as usize];
                    Band::new(look.sheet, cell, rays, leaf, &member.outline)
                }
                _ => Band::unknown(member.outline.depth),
            };
        }
        self.bands[number]
    }

    /// How far from `from` on all rays stay inside of what stands at `at`, or outside; `from` itself if that is not
    /// known. What lies beyond `limit` need not be told apart.
    fn reach(&mut self, look: &Look<'_>, at: usize, inside: bool, from: f64, limit: f64) -> f64 {
        match look.list.entries[at] {
            Entry::Solid { solid, complemented, .. } => {
                let within = inside != complemented;
                if !self.is_known(solid) {
                    let [near, far] = look.list.depths[solid as usize];
                    if from >= far {
                        return if within { from } else { f64::INFINITY };
                    }
                    if from < near && (within || near >= limit) {
                        return if within { from } else { near };
                    }
                }
                let Band { enters, leaves, .. } = self.band(look, solid);
                if within {
                    if enters[1] <= from && from < leaves[0] { leaves[0] } else { from }
                } else if from < enters[0] {
                    enters[0]
                } else if from >= leaves[1] {
                    f64::INFINITY
                } else {
                    from
                }
            }
            Entry::Join { union, length } if union == inside => {
                // As far as one after the other takes them.
                let end = at + length as usize;
                let mut to = from;
                loop {
                    let before = to;
                    let mut operand = at + 1;
                    while operand < end && to < limit {
                        to = self.reach(look, operand, inside, to, limit);
                        operand += look.list.length(operand);
                    }
                    if to <= before || to >= limit {
                        return to;
                    }
                }
            }
            Entry::Join { length, .. } => {
                let end = at + length as usize;
                let (mut least, mut operand) = (f64::INFINITY, at + 1);
                while operand < end && least > from {
                    let limit = if least < limit { least } else { limit };
                    let reach = self.reach(look, operand, inside, from, limit);
                    least = if reach < least { reach } else { least };
                    operand += look.list.length(operand);
                }
                least
            }
        }
    }

    /// The least depth from `from` on at which all rays are known to be inside of what stands at `at`, or outside;
    /// infinity beyond `limit`.
    fn surely(&mut self, look: &Look<'_>, at: usize, inside: bool, from: f64, limit: f64) -> f64 {
        match look.list.entries[at] {
            Entry::Solid { solid, complemented, .. } => {
                let within = inside != complemented;
                let [near, far] = look.list.depths[solid as usize];
                if from < near || from >= far {
                    if !within {
                        return from;
                    }
                    if from >= far || near >= limit {
                        return f64::INFINITY;
                    }
                }
                let Band { enters, leaves, .. } = self.band(look, solid);
                if within {
                    let first = if enters[1] > from { enters[1] } else { from };
                    if first < leaves[0] { first } else { f64::INFINITY }
                } else if from < enters[0] || from >= leaves[1] {
                    from
                } else {
                    leaves[1]
                }
            }
            Entry::Join { union, length } if union == inside => {
                let end = at + length as usize;
                let (mut least, mut operand) = (f64::INFINITY, at + 1);
                while operand < end {
                    let limit = if least < limit { least } else { limit };
                    let first = self.surely(look, operand, inside, from, limit);
                    least = if first < least { first } else { least };
                    operand += look.list.length(operand);
                }
                least
            }
            Entry::Join { length, .. } => {
                let end = at + length as usize;
                let mut to = from;
                loop {
                    let before = to;
                    let mut operand = at + 1;
                    while operand < end && to < limit {
                        to = self.surely(look, operand, inside, to, limit);
                        operand += look.list.length(operand);
                    }
                    if to >= limit {
                        return f64::INFINITY;
                    }
                    if to <= before {
                        return to;
                    }
                }
            }
        }
    }

    /// A depth at or before which all rays have met something, or infinity beyond `limit`.
    pub(crate) fn cover(&mut self, look: &Look<'_>, at: usize, limit: f64) -> f64 {
        self.surely(look, at, true, 0.0, limit)
    }

    /// What is seen of the list at `at`.
    pub(crate) fn verdict(&mut self, look: &Look<'_>, at: usize) -> Verdict {
        let first = self.reach(look, at, false, 0.0, f64::INFINITY);
        if first >= f64::INFINITY {
            return Verdict::Background;
        }
        let mut found = Verdict::Hopeless;
        for k in 0..self.known.len() {
            let solid = self.known[k];
            let band = self.bands[solid as usize];
            // What is not reached cannot be what ended the reach.
            let starts = |depth: f64| depth.to_bits() == first.to_bits();
            let member = &look.list.members[solid as usize];
            let is_entered = starts(band.enters[0]);
            if !is_entered && !starts(band.leaves[0]) {
                continue;
            }
            let Some(leaf) = member.leaf.filter(|_| band.crossed || member.outline.is_provable())
            else {
                continue;
            };
            found = Verdict::Undecided;
            let (face, range) =
                if is_entered { (band.front, band.enters) } else { (band.back, band.leaves) };
            let Some(face) = face.filter(|_| band.crossed && range[1] < f64::INFINITY) else {
                continue;
            };
            if self.is_first(look, at, solid, is_entered, range) {
                return Verdict::Surface(Surface { leaf, face, from_inside: !is_entered });
            }
        }
        found
    }

    /// True if nothing but the surface of `solid` within `range` can be what rays see first, and all of them see it.
    fn is_first(
        &mut self,
        look: &Look<'_>,
        at: usize,
        solid: u32,
        is_entered: bool,
        [low, high]: [f64; 2],
    ) -> bool {
        let own = self.bands[solid as usize];
        let never = [f64::INFINITY; 2];
        let (before, behind) = if is_entered {
            // Whoever has just entered is inside, however thin the solid.
            (Band::MISSED, Band { enters: [f64::NEG_INFINITY; 2], leaves: never, ..own })
        } else {
            (Band { leaves: never, ..own }, Band::MISSED)
        };
        self.bands[solid as usize] = before;
        let alone = self.reach(look, at, false, 0.0, high) >= high;
        self.bands[solid as usize] = behind;
        let met = alone && self.reach(look, at, true, low, high) >= high;
        self.bands[solid as usize] = own;
        met
    }
}

/// A list that says nothing, or everything.
pub(crate) fn of_nothing(kept: Kept) -> Option<Verdict> {
    match kept {
        Kept::Nothing => Some(Verdict::Background),
        Kept::Everything => Some(Verdict::Hopeless),
        Kept::Entries => None,
    }
}
