//! Median cut (Heckbert, "Color Image Quantization for Frame Buffer Display", SIGGRAPH 1982).

use std::collections::BTreeMap;

use crate::histogram::Histogram;

/// A cell of 5 bits for each channel, and its pixels. Opaque cells have an alpha of [`OPAQUE`].
type Cell = ([u8; 4], u64);

/// Cells in a box that is shrunk to them.
struct Part {
    cells: Vec<Cell>,
    pixels: u64,
    /// Longest side, and how long it is: 0 where there is one cell.
    longest: (usize, u8),
}

/// Beyond the cells of alpha, so that no box of both is made: they begin in boxes of their own.
const OPAQUE: u8 = 32;

/// A table of at most `most` colours. Colours are first cut to 5 bits; a box is cut at the median
/// of its pixels across its longest side (of green, red, blue, alpha the first); the box of most
/// pixels is cut next; the entry of a box is the mean of its cells' centres by pixels, rounded.
pub(crate) fn median_cut(histogram: &Histogram, most: usize) -> Vec<[u8; 4]> {
    let mut parts: Vec<Part> = [opaque(histogram), translucent(histogram)]
        .into_iter()
        .filter(|cells| !cells.is_empty())
        .map(Part::new)
        .collect();
    parts.truncate(most);
    while parts.len() < most {
        let mut largest: Option<usize> = None;
        for (at, part) in parts.iter().enumerate().filter(|(_, part)| part.longest.1 > 0) {
            if largest.is_none_or(|other| part.pixels > parts[other].pixels) {
                largest = Some(at);
            }
        }
        let Some(at) = largest else { break };
        let (low, high) = parts[at].halves();
        parts[at] = low;
        parts.push(high);
    }
    parts.iter().map(Part::entry).collect()
}

/// Cells of opaque pixels, ascending.
fn opaque(histogram: &Histogram) -> Vec<Cell> {
    const STEPS: usize = 1 << 5;
    let mut pixels = vec![0; STEPS * STEPS * STEPS];
    histogram.each_opaque(|color, times| {
        let [red, green, blue] = color.map(|byte| usize::from(byte >> 3));
        pixels[(red * STEPS + green) * STEPS + blue] += times;
    });
    let cells = pixels.iter().zip(0_u16..).filter(|(times, _)| **times > 0);
    let steps = |at: u16| [at >> 10, at >> 5, at].map(|steps| (steps & 31) as u8);
    let cells = cells.map(|(&times, at)| {
        let [red, green, blue] = steps(at);
        ([red, green, blue, OPAQUE], times)
    });
    cells.collect()
}

/// Cells of translucent pixels, ascending.
fn translucent(histogram: &Histogram) -> Vec<Cell> {
    let mut cells: BTreeMap<[u8; 4], u64> = BTreeMap::new();
    for &(color, times) in histogram.translucent() {
        *cells.entry(color.map(|byte| byte >> 3)).or_default() += u64::from(times);
    }
    cells.into_iter().collect()
}

impl Part {
    fn new(cells: Vec<Cell>) -> Self {
        let (mut least, mut most, mut pixels) = ([u8::MAX; 4], [0; 4], 0);
        for (cell, times) in &cells {
            for axis in 0..4 {
                least[axis] = least[axis].min(cell[axis]);
                most[axis] = most[axis].max(cell[axis]);
            }
            pixels += times;
        }
        let side = |axis: usize| most[axis] - least[axis];
        let mut longest = (1, side(1));
        for axis in [0, 2, 3] {
            if side(axis) > longest.1 {
                longest = (axis, side(axis));
            }
        }
        Self { cells, pixels, longest }
    }

    /// Both sides of the median plane. It belongs to the lower half unless that would leave the
    /// upper one empty.
    fn halves(&self) -> (Self, Self) {
        let axis = self.longest.0;
        let mut planes = [0; OPAQUE as usize + 1];
        for (cell, times) in &self.cells {
            planes[usize::from(cell[axis])] += times;
        }
        let mut below = 0;
        let mut median = 0;
        for (plane, pixels) in (0..).zip(planes) {
            below += pixels;
            if 2 * below >= self.pixels {
                median = plane;
                break;
            }
        }
        let is_last = below == self.pixels;
        let (low, high) = self
            .cells
            .iter()
            .partition(|(cell, _)| cell[axis] < median || cell[axis] == median && !is_last);
        (Self::new(low), Self::new(high))
    }

