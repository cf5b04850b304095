//! A picture as it is seen: display values with the background painted in, and coverage.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use idf::{Kind, Samples};
use render::{Film, Form};
use scene::Rgb;

/// A picture of display values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shown {
    pub(crate) columns: usize,
    /// Red, green and blue, row by row from the top.
    pub(crate) pixels: Vec<[u8; 3]>,
    /// 0…1.
    pub(crate) coverage: Vec<f32>,
}

impl Shown {
    pub(crate) fn new(film: &Film, background: Rgb) -> Self {
        let form =
            Form { float: false, opaque: true, coverage: false, straight: false, dither: false };
        let image = film.image(form, background).unwrap();
        let plane = |kind| match image.plane(kind) {
            Some(Samples::U8(samples)) => samples.clone(),
            other => panic!("{kind}: {other:?}"),
        };
        let planes = [Kind::Red, Kind::Grn, Kind::Blu].map(plane);
        let pixels = (0..planes[0].len()).map(|i| planes.each_ref().map(|plane| plane[i]));
        Self {
            columns: film.size().0 as usize,
            pixels: pixels.collect(),
            coverage: film.pixels().map(|pixel| pixel.coverage).collect(),
        }
    }

    pub(crate) fn at(&self, column: usize, row: usize) -> [u8; 3] {
        self.pixels[row * self.columns + column]
    }

    /// Rows of letters, one for each pixel.
    pub(crate) fn letters(&self, letter: impl Fn(usize) -> char) -> String {
        let rows = 0..self.pixels.len() / self.columns;
        let row = |y| (0..self.columns).map(|x| letter(y * self.columns + x)).collect::<String>();
        rows.map(row).collect::<Vec<String>>().join("\n")
    }

    /// `#` where more than half is covered, else `.`.
    pub(crate) fn silhouette(&self) -> String {
        self.letters(|i| if self.coverage[i] > 0.5 { '#' } else { '.' })
    }

    /// The pixels in which some channel differs from that of `other` by more than `steps` of 255.
    pub(crate) fn differing(&self, other: &Self, steps: u8) -> Vec<usize> {
        assert_eq!(self.pixels.len(), other.pixels.len(), "sizes");
        let far = |(a, b): (&u8, &u8)| a.abs_diff(*b) > steps;
        let pairs = self.pixels.iter().zip(&other.pixels).enumerate();
        pairs.filter(|(_, (a, b))| a.iter().zip(*b).any(far)).map(|(i, _)| i).collect()
    }
}
