//! Samples to pixels. Two halves of the samples are kept apart: their difference tells how far off the picture is.

use scene::Rgb;

use crate::options::Filter;
use crate::sampling::estimate;
use crate::trace::record::Seen;

/// Sum of the samples of one half of a pixel, or their mean.
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
    /// Column and row of its first pixel in the whole picture.
    origin: [u32; 2],
}

/// A piece of the film.
#[derive(Clone, Debug)]
pub(crate) struct FilmTile {
    pub(crate) columns: u32,
    /// Row by row from the top. The second half is empty where one sample a pixel leaves nothing for it.
    pub(crate) halves: [Vec<Half>; 2],
}

/// A rectangle of pixels whose samples are taken together; the first pixel of the picture is (0, 0).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Of its first pixel; outside of the picture where samples there count in it.
    pub(crate) column: i32,
    pub(crate) row: i32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Piece {
    pub(crate) fn area(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// With so many pixels more on each side.
    pub(crate) fn grown(&self, by: u32) -> Self {
        let side = i32::try_from(by).expect("small");
        Self {
            column: self.column - side,
            row: self.row - side,
            width: self.width + 2 * by,
            height: self.height + 2 * by,
        }
    }

    /// If a pixel of the picture is in it.
    pub(crate) fn contains(&self, [column, row]: [u32; 2]) -> bool {
        let inside = |at: u32, first: i32, side: u32| {
            let off = i64::from(at) - i64::from(first);
            (0..i64::from(side)).contains(&off)
        };
        inside(column, self.column, self.width) && inside(row, self.row, self.height)
    }

    /// Column and row of a pixel by its number, row by row.
    pub(crate) fn pixel(&self, number: usize) -> [i32; 2] {
        let number = i32::try_from(number).expect("a piece is small");
        let width = i32::try_from(self.width).expect("a piece is small");
        [self.column + number % width, self.row + number / width]
    }

    /// The numbers of all pixels, a block of neighbours after the other: rays that are followed together should meet the
    /// same things.
    pub(crate) fn in_blocks(&self) -> Vec<usize> {
        // As many as rays are sought together.
        const ACROSS: usize = 4;
        const DOWN: usize = 2;
        let (width, height) = (self.width as usize, self.height as usize);
        let mut numbers = Vec::with_capacity(width * height);
        for top in (0..height).step_by(DOWN) {
            for left in (0..width).step_by(ACROSS) {
                for row in top..height.min(top + DOWN) {
                    numbers.extend((left..width.min(left + ACROSS)).map(|at| row * width + at));
                }
            }
        }
        numbers
    }
}

/// What samples of a piece are added to.
pub(crate) trait Sums {
    /// Adds `weight` times what is seen at `place` (0…1 each way) of a pixel of the piece, by its number.
    fn add(&mut self, half: usize, pixel: usize, place: [f64; 2], weight: f32, light: Half);
}

/// Sums with their weights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Weighed {
    pub(crate) sum: Half,
    pub(crate) weight: f32,
}

/// Samples of a piece whose filter reaches beyond the pixel, in all pixels that they count in.
#[derive(Clone, Debug)]
pub(crate) struct WideTile {
    piece: Piece,
    filter: Filter,
    halves: [Vec<Weighed>; 2],
}

/// Most light of a sample: as many as a pixel can have add up to a number of f32.
const BRIGHTEST: f64 = 1e33;

impl Half {
    /// What a sample saw.
    pub(crate) fn of(seen: &Seen, clamp: bool, background: Rgb) -> Self {
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
        Self { color: color.to_array().map(small), coverage: small(seen.coverage) }
    }

    #[inline]
    pub(crate) fn add(&mut self, weight: f32, other: &Self) {
        for (sum, channel) in self.color.iter_mut().zip(other.color) {
            *sum += weight * channel;
        }
        self.coverage += weight * other.coverage;
    }