    fn entry(&self) -> [u8; 4] {
        std::array::from_fn(|channel| {
            if channel == 3 && self.cells[0].0[3] == OPAQUE {
                return u8::MAX;
            }
            // The centre of a cell is 8 c + 3.5; twice that keeps it whole.
            let twice = |cell: &[u8; 4]| 16 * u64::from(cell[channel]) + 7;
            let sum: u64 = self.cells.iter().map(|(cell, times)| twice(cell) * times).sum();
            u8::try_from((sum + self.pixels) / (2 * self.pixels)).unwrap_or(u8::MAX)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pixels;

    fn table(colors: Vec<[u8; 4]>, most: usize) -> Vec<[u8; 4]> {
        let columns = u32::try_from(colors.len()).unwrap();
        let pixels = Pixels::new(columns, 1, colors).unwrap();
        median_cut(&Histogram::new(&[&pixels], 0, false), most)
    }

    fn opaque([red, green, blue]: [u8; 3]) -> [u8; 4] {
        [red, green, blue, u8::MAX]
    }

    /// Eight pixels in seven cells: the last two share one.
    const PIXELS: [[u8; 3]; 8] = [
        [255, 0, 0],
        [250, 10, 5],
        [0, 255, 0],
        [5, 250, 10],
        [0, 0, 255],
        [10, 5, 250],
        [255, 255, 255],
        [248, 248, 248],
    ];

    #[test]
    fn eight_pixels_by_hand() {
        // All sides are 31 cells long, so green is cut; 4 of 8 pixels have 0 or 1 there. Centres of
        // cells are 3.5, 11.5 and 251.5: the means of the lower half are 129.5, 5.5 and 127.5, those of
        // the upper 127.5, 251.5 and 129.5.
        let two = table(PIXELS.map(opaque).into(), 2);
        assert_eq!(two, [[130, 6, 128, 255], [128, 252, 130, 255]]);
        let four = table(PIXELS.map(opaque).into(), 4);
        let expected = [[8, 4, 252, 255], [4, 252, 8, 255], [252, 8, 4, 255], [252, 252, 252, 255]];
        assert_eq!(four, expected);
        assert_eq!(table(PIXELS.map(opaque).into(), 256).len(), 7);
    }

    #[test]
    fn clear_and_translucent_pixels_do_not_touch_opaque_entries() {
        let colors = vec![[9, 9, 9, 255], [200, 9, 9, 255], [9, 9, 9, 100], [9, 9, 9, 0]];
        let entries = table(colors, 2);
        assert_eq!(entries, [[108, 12, 12, 255], [12, 12, 12, 100]]);
    }

    /// Median cut the plain way: all pixels kept and sorted, boxes found again for every cut.
    fn plain(pixels: &[[u8; 4]], most: usize) -> Vec<[u8; 4]> {
        let cell = |color: &[u8; 4]| color.map(|byte| byte / 8);
        let mut boxes: Vec<Vec<[u8; 4]>> = vec![pixels.iter().map(cell).collect()];
        let side = |part: &[[u8; 4]], axis: usize| {
            let mut sorted: Vec<u8> = part.iter().map(|cell| cell[axis]).collect();
            sorted.sort_unstable();
            sorted[sorted.len() - 1] - sorted[0]
        };
        let longest = |part: &[[u8; 4]]| {
            let mut axes = [1, 0, 2];
            axes.sort_by_key(|&axis| std::cmp::Reverse(side(part, axis)));
            axes[0]
        };
        while boxes.len() < most {
            let mut order: Vec<usize> = (0..boxes.len()).collect();
            order.retain(|&at| side(&boxes[at], longest(&boxes[at])) > 0);
            order.sort_by_key(|&at| std::cmp::Reverse(boxes[at].len()));
            let Some(&at) = order.first() else { break };
            let axis = longest(&boxes[at]);
            let mut sorted = boxes[at].clone();
            sorted.sort_by_key(|cell| cell[axis]);
            let median = sorted[sorted.len().div_ceil(2) - 1][axis];
            let last = sorted[sorted.len() - 1][axis];
            let is_low = |c: &[u8; 4]| c[axis] < median || c[axis] == median && median < last;
            let (low, high) = sorted.iter().partition(|cell| is_low(cell));
            boxes[at] = low;
            boxes.push(high);
        }
        let mean = |part: &Vec<[u8; 4]>| {
            let channel = |axis: usize| {
                let twice: usize = part.iter().map(|cell| 16 * usize::from(cell[axis]) + 7).sum();
                u8::try_from((twice + part.len()) / 2 / part.len()).unwrap()
            };
            [channel(0), channel(1), channel(2), 255]
        };
        boxes.iter().map(mean).collect()
    }

    #[test]
    fn it_agrees_with_the_plain_way() {
        let mut state = 5_u32;
        let pixels: Vec<[u8; 4]> = (0..900)
            .map(|at: u32| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let [a, b, c, _] = state.to_be_bytes();
                if at.is_multiple_of(3) { [a, b, c, 255] } else { [a / 4, 200 - b / 8, c / 2, 255] }
            })
            .collect();
        for most in [1, 2, 3, 10, 64, 200] {
            assert_eq!(table(pixels.clone(), most), plain(&pixels, most), "{most}");
        }
    }
}
