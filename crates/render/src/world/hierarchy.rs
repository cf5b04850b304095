//! Boxes in a tree: binned by surface area, nodes of 32 bytes, rounded outward to `f32`.

use glam::DVec3;
use scene::{Bounds, Ray};

use super::ROUNDING;

/// A ray with what box tests need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRay {
    pub(crate) ray: Ray,
    inverse: [f64; 3],
    /// The ray runs down this axis.
    down: [bool; 3],
}

impl BoxRay {
    pub(crate) fn new(ray: Ray) -> Self {
        // A ray along a slab has an inverse so large that only its sign and zero matter; 0 · ∞ never happens.
        let inverse = ray.direction.map(|d| {
            if d.abs() > f64::MIN_POSITIVE { 1.0 / d } else { f64::MAX.copysign(d) }
        });
        Self { ray, inverse, down: inverse.map(|i| i < 0.0) }
    }

    /// Where the ray is in the box, within `from` … `to`; the slack covers the rounding of the test itself.
    #[inline(always)]
    fn enters(&self, low: [f32; 3], high: [f32; 3], from: f64, to: f64) -> Option<f64> {
        let (mut near, mut far) = (from, to);
        for k in 0..3 {
            let (first, last) = if self.down[k] { (high[k], low[k]) } else { (low[k], high[k]) };
            let a = (f64::from(first) - self.ray.origin[k]) * self.inverse[k];
            let b = (f64::from(last) - self.ray.origin[k]) * self.inverse[k];
            near = if a > near { a } else { near };
            far = if b < far { b } else { far };
        }
        (near * (1.0 - SLACK) <= far * (1.0 + SLACK)).then_some(near)
    }

    /// True if the ray meets the box somewhere in `from` … `to`.
    #[inline]
    pub(crate) fn meets(&self, bounds: &Bounds, from: f64, to: f64) -> bool {
        self.enters(round_down(bounds.low), round_up(bounds.high), from, to).is_some()
    }
}

/// Relative error of a slab parameter is a few units in the last place; boxes lose nothing by more.
const SLACK: f64 = 1e-12;
/// Items in a leaf of the tree.
const LEAF: usize = 2;
/// With no more items than this, point queries leave box tests to whoever looks at the items.
const SMALL: usize = 8;
const BINS: usize = 16;
/// Deeper than any tree the splitter makes: the middle split halves, and 2³² items halve 32 times; binned splits are
/// bounded by the explicit check in [`Hierarchy::build`].
const STACK: usize = 64;
const SHALLOW: usize = 12;

#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Cell {
    low: [f32; 3],
    /// First item of a leaf, or the first of two children.
    first: u32,
    high: [f32; 3],
    /// Items of a leaf; 0 for an inner cell.
    count: u32,
}

/// A tree of boxes over numbered items.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    cells: Vec<Cell>,
    /// The largest magnitude below each cell, rounded up.
    magnitudes: Vec<f32>,
    items: Vec<u32>,
    /// Levels below the root.
    depth: usize,
}

fn round_down(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| {
        #[expect(clippy::cast_possible_truncation, reason = "rounded outward below")]
        let y = x as f32;
        if f64::from(y) > x { y.next_down() } else { y }
    })
}

