//! Colours moved into the hull of a coarse table: what no mix of its entries can show is taken
//! from the picture before it is dithered.
//!
//! Errors that no entry makes up for would else grow from pixel to pixel, and drown those that
//! could be made up for: a red area in grey entries would lose its shades.

use std::sync::OnceLock;

use ilut::nearest_in_hull;

use crate::grid::{Grid, whole};

/// Most entries of a table that is coarse. More of them are seldom far from a picture's colours,
/// and moving colours would cost more than it brings.
pub(crate) const MOST_ENTRIES: usize = 64;
/// Length of a cell's edge, in display steps.
const EDGE: f32 = 16.0;
/// Steps of the search for it.
const MOST_STEPS: usize = 100;

/// The nearest places in the hull, at the corners of cells; between them it is interpolated. A
/// mean of places in the hull is in the hull.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    entries: Vec<[f32; 3]>,
    least: [f32; 4],
    counts: [usize; 3],
    /// Found when first asked for: pictures have colours in a tenth of the cells.
    corners: Vec<OnceLock<[f32; 3]>>,
}

impl Hull {
    /// The hull of the opaque entries, if they are few.
    pub(crate) fn of(grid: &Grid) -> Option<Self> {
        let entries = grid.opaque_places();
        if !(1..=MOST_ENTRIES).contains(&entries.len()) {
            return None;
        }
        let bounds = grid.bounds();
        let counts: [usize; 3] =
            std::array::from_fn(|axis| whole((bounds.most[axis] - bounds.least[axis]) / EDGE) + 2);
        let corners = vec![OnceLock::new(); counts.iter().product()];
        Some(Self { entries, least: bounds.least, counts, corners })
    }

    /// The place in the hull nearest to a corner. It does not depend on who asks first.
    #[inline]
    fn corner(&self, at: usize) -> [f32; 3] {
        *self.corners[at].get_or_init(|| {
            let steps = [at / (self.counts[1] * self.counts[2]), at / self.counts[2], at];
            let place = std::array::from_fn(|axis| {
                let steps = u16::try_from(steps[axis] % self.counts[axis]).expect("few corners");
                self.least[axis] + EDGE * f32::from(steps)
            });
            nearest_in_hull(place, &self.entries, MOST_STEPS, &mut Vec::new())
        })
    }

    /// A place (in the grid's box) moved into the hull, or very near to it.
    pub(crate) fn pulled(&self, place: [f32; 4]) -> [f32; 4] {
        let mut corner = [0; 3];
        let mut share = [0.0; 3];
        for axis in 0..3 {
            let along = (place[axis] - self.least[axis]) * (1.0 / EDGE);
            corner[axis] = whole(along);
            share[axis] = along.fract();
        }
        let first = (corner[0] * self.counts[1] + corner[1]) * self.counts[2] + corner[2];
        let (row, plane) = (self.counts[2], self.counts[1] * self.counts[2]);
        let mixed = |a: [f32; 3], b: [f32; 3], share: f32| -> [f32; 3] {
            std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]))
        };
        let line = |at: usize| mixed(self.corner(at), self.corner(at + 1), share[2]);
        let side = |at: usize| mixed(line(at), line(at + row), share[1]);
        let [x, y, z] = mixed(side(first), side(first + plane), share[0]);
        [x, y, z, place[3]]
    }
}

#[cfg(test)]
mod tests {
    use ilut::{Metric, Table};

    use super::*;

    fn hull(colors: &[[u8; 3]]) -> Hull {
        let colors = colors.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
        Hull::of(&Grid::new(&Table::new(colors).unwrap(), Metric::Rgb)).unwrap()
    }

    fn near(hull: &Hull, [x, y, z]: [f32; 3], expected: [f32; 3]) {
        let found = hull.pulled([x, y, z, 0.0]);
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 0.6, "{found:?}, expected {expected:?}");
    }

    #[test]
    fn on_a_line_of_greys_the_mean_of_the_channels_is_left() {
        let hull = hull(&[[0; 3], [85; 3], [170; 3], [255; 3]]);
        for [r, g, b] in [[200.0, 10.0, 30.0], [90.0, 91.0, 92.0], [20.0, 250.0, 180.0]] {
            near(&hull, [r, g, b], [(r + g + b) / 3.0; 3]);
        }
    }

    #[test]
    fn inside_nothing_moves_and_outside_it_is_to_the_face() {
        let corner = |at: u8| [0, 1, 2].map(|axis| if at >> axis & 1 == 1 { 200 } else { 40 });
        let hull = hull(&(0..8).map(corner).collect::<Vec<_>>());
        near(&hull, [60.0, 100.0, 180.0], [60.0, 100.0, 180.0]);
        near(&hull, [0.0, 100.0, 120.0], [40.0, 100.0, 120.0]);
        near(&hull, [250.0, 100.0, 0.0], [200.0, 100.0, 40.0]);
    }

    #[test]
    fn one_color_takes_all_and_many_are_not_coarse() {
        near(&hull(&[[9, 8, 7]]), [255.0, 255.0, 255.0], [9.0, 8.0, 7.0]);
        let many = (0..65).map(|grey| [grey, grey, grey, 255]).collect();
        assert!(Hull::of(&Grid::new(&Table::new(many).unwrap(), Metric::Rgb)).is_none());
    }
}
