//! A tile divided into squares until each is proved, or too small, or would take longer to prove than to sample.

use super::expression::{Entry, Expression, Kept, MOST, Scope};
use super::sheet::{Cell, Sheet};
use super::verdict::{Bands, Look, Surface, Verdict, of_nothing};
use crate::film::Piece;
use crate::world::World;
use crate::world::region::{Beam, Region};

/// The smallest squares, in pixels.
pub(crate) const FINEST: f64 = 1.0 / 64.0;
/// More solids in a square of 8 pixels or less: most of it would have to be divided to the end.
const CROWD: usize = 40;
/// More solids in a pixel.
const CROWDED_PIXEL: usize = 16;
/// Solids that cover more than so many times the area of a square are not lost between samples of it.
const LARGE: f64 = 2.0;
/// Solids that cover less of the picture, in pixels, are looked for where they are.
const SMALL: f64 = 1.0;

/// Bands of solids that a tile may ask for before it is given up, and more for each pixel that is settled: beyond that,
/// samples of all pixels take less.
const FIRST_BANDS: usize = 256;
const BANDS_A_PIXEL: usize = 6;

/// What was proved of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Proof {
    /// All of it shows one surface, or the background.
    Whole(Option<Surface>),
    /// It is divided: so many parts, from this one on.
    Parts { first: u32, count: u32 },
    /// Nothing.
    Open {
        /// It was tried by itself, so pixels around it may be proved.
        alone: bool,
    },
}

/// A part of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) cell: Cell,
    /// What it shows, if that is proved.
    pub(crate) proved: Option<Option<Surface>>,
    /// A place where something small may be seen.
    pub(crate) witness: Option<[f64; 2]>,
}

/// A place where something smaller than a pixel may be seen, in a pixel of which nothing is proved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Witness {
    pub(crate) pixel: u32,
    pub(crate) place: [f64; 2],
    /// Of the pixel.
    pub(crate) share: f64,
}

/// What was proved of a tile.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    /// Row by row.
    pub(crate) proofs: Vec<Proof>,
    pub(crate) parts: Vec<Part>,
    /// In the order of their pixels.
    pub(crate) witnesses: Vec<Witness>,
    /// It has more solids than are sorted out, or what was left of it was not worth it.
    pub(crate) given_up: bool,
}

/// Proves tiles, one after the other; each thread has its own.
pub(crate) struct Prover<'w> {
    world: &'w World,
    sheet: &'w Sheet,
    expression: Expression,
    bands: Bands,
    piece: Piece,
    plan: Plan,
    /// Bands that the tile has asked for, and pixels that are settled.
    bands_asked: usize,
    settled: usize,
}

impl<'w> Prover<'w> {
    pub(crate) fn new(world: &'w World, sheet: &'w Sheet) -> Self {
        let piece = Piece { column: 0, row: 0, width: 0, height: 0 };
        let (expression, bands, plan) = (Expression::default(), Bands::default(), Plan::default());
        Self { world, sheet, expression, bands, piece, plan, bands_asked: 0, settled: 0 }
    }

    /// Proves what it can of a piece of the picture whose rays are in `beam` and meet nothing outside of `region`.
    pub(crate) fn tile(
        &mut self,
        piece: &Piece,
        beam: &Beam,
        region: &Region,
        slack: f64,
    ) -> &Plan {
        self.piece = *piece;
        self.plan.parts.clear();
        self.plan.witnesses.clear();
        self.plan.proofs.clear();
        self.plan.proofs.resize(piece.area(), Proof::Open { alone: false });
        let scope = Scope { world: self.world, sheet: self.sheet, beam, slack };
        let kept = self.expression.fill(&scope, region.parts.iter().map(|part| part.node));
        let members = self.expression.members.len();
        self.plan.given_up = members > MOST || kept == Kept::Everything;
        let side = f64::from(piece.width.max(piece.height).next_power_of_two());
        let half = 0.5 * side;
        let middle = [f64::from(piece.column) + half, f64::from(piece.row) + half];
        let cell = Cell { middle, half };
        self.bands.start(members);
        (self.bands_asked, self.settled) = (0, 0);
        match kept {
            _ if self.plan.given_up => {}
            Kept::Nothing => self.proved(&cell, None),
            _ => self.divide(&cell, 0, f64::INFINITY),
        }
        self.plan.witnesses.sort_by_key(|witness| witness.pixel);
        &self.plan
    }

    /// Proves a cell or its parts by the list at `at`; behind `cover` nothing is seen.
    fn divide(&mut self, cell: &Cell, at: usize, cover: f64) {
        let whole = cell.half >= 0.5;
        if whole && self.bands_asked > FIRST_BANDS + BANDS_A_PIXEL * self.settled {
            self.plan.given_up = true;
            return self.open(cell, at, at + self.expression.length(at));
        }
        let start = self.expression.entries.len();
        let kept = self.expression.prune(at, cell, cover);
        let verdict = match of_nothing(kept) {
            Some(verdict) => verdict,
            None => {
                self.bands.enter(self.sheet, cell);
                let look = Look { world: self.world, sheet: self.sheet, list: &self.expression };
                self.bands.verdict(&look, start)
            }
        };
        let asked = if kept == Kept::Entries { self.bands.solids().len() } else { 0 };
        self.bands_asked += asked;
        match verdict {
            Verdict::Background => self.proved(cell, None),
            Verdict::Surface(surface) => self.proved(cell, Some(surface)),
            Verdict::Hopeless if kept == Kept::Everything => {
                let end = self.expression.entries.len();
                self.open(cell, start, end);
            }
            Verdict::Undecided | Verdict::Hopeless => {
                if self.is_enough(cell, start) {
                    self.open(cell, start, self.expression.entries.len());
                } else {
                    let look =
                        Look { world: self.world, sheet: self.sheet, list: &self.expression };
                    let covered = self.bands.cover(&look, start, cover);
                    let cover = if covered < cover { covered } else { cover };
                    self.bands_asked += self.bands.solids().len() - asked;
                    self.bands.note_crossed(&mut self.expression.entries[start..]);
                    for quarter in cell.quarters() {
                        if self.shows(&quarter) {
                            self.divide(&quarter, start, cover);
                        }
                    }
                    if whole && cell.half < 1.0 {
                        self.settled += 1;
                    }
                }
            }
        }
        self.expression.entries.truncate(start);
    }

