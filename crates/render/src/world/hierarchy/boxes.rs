//! A tree gone through box by box from the root, as the paper goes through its binary trees.

use glam::DVec3;
use scene::Bounds;

use super::{Below, BoxRay, Hierarchy, SLACK, SMALL, STACK, index};

impl BoxRay {
    /// True if the ray meets the box from `start` on: one box by itself.
    #[inline]
    pub(crate) fn meets_after(&self, bounds: &Bounds, start: f64) -> bool {
        let (mut near, mut far) = (start, f64::INFINITY);
        for k in 0..3 {
            let a = (bounds.low[k] - self.ray.origin[k]) * self.inverse[k];
            let b = (bounds.high[k] - self.ray.origin[k]) * self.inverse[k];
            let (first, last) = if a < b { (a, b) } else { (b, a) };
            near = if first > near { first } else { near };
            far = if last < far { last } else { far };
        }
        near * (1.0 - SLACK) <= far * (1.0 + SLACK)
    }
}

/// Who asks about the boxes of a tree, by their numbers, and about its items.
pub(crate) trait Descent {
    /// Whether to look into a box.
    fn enter(&mut self, number: u32, bounds: &Bounds) -> bool;
    /// An item in boxes that were all entered; whether the ray meets it.
    fn item(&mut self, item: u32) -> bool;
    /// The ray has met an item in this box.
    fn met(&mut self, number: u32);
}

/// A cell under way: the side to look at next, and whether something in it was met.
type Visit = (u32, u32, bool);

impl Hierarchy {
    /// How many boxes are numbered, some of them of no use.
    pub(crate) fn box_count(&self) -> u32 {
        index(2 * self.cells.len())
    }

    /// The box of a number.
    pub(crate) fn numbered(&self, number: u32) -> Bounds {
        let (cell, side) = (&self.cells[number as usize / 2], number as usize % 2);
        let corner = |corners: &super::Corners| {
            DVec3::from_array(std::array::from_fn(|k| f64::from(corners[k][side])))
        };
        Bounds { low: corner(&cell.low), high: corner(&cell.high) }
    }

    /// What is joined of all items in each box, by its number.
    pub(crate) fn folded<T: Copy>(
        &self,
        nothing: T,
        item: impl Fn(u32) -> T,
        join: impl Fn(T, T) -> T,
    ) -> Vec<T> {
        let mut found = vec![nothing; 2 * self.cells.len()];
        // Cells stand before those below them.
        for (number, cell) in self.cells.iter().enumerate().rev() {
            for (side, below) in cell.below.iter().enumerate() {
                found[2 * number + side] = match *below {
                    Below::Item(only) if (only as usize) < self.count => item(only),
                    Below::Item(_) => nothing,
                    Below::Cell(inner) => {
                        let inner = 2 * inner as usize;
                        join(found[inner], found[inner + 1])
                    }
                };
            }
        }
        found
    }

    /// Goes down into all boxes that `descent` enters. Items have no box of their own here, nor have few of them.
    pub(crate) fn descend(&self, descent: &mut impl Descent) {
        if self.count <= SMALL {
            for item in 0..self.count {
                descent.item(index(item));
            }
            return;
        }
        let mut stack: [Visit; STACK] = [(0, 0, false); STACK];
        let mut top = 1;
        while top > 0 {
            let (cell, side, met) = stack[top - 1];
            if side == 2 {
                top -= 1;
                if let (true, Some((outer, next, any))) = (met, stack[..top].last_mut()) {
                    *any = true;
                    descent.met(2 * *outer + *next - 1);
                }
                continue;
            }
            stack[top - 1].1 += 1;
            match self.cells[cell as usize].below[side as usize] {
                Below::Item(item) => stack[top - 1].2 |= descent.item(item),
                Below::Cell(inner) => {
                    let number = 2 * cell + side;
                    if descent.enter(number, &self.numbered(number)) {
                        stack[top] = (inner, 0, false);
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
    use scene::Ray;

    /// Enters what a ray meets, and meets items whose boxes it does.
    struct Asked<'a> {
        ray: BoxRay,
        boxes: &'a [(Bounds, f64)],
        items: Vec<u32>,
        entered: Vec<u32>,
        met: Vec<u32>,
    }

    impl Descent for Asked<'_> {
        fn enter(&mut self, number: u32, bounds: &Bounds) -> bool {
            let enters = self.ray.meets_after(bounds, 0.0);
            if enters {
                self.entered.push(number);
            }
            enters
        }

        fn item(&mut self, item: u32) -> bool {
            let met = self.ray.meets_after(&self.boxes[item as usize].0, 0.0);
            if met {
                self.items.push(item);
            }
            met
        }

        fn met(&mut self, number: u32) {
            self.met.push(number);
        }
    }

    #[test]
    fn boxes_hold_what_is_joined_of_their_items() {
        let boxes: Vec<(Bounds, f64)> = (0..40)
            .map(|k| (Bounds::about(DVec3::splat(f64::from(k * 7 % 40)), DVec3::splat(0.25)), 1.0))
            .collect();
        let tree = Hierarchy::build(&boxes);
        let hulls = tree.folded(Bounds::EMPTY, |item| boxes[item as usize].0, Bounds::hull);
        for (number, hull) in (0..tree.box_count()).zip(hulls) {
            assert_eq!(
                (hull.low, hull.high),
                (tree.numbered(number).low, tree.numbered(number).high)
            );
        }
    }

    #[test]
    fn a_descent_meets_what_the_ray_meets_and_tells_of_the_boxes_around_it() {
        let cube = |k: u32| {
            let place = DVec3::new(f64::from(k % 7), f64::from(k / 7 % 7), f64::from(k % 5));
            (Bounds::about(2.0 * place, DVec3::splat(0.6)), 1.0)
        };
        for count in [1, 8, 9, 150] {
            let boxes: Vec<(Bounds, f64)> = (0..count).map(cube).collect();
            let tree = Hierarchy::build(&boxes);
            for k in 0..20 {
                let (x, y) = (f64::from(k % 5) * 2.9 + 0.1, f64::from(k / 5) * 3.1 - 0.2);
                let origin = DVec3::new(x, y, -3.0);
                let direction = DVec3::new(0.1 - 0.01 * x, 0.05, 1.0).normalize();
                let ray = BoxRay::new(Ray::new(origin, direction));
                let (items, entered, met) = (Vec::new(), Vec::new(), Vec::new());
                let mut asked = Asked { ray, boxes: &boxes, items, entered, met };
                tree.descend(&mut asked);
                asked.items.sort_unstable();
                let all = (0..count).filter(|&k| ray.meets_after(&boxes[k as usize].0, 0.0));
                assert_eq!(asked.items, all.collect::<Vec<_>>(), "{count}, {k}");
                assert!(
                    asked.met.iter().all(|number| asked.entered.contains(number)),
                    "{count}, {k}"
                );
                // Every box around something that was met is told once, and no other.
                let holds = |number: u32, item: u32| {
                    let (outer, inner) = (tree.numbered(number), boxes[item as usize].0);
                    outer.contains(inner.low) && outer.contains(inner.high)
                };
                let mut told = asked.met.clone();
                told.sort_unstable();
                told.dedup();
                assert_eq!(told.len(), asked.met.len(), "{count}, {k}: once");
                let around = |number: &u32| asked.items.iter().any(|&item| holds(*number, item));
                assert!(asked.met.iter().all(around), "{count}, {k}");
                assert!(
                    count <= 8 || asked.items.is_empty() || !asked.met.is_empty(),
                    "{count}, {k}"
                );
            }
        }
    }
}
