//! Floyd-Steinberg: each pixel's error goes on to those that come after it.
//!
//! Rows run there and back. A strip of rows begins some rows early, with no error, and its first
//! rows are dropped; so strips are apart from each other, and any number of threads gives the
//! same indices. The next pixel waits for the error of this one; two strips that take turns fill
//! each other's waits (a third less time than one after the other).

use ilut::{Metric, Nearest, Pixels, Table};
use rayon::prelude::*;

use crate::grid::{Bounds, Grid, Grids, color, places};
use crate::hull::Hull;

/// Rows of a strip, about. Shorter ones waste more on early rows.
const STRIP: usize = 128;
/// Rows that a strip begins early: even, so that rows run as they would.
const EARLY: usize = 8;
/// Most error that a pixel takes over, on each axis, in spacings of the table's entries. Errors
/// that no entry makes up for would else grow, and smear over what comes after them.
const MOST_SPACINGS: f32 = 3.0;
/// Added and taken away, it leaves a multiple of 2^-14. Errors would else fade in flat areas to
/// numbers so small that processors take a hundred times as long for them.
const COARSE: f32 = 512.0;
/// The shares of the next pixel and, in the row after, of those behind, below and ahead.
const SHARES: [f32; 4] = [7.0 / 16.0, 3.0 / 16.0, 5.0 / 16.0, 1.0 / 16.0];

/// How a pixel gets its entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    /// The opaque entry nearest to colour and error.
    Opaque,
    /// The entry nearest to colour and error, alpha as it is.
    Covered,
    /// This entry; the error ends here.
    Fixed(u8),
}

/// What all strips share.
struct Work<'a> {
    pixels: &'a Pixels,
    /// Rows of a strip.
    height: usize,
    metric: Metric,
    strength: f32,
    nearest: Nearest,
    /// Colours of the table and their first entries, in order of colours.
    exact: Vec<([u8; 4], u8)>,
    bounds: Bounds,
    most_error: f32,
    /// Of a coarse table. Errors are then whole, as there are none that cannot be made up for.
    hull: Option<Hull>,
    /// What an opaque pixel gets that is not fixed.
    opaque: Choice,
}

/// One strip on its way down.
struct Strip {
    /// The row that comes next, and the one after the last.
    row: usize,
    end: usize,
    /// Rows before this one are dropped.
    kept: usize,
    choices: Vec<Choice>,
    places: Vec<[f32; 4]>,
    /// Errors that come to the pixels of this row and the next; one more at either end.
    errors: Vec<[f32; 4]>,
    next: Vec<[f32; 4]>,
    carried: [f32; 4],
    indices: Vec<u8>,
}

/// An entry for each pixel.
pub(crate) fn indices(pixels: &Pixels, table: &Table, metric: Metric, strength: f32) -> Vec<u8> {
    let columns = pixels.columns() as usize;
    let empty = Grid::new(table, metric);
    let height = height(pixels.rows() as usize);
    let work = Work {
        pixels,
        height,
        metric,
        strength,
        nearest: Nearest::new(table, metric),
        exact: exact(table),
        bounds: empty.bounds(),
        most_error: MOST_SPACINGS * empty.spacing(),
        hull: Hull::of(&empty),
        opaque: if empty.has_opaque() { Choice::Opaque } else { Choice::Covered },
    };
    let grids = Grids::of(empty);
    let mut indices = vec![0; pixels.colors().len()];
    let pairs = indices.par_chunks_mut(2 * height * columns).enumerate();
    pairs.for_each(|(pair, indices)| {
        grids.with(|grid| work.pair(2 * height * pair, grid, indices));
    });
    indices
}

/// Rows of a strip of a picture: even, so that two strips run the same way, and so that their
/// number is one of whole pairs, in larger pictures of two pairs, which two threads share evenly.
/// It depends on the picture alone.
fn height(rows: usize) -> usize {
    let strips = if rows < 2 * STRIP { 2 } else { 4 * ((rows + 2 * STRIP) / (4 * STRIP)) };
    rows.div_ceil(strips).next_multiple_of(2)
}

/// The table in order of colours, each once, with its first entry.
fn exact(table: &Table) -> Vec<([u8; 4], u8)> {
    let mut exact: Vec<_> = table.colors().iter().copied().zip(0..=u8::MAX).collect();
    exact.sort_unstable();
    exact.dedup_by_key(|(color, _)| *color);
    exact
}

