//! Separable filters over bands of rows, with the edge repeated outward.

use std::ops::Range;

/// Rows that a thread filters at once; the rows beyond its ends that a filter reaches are worked
/// on twice.
pub(crate) const BAND: usize = 64;

/// Rows of a band of one channel, filtered across.
pub(crate) struct Across {
    rows: Vec<Vec<f32>>,
    first: isize,
}

/// The rows of `band` and as many beyond its ends as `reach`, as positions that may lie outside.
pub(crate) fn with_reach(band: &Range<usize>, reach: usize) -> Range<isize> {
    let signed = |row: usize| isize::try_from(row).expect("rows of an image in memory");
    signed(band.start) - signed(reach)..signed(band.end) + signed(reach)
}

/// The row that stands for one outside.
pub(crate) fn clamped(row: isize, rows: usize) -> usize {
    usize::try_from(row).unwrap_or(0).min(rows - 1)
}

/// `row` with its ends repeated `reach` times.
pub(crate) fn padded(row: &[f32], reach: usize) -> Vec<f32> {
    let [first, last] = [row.first(), row.last()].map(|end| end.copied().unwrap_or(0.0));
    let before = std::iter::repeat_n(first, reach);
    before.chain(row.iter().copied()).chain(std::iter::repeat_n(last, reach)).collect()
}

impl Across {
    /// No rows yet; the first that is added is `first`.
    pub(crate) fn new(first: isize) -> Self {
        Self { rows: Vec::new(), first }
    }

    /// Adds the next row: the padded one through `kernel`, an odd number of weights.
    pub(crate) fn push(&mut self, padded: &[f32], reach: usize, kernel: &[f32]) {
        let start = reach - kernel.len() / 2;
        let mut row = vec![0.0; padded.len() - 2 * reach];
        for (offset, &weight) in kernel.iter().enumerate() {
            add(&mut row, weight, &padded[start + offset..]);
        }
        self.rows.push(row);
    }

    /// Row `row` of the picture, filtered down by `kernel`.
    pub(crate) fn down(&self, row: usize, kernel: &[f32]) -> Vec<f32> {
        let offset = isize::try_from(row).expect("rows of an image in memory") - self.first;
        let centre = usize::try_from(offset).expect("a row of the band");
        let mut sum = vec![0.0; self.rows[centre].len()];
        let sources = &self.rows[centre - kernel.len() / 2..];
        for (&weight, source) in kernel.iter().zip(sources) {
            add(&mut sum, weight, source);
        }
        sum
    }
}

fn add(sum: &mut [f32], weight: f32, values: &[f32]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_repeated() {
        assert_eq!(padded(&[1.0, 2.0], 2), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!([clamped(-3, 4), clamped(2, 4), clamped(9, 4)], [0, 2, 3]);
        assert_eq!(with_reach(&(0..8), 3), -3..11);
    }

    #[test]
    fn a_filter_is_the_sum_of_its_weights_times_its_neighbours() {
        let mut across = Across::new(-1);
        for row in [[1.0, 2.0, 4.0], [1.0, 2.0, 4.0], [0.0, 0.0, 8.0]] {
            across.push(&padded(&row, 2), 2, &[1.0, 10.0, 100.0]);
        }
        // 1 + 10 + 200, 1 + 20 + 400, 2 + 40 + 400.
        assert_eq!(across.rows[0], [211.0, 421.0, 442.0]);
        assert_eq!(across.down(0, &[1.0]), [211.0, 421.0, 442.0]);
        assert_eq!(across.down(0, &[1.0, 0.0, 2.0]), [211.0, 421.0 + 1600.0, 442.0 + 1760.0]);
    }
}
