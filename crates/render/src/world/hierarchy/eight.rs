//! Eight rays through a hierarchy together: a box is looked into where any of them meets it.
//!
//! Boxes are tested in single precision. Everything is rounded so that a box that a ray meets is never passed over: see
//! [`EightBoxRays`].

use scene::{Eight, EightMask, Lanes, Ray};
use wide::f32x8;

use crate::trace::packet::sides::EightProbes;

use super::box32::Box32;
use super::{Below, Cell, Hierarchy, SMALL, STACK, index};

/// Eight rays with what box tests need.
///
/// The distance to a side of a box is (side − origin) / direction. Low sides are compared with origins that are rounded
/// up, high ones with origins rounded down, so that boxes seem larger; what the difference, the inverse and the product
/// lose is less than [`SLACK`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightBoxRays {
    pub(crate) ray: Ray<Eight>,
    up: [f32x8; 3],
    down: [f32x8; 3],
    inverse: [f32x8; 3],
}

/// Largest coordinates of worlds that single precision has room for.
const SIZES: std::ops::RangeInclusive<f64> = 1e-18..=1e30;
/// Of numbers when they are rounded to single precision, and a step more.
const STEP: f64 = 1.0 / (1 << 22) as f64;
/// Of a distance that was rounded four times.
const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// Where rays are in a box, and which of them are.
#[derive(Clone, Copy, Debug)]
struct Met {
    near: f32x8,
    /// Bit k is of lane k.
    lanes: u32,
}

/// What is not passed yet, of each ray.
struct Reach {
    from: Eight,
    /// `from`, rounded down.
    near: f32x8,
    /// How far to look, rounded up.
    far: f32x8,
    /// Lanes that have not found anything at `from`, which could not be nearer.
    open: u32,
}

impl Reach {
    fn new(from: Eight, to: Eight, open: EightMask) -> Self {
        let mut reach = Self { open: open.bits(), ..Self::at(from, 0) };
        reach.shorten(to);
        reach
    }

    /// One place on each ray.
    #[inline(always)]
    fn at(at: Eight, open: u32) -> Self {
        // Twice what tests lose: it may be below 0.
        let room = at.abs() * Eight::splat(2.0 * f64::from(SLACK));
        Self { from: at, near: single(at - room), far: single(at + room), open }
    }

    #[inline(always)]
    fn shorten(&mut self, to: Eight) {
        self.far = single(to * Eight::splat(1.0 + STEP));
        self.open &= self.from.less(to).bits();
    }
}

/// The nearest numbers of single precision; infinite for those beyond.
#[inline(always)]
fn single(lanes: Eight) -> f32x8 {
    #[expect(clippy::cast_possible_truncation, reason = "rounded, with room for it")]
    let narrow = lanes.to_array().map(|x| x as f32);
    f32x8::new(narrow)
}

#[inline(always)]
fn bits(mask: f32x8) -> u32 {
    mask.to_bitmask()
}

impl EightBoxRays {
    /// If box tests have room for rays in a world with this largest coordinate.
    pub(crate) fn can_trace(magnitude: f64) -> bool {
        SIZES.contains(&magnitude)
    }

    /// In a world with this largest coordinate, which can be traced.
    pub(crate) fn new(ray: Ray<Eight>, magnitude: f64) -> Self {
        // So that nothing is taken for 0 by rounding; and rays along a side, with inverses that had to be cut off, leave
        // the box farther off than the world is wide.
        let least = Eight::splat(1e-30 * magnitude + 1e-36);
        let rounded =
            |x: Eight, sign: Eight| single(x + sign * (x.abs() * Eight::splat(STEP) + least));
        let one = Eight::splat(1.0);
        let most = f32x8::splat(f32::MAX);
        let inverse = |d: Eight| single(one / d).fast_min(most).fast_max(-most);
        Self {
            up: ray.origin.map(|x| rounded(x, one)),
            down: ray.origin.map(|x| rounded(x, -one)),
            inverse: ray.direction.map(inverse),
            ray,
        }
    }

