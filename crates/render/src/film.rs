//! Samples to pixels. Two halves of the samples are kept apart: their difference tells how far off the picture is.

use scene::Rgb;

use crate::trace::record::Seen;

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
    /// Tiles stay as they were made: putting them together would take a pass over the whole picture.
    tiles: Vec<FilmTile>,
    /// Side of a tile; the last ones across and down may be less.
    side: u32,
    /// Samples in each sum.
    counts: [u32; 2],
}

/// A piece of the film.
#[derive(Clone, Debug)]
pub(crate) struct FilmTile {
    pub(crate) columns: u32,
    /// Row by row from the top. The second half is empty where one sample a pixel leaves nothing for it.
    pub(crate) halves: [Vec<Half>; 2],
}

/// Most light of a sample: as many as a pixel can have add up to a number of f32.
const BRIGHTEST: f64 = 1e33;

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
        // Lights may be brighter than f32 holds.
        let color = color.clamp(Rgb::splat(-BRIGHTEST), Rgb::splat(BRIGHTEST));
        for (sum, channel) in self.color.iter_mut().zip(color.to_array()) {
            *sum += small(channel);
        }
        self.coverage += small(seen.coverage);
    }
}

impl FilmTile {
    /// An empty piece for `counts` samples in the halves of each pixel.
    pub(crate) fn new(columns: u32, rows: u32, counts: [u32; 2]) -> Self {
        let pixels = columns as usize * rows as usize;
        let halves = counts.map(|count| vec![Half::default(); if count > 0 { pixels } else { 0 }]);
        Self { columns, halves }
    }
}

impl Film {
    /// A film of all its tiles, row by row from the top.
    pub(crate) fn new(
        (columns, rows): (u32, u32),
        side: u32,
        counts: [u32; 2],
        tiles: Vec<FilmTile>,
    ) -> Self {
        Self { columns, rows, tiles, side, counts }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// The sums of one half, 0 or 1, row by row from the top, and the samples in each sum; no sums where there are no
    /// samples.
    pub fn half(&self, half: usize) -> (impl Iterator<Item = Half> + '_, u32) {
        let sums = self.places().filter_map(move |(tile, at)| tile.halves[half].get(at).copied());
        (sums, self.counts[half])
    }

    /// The mean of all samples of each pixel, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let n = (self.counts[0] + self.counts[1]) as f32;
        self.places().map(move |(tile, at)| {
            let a = tile.halves[0][at];
            let b = tile.halves[1].get(at).copied().unwrap_or_default();
            let color = std::array::from_fn(|k| (a.color[k] + b.color[k]) / n);
            Pixel { color, coverage: (a.coverage + b.coverage) / n }
        })
    }

    /// The tile of each pixel and the place in it, row by row from the top.
    fn places(&self) -> impl Iterator<Item = (&FilmTile, usize)> {
        let across = self.columns.div_ceil(self.side) as usize;
        (0..self.rows).flat_map(move |row| {
            let first = (row / self.side) as usize * across;
            self.tiles[first..first + across].iter().flat_map(move |tile| {
                let start = (row % self.side * tile.columns) as usize;
                (start..start + tile.columns as usize).map(move |at| (tile, at))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_row_by_row_from_tiles_of_any_size() {
        // 5 × 3 pixels in tiles of 2: each pixel holds its own number.
        let (columns, rows, side) = (5_u32, 3_u32, 2_u32);
        let mut tiles = Vec::new();
        for top in (0..rows).step_by(2) {
            for left in (0..columns).step_by(2) {
                let (width, height) = (side.min(columns - left), side.min(rows - top));
                let mut tile = FilmTile::new(width, height, [1, 0]);
                for (at, sum) in (0..).zip(&mut tile.halves[0]) {
                    let number = (top + at / width) * columns + left + at % width;
                    sum.coverage = f32::from(u8::try_from(number).unwrap());
                }
                tiles.push(tile);
            }
        }
        let film = Film::new((columns, rows), side, [1, 0], tiles);
        let numbers: Vec<f32> = film.pixels().map(|pixel| pixel.coverage).collect();
        let expected: Vec<f32> = (0_u8..15).map(f32::from).collect();
        assert_eq!(numbers, expected);
        assert_eq!((film.half(0).0.count(), film.half(1).0.count()), (15, 0));
    }
}
