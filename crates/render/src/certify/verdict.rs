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

/// The bands of the solids of a cell.
#[derive(Debug, Default)]
pub(crate) struct Bands {
    bands: Vec<Band>,
    /// Numbers of the solids that have one.
    known: Vec<u32>,
    /// For each solid, the latest cell in which it has a band.
    latest: Vec<u32>,
    cell: u32,
}

impl Bands {
    /// Begins with the solids of another tile.
    pub(crate) fn start(&mut self, count: usize) {
        self.bands.clear();
        self.bands.resize(count, Band::MISSED);
        self.latest.clear();
        self.latest.resize(count, 0);
        self.cell = 0;
    }

    /// Makes those of the list at `at`, and returns how many.
    pub(crate) fn fill(
        &mut self,
        world: &World,
        sheet: &Sheet,
        cell: &Cell,
        expression: &Expression,
        at: usize,
    ) -> usize {
        self.cell += 1;
        self.known.clear();
        let rays = Rays::new(sheet, cell);
        for entry in &expression.entries[at..] {
            let Entry::Solid { solid, .. } = *entry else { continue };
            let number = solid as usize;
            if self.latest[number] == self.cell {
                continue;
            }
            self.latest[number] = self.cell;
            self.known.push(solid);
            let member = &expression.members[number];
            self.bands[number] = match member.leaf {
                Some(leaf) => {
                    Band::new(sheet, cell, &rays, &world.leaves[leaf as usize], &member.outline)
                }
                None => Band::unknown(member.outline.depth),
            };
        }
        self.known.len()
    }

    /// A depth at or before which all rays have met something, or infinity.
    pub(crate) fn cover(&self, expression: &Expression, at: usize) -> f64 {
        self.surely(expression, at, true, 0.0)
    }

    /// The numbers of the solids of the cell.
    pub(crate) fn solids(&self) -> &[u32] {
        &self.known
    }

    /// If all rays go through a solid.
    pub(crate) fn is_crossed(&self, solid: u32) -> bool {
        self.bands[solid as usize].crossed
    }

    /// How far from `from` on all rays stay inside of what stands at `at`, or outside; `from` itself if that is not
    /// known.
    fn reach(&self, expression: &Expression, at: usize, inside: bool, from: f64) -> f64 {
        match expression.entries[at] {
            Entry::Solid { solid, complemented } => {
                let Band { enters, leaves, .. } = &self.bands[solid as usize];
                if inside != complemented {
                    if enters[1] <= from && from < leaves[0] { leaves[0] } else { from }
                } else if from < enters[0] {
                    enters[0]
                } else if from >= leaves[1] {
                    f64::INFINITY
                } else {
                    from
                }
            }
            Entry::Join { union, length } => {
                let end = at + length as usize;
                let any = union == inside;
                let (mut to, mut least) = (from, f64::INFINITY);
                loop {
                    let before = to;
                    let mut operand = at + 1;
                    while operand < end {
                        let reach = self.reach(expression, operand, inside, to);
                        if any {
                            to = reach;
                        } else if reach < least {
                            least = reach;
                            if least <= from {
                                return from;
                            }
                        }
                        operand += expression.length(operand);
                    }
                    if !any {
                        return least;
                    }
                    if to <= before || to >= f64::INFINITY {
                        return to;
                    }
                }
            }
        }
    }

    /// The least depth from `from` on at which all rays are known to be inside of what stands at `at`, or outside.
    fn surely(&self, expression: &Expression, at: usize, inside: bool, from: f64) -> f64 {
        match expression.entries[at] {
            Entry::Solid { solid, complemented } => {
                let Band { enters, leaves, .. } = &self.bands[solid as usize];
                if inside != complemented {
                    let first = if enters[1] > from { enters[1] } else { from };
                    if first < leaves[0] { first } else { f64::INFINITY }
                } else if from < enters[0] || from >= leaves[1] {
                    from
                } else {
                    leaves[1]
                }
            }
            Entry::Join { union, length } => {
                let end = at + length as usize;
                if union == inside {
                    let mut least = f64::INFINITY;
                    let mut operand = at + 1;
                    while operand < end {
                        let first = self.surely(expression, operand, inside, from);
                        least = if first < least { first } else { least };
                        operand += expression.length(operand);
                    }
                    return least;
                }
                let mut to = from;
                loop {
                    let before = to;
                    let mut operand = at + 1;
                    while operand < end && to < f64::INFINITY {
                        to = self.surely(expression, operand, inside, to);
                        operand += expression.length(operand);
                    }
                    if to <= before || to >= f64::INFINITY {
                        return to;
                    }
                }
            }
        }
    }

    /// What is seen of the list at `at`.
    pub(crate) fn verdict(&mut self, expression: &Expression, at: usize) -> Verdict {
        let first = self.reach(expression, at, false, 0.0);
        if first >= f64::INFINITY {
            return Verdict::Background;
        }
        let mut found = Verdict::Hopeless;
        for k in 0..self.known.len() {
            let solid = self.known[k];
            let band = self.bands[solid as usize];
            // What is not reached cannot be what ended the reach.
            let starts = |depth: f64| depth <= first && depth >= first;
            let member = &expression.members[solid as usize];
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
            if self.is_first(expression, at, solid, is_entered, range) {
                return Verdict::Surface(Surface { leaf, face, from_inside: !is_entered });
            }
        }
        found
    }

    /// True if nothing but the surface of `solid` within `range` can be what rays see first, and all of them see it.
    fn is_first(
        &mut self,
        expression: &Expression,
        at: usize,
        solid: u32,
        is_entered: bool,
        [low, high]: [f64; 2],
    ) -> bool {
        let own = self.bands[solid as usize];
        let never = [f64::INFINITY; 2];
        let (before, behind) = if is_entered {
            (Band::MISSED, Band { enters: [f64::NEG_INFINITY; 2], ..own })
        } else {
            (Band { leaves: never, ..own }, Band::MISSED)
        };
        self.bands[solid as usize] = before;
        let alone = self.reach(expression, at, false, 0.0) >= high;
        self.bands[solid as usize] = behind;
        let met = alone && self.reach(expression, at, true, low) >= high;
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
