//! How much an error is seen, where and in what: weights of pixels and colours for tables that are
//! made to the eye.
//!
//! Three things are known of it. Texture hides errors that show as steps in flat areas (contrast
//! masking). Near black, cube roots part colours that screens and eyes with their stray light do
//! not. And one pixel far off is seen before many that are a little off. Constants are those with
//! which no picture of 28 was behind a peer, but one synthetic gradient (SSIMULACRA2 and DSSIM;
//! the means gain 1.2 and 10 %).

use crate::Pixels;

/// How often pixels of flat areas count.
const FLAT: u8 = 5;
/// Most that the channels of a flat pixel differ from those of the left and the upper one,
/// together.
const FLAT_DIFFERENCE: u32 = 12;
/// Lightness (0 to 255) at which errors count half.
const HALF_SEEN: f32 = 160.0;
/// Squared distance at which an error counts twice as much as its square.
const TWICE: f32 = 2.0;

/// Counts of pixels, row by row.
#[derive(Debug, Default)]
pub(crate) struct Flatness {
    differences: Vec<u8>,
    counts: Vec<u8>,
}

impl Flatness {
    /// How often each pixel of a row counts: [`FLAT`] times in flat areas, else once.
    pub(crate) fn row(&mut self, pixels: &Pixels, row: usize) -> &[u8] {
        let columns = pixels.columns() as usize;
        let colors = &pixels.colors()[row * columns..][..columns];
        let above = &pixels.colors()[row.saturating_sub(1) * columns..][..columns];
        let (bytes, above) = (colors.as_flattened(), above.as_flattened());
        self.differences.clear();
        self.differences.extend(bytes.iter().zip(above).map(|(a, b)| a.abs_diff(*b)));
        // The first pixel has none to the left.
        for (difference, (a, b)) in
            self.differences[4..].iter_mut().zip(bytes[4..].iter().zip(bytes))
        {
            *difference = difference.saturating_add(a.abs_diff(*b));
        }
        self.counts.clear();
        self.counts.extend(self.differences.as_chunks().0.iter().map(|&[r, g, b, a]| {
            let difference = u32::from(r) + u32::from(g) + u32::from(b) + u32::from(a);
            if difference <= FLAT_DIFFERENCE { FLAT } else { 1 }
        }));
        &self.counts
    }
}

/// Share of an error that is seen in a colour of some lightness, 0 to 255.
pub(crate) fn in_lightness(lightness: f32) -> f32 {
    // Black itself must count, if little.
    (lightness + 1.0) / (lightness + 1.0 + HALF_SEEN)
}

/// What the square of an error counts, besides, for being large. Rounds of k-means with this weight
/// lessen the sum of `d² + d⁴ / 4` over all distances `d`, where those without lessen that of `d²`.
#[inline(always)]
pub(crate) fn of_size(square: f32) -> f32 {
    1.0 + square / TWICE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_pixels_differ_little_from_the_left_and_the_upper_one() {
        let colors: [[u8; 4]; 8] = [
            [50, 50, 50, 255],
            [54, 50, 50, 255], // 4 to the left
            [54, 50, 57, 255], // 7 to the left
            [0, 50, 57, 255],  // 54
            [50, 50, 50, 250], // 5 up
            [55, 51, 50, 255], // 1 + 1 up, 5 + 1 + 5 to the left: 13
            [55, 51, 51, 255], // 1 + 1 + 6 up, 1 to the left: 9
            [55, 51, 51, 255], // 55 up
        ];
        let pixels = Pixels::new(4, 2, colors.to_vec()).unwrap();
        let mut flatness = Flatness::default();
        assert_eq!(flatness.row(&pixels, 0), [FLAT, FLAT, FLAT, 1]);
        assert_eq!(flatness.row(&pixels, 1), [FLAT, 1, FLAT, 1]);
    }

    #[test]
    fn large_errors_and_light_colors_count_more() {
        assert!((of_size(0.0) - 1.0).abs() < 1e-6 && (of_size(16.0) - 9.0).abs() < 1e-6);
        assert!((in_lightness(159.0) - 0.5).abs() < 1e-6);
        assert!(in_lightness(0.0) > 0.0 && in_lightness(10.0) < in_lightness(20.0));
    }
}
