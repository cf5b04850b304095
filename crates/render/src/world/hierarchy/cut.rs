//! A tree cut down to the items that some rays can meet.

use glam::DVec3;
use scene::Bounds;

use super::{Below, Hierarchy, SMALL, index};

/// What is left below one side of a cell, and the cell and side of the whole tree whose box holds it most closely.
#[derive(Clone, Copy)]
struct Kept {
    below: Below,
    cell: usize,
    side: usize,
}

/// A cell and its side.
type Place = (usize, usize);

/// A tree under the saw.
struct Cut<'h, M> {
    whole: &'h Hierarchy,
    meets: M,
    most: usize,
    left: Hierarchy,
    /// Old numbers of the items that are left, and where their boxes are.
    items: Vec<(u32, usize, usize)>,
}

impl Hierarchy {
    /// The tree of the items whose boxes are met, numbered anew, and their old numbers; nothing if they are more than
    /// `most`.
    pub(crate) fn cut_down(
        &self,
        meets: impl Fn(&Bounds) -> bool,
        most: usize,
    ) -> Option<(Self, Vec<u32>)> {
        let (left, items) = (Self::default(), Vec::new());
        let mut cut = Cut { whole: self, meets, most, left, items };
        if self.count <= SMALL {
            for item in 0..self.count {
                cut.side((item / 2, item % 2), Below::Item(index(item)));
            }
        } else {
            // The root is the first cell.
            cut.left.grow();
            if let Some(Kept { below: Below::Cell(root), .. }) = cut.cell(0, (0, 0)) {
                cut.left.cells[0] = cut.left.cells[root as usize];
                cut.left.magnitudes[0] = cut.left.magnitudes[root as usize];
            }
        }
        let Cut { mut left, items, .. } = cut;
        if items.len() > most {
            return None;
        }
        left.count = items.len();
        if items.len() <= SMALL {
            left = self.few_of(&items);
        }
        Some((left, items.into_iter().map(|(item, ..)| item).collect()))
    }

    /// A tree of a few items of this one.
    fn few_of(&self, items: &[(u32, usize, usize)]) -> Self {
        let boxes: Vec<_> = items
            .iter()
            .map(|&(_, cell, side)| {
                (self.side_bounds(cell, side), f64::from(self.magnitudes[cell][side]))
            })
            .collect();
        Self::build(&boxes)
    }

    fn side_bounds(&self, cell: usize, side: usize) -> Bounds {
        let cell = &self.cells[cell];
        let corner = |c: &super::Corners| DVec3::from_array(c.map(|x| f64::from(x[side])));
        Bounds { low: corner(&cell.low), high: corner(&cell.high) }
    }
}

impl<M: Fn(&Bounds) -> bool> Cut<'_, M> {
    /// What is left below one side of a cell. Trees are not deep: see [`super::STACK`].
    fn side(&mut self, place: Place, below: Below) -> Option<Kept> {
        let (cell, side) = place;
        if self.items.len() > self.most || !(self.meets)(&self.whole.side_bounds(cell, side)) {
            return None;
        }
        match below {
            Below::Item(item) => {
                self.items.push((item, cell, side));
                Some(Kept { below: Below::Item(index(self.items.len() - 1)), cell, side })
            }
            Below::Cell(child) => self.cell(child as usize, place),
        }
    }

    /// What is left of a cell that stands at `place`.
    fn cell(&mut self, number: usize, place: Place) -> Option<Kept> {
        let [first, second] = self.whole.cells[number].below;
        match (self.side((number, 0), first), self.side((number, 1), second)) {
            (Some(first), Some(second)) => {
                let cell = self.left.grow();
                self.fill((cell, 0), first);
                self.fill((cell, 1), second);
                Some(Kept { below: Below::Cell(index(cell)), cell: place.0, side: place.1 })
            }
            // A cell of one is none.
            (only, None) | (None, only) => only,
        }
    }

    fn fill(&mut self, (cell, side): Place, kept: Kept) {
        let from = &self.whole.cells[kept.cell];
        self.left.magnitudes[cell][side] = self.whole.magnitudes[kept.cell][kept.side];
        let to = &mut self.left.cells[cell];
        to.below[side] = kept.below;
        for k in 0..3 {
            to.low[k][side] = from.low[k][kept.side];
            to.high[k][side] = from.high[k][kept.side];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::hierarchy::BoxRay;
    use scene::Ray;

    #[test]
    fn a_tree_cut_down_finds_what_the_whole_one_finds() {
        let place = |k: u32| DVec3::new(f64::from(k % 7), f64::from(k / 7 % 7), f64::from(k / 49));
        for count in [0, 1, 2, 5, 8, 9, 30, 343] {
            let boxes: Vec<_> =
                (0..count).map(|k| (Bounds::about(place(k), DVec3::splat(0.3)), 1.0)).collect();
            let whole = Hierarchy::build(&boxes);
            for edge in [-1.0, 0.2, 1.5, 2.4, 9.0] {
                let meets = |bounds: &Bounds| bounds.low.x < edge && bounds.low.z < edge;
                let (left, items) = whole.cut_down(meets, 1000).expect("not too many");
                let expected = (0..count).filter(|&k| meets(&boxes[k as usize].0));
                let mut sorted = items.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, expected.collect::<Vec<_>>(), "{count} up to {edge}");
                assert_eq!(
                    whole.cut_down(meets, items.len()).map(|cut| cut.1),
                    Some(items.clone())
                );
                let fewer = items.len().checked_sub(1).and_then(|most| whole.cut_down(meets, most));
                assert!(fewer.is_none(), "{count} up to {edge}: too many");
                for at in 0..7 {
                    let start = DVec3::new(f64::from(at) + 0.1, 3.1, -5.0);
                    let ray = BoxRay::new(Ray::new(start, DVec3::new(0.01, 0.02, 1.0)));
                    let found = |tree: &Hierarchy, name: &dyn Fn(u32) -> u32| {
                        let mut found = Vec::new();
                        tree.nearest(&ray, 0.0, f64::INFINITY, &mut |item, to| {
                            found.push(name(item));
                            to
                        });
                        found.sort_unstable();
                        found
                    };
                    let mut all = found(&whole, &|item| item);
                    all.retain(|item| items.contains(item));
                    assert_eq!(found(&left, &|item| items[item as usize]), all, "{count}, {edge}");
                }
            }
        }
    }
}
