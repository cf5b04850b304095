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
    /// Samples in the sum.
    pub count: u32,
}

/// The mean of some samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Linear red, green and blue, multiplied by coverage.
    pub color: [f32; 3],
    /// 0…1.
    pub coverage: f32,
}

/// A picture under way, or done.
#[derive(Clone, Debug)]
pub struct Film {
    columns: u32,
    rows: u32,
    /// Row by row from the top, two halves a pixel.
    halves: Vec<[Half; 2]>,
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
        for (sum, channel) in self.color.iter_mut().zip(color.to_array()) {
            *sum += channel as f32;
        }
        #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
        {
            self.coverage += seen.coverage as f32;
        }
        self.count += 1;
    }
}

impl Film {
    /// A film of finished rows.
    pub(crate) fn new(columns: u32, rows: u32, halves: Vec<[Half; 2]>) -> Self {
        debug_assert_eq!(halves.len(), columns as usize * rows as usize, "one entry a pixel");
        Self { columns, rows, halves }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// The sums of both halves, row by row from the top.
    #[must_use]
    pub fn halves(&self) -> &[[Half; 2]] {
        &self.halves
    }

    /// The mean of all samples of each pixel, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.halves.iter().map(|[a, b]| {
            #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
            let n = (a.count + b.count) as f32;
            let mean = |a: f32, b: f32| (a + b) / n;
            let color = std::array::from_fn(|k| mean(a.color[k], b.color[k]));
            Pixel { color, coverage: mean(a.coverage, b.coverage) }
        })
    }
}
