//! Pixels divided where their corners differ (Whitted, "An Improved Illumination Model for Shaded Display", 1980).
//!
//! All squares of a piece are divided a level at a time, and a corner is looked at once for all squares that share it.

use crate::film::{Half, Piece, Sums};
use crate::sampling::display::Display;

/// Corners of a square that differ by more display steps in a channel differ.
const MOST_STEPS: f32 = 8.0;

/// What is seen at a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) light: Half,
    /// Over the background, in display steps.
    pub(crate) shown: [f32; 3],
    /// The object the ray meets first, or 0.
    pub(crate) object: usize,
}

impl Corner {
    pub(crate) fn new(light: Half, background: [f32; 3], object: usize) -> Self {
        let display = Display::get();
        let open = 1.0 - light.coverage;
        let shown = std::array::from_fn(|k| display.steps(light.color[k] + open * background[k]));
        Self { light, shown, object }
    }
}

/// A square whose side is so many steps of the lattice, by the step of its first corner.
#[derive(Clone, Copy, Debug)]
struct Square {
    x: u32,
    y: u32,
    side: u32,
}

/// The corners of all squares that the pixels of a piece can be divided into.
#[derive(Debug)]
pub(crate) struct Lattice {
    piece: Piece,
    /// Steps along the side of a pixel.
    steps: u32,
    /// Where in `corners` each is, if it has been looked at or is to be.
    places: Vec<u32>,
    corners: Vec<Corner>,
    /// Those that are still to be looked at, as steps.
    wanted: Vec<[u32; 2]>,
}

impl Lattice {
    pub(crate) fn new(piece: Piece, levels: u32) -> Self {
        let steps = 1 << levels;
        let count = (piece.width * steps + 1) as usize * (piece.height * steps + 1) as usize;
        Self {
            piece,
            steps,
            places: vec![u32::MAX; count],
            corners: Vec::new(),
            wanted: Vec::new(),
        }
    }

    fn place(&self, x: u32, y: u32) -> usize {
        y as usize * (self.piece.width * self.steps + 1) as usize + x as usize
    }

    fn want(&mut self, x: u32, y: u32) {
        let place = self.place(x, y);
        if self.places[place] == u32::MAX {
            let next = self.corners.len() + self.wanted.len();
            self.places[place] = u32::try_from(next).expect("a piece has few corners");
            self.wanted.push([x, y]);
        }
    }

    fn corners(&self, square: Square) -> [&Corner; 4] {
        let Square { x, y, side } = square;
        [(x, y), (x + side, y), (x, y + side), (x + side, y + side)]
            .map(|(x, y)| &self.corners[self.places[self.place(x, y)] as usize])
    }

    /// Divides until corners are alike or squares smallest, and adds all squares to `sums`: each of their corners
    /// stands for a quarter of them. `look` appends what is seen at places of the piece, in pixels from its first
    /// corner, for squares of a side.
    pub(crate) fn divide(
        &mut self,
        sums: &mut impl Sums,
        mut look: impl FnMut(&[[f64; 2]], f64, &mut Vec<Corner>),
    ) {
        let steps = self.steps;
        let mut squares: Vec<Square> = (0..self.piece.area())
            .map(|number| {
                let number = u32::try_from(number).expect("a piece is small");
                let (x, y) = (number % self.piece.width, number / self.piece.width);
                Square { x: x * steps, y: y * steps, side: steps }
            })
            .collect();
        for &Square { x, y, side } in &squares {
            for (x, y) in [(x, y), (x + side, y), (x, y + side), (x + side, y + side)] {
                self.want(x, y);
            }
        }
        let mut side = steps;
        while !squares.is_empty() {
            let scale = 1.0 / f64::from(steps);
            let places: Vec<_> =
                self.wanted.drain(..).map(|place| place.map(|at| scale * f64::from(at))).collect();
            look(&places, scale * f64::from(side), &mut self.corners);
            let mut parts = Vec::new();
            for square in squares {
                if side > 1 && differ(self.corners(square)) {
                    let h = side / 2;
                    let Square { x, y, .. } = square;
                    for (dx, dy) in [(h, 0), (0, h), (h, h), (side, h), (h, side)] {
                        self.want(x + dx, y + dy);
                    }
                    let part = |(dx, dy)| Square { x: x + dx, y: y + dy, side: h };
                    parts.extend([(0, 0), (h, 0), (0, h), (h, h)].map(part));
                } else {
                    self.add(square, sums);
                }
            }
            squares = parts;
            side /= 2;
        }
    }

