//! A picture at every scale: levels of half the size each, in linear light, and means over parts of it (Williams,
//! "Pyramidal Parametrics", 1983; several probes along a slanted part as in "Feline" of `McCormack` and others, 1999).

use glam::DVec2;
use scene::texture::{Edge, Placed};

/// A level: texels from the lower left, row by row upward, `N` channels each.
#[derive(Debug)]
struct Level<const N: usize> {
    columns: usize,
    rows: usize,
    texels: Vec<[f32; N]>,
}

/// A picture with all its levels, the largest first.
#[derive(Debug)]
pub(crate) struct Pyramid<const N: usize> {
    levels: Vec<Level<N>>,
}

/// What is between texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Between {
    /// Straight lines from each to the next, as pictures are shown.
    Straight,
    /// Arcs, quadratic B-splines: slopes have no steps, as reliefs need it.
    Curved,
}

/// Most probes along a slanted part. A part longer than this many of its widths is taken in a wider one: it is blurred.
const PROBES: f64 = 16.0;

impl<const N: usize> Pyramid<N> {
    /// All levels of a picture of `columns` by `rows` texels, row by row from the top.
    pub(crate) fn new(columns: usize, rows: usize, mut texels: Vec<[f32; N]>) -> Self {
        debug_assert_eq!(texels.len(), columns * rows, "a whole picture");
        for row in 0..rows / 2 {
            let (upper, lower) = texels.split_at_mut((rows - 1 - row) * columns);
            upper[row * columns..][..columns].swap_with_slice(&mut lower[..columns]);
        }
        let mut levels = vec![Level { columns, rows, texels }];
        while let Some(last) = levels.last().filter(|last| last.columns > 1 || last.rows > 1) {
            let next = last.halved();
            levels.push(next);
        }
        Self { levels }
    }

    /// Height over width.
    pub(crate) fn aspect(&self) -> f64 {
        self.levels[0].rows as f64 / self.levels[0].columns as f64
    }

    /// Mean over a part of the picture: a parallelogram about a place, by its edges in widths and heights of the picture.
    pub(crate) fn mean(&self, placed: &Placed, edges: [DVec2; 2], between: Between) -> [f64; N] {
        let size = DVec2::new(self.levels[0].columns as f64, self.levels[0].rows as f64);
        let [major, minor] = axes(edges.map(|edge| edge * size));
        let (length, width) = (major.length(), minor.length());
        // Not below a texel: between texels there is nothing finer.
        let width = width.max(length / PROBES).max(1.0);
        let level = libm::log2(width);
        let probes = if length > width { libm::ceil(length / width).min(PROBES) } else { 1.0 };
        let step = major / size / probes;
        let mut sum = [0.0; N];
        let mut probe = 0.0;
        while probe < probes {
            let away = probe + 0.5 - 0.5 * probes;
            let value = self.at_level(placed.place + away * step, placed.edges, level, between);
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += value / probes;
            }
            probe += 1.0;
        }
        sum
    }

    fn at_level(&self, place: DVec2, edges: [Edge; 2], level: f64, between: Between) -> [f64; N] {
        let last = self.levels.len() - 1;
        let lower = libm::floor(level);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 or more")]
        let index = (lower as usize).min(last);
        let fine = self.levels[index].at(place, edges, between);
        let share = level - lower;
        if index == last || share <= 0.0 {
            return fine;
        }
        let coarse = self.levels[index + 1].at(place, edges, between);
        std::array::from_fn(|channel| fine[channel] + share * (coarse[channel] - fine[channel]))
    }
}

/// The axes of the ellipse in a parallelogram with these edges, the longer first.
fn axes([a, b]: [DVec2; 2]) -> [DVec2; 2] {
    // Not a number where the surface has no direction there: nothing is known but the place.
    if !(a.is_finite() && b.is_finite()) {
        return [DVec2::ZERO; 2];
    }
    // Turned by this angle conjugate radii are perpendicular.
    let twice = libm::atan2(2.0 * a.dot(b), a.length_squared() - b.length_squared());
    let (sine, cosine) = (libm::sin(0.5 * twice), libm::cos(0.5 * twice));
    let (first, second) = (cosine * a + sine * b, cosine * b - sine * a);
    if first.length_squared() < second.length_squared() { [second, first] } else { [first, second] }
}