impl Work<'_> {
    /// Indices of two strips, from row `top` on.
    fn pair(&self, top: usize, grid: &mut Grid, indices: &mut [u8]) {
        let columns = self.pixels.columns() as usize;
        let (upper, lower) = indices.split_at_mut((self.height * columns).min(indices.len()));
        let mut a = self.strip(top, upper.len() / columns);
        let mut b = self.strip(top + self.height, lower.len() / columns);
        while a.row < a.end || b.row < b.end {
            let (runs_a, runs_b) = (a.row < a.end, b.row < b.end);
            for (strip, runs) in [(&mut a, runs_a), (&mut b, runs_b)] {
                if runs {
                    self.begin_row(strip);
                }
            }
            match (runs_a, runs_b) {
                (true, true) => self.two_rows(&mut a, &mut b, grid),
                (true, false) => self.one_row(&mut a, grid),
                _ => self.one_row(&mut b, grid),
            }
            for (strip, runs, indices) in [(&mut a, runs_a, &mut *upper), (&mut b, runs_b, lower)] {
                if runs {
                    strip.end_row(indices);
                }
            }
        }
    }

    fn strip(&self, kept: usize, rows: usize) -> Strip {
        let columns = self.pixels.columns() as usize;
        let row = if rows == 0 { kept } else { kept.saturating_sub(EARLY) };
        Strip {
            row,
            end: kept + rows,
            kept,
            choices: vec![Choice::Opaque; columns],
            places: vec![[0.0; 4]; columns],
            errors: vec![[0.0; 4]; columns + 2],
            next: vec![[0.0; 4]; columns + 2],
            carried: [0.0; 4],
            indices: vec![0; columns],
        }
    }

    /// Finds places and choices of a row, before its errors are known.
    fn begin_row(&self, strip: &mut Strip) {
        let columns = self.pixels.columns() as usize;
        let colors = self.pixels.colors();
        let row = &colors[strip.row * columns..][..columns];
        let above = &colors[strip.row.saturating_sub(1) * columns..][..columns];
        let below = match &colors[(strip.row + 1) * columns..] {
            [] => row,
            rest => &rest[..columns],
        };
        places(row, self.metric, &mut strip.places);
        if let Some(hull) = &self.hull {
            for (place, color) in strip.places.iter_mut().zip(row) {
                if self.entry_of(*color).is_none() {
                    *place = hull.pulled(*place);
                }
            }
        }
        strip.carried = [0.0; 4];
        let mut last = (row[0], self.fixed(row[0]));
        for (column, &color) in row.iter().enumerate() {
            let (left, right) = (column.saturating_sub(1), (column + 1).min(columns - 1));
            let around = [row[left], row[right], above[column], below[column]];
            let mut choice = if color[3] == u8::MAX { self.opaque } else { Choice::Covered };
            if color[3] == 0 || around == [color; 4] {
                if color != last.0 {
                    last = (color, self.fixed(color));
                }
                choice = last.1.map_or(choice, Choice::Fixed);
            }
            strip.choices[column] = choice;
        }
    }

    /// The entry that a colour gets in a flat area: its own, if it has one, or any without
    /// coverage for one without.
    fn fixed(&self, color: [u8; 4]) -> Option<u8> {
        self.entry_of(color).or_else(|| (color[3] == 0).then(|| self.nearest.index(color)))
    }

    /// The entry that is this colour.
    fn entry_of(&self, color: [u8; 4]) -> Option<u8> {
        let found = self.exact.binary_search_by_key(&color, |(color, _)| *color).ok();
        found.map(|at| self.exact[at].1)
    }

    fn one_row(&self, strip: &mut Strip, grid: &mut Grid) {
        let columns = strip.indices.len();
        if strip.row.is_multiple_of(2) {
            (0..columns).for_each(|column| self.step(strip, grid, column, true));
        } else {
            (0..columns).rev().for_each(|column| self.step(strip, grid, column, false));
        }
    }

    /// A row of each strip, in turns. Both begin at even rows, so they run the same way.
    fn two_rows(&self, a: &mut Strip, b: &mut Strip, grid: &mut Grid) {
        let (columns, forward) = (a.indices.len(), a.row.is_multiple_of(2));
        let mut turns = |column, forward| {
            self.step(a, grid, column, forward);
            self.step(b, grid, column, forward);
        };
        if forward {
            (0..columns).for_each(|column| turns(column, true));
        } else {
            (0..columns).rev().for_each(|column| turns(column, false));
        }
    }

    /// Chooses the entry of one pixel and hands its error on.
    #[inline(always)]
    fn step(&self, strip: &mut Strip, grid: &mut Grid, column: usize, forward: bool) {
        let (arrived, carried) = (strip.errors[column + 1], strip.carried);
        let place = strip.places[column];
        let whole = std::array::from_fn(|axis| {
            let error = (arrived[axis] + carried[axis]) * self.strength;
            let error = (error + COARSE) - COARSE;
            place[axis] + error.max(-self.most_error).min(self.most_error)
        });
        let wanted = self.bounds.clamped(whole);
        let asked = if self.hull.is_some() { whole } else { wanted };
        let (index, share) = match strip.choices[column] {
            Choice::Opaque => (grid.nearest(wanted), 1.0),
            choice => self.covered(strip, choice, column, wanted),
        };
        strip.indices[column] = index;
        let got = grid.places()[usize::from(index)];
        let (behind, ahead) = if forward { (column, column + 2) } else { (column + 2, column) };
        for axis in 0..4 {
            let error = (asked[axis] - got[axis]) * share;
            strip.carried[axis] = error * SHARES[0];
            strip.next[behind][axis] += error * SHARES[1];
            strip.next[column + 1][axis] += error * SHARES[2];
            strip.next[ahead][axis] += error * SHARES[3];
        }
    }

    /// The entry of a pixel that is fixed or not opaque, and the share of its error that counts.
    #[cold]
    fn covered(&self, strip: &Strip, choice: Choice, column: usize, wanted: [f32; 4]) -> (u8, f32) {
        if let Choice::Fixed(index) = choice {
            return (index, 0.0);
        }
        let alpha = self.pixels.colors()[strip.row * strip.indices.len() + column][3];
        let [x, y, z, _] = wanted;
        let [red, green, blue] = color([x, y, z], self.metric);
        (self.nearest.index([red, green, blue, alpha]), f32::from(alpha) / 255.0)
    }
}

impl Strip {
    /// Keeps the indices of a row unless it is an early one, and goes on to the next.
    fn end_row(&mut self, indices: &mut [u8]) {
        let columns = self.indices.len();
        if let Some(row) = self.row.checked_sub(self.kept) {
            indices[row * columns..][..columns].copy_from_slice(&self.indices);
        }
        std::mem::swap(&mut self.errors, &mut self.next);
        self.next.fill([0.0; 4]);
        self.row += 1;
    }
}