    pub(crate) fn scaled(&self, factor: f32) -> Self {
        Self { color: self.color.map(|c| factor * c), coverage: factor * self.coverage }
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

impl Sums for FilmTile {
    #[inline]
    fn add(&mut self, half: usize, pixel: usize, _: [f64; 2], weight: f32, light: Half) {
        self.halves[half][pixel].add(weight, &light);
    }
}

impl Weighed {
    #[inline]
    pub(crate) fn add(&mut self, weight: f32, light: &Half) {
        self.sum.add(weight, light);
        self.weight += weight;
    }

    /// `count` times the mean. Negative lobes may leave hardly any weight where samples are few: no sum is blown up by
    /// more than four.
    pub(crate) fn mean(&self, count: u32) -> Half {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let count = count as f32;
        self.sum.scaled(count / if self.weight > 0.25 { self.weight } else { 0.25 })
    }
}

/// What a sample at `place` of a pixel counts for in the pixels around it, along one axis.
pub(crate) fn weights(filter: Filter, place: f64) -> impl Iterator<Item = f32> + Clone {
    let reach = filter.reach();
    (0..=2 * reach).map(move |step| {
        let centre = f64::from(step) - f64::from(reach) + 0.5;
        #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
        let weight = filter.weight(centre - place) as f32;
        weight
    })
}

impl WideTile {
    /// An empty one; the second half has no room where it has no samples.
    pub(crate) fn new(piece: Piece, filter: Filter, counts: [u32; 2]) -> Self {
        let wide = |side: u32| (side + 2 * filter.reach()) as usize;
        let pixels = wide(piece.width) * wide(piece.height);
        let room = |count| vec![Weighed::default(); if count > 0 { pixels } else { 0 }];
        Self { piece, filter, halves: counts.map(room) }
    }
}

impl WideTile {
    /// Adds the mean of `count` samples of a pixel, whose sums are given for each pixel around it.
    pub(crate) fn gather(&mut self, half: usize, pixel: usize, count: u32, sums: &[Weighed]) {
        if count == 0 {
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let share = 1.0 / count as f32;
        let (width, beside) = (self.piece.width as usize, 2 * self.filter.reach() as usize + 1);
        let wide = width + beside - 1;
        for (step, sums) in sums.chunks_exact(beside).enumerate() {
            let first = (pixel / width + step) * wide + pixel % width;
            for (weighed, sum) in self.halves[half][first..].iter_mut().zip(sums) {
                weighed.sum.add(share, &sum.sum);
                weighed.weight += share * sum.weight;
            }
        }
    }
}

impl Sums for WideTile {
    fn add(&mut self, half: usize, pixel: usize, place: [f64; 2], weight: f32, light: Half) {
        let width = self.piece.width as usize;
        let wide = width + 2 * self.filter.reach() as usize;
        let across = weights(self.filter, place[0]);
        for (step, down) in weights(self.filter, place[1]).enumerate() {
            let first = (pixel / width + step) * wide + pixel % width;
            let row = &mut self.halves[half][first..];
            for (weighed, across) in row.iter_mut().zip(across.clone()) {
                weighed.add(weight * down * across, &light);
            }
        }
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
        Self { columns, rows, tiles, side, counts, origin: [0; 2] }
    }

    /// A film of pieces that overlap; what they have outside of it does not count. `origin` is the place of its first
    /// pixel in the picture.
    pub(crate) fn of_wide(
        (columns, rows): (u32, u32),
        origin: [u32; 2],
        counts: [u32; 2],
        tiles: Vec<WideTile>,
    ) -> Self {
        let corner = origin.map(|side| i32::try_from(side).expect("below 2¹⁶"));
        let pixels = columns as usize * rows as usize;
        let mut sums =
            counts.map(|count| vec![Weighed::default(); if count > 0 { pixels } else { 0 }]);
        for tile in tiles {
            let WideTile { piece, filter, halves } = tile;
            let outer = piece.grown(filter.reach());
            for (sums, half) in sums.iter_mut().zip(&halves) {
                for (at, weighed) in half.iter().enumerate() {
                    let [column, row] = outer.pixel(at);
                    let place = [column - corner[0], row - corner[1]].map(u32::try_from);
                    if let [Ok(column), Ok(row)] = place
                        && column < columns
                        && row < rows
                    {
                        let sum = &mut sums[row as usize * columns as usize + column as usize];
                        sum.sum.add(1.0, &weighed.sum);
                        sum.weight += weighed.weight;
                    }
                }
            }
        }
        let mean = |(sums, count): (Vec<Weighed>, u32)| {
            sums.iter().map(|sum| sum.mean(count)).collect::<Vec<_>>()
        };
        let [first, second] = sums;
        let halves = [mean((first, counts[0])), mean((second, counts[1]))];
        Self::whole((columns, rows), counts, halves).at(origin)
    }

    /// A film in one piece.
    pub(crate) fn whole(
        (columns, rows): (u32, u32),
        counts: [u32; 2],
        halves: [Vec<Half>; 2],
    ) -> Self {
        let tiles = vec![FilmTile { columns, halves }];
        Self { columns, rows, tiles, side: columns.max(rows), counts, origin: [0; 2] }
    }

    /// The same as that of a window of a picture, whose first pixel is at a column and row of it.
    pub(crate) fn at(self, origin: [u32; 2]) -> Self {
        Self { origin, ..self }
    }

    /// Column and row of the first pixel in the whole picture.
    #[must_use]
    pub fn origin(&self) -> [u32; 2] {
        self.origin
    }

    /// What is known of the root of the mean square error, in display steps, over a background: see
    /// [`estimate::error`]. Only for halves that know nothing of each other.
    pub(crate) fn error(&self, background: [f32; 3]) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let means = self.counts.map(|count| 1.0 / count.max(1) as f32);
        let halves: [Vec<Half>; 2] = std::array::from_fn(|half| {
            self.half(half).0.map(|sum| sum.scaled(means[half])).collect()
        });
        estimate::error([&halves[0], &halves[1]], self.counts, background)
    }

    /// Without the second half.
    pub(crate) fn of_first_half(mut self) -> Self {
        for tile in &mut self.tiles {
            tile.halves[1].clear();
        }
        Self { counts: [self.counts[0], 0], ..self }
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
        (0..self.rows).flat_map(|row| self.row(row))
    }

    /// The mean of all samples of each pixel of a row.
    pub(crate) fn row(&self, row: u32) -> impl Iterator<Item = Pixel> + '_ {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
        let n = (self.counts[0] + self.counts[1]) as f32;
        self.places_in(row).map(move |(tile, at)| {
            let a = tile.halves[0][at];
            let b = tile.halves[1].get(at).copied().unwrap_or_default();
            let color = std::array::from_fn(|k| (a.color[k] + b.color[k]) / n);
            Pixel { color, coverage: (a.coverage + b.coverage) / n }
        })
    }

    /// The tile of each pixel and the place in it, row by row from the top.
    fn places(&self) -> impl Iterator<Item = (&FilmTile, usize)> {
        (0..self.rows).flat_map(|row| self.places_in(row))
    }

    /// The same of a row.
    fn places_in(&self, row: u32) -> impl Iterator<Item = (&FilmTile, usize)> {
        let across = self.columns.div_ceil(self.side) as usize;
        let first = (row / self.side) as usize * across;
        self.tiles[first..first + across].iter().flat_map(move |tile| {
            let start = (row % self.side * tile.columns) as usize;
            (start..start + tile.columns as usize).map(move |at| (tile, at))
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