    /// If dividing the cell further brings less than it takes. The list of the cell begins at `start`.
    fn is_enough(&self, cell: &Cell, start: usize) -> bool {
        let side = 2.0 * cell.half;
        let outline = |&solid: &u32| &self.expression.members[solid as usize].outline;
        let solids = self.bands.solids();
        if side > 8.0 {
            return false;
        }
        if side <= 4.0 && solids.iter().any(|solid| !outline(solid).is_provable()) || side <= FINEST
        {
            return true;
        }
        if side > 1.0 {
            return solids.len() > CROWD;
        }
        // What stands behind counts as well: it may be seen beside what stands in front.
        let mut solids: Vec<u32> = self.expression.solids(start).collect();
        solids.sort_unstable();
        solids.dedup();
        if side >= 1.0 && solids.len() > CROWDED_PIXEL {
            return true;
        }
        // Two curves may have something between them.
        let curves = |solid: &u32| {
            if self.bands.is_crossed(*solid) { 0 } else { outline(solid).curves_in(cell) }
        };
        solids.iter().map(curves).sum::<usize>() <= 1
            && solids.iter().all(|solid| outline(solid).area > LARGE * side * side)
    }

    /// If a pixel of the piece is in the cell.
    fn shows(&self, cell: &Cell) -> bool {
        let [column, row] = self.first_pixel(cell);
        column < self.piece.width && row < self.piece.height
    }

    /// Column and row within the piece of the first pixel of a cell.
    fn first_pixel(&self, cell: &Cell) -> [u32; 2] {
        let first = [f64::from(self.piece.column), f64::from(self.piece.row)];
        std::array::from_fn(|k| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within a tile, and not before it"
            )]
            let pixel = (cell.middle[k] - cell.half - first[k]) as u32;
            pixel
        })
    }

    fn proved(&mut self, cell: &Cell, shown: Option<Surface>) {
        if cell.half < 0.5 {
            self.part(Part { cell: *cell, proved: Some(shown), witness: None });
        } else {
            let [columns, rows] = self.pixels(cell);
            let columns = columns.start as usize..columns.end as usize;
            for row in rows {
                let first = (row * self.piece.width) as usize;
                self.plan.proofs[first..][columns.clone()].fill(Proof::Whole(shown));
            }
            self.settle(cell);
        }
    }

    /// Leaves a cell to samples; `start` … `end` of the list are what may be seen in it.
    fn open(&mut self, cell: &Cell, start: usize, end: usize) {
        let side = 2.0 * cell.half;
        let least = if side < 1.0 { LARGE * side * side } else { SMALL };
        let small = |entry: &Entry| -> Option<([f64; 2], f64)> {
            let Entry::Solid { solid, complemented: false, .. } = *entry else { return None };
            let outline = &self.expression.members[solid as usize].outline;
            let center = outline.center.filter(|&center| {
                outline.area < least && outline.depth[0] > 0.0 && cell.holds(center)
            })?;
            Some((center, outline.area))
        };
        let found = self.expression.entries[start..end].iter().filter_map(small);
        if side < 1.0 {
            // The smallest is the likeliest to be lost.
            let least = found.reduce(|least, other| if other.1 < least.1 { other } else { least });
            let witness = least.map(|(place, _)| place);
            self.part(Part { cell: *cell, proved: None, witness });
            return;
        }
        let found: Vec<_> = found.collect();
        if side <= 1.0 {
            let [column, row] = self.first_pixel(cell);
            let pixel = (row * self.piece.width + column) as usize;
            self.plan.proofs[pixel] = Proof::Open { alone: true };
        }
        self.settle(cell);
        for (place, share) in found {
            let [column, row] = self.first_pixel(&Cell { middle: place, half: 0.0 });
            if column < self.piece.width && row < self.piece.height {
                let pixel = row * self.piece.width + column;
                self.plan.witnesses.push(Witness { pixel, place, share });
            }
        }
    }

    fn part(&mut self, part: Part) {
        let [column, row] = self.first_pixel(&part.cell);
        let next = u32::try_from(self.plan.parts.len()).expect("a tile has few parts");
        // Parts of a pixel come one after the other.
        match &mut self.plan.proofs[(row * self.piece.width + column) as usize] {
            Proof::Parts { count, .. } => *count += 1,
            proof => *proof = Proof::Parts { first: next, count: 1 },
        }
        self.plan.parts.push(part);
    }

    /// Those of the piece that are in the cell, by column and row.
    fn pixels(&self, cell: &Cell) -> [std::ops::Range<u32>; 2] {
        let [column, row] = self.first_pixel(cell);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole")]
        let side = (2.0 * cell.half) as u32;
        let Piece { width, height, .. } = self.piece;
        [column..(column + side).min(width), row..(row + side).min(height)]
    }

    fn settle(&mut self, cell: &Cell) {
        let [columns, rows] = self.pixels(cell);
        self.settled += columns.len() * rows.len();
    }
}
