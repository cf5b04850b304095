//! Trees of boxes, split where the surface area heuristic says (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007).

use std::ops::Range;

use glam::DVec3;
use scene::Bounds;

use super::box32::{Box32, round_up};
use super::{Below, Cell, Hierarchy, SMALL, STACK, index};

const BINS: usize = 16;

/// What the tree is over, in the order in which the leaves come to stand.
#[derive(Clone, Copy)]
struct Item {
    within: Box32,
    magnitude: f32,
    number: u32,
}

impl Item {
    fn middle(&self, axis: usize) -> f32 {
        0.5 * self.within.low[axis] + 0.5 * self.within.high[axis]
    }
}

/// Items from … to that go to one side of a cell, so many levels down.
struct Task {
    cell: usize,
    side: usize,
    items: Range<usize>,
    depth: usize,
}

impl Hierarchy {
    /// A tree over `boxes`, each with the magnitude of what is in it. None of the boxes is empty.
    pub(crate) fn build(boxes: &[(Bounds, f64)]) -> Self {
        let mut items: Vec<Item> = (0..)
            .zip(boxes)
            .map(|(number, (bounds, magnitude))| {
                let magnitude = round_up(DVec3::splat(*magnitude))[0];
                Item { within: Box32::about(bounds), magnitude, number }
            })
            .collect();
        let mut tree = Self { count: items.len(), ..Self::default() };
        if items.len() <= SMALL {
            for (i, item) in items.iter().enumerate() {
                if i % 2 == 0 {
                    tree.grow();
                }
                tree.fill(i / 2, i % 2, &item.within, item.magnitude);
            }
            return tree;
        }
        tree.cells.reserve(items.len() - 1);
        tree.magnitudes.reserve(items.len() - 1);
        tree.grow();
        let mut tasks = vec![Task { cell: 0, side: 0, items: 0..items.len(), depth: 0 }];
        while let Some(Task { cell, side, items: Range { start, end }, depth }) = tasks.pop() {
            let items = &mut items[start..end];
            let (mut hull, mut magnitude) = (Box32::EMPTY, 0.0_f32);
            for item in &*items {
                hull = hull.hull(&item.within);
                magnitude = magnitude.max(item.magnitude);
            }
            tree.fill(cell, side, &hull, magnitude);
            if let [item] = *items {
                tree.cells[cell].below[side] = Below::Item(item.number);
                continue;
            }
            // Uneven splits only while even ones would still fit what is left of the levels.
            let even = items.len().ilog2() as usize + 1;
            let first = if depth + even < STACK - 1 { split(items) } else { items.len() / 2 };
            // The whole is no box worth a test: the first split fills the first cell.
            let child = if depth == 0 { 0 } else { tree.grow() };
            if depth > 0 {
                tree.cells[cell].below[side] = Below::Cell(index(child));
            }
            let half = start + first;
            let task = |side, items| Task { cell: child, side, items, depth: depth + 1 };
            tasks.extend([task(1, half..end), task(0, start..half)]);
        }
        tree
    }

    pub(super) fn grow(&mut self) -> usize {
        self.cells.push(Cell::EMPTY);
        self.magnitudes.push([0.0; 2]);
        self.cells.len() - 1
    }

    fn fill(&mut self, cell: usize, side: usize, within: &Box32, magnitude: f32) {
        self.magnitudes[cell][side] = magnitude;
        for k in 0..3 {
            self.cells[cell].low[k][side] = within.low[k];
            self.cells[cell].high[k][side] = within.high[k];
        }
    }
}

/// Items of one bin: their box and number.
type Bin = (Box32, usize);

/// Bins along an axis.
#[derive(Clone, Copy)]
struct Binning {
    low: f32,
    scale: f32,
}

impl Binning {
    /// None where all middles are the same, or none is known.
    fn along(axis: usize, items: &[Item]) -> Option<Self> {
        let (low, high) = items.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), item| {
            let middle = item.middle(axis);
            (l.min(middle), h.max(middle))
        });
        let width = high - low;
        let scale = BINS as f32 / width;
        (width > 0.0 && width.is_finite() && scale.is_finite()).then_some(Self { low, scale })
    }

    fn bin(self, middle: f32) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0…BINS")]
        let bin = ((middle - self.low) * self.scale) as usize;
        bin.min(BINS - 1)
    }
}

/// The border between bins with the least cost that leaves something on both sides: the cost, and the first bin beyond.
fn border(bins: &[Bin; BINS], count: usize) -> Option<(f64, usize)> {
    let mut right = [0.0; BINS];
    let (mut hull, mut beyond) = (Box32::EMPTY, 0);
    for k in (1..BINS).rev() {
        hull = hull.hull(&bins[k].0);
        beyond += bins[k].1;
        right[k] = hull.area() * beyond as f64;
    }
    let (mut hull, mut before) = (Box32::EMPTY, 0);
    let mut best: Option<(f64, usize)> = None;
    for k in 1..BINS {
        hull = hull.hull(&bins[k - 1].0);
        before += bins[k - 1].1;
        let cost = hull.area() * before as f64 + right[k];
        if before > 0 && before < count && best.is_none_or(|best| cost < best.0) {
            best = Some((cost, k));
        }
    }
    best
}

/// Halves `items` in place where the surface area heuristic says, and returns how many are in the first half.
fn split(items: &mut [Item]) -> usize {
    let mut best: Option<(f64, usize, Binning, usize)> = None;
    for axis in 0..3 {
        let Some(binning) = Binning::along(axis, items) else { continue };
        let mut bins = [(Box32::EMPTY, 0); BINS];
        for item in &*items {
            let bin = &mut bins[binning.bin(item.middle(axis))];
            *bin = (bin.0.hull(&item.within), bin.1 + 1);
        }
        if let Some((cost, border)) = border(&bins, items.len())
            && best.is_none_or(|best| cost < best.0)
        {
            best = Some((cost, axis, binning, border));
        }
    }
    let Some((_, axis, binning, border)) = best else { return items.len() / 2 };
    let mut first = 0;
    for k in 0..items.len() {
        if binning.bin(items[k].middle(axis)) < border {
            items.swap(k, first);
            first += 1;
        }
    }
    first
}
