//! Boxes in a tree: binned by surface area, rounded outward to `f32`, the boxes of two children in one cell of 64 bytes
//! and tested together.

mod cut;
mod four;

pub(crate) use four::FourBoxRays;

use glam::DVec3;
use scene::{Bounds, Ray};
use wide::f64x2;

use super::ROUNDING;

/// A ray with what box tests need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRay {
    pub(crate) ray: Ray,
    inverse: [f64; 3],
}

impl BoxRay {
    pub(crate) fn new(ray: Ray) -> Self {
        // A ray along a slab has an inverse so large that only its sign and zero matter; 0 · ∞ never happens.
        let inverse = ray
            .direction
            .map(|d| if d.abs() > f64::MIN_POSITIVE { 1.0 / d } else { f64::MAX.copysign(d) });
        Self { ray, inverse }
    }

    /// Where the ray is in two boxes, within `from` … `to`; not in them where the first result is above the second.
    /// The slack covers the rounding of the test itself; behind the origin it takes away as much.
    #[inline(always)]
    fn enters(&self, low: &Corners, high: &Corners, from: f64, to: f64) -> ([f64; 2], [f64; 2]) {
        let (mut near, mut far) = (f64x2::splat(from), f64x2::splat(to));
        for k in 0..3 {
            let (origin, inverse) =
                (f64x2::splat(self.ray.origin[k]), f64x2::splat(self.inverse[k]));
            let a = (pair(&low[k]) - origin) * inverse;
            let b = (pair(&high[k]) - origin) * inverse;
            near = near.fast_max(a.fast_min(b));
            far = far.fast_min(a.fast_max(b));
        }
        (
            (near * f64x2::splat(1.0 - SLACK)).to_array(),
            (far * f64x2::splat(1.0 + SLACK)).to_array(),
        )
    }

    /// True if the ray meets the box somewhere in `from` … `to`.
    #[inline]
    pub(crate) fn meets(&self, bounds: &Bounds, from: f64, to: f64) -> bool {
        let twice = |v: [f32; 3]| v.map(|x| [x; 2]);
        let (low, high) = (twice(round_down(bounds.low)), twice(round_up(bounds.high)));
        let (near, far) = self.enters(&low, &high, from, to);
        near[0] <= far[0]
    }
}

/// Coordinates of two boxes' corners, by axis.
type Corners = [[f32; 2]; 3];

#[inline(always)]
fn pair(x: &[f32; 2]) -> f64x2 {
    f64x2::new([f64::from(x[0]), f64::from(x[1])])
}

/// Relative error of a slab parameter is a few units in the last place; boxes lose nothing by more.
const SLACK: f64 = 1e-12;
/// No more items than this need no tree. Point queries then leave box tests to whoever looks at the items.
const SMALL: usize = 8;
const BINS: usize = 16;
/// Levels of the deepest tree. A stack is cleared for every ray, so it is kept small.
const STACK: usize = 40;

/// What is below one side of a cell.
#[derive(Clone, Copy, Debug)]
enum Below {
    Cell(u32),
    Item(u32),
}

/// Two boxes and what is in them.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Cell {
    low: Corners,
    high: Corners,
    below: [Below; 2],
}

impl Cell {
    const EMPTY: Self =
        Self { low: [[0.0; 2]; 3], high: [[0.0; 2]; 3], below: [Below::Item(0); 2] };
}

// Two children in one line of cache.
const _: () = assert!(size_of::<Cell>() == 64, "a cell has grown");

/// A tree of boxes over numbered items.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    cells: Vec<Cell>,
    /// The boxes of a few items as numbers that need no widening.
    few: Vec<Bounds>,
    /// The largest magnitude below each side of a cell, rounded up.
    magnitudes: Vec<[f32; 2]>,
    /// Items are numbered from 0.
    count: usize,
}

fn round_down(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| {
        #[expect(clippy::cast_possible_truncation, reason = "rounded outward below")]
        let y = x as f32;
        if f64::from(y) > x { y.next_down() } else { y }
    })
}

/// A distance along a ray, rounded down; at least 0 or of no matter.
#[inline(always)]
fn rounded_down(near: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "taken down by more than it was rounded")]
    let near = (near * (1.0 - f64::from(f32::EPSILON))) as f32;
    near
}

fn round_up(v: DVec3) -> [f32; 3] {
    round_down(-v).map(|x| -x)
}