impl<const N: usize> Level<N> {
    /// Half as many texels each way, rounded up: each the mean of what it lies over, by area.
    fn halved(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let (across, down) = (shares(self.columns, columns), shares(self.rows, rows));
        let mut texels = Vec::with_capacity(columns * rows);
        for &(first_row, ref row_shares) in &down {
            for &(first_column, ref column_shares) in &across {
                let mut sum = [0.0_f32; N];
                for (row, row_share) in (first_row..).zip(row_shares) {
                    for (column, column_share) in (first_column..).zip(column_shares) {
                        let share = row_share * column_share;
                        let texel = &self.texels[row * self.columns + column];
                        for (sum, value) in sum.iter_mut().zip(texel) {
                            *sum += share * value;
                        }
                    }
                }
                texels.push(sum);
            }
        }
        Self { columns, rows, texels }
    }

    /// The value at a place, between the nearest texels.
    fn at(&self, place: DVec2, edges: [Edge; 2], between: Between) -> [f64; N] {
        let across = neighbours(place.x, self.columns, edges[0], between);
        let up = neighbours(place.y, self.rows, edges[1], between);
        let mut sum = [0.0; N];
        for (row, row_share) in up.into_iter().flatten() {
            for (column, column_share) in across.into_iter().flatten() {
                let share = row_share * column_share;
                let texel = &self.texels[row * self.columns + column];
                for (sum, &value) in sum.iter_mut().zip(texel) {
                    *sum += share * f64::from(value);
                }
            }
        }
        sum
    }
}

/// For each of `to` equal parts of a row of `from` texels, more than `to` but at most twice as many: the first texel it
/// lies over, and the share of it that each has.
fn shares(from: usize, to: usize) -> Vec<(usize, Vec<f32>)> {
    let part = from as f64 / to as f64;
    (0..to)
        .map(|i| {
            let (low, high) = (i as f64 * part, (i + 1) as f64 * part);
            // Whole numbers of texels are exact, so a part ends in the row.
            let first = i * from / to;
            let end = ((i + 1) * from).div_ceil(to);
            let over = |texel: usize| {
                let texel = texel as f64;
                (high.min(texel + 1.0) - low.max(texel)).max(0.0) / part
            };
            #[expect(
                clippy::cast_possible_truncation,
                reason = "shares of a sum of 32-bit numbers"
            )]
            (first, (first..end).map(|texel| over(texel) as f32).collect())
        })
        .collect()
}

/// The texels about a place on an axis and their shares; nothing beyond an edge that has nothing beyond it.
fn neighbours(place: f64, count: usize, edge: Edge, between: Between) -> [Option<(usize, f64)>; 3] {
    let count_f = count as f64;
    let at = place * count_f - 0.5;
    // What is too far away to have a fraction is at its texel's middle.
    let above = |low: f64| if (at - low).is_finite() { at - low } else { 0.0 };
    let taps = match between {
        Between::Straight => {
            let low = libm::floor(at);
            let share = above(low);
            [(low, 1.0 - share), (low + 1.0, share), (low, 0.0)]
        }
        Between::Curved => {
            let middle = libm::floor(at + 0.5);
            let away = above(middle);
            let (low, high) = (0.5 - away, 0.5 + away);
            let (low, high) = (0.5 * low * low, 0.5 * high * high);
            [(middle - 1.0, low), (middle, 1.0 - low - high), (middle + 1.0, high)]
        }
    };
    taps.map(|(texel, share)| {
        if share <= 0.0 {
            return None;
        }
        let texel = match edge {
            Edge::Tiled => texel,
            Edge::Held(times) => texel.min(libm::ceil(times * count_f) - 1.0).max(0.0),
            Edge::Once if texel >= 0.0 && texel < count_f => texel,
            Edge::Once => return None,
        };
        let inside = texel - count_f * libm::floor(texel / count_f);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked below"
        )]
        let index = inside as usize;
        // Rounding of what is far away.
        Some((if index < count { index } else { 0 }, share))
    })
}

#[cfg(test)]
mod tests;
