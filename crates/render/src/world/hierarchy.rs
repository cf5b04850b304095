//! Boxes in a tree: binned by surface area, rounded outward to `f32`, the boxes of two children in one cell of 64 bytes
//! and tested together.

mod box32;
mod boxes;
mod cut;
mod eight;
mod grow;

pub(crate) use box32::Box32;
pub(crate) use boxes::Descent;
pub(crate) use eight::EightBoxRays;

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
    pub(crate) fn meets(&self, bounds: &Box32, from: f64, to: f64) -> bool {
        let twice = |v: [f32; 3]| v.map(|x| [x; 2]);
        let (near, far) = self.enters(&twice(bounds.low), &twice(bounds.high), from, to);
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
    /// The largest magnitude below each side of a cell, rounded up.
    magnitudes: Vec<[f32; 2]>,
    /// Items are numbered from 0.
    count: usize,
}

/// A distance along a ray, rounded down, at all sizes.
#[inline(always)]
fn rounded_down(near: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounded down below")]
    let y = near as f32;
    if f64::from(y) > near { y.next_down() } else { y }
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("items are numbered by u32")
}

impl Hierarchy {
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