    fn add(&self, square: Square, sums: &mut impl Sums) {
        let Square { x, y, side } = square;
        let (column, row) = (x / self.steps, y / self.steps);
        let pixel = (row * self.piece.width + column) as usize;
        let scale = 1.0 / f64::from(self.steps);
        let edges = |first: u32, pixel: u32| {
            let low = f64::from(first - pixel * self.steps);
            [scale * low, scale * (low + f64::from(side))]
        };
        let (across, down) = (edges(x, column), edges(y, row));
        let share = scale * f64::from(side);
        #[expect(clippy::cast_possible_truncation, reason = "a power of two")]
        let weight = (0.25 * share * share) as f32;
        for (number, corner) in self.corners(square).into_iter().enumerate() {
            let place = [across[number % 2], down[number / 2]];
            sums.add(0, pixel, place, weight, corner.light);
        }
    }
}

/// By colour or by object.
fn differ(corners: [&Corner; 4]) -> bool {
    let [first, others @ ..] = corners;
    if others.iter().any(|corner| corner.object != first.object) {
        return true;
    }
    (0..3).any(|k| {
        let (mut low, mut high) = (first.shown[k], first.shown[k]);
        for corner in others {
            let shown = corner.shown[k];
            low = if shown < low { shown } else { low };
            high = if shown > high { shown } else { high };
        }
        high - low > MOST_STEPS
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;

    const PIECE: Piece = Piece { column: 0, row: 0, width: 3, height: 2 };

    /// Divides pixels of a picture given as a function and returns their coverage and how many corners were looked at.
    fn divided(levels: u32, seen: impl Fn(f64, f64) -> (f32, usize)) -> (Vec<f32>, usize) {
        let mut tile = FilmTile::new(PIECE.width, PIECE.height, [1, 0]);
        let mut lattice = Lattice::new(PIECE, levels);
        lattice.divide(&mut tile, |places, _, corners| {
            corners.extend(places.iter().map(|&[x, y]| {
                let (value, object) = seen(x, y);
                Corner::new(Half { color: [value; 3], coverage: 1.0 }, [0.0; 3], object)
            }));
        });
        let looked = lattice.corners.len();
        (tile.halves[0].iter().map(|half| half.color[0]).collect(), looked)
    }

    #[expect(clippy::cast_possible_truncation, reason = "a sample")]
    fn single(x: f64) -> f32 {
        x as f32
    }

    #[test]
    fn published_shares_of_an_edge() {
        // Reference page: an upright edge at 0.3 of a pixel by levels; the truth is 0.3.
        for (levels, expected) in [(0, 0.5), (1, 0.25), (2, 0.375), (3, 0.3125), (4, 0.28125)] {
            let (pixels, _) = divided(levels, |x, _| (f32::from(u8::from(x < 1.3)), 0));
            assert!((pixels[1] - expected).abs() < 1e-6, "{levels}: {pixels:?}");
            assert!(pixels[0] > 0.999 && pixels[2] < 0.001, "the others are whole: {pixels:?}");
        }
    }

    #[test]
    fn alike_corners_are_shared_and_not_divided() {
        let (pixels, looked) = divided(4, |_, _| (0.25, 7));
        assert!(pixels.iter().all(|pixel| (pixel - 0.25).abs() < 1e-7), "{pixels:?}");
        assert_eq!(looked, 12, "4 × 3 corners of 3 × 2 pixels");
        // Light that rises by less than the limit is taken by the rule of trapezoids, which is exact for it.
        let (pixels, looked) = divided(4, |x, _| (0.5 + 0.005 * single(x), 7));
        assert!((pixels[1] - 0.5075).abs() < 1e-6 && looked == 12, "{pixels:?}");
    }

    #[test]
    fn objects_of_one_colour_are_told_apart() {
        let (pixels, looked) = divided(2, |x, _| (0.5, usize::from(x > 1.3)));
        assert!(pixels.iter().all(|pixel| (pixel - 0.5).abs() < 1e-7), "{pixels:?}");
        // The middle column of two pixels is divided: 9 corners at the first level, where the two share one, and 17 at
        // the second, where the left halves are divided: 5 edges across and 3 corners on each side of four.
        assert_eq!(looked, 12 + 9 + 17, "only what the edge goes through");
    }
}