fn area(b: &Bounds) -> f64 {
    if b.is_empty() {
        return 0.0;
    }
    let e = b.high - b.low;
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// Halves `items` in place where the surface area heuristic says, and returns how many are in the first half.
fn split(items: &mut [u32], boxes: &[(Bounds, f64)]) -> usize {
    let middle = |i: u32, axis: usize| {
        let b = &boxes[i as usize].0;
        0.5 * b.low[axis] + 0.5 * b.high[axis]
    };
    let mut best: Option<(f64, usize, f64, f64, usize)> = None;
    for axis in 0..3 {
        let (low, high) = items.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &i| {
            let m = middle(i, axis);
            (l.min(m), h.max(m))
        });
        let width = high - low;
        if !(width > 0.0 && width.is_finite()) {
            continue;
        }
        let scale = BINS as f64 / width;
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for &i in &*items {
            let bin = &mut bins[bin_of(middle(i, axis), low, scale)];
            bin.0 = bin.0.hull(boxes[i as usize].0);
            bin.1 += 1;
        }
        let mut right = [0.0; BINS];
        let (mut hull, mut count) = (Bounds::EMPTY, 0_usize);
        for k in (1..BINS).rev() {
            hull = hull.hull(bins[k].0);
            count += bins[k].1;
            right[k] = area(&hull) * count as f64;
        }
        let (mut hull, mut count) = (Bounds::EMPTY, 0_usize);
        for k in 1..BINS {
            hull = hull.hull(bins[k - 1].0);
            count += bins[k - 1].1;
            let cost = area(&hull) * count as f64 + right[k];
            if count > 0 && count < items.len() && best.is_none_or(|b| cost < b.0) {
                best = Some((cost, axis, low, scale, k));
            }
        }
    }
    let Some((_, axis, low, scale, border)) = best else { return items.len() / 2 };
    let mut first = 0;
    for k in 0..items.len() {
        if bin_of(middle(items[k], axis), low, scale) < border {
            items.swap(k, first);
            first += 1;
        }
    }
    first
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("items are numbered by u32")
}

fn bin_of(middle: f64, low: f64, scale: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0…BINS")]
    let bin = ((middle - low) * scale) as usize;
    bin.min(BINS - 1)
}

impl Hierarchy {
    /// A tree over `boxes`, each with the magnitude of what is in it. None of the boxes is empty.
    pub(crate) fn build(boxes: &[(Bounds, f64)]) -> Self {
        let mut tree = Self { count: boxes.len(), ..Self::default() };
        let mut order: Vec<u32> = (0..index(boxes.len())).collect();
        if boxes.len() <= SMALL {
            for (i, (bounds, magnitude)) in boxes.iter().enumerate() {
                if i % 2 == 0 {
                    tree.grow();
                }
                tree.fill(i / 2, i % 2, bounds, *magnitude);
                tree.few.push(*bounds);
            }
            return tree;
        }
        tree.grow();
        // Items from … to go to one side of a cell.
        let mut todo = vec![(0_usize, 0_usize, 0_usize, boxes.len(), 0_usize)];
        while let Some((cell, side, start, end, depth)) = todo.pop() {
            let items = &mut order[start..end];
            let (hull, magnitude) =
                items.iter().fold((Bounds::EMPTY, 0.0_f64), |(hull, magnitude), &i| {
                    let (b, m) = boxes[i as usize];
                    (hull.hull(b), magnitude.max(m))
                });
            tree.fill(cell, side, &hull, magnitude);
            if let [item] = *items {
                tree.cells[cell].below[side] = Below::Item(item);
                continue;
            }
            // Uneven splits only while even ones would still fit what is left of the levels.
            let even = items.len().ilog2() as usize + 1;
            let first =
                if depth + even < STACK - 1 { split(items, boxes) } else { items.len() / 2 };
            // The whole is no box worth a test: the first split fills the first cell.
            let child = if depth == 0 { 0 } else { tree.grow() };
            if depth > 0 {
                tree.cells[cell].below[side] = Below::Cell(index(child));
            }
            todo.push((child, 1, start + first, end, depth + 1));
            todo.push((child, 0, start, start + first, depth + 1));
        }
        tree
    }

    fn grow(&mut self) -> usize {
        self.cells.push(Cell::EMPTY);
        self.magnitudes.push([0.0; 2]);
        self.cells.len() - 1
    }

    fn fill(&mut self, cell: usize, side: usize, bounds: &Bounds, magnitude: f64) {
        self.magnitudes[cell][side] = round_up(DVec3::splat(magnitude))[0];
        let (low, high) = (round_down(bounds.low), round_up(bounds.high));
        for k in 0..3 {
            self.cells[cell].low[k][side] = low[k];
            self.cells[cell].high[k][side] = high[k];
        }
    }