/// A distance along a ray, rounded down.
#[inline(always)]
fn below(near: f64) -> f32 {
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
        let count = u32::try_from(boxes.len()).expect("items are numbered by u32");
        let mut tree =
            Self { items: (0..count).collect(), ..Self::default() };
        if boxes.is_empty() {
            return tree;
        }
        let blank = Cell { low: [0.0; 3], first: 0, high: [0.0; 3], count: 0 };
        tree.cells.push(blank);
        tree.magnitudes.push(0.0);
        let mut todo = vec![(0_usize, 0_usize, boxes.len(), 0_usize)];
        while let Some((cell, start, end, depth)) = todo.pop() {
            let items = &mut tree.items[start..end];
            let (hull, magnitude) =
                items.iter().fold((Bounds::EMPTY, 0.0_f64), |(hull, magnitude), &i| {
                    let (b, m) = boxes[i as usize];
                    (hull.hull(b), magnitude.max(m))
                });
            tree.magnitudes[cell] = round_up(DVec3::splat(magnitude))[0];
            tree.depth = tree.depth.max(depth);
            let (low, high) = (round_down(hull.low), round_up(hull.high));
            if items.len() <= LEAF {
                let count = index(items.len());
                tree.cells[cell] = Cell { low, high, first: index(start), count };
                continue;
            }
            // Past half of the stack every split is even, so the rest fits the other half.
            let first =
                if depth < STACK / 2 { split(items, boxes) } else { items.len() / 2 };
            let child = tree.cells.len();
            tree.cells.extend([blank; 2]);
            tree.magnitudes.extend([0.0; 2]);
            tree.cells[cell] = Cell { low, high, first: index(child), count: 0 };
            todo.push((child + 1, start + first, end, depth + 1));
            todo.push((child, start, start + first, depth + 1));
        }
        tree
    }

    fn items_of(&self, cell: &Cell) -> &[u32] {
        &self.items[cell.first as usize..cell.first as usize + cell.count as usize]
    }

    /// Shows `visit` the items whose boxes the ray meets in `from` … `to`, near ones first; it answers how far to look
    /// from then on.
    #[inline]
    pub(crate) fn nearest(
        &self,
        ray: &BoxRay,
        from: f64,
        to: f64,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) {
        // A stack is cleared for every ray; most scenes need little of it.
        if self.depth < SHALLOW {
            self.nearest_within::<SHALLOW>(ray, from, to, visit);
        } else {
            self.nearest_within::<STACK>(ray, from, to, visit);
        }
    }

    #[inline]
    fn nearest_within<const STACK: usize>(
        &self,
        ray: &BoxRay,
        from: f64,
        mut to: f64,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let Some(root) = self.cells.first() else { return };
        let Some(near) = ray.enters(root.low, root.high, from, to) else { return };
        let mut stack = [(0_u32, 0.0_f32); STACK];
        stack[0] = (0, below(near));
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (cell, near) = stack[top];
            if f64::from(near) > to {
                continue;
            }
            let cell = &self.cells[cell as usize];
            if cell.count > 0 {
                for &item in self.items_of(cell) {
                    to = visit(item, to);
                    if to <= from {
                        return;
                    }
                }
                continue;
            }
            let enter = |i: u32| {
                let child = &self.cells[i as usize];
                ray.enters(child.low, child.high, from, to).map(|near| (i, below(near)))
            };
            match (enter(cell.first), enter(cell.first + 1)) {
                (Some(a), Some(b)) => {
                    let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    stack[top] = far;
                    stack[top + 1] = near;
                    top += 2;
                }
                (Some(only), None) | (None, Some(only)) => {
                    stack[top] = only;
                    top += 1;
                }
                (None, None) => {}
            }
        }
    }

    /// Shows `visit` the items whose boxes hold the ray's point at `at`; it answers where the ray is from then on.
    pub(crate) fn stab(&self, ray: &BoxRay, mut at: f64, visit: &mut impl FnMut(u32, f64) -> f64) {
        if self.cells.is_empty() {
            return;
        }
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let cell = &self.cells[stack[top] as usize];
            if ray.enters(cell.low, cell.high, at, at).is_none() {
                continue;
            }
            if cell.count > 0 {
                for &item in self.items_of(cell) {
                    at = visit(item, at);
                }
            } else {
                stack[top] = cell.first + 1;
                stack[top + 1] = cell.first;
                top += 2;
            }
        }
    }

    /// Shows `visit` the items whose boxes come within `tolerance` of `point` and may hold a magnitude above `above`.
    pub(crate) fn around(
        &self,
        point: DVec3,
        tolerance: f64,
        above: f64,
        visit: &mut impl FnMut(u32),
    ) {
        if self.items.len() <= SMALL {
            // In the order of the items: what is found does not depend on the tree.
            (0..self.items.len()).for_each(|item| visit(index(item)));
            return;
        }
        let p = point.to_array();
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let number = stack[top] as usize;
            let cell = &self.cells[number];
            let holds = (0..3).all(|k| {
                p[k] >= f64::from(cell.low[k]) - tolerance
                    && p[k] <= f64::from(cell.high[k]) + tolerance
            });
            if !holds || f64::from(self.magnitudes[number]) <= above {
                continue;
            }
            if cell.count > 0 {
                for &item in self.items_of(cell) {
                    visit(item);
                }
            } else {
                stack[top] = cell.first + 1;
                stack[top + 1] = cell.first;
                top += 2;
            }
        }
    }
}

/// A leaf's or instance's box made safe: wider by the rounding bound of its magnitude.
pub(crate) fn widened(bounds: Bounds, magnitude: f64) -> Bounds {
    bounds.widened(ROUNDING * magnitude)
}