    /// Tests one side of a cell.
    #[inline(always)]
    fn meets(&self, cell: &Cell, side: usize, reach: &Reach, lanes: u32) -> Met {
        let (mut near, mut far) = (reach.near, reach.far);
        for k in 0..3 {
            let a = (f32x8::splat(cell.low[k][side]) - self.up[k]) * self.inverse[k];
            let b = (f32x8::splat(cell.high[k][side]) - self.down[k]) * self.inverse[k];
            near = near.fast_max(a.fast_min(b));
            far = far.fast_min(a.fast_max(b));
        }
        let near = near * f32x8::splat(1.0 - SLACK);
        Met { near, lanes: lanes & bits(near.simd_le(far)) }
    }
}

impl Met {
    /// True if more lanes meet this sooner than the other.
    #[inline(always)]
    fn is_sooner(&self, other: &Self) -> bool {
        let here = self.lanes & !(other.lanes & bits(other.near.simd_le(self.near)));
        let there = other.lanes & !(self.lanes & bits(self.near.simd_le(other.near)));
        here.count_ones() > there.count_ones()
    }
}

impl Hierarchy {
    /// [`Hierarchy::nearest`] for the lanes that are `open`: `visit` is told which of them meet the item's box, and
    /// answers how far each of them has to look from then on. `from` is below 0 by rounding at most.
    #[inline]
    pub(crate) fn nearest_of_eight(
        &self,
        rays: &EightBoxRays,
        from: Eight,
        to: Eight,
        open: EightMask,
        visit: &mut impl FnMut(u32, EightMask) -> Eight,
    ) {
        let reach = Reach::new(from, to, open);
        if self.count <= SMALL {
            self.nearest_of_few_for_eight(rays, reach, visit);
        } else {
            self.nearest_of_many_for_eight(rays, reach, visit);
        }
    }

    #[inline(always)]
    fn nearest_of_few_for_eight(
        &self,
        rays: &EightBoxRays,
        mut reach: Reach,
        visit: &mut impl FnMut(u32, EightMask) -> Eight,
    ) {
        for item in 0..self.count {
            let here = rays.meets(&self.cells[item / 2], item % 2, &reach, reach.open);
            if here.lanes != 0 {
                reach.shorten(visit(index(item), EightMask::of_bits(here.lanes)));
            }
        }
    }

