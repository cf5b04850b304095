//! Samples to pixels. Two halves of the samples are kept apart: their difference tells how far off the picture is.

use scene::Rgb;

use crate::trace::tree::Seen;

/// Sum of the samples of one half of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Half {
    /// Linear red, green and blue, without the background seen straight.
    pub color: [f32; 3],
    /// Share covered.
    pub coverage: f32,
}

/// The mean of some samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Linear red, green and blue, multiplied by coverage.
    pub color: [f32; 3],
    /// 0…1.
    pub coverage: f32,
}

/// A finished picture as sums of samples.
#[derive(Clone, Debug)]
pub struct Film {
    columns: u32,
    rows: u32,
    /// Row by row from the top. The second half is empty where one sample a pixel leaves nothing for it.
    halves: [Vec<Half>; 2],
    /// Samples in each sum.
    counts: [u32; 2],
}

impl Half {
    pub(crate) fn add(&mut self, seen: &Seen, clamp: bool, background: Rgb) {
        // Clamped as it will be shown: background included, then taken off again.
        let color = if clamp {
            let open = (1.0 - seen.coverage) * background;
            (seen.color + open).clamp(Rgb::ZERO, Rgb::ONE) - open
        } else {
            seen.color
        };
        #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
        let small = |x: f64| x as f32;
        for (sum, channel) in self.color.iter_mut().zip(color.to_array()) {
            *sum += small(channel);
        }
        self.coverage += small(seen.coverage);
    }
}

impl Film {
    /// An empty film for `counts` samples in the halves of each pixel.
    pub(crate) fn new(columns: u32, rows: u32, counts: [u32; 2]) -> Self {
        let pixels = columns as usize * rows as usize;
        let halves = counts.map(|count| vec![Half::default(); if count > 0 { pixels } else { 0 }]);
        Self { columns, rows, halves, counts }
    }

    /// Puts a piece of a row of one half in its place.
    pub(crate) fn put(&mut self, half: usize, column: u32, row: u32, piece: &[Half]) {
        let start = row as usize * self.columns as usize + column as usize;
        self.halves[half][start..start + piece.len()].copy_from_slice(piece);
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// The sums of one half, 0 or 1, row by row from the top, and the samples in each sum.
    #[must_use]
    pub fn half(&self, half: usize) -> (&[Half], u32) {
        (&self.halves[half], self.counts[half])
    }

    /// The mean of all samples of each pixel, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let n = (self.counts[0] + self.counts[1]) as f32;
        self.halves[0].iter().enumerate().map(move |(i, a)| {
            let b = self.halves[1].get(i).copied().unwrap_or_default();
            let color = std::array::from_fn(|k| (a.color[k] + b.color[k]) / n);
            Pixel { color, coverage: (a.coverage + b.coverage) / n }
        })
    }
}