    /// [`Hierarchy::nearest`] for a few items: all boxes first, then the items met, near ones first.
    #[inline(always)]
    fn nearest_of_few(
        &self,
        ray: &BoxRay,
        from: f64,
        mut to: f64,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let mut met = [(0.0_f64, 0_u32); SMALL];
        let mut count = 0;
        for (first, cell) in (0..).step_by(2).zip(&self.cells) {
            let (near, far) = ray.enters(&cell.low, &cell.high, from, to);
            for s in 0..2 {
                // An odd one out has no neighbour, but an empty box.
                if near[s] <= far[s] && first + s < self.count {
                    let mut at = count;
                    while at > 0 && met[at - 1].0 > near[s] {
                        met[at] = met[at - 1];
                        at -= 1;
                    }
                    met[at] = (near[s], index(first + s));
                    count += 1;
                }
            }
        }
        for &(near, item) in &met[..count] {
            if near > to {
                return;
            }
            to = visit(item, to);
            if to <= from {
                return;
            }
        }
    }

    /// Shows `visit` the items whose boxes the ray meets in `from` … `to`, near ones first; it answers how far to look
    /// from then on.
    #[inline]
    pub(crate) fn nearest(
        &self,
        ray: &BoxRay,
        from: f64,
        mut to: f64,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) {
        if self.count <= SMALL {
            return self.nearest_of_few(ray, from, to, visit);
        }
        let mut stack = [(Below::Item(0), 0.0_f32); STACK];
        stack[0] = (Below::Cell(0), f32::NEG_INFINITY);
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (below, near) = stack[top];
            if f64::from(near) > to {
                continue;
            }
            match below {
                Below::Item(item) => {
                    to = visit(item, to);
                    if to <= from {
                        return;
                    }
                }
                Below::Cell(number) => {
                    let cell = &self.cells[number as usize];
                    let (near, far) = ray.enters(&cell.low, &cell.high, from, to);
                    let side = |s: usize| (cell.below[s], rounded_down(near[s]));
                    let first = usize::from(near[1] < near[0]);
                    for s in [1 - first, first] {
                        if near[s] <= far[s] {
                            stack[top] = side(s);
                            top += 1;
                        }
                    }
                }
            }
        }
    }

    /// Shows `visit` the items whose boxes hold the ray's point at `at`; it answers where the ray is from then on.
    pub(crate) fn stab(&self, ray: &BoxRay, mut at: f64, visit: &mut impl FnMut(u32, f64) -> f64) {
        if self.count <= SMALL {
            (0..self.count).for_each(|item| at = visit(index(item), at));
            return;
        }
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let cell = &self.cells[stack[top] as usize];
            // Whoever asks does so again until the ray stays where it is.
            let slack = 2.0 * SLACK * at.abs();
            let (near, far) = ray.enters(&cell.low, &cell.high, at - slack, at + slack);
            for s in 0..2 {
                if near[s] > far[s] {
                    continue;
                }
                match cell.below[s] {
                    Below::Item(item) => at = visit(item, at),
                    Below::Cell(child) => {
                        stack[top] = child;
                        top += 1;
                    }
                }
            }
        }
    }

    /// Shows `visit` the items whose boxes come within `tolerance` of `point` and may hold a magnitude above `above`;
    /// others, too.
    pub(crate) fn around(
        &self,
        point: DVec3,
        tolerance: f64,
        above: f64,
        visit: &mut impl FnMut(u32),
    ) {
        if self.count <= SMALL {
            // In the order of the items: what is found does not depend on the tree.
            (0..self.count).for_each(|item| visit(index(item)));
            return;
        }
        let p = point.to_array();
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let number = stack[top] as usize;
            let cell = &self.cells[number];
            for s in 0..2 {
                let holds = (0..3).all(|k| {
                    p[k] >= f64::from(cell.low[k][s]) - tolerance
                        && p[k] <= f64::from(cell.high[k][s]) + tolerance
                });
                if !holds || f64::from(self.magnitudes[number][s]) <= above {
                    continue;
                }
                match cell.below[s] {
                    Below::Item(item) => visit(item),
                    Below::Cell(child) => {
                        stack[top] = child;
                        top += 1;
                    }
                }
            }
        }
    }
}

/// A leaf's or instance's box made safe: wider by the rounding bound of its magnitude.
pub(crate) fn widened(bounds: Bounds, magnitude: f64) -> Bounds {
    bounds.widened(ROUNDING * magnitude)
}