    fn nearest_of_many_for_eight(
        &self,
        rays: &EightBoxRays,
        mut reach: Reach,
        visit: &mut impl FnMut(u32, EightMask) -> Eight,
    ) {
        let everywhere = Met { near: f32x8::ZERO, lanes: 0 };
        let mut stack = [(Below::Cell(0), everywhere); STACK];
        let mut top = 0;
        let (mut below, mut lanes) = (Below::Cell(0), reach.open);
        while lanes != 0 {
            match below {
                Below::Item(item) => {
                    reach.shorten(visit(item, EightMask::of_bits(lanes)));
                    lanes = 0;
                }
                Below::Cell(number) => {
                    let cell = &self.cells[number as usize];
                    let met = [0, 1].map(|s| rays.meets(cell, s, &reach, lanes));
                    let side = match met.map(|met| met.lanes != 0) {
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
            while lanes == 0 && top > 0 {
                top -= 1;
                let met = stack[top].1;
                below = stack[top].0;
                lanes = met.lanes & reach.open & bits(met.near.simd_le(reach.far));
            }
        }
    }

    /// Shows `visit` the items whose boxes come near any of the probes; others, too.
    pub(crate) fn around_eight(&self, probes: &EightProbes, visit: &mut impl FnMut(u32)) {
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
                let corner = |c: &super::Corners| c.map(|pair| pair[s]);
                if !probes.near_box(&Box32 { low: corner(&cell.low), high: corner(&cell.high) }) {
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
    pub(crate) fn stab_eight(
        &self,
        rays: &EightBoxRays,
        mut at: Eight,
        open: EightMask,
        visit: &mut impl FnMut(u32, EightMask) -> Eight,
    ) {
        if self.count <= SMALL {
            (0..self.count).for_each(|item| at = visit(index(item), open));
            return;
        }
        let open = open.bits();
        let mut reach = Reach::at(at, open);
        let mut stack = [0_u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let cell = &self.cells[stack[top] as usize];
            for s in 0..2 {
                let met = rays.meets(cell, s, &reach, open);
                if met.lanes == 0 {
                    continue;
                }
                match cell.below[s] {
                    Below::Item(item) => {
                        at = visit(item, EightMask::of_bits(met.lanes));
                        reach = Reach::at(at, open);
                    }
                    Below::Cell(child) => {
                        stack[top] = child;
                        top += 1;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use scene::Bounds;

    /// A fixed sequence of numbers in −1…1.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }
    }

    fn lanes(vectors: [DVec3; Eight::LANES]) -> [Eight; 3] {
        std::array::from_fn(|k| Eight::new(vectors.map(|v| v[k])))
    }

    /// Rays to points of boxes of all sizes, some along axes and some in the planes of faces, never miss them.
    #[test]
    fn no_box_that_a_ray_meets_is_passed_over() {
        let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
        let mut tried = 0;
        for decade in -16..28 {
            let unit = libm::exp10(f64::from(decade));
            for count in [1, 3, 8, 60] {
                let boxes: Vec<_> = (0..count)
                    .map(|_| {
                        // As wide as the world down to a ten-millionth of it, and flat ones.
                        let half = numbers.vector().abs() * libm::exp10(7.0 * numbers.next() - 7.0);
                        let flat = if numbers.next() > 0.5 { DVec3::X } else { DVec3::ZERO };
                        let half = half * (DVec3::ONE - flat);
                        (Bounds::about(numbers.vector() * unit, half * unit), 1.0)
                    })
                    .collect();
                let tree = Hierarchy::build(&boxes);
                for (item, (bounds, _)) in (0..).zip(&boxes) {
                    let origins = [(); Eight::LANES].map(|()| numbers.vector() * unit);
                    let mut way = |lane: usize| {
                        let share = 0.5 + 0.5 * numbers.vector();
                        let mut point = bounds.low + share * (bounds.high - bounds.low);
                        let mut origin = origins[lane];
                        // Along an axis, along it but for a trace, and in the plane of a face.
                        if lane < 3 {
                            let trace = if lane == 2 { 1e-45 * unit } else { 0.0 };
                            origin = point + origin.length() * DVec3::Y + trace * DVec3::X;
                        } else if lane == 3 {
                            (point.x, origin.x) = (bounds.low.x, bounds.low.x);
                        }
                        let sight = point - origin;
                        (origin, sight / sight.length(), sight.length())
                    };
                    let ways: [_; Eight::LANES] = std::array::from_fn(&mut way);
                    let ray = Ray {
                        origin: lanes(ways.map(|way| way.0)),
                        direction: lanes(ways.map(|way| way.1)),
                    };
                    let rays = EightBoxRays::new(ray, unit);
                    let at = Eight::new(ways.map(|way| way.2));
                    // The point itself is known to a few units in the last place.
                    let trace = Eight::splat(4e-16 * unit) + at * Eight::splat(1e-15);
                    let zero = Eight::splat(0.0);
                    let from = Eight::select((at - trace).less(zero), zero, at - trace);
                    let mut met = 0;
                    tree.nearest_of_eight(
                        &rays,
                        from,
                        at + trace,
                        EightMask::first(Eight::LANES),
                        &mut |found, lanes| {
                            met |= if found == item { lanes.bits() } else { 0 };
                            at + trace
                        },
                    );
                    assert_eq!(met, 0xff, "box {item} of {count} at 1e{decade}: {bounds:?}");
                    let mut met = 0;
                    tree.stab_eight(&rays, at, EightMask::first(8), &mut |found, lanes| {
                        met |= if found == item { lanes.bits() } else { 0 };
                        at
                    });
                    // A point on a face may be off it by rounding; whoever asks widens boxes by that.
                    assert!(met.count_ones() >= 4, "box {item} of {count} at 1e{decade}");
                    tried += Eight::LANES;
                }
            }
        }
        assert!(tried > 20_000, "{tried} rays say something");
    }
}
