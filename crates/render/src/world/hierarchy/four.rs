//! Four rays through a hierarchy together: a box is looked into where any of them meets it.

use glam::DVec3;
use scene::{Four, FourMask, Lanes, Ray};

use crate::trace::packet::sides::FourProbes;

use super::{Below, Hierarchy, SLACK, SMALL, STACK, index};

/// Four rays with what box tests need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourBoxRays {
    pub(crate) ray: Ray<Four>,
    inverse: [Four; 3],
}

/// Where rays are in a box, and which of them are.
#[derive(Clone, Copy, Debug)]
struct Met {
    near: Four,
    lanes: FourMask,
}

impl FourBoxRays {
    pub(crate) fn new(ray: Ray<Four>) -> Self {
        let (least, most) = (Four::splat(f64::MIN_POSITIVE), Four::splat(f64::MAX));
        // As for one ray: 0 · ∞ never happens.
        let inverse = ray.direction.map(|d| {
            let along = Four::select(d.less(Four::splat(0.0)), -most, most);
            Four::select(least.less(d.abs()), Four::splat(1.0) / d, along)
        });
        Self { ray, inverse }
    }

    /// Tests one side of a cell.
    #[inline(always)]
    fn meets(&self, cell: &super::Cell, side: usize, from: Four, to: Four, open: FourMask) -> Met {
        let corner = |c: &super::Corners| std::array::from_fn(|k| f64::from(c[k][side]));
        self.meets_box(corner(&cell.low), corner(&cell.high), from, to, open)
    }

    /// Tests a box; the slack covers the rounding of the test itself.
    #[inline(always)]
    fn meets_box(
        &self,
        low: [f64; 3],
        high: [f64; 3],
        from: Four,
        to: Four,
        open: FourMask,
    ) -> Met {
        let (mut near, mut far) = (from, to);
        for k in 0..3 {
            let (origin, inverse) = (self.ray.origin[k], self.inverse[k]);
            let a = (Four::splat(low[k]) - origin) * inverse;
            let b = (Four::splat(high[k]) - origin) * inverse;
            near = near.either_max(a.either_min(b));
            far = far.either_min(a.either_max(b));
        }
        let near = near * Four::splat(1.0 - SLACK);
        let lanes = Four::and(open, near.at_most(far * Four::splat(1.0 + SLACK)));
        Met { near, lanes }
    }
}

impl Met {
    /// True if more lanes meet this sooner than the other.
    #[inline(always)]
    fn is_sooner(&self, other: &Self) -> bool {
        let sooner = |a: &Self, b: &Self| {
            Four::and(a.lanes, Four::not(Four::and(b.lanes, b.near.at_most(a.near))))
        };
        let (here, there) = (sooner(self, other).bits(), sooner(other, self).bits());
        here.count_ones() > there.count_ones()
    }
}

impl Hierarchy {
    /// [`Hierarchy::nearest`] for the lanes that are `open`: `visit` is told which of them meet the item's box, and
    /// answers how far each of them has to look from then on.
    #[inline]
    pub(crate) fn nearest_of_four(
        &self,
        rays: &FourBoxRays,
        from: Four,
        to: Four,
        open: FourMask,
        visit: &mut impl FnMut(u32, FourMask) -> Four,
    ) {
        if self.count <= SMALL {
            self.nearest_of_few_for_four(rays, from, to, open, visit);
        } else {
            self.nearest_of_many_for_four(rays, from, to, open, visit);
        }
    }

    #[inline(always)]
    fn nearest_of_few_for_four(
        &self,
        rays: &FourBoxRays,
        from: Four,
        mut to: Four,
        open: FourMask,
        visit: &mut impl FnMut(u32, FourMask) -> Four,
    ) {
        // A lane that has found something at `from` is done.
        let mut open = open;
        for (item, bounds) in (0..).zip(&self.few) {
            let (low, high) = (bounds.low.to_array(), bounds.high.to_array());
            let here = rays.meets_box(low, high, from, to, open);
            if here.lanes.any() {
                to = visit(item, here.lanes);
                open = Four::and(open, from.less(to));
            }
        }
    }

    fn nearest_of_many_for_four(
        &self,
        rays: &FourBoxRays,
        from: Four,
        mut to: Four,
        open: FourMask,
        visit: &mut impl FnMut(u32, FourMask) -> Four,
    ) {
        let everywhere = Met { near: Four::splat(f64::NEG_INFINITY), lanes: open };
        let mut stack = [(Below::Cell(0), everywhere); STACK];
        let mut top = 0;
        let (mut below, mut lanes) = (Below::Cell(0), Four::and(open, from.less(to)));
        while lanes.any() {
            match below {
                Below::Item(item) => {
                    to = visit(item, lanes);
                    lanes = FourMask::none();
                }
                Below::Cell(number) => {
                    let cell = &self.cells[number as usize];
                    let met = [0, 1].map(|s| rays.meets(cell, s, from, to, lanes));
                    let side = match met.map(|met| met.lanes.any()) {
                        [true, true] => {
                            let first = usize::from(met[1].is_sooner(&met[0]));
                            stack[top] = (cell.below[1 - first], met[1 - first]);
                            top += 1;
                            first
                        }
                        [_, second] => usize::from(second),
                    };
                    (below, lanes) = (cell.below[side], met[side].lanes);
                }
            }
            while !lanes.any() && top > 0 {
                top -= 1;
                let met = stack[top].1;
                below = stack[top].0;
                lanes = Four::and(met.lanes, Four::and(met.near.at_most(to), from.less(to)));
            }
        }
    }

    /// Shows `visit` the items whose boxes come near any of the probes; others, too.
    pub(crate) fn around_four(&self, probes: &FourProbes, visit: &mut impl FnMut(u32)) {
        if self.count <= SMALL {
            // In the order of the items: what is found does not depend on the tree.
            (0..self.count).for_each(|item| visit(index(item)));
            return;
        }
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let cell = &self.cells[stack[top] as usize];
            for s in 0..2 {
                let corner = |c: &super::Corners| {
                    DVec3::new(f64::from(c[0][s]), f64::from(c[1][s]), f64::from(c[2][s]))
                };
                if !probes.near(corner(&cell.low), corner(&cell.high)).any() {
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

    /// [`Hierarchy::stab`] for the lanes that are `open`; `visit` answers where each ray is from then on.
    pub(crate) fn stab_four(
        &self,
        rays: &FourBoxRays,
        mut at: Four,
        open: FourMask,
        visit: &mut impl FnMut(u32, FourMask) -> Four,
    ) {
        if self.count <= SMALL {
            (0..self.count).for_each(|item| at = visit(index(item), open));
            return;
        }
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let cell = &self.cells[stack[top] as usize];
            let slack = Four::splat(2.0 * SLACK) * at.abs();
            for s in 0..2 {
                let met = rays.meets(cell, s, at - slack, at + slack, open);
                if !met.lanes.any() {
                    continue;
                }
                match cell.below[s] {
                    Below::Item(item) => at = visit(item, met.lanes),
                    Below::Cell(child) => {
                        stack[top] = child;
                        top += 1;
                    }
                }
            }
        }
    }
}
