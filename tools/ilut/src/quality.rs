//! `Quality`: how far a picture in the colours of a table is from the original.

use rayon::prelude::*;

use crate::{Metric, Pixels, Table};

/// How far a picture in the colours of a table is from the original. Where there is alpha, over
/// black and over white on the average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Root mean square difference of a channel, in display steps.
    pub rms_rgb: f64,
    /// Peak signal to noise ratio of `rms_rgb`, in decibels; infinite where nothing differs.
    pub psnr_rgb: f64,
    /// Root mean square distance in Oklab, scaled by 255.
    pub rms_oklab: f64,
    /// Largest distance of a pixel in RGB, in display steps.
    pub worst: f64,
}

/// Squared distances of pixels, summed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pixels: f64,
    rgb: f64,
    oklab: f64,
    worst: f64,
}

/// Pixels of a sum that is taken on one thread, so that the order of additions is always the same.
const CHUNK: usize = 1 << 14;

/// Compares a picture with itself in the colours of `table`.
///
/// # Panics
///
/// If there are fewer indices than pixels, or one is beyond the table.
pub fn quality(pixels: &Pixels, table: &Table, indices: &[u8]) -> Quality {
    sums_of(pixels, table, indices).quality()
}

/// [`Quality::rms_rgb`] alone, in a fraction of the time.
///
/// # Panics
///
/// As [`quality`].
pub fn rms_rgb(pixels: &Pixels, table: &Table, indices: &[u8]) -> f64 {
    sums::<false>(pixels, table, indices).quality().rms_rgb
}

impl Quality {
    /// The figures in words, after the number of `colors` of the table: what `ilut` and `iencode`
    /// say about a picture.
    pub fn words(&self, colors: usize) -> String {
        if self.worst <= 0.0 {
            return format!("{colors} colours, unchanged");
        }
        let Self { rms_rgb, psnr_rgb, rms_oklab, worst } = self;
        format!(
            "{colors} colours, {psnr_rgb:.2} dB (off by {rms_rgb:.3} of 255 a channel, by \
             {rms_oklab:.3} in Oklab, by at most {worst:.1})"
        )
    }
}

pub(crate) fn sums_of(pixels: &Pixels, table: &Table, indices: &[u8]) -> Sums {
    sums::<true>(pixels, table, indices)
}

/// Sums of squares, those of Oklab only if asked for.
fn sums<const OKLAB: bool>(pixels: &Pixels, table: &Table, indices: &[u8]) -> Sums {
    let places = |metric: Metric| -> Vec<[f32; 4]> {
        table.colors().iter().map(|&color| metric.place_with_alpha(color)).collect()
    };
    let (rgb, oklab) = (places(Metric::Rgb), places(Metric::Oklab));
    let chunks = pixels.colors().par_chunks(CHUNK).zip(indices.par_chunks(CHUNK));
    let chunks = chunks.map(|(colors, indices)| {
        let mut sums = Sums::default();
        for (&color, &index) in colors.iter().zip(indices) {
            let index = usize::from(index);
            let near = square(Metric::Rgb.place_with_alpha(color), rgb[index]);
            sums.pixels += 1.0;
            sums.rgb += near;
            if OKLAB {
                sums.oklab += square(Metric::Oklab.place_with_alpha(color), oklab[index]);
            }
            sums.worst = if near > sums.worst { near } else { sums.worst };
        }
        sums
    });
    let chunks: Vec<Sums> = chunks.collect();
    chunks.into_iter().fold(Sums::default(), Sums::and)
}

impl Sums {
    /// Those of two pictures.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            rgb: self.rgb + other.rgb,
            oklab: self.oklab + other.oklab,
            worst: self.worst.max(other.worst),
        }
    }

    pub(crate) fn quality(self) -> Quality {
        let rms_rgb = (self.rgb / (3.0 * self.pixels)).sqrt();
        Quality {
            rms_rgb,
            psnr_rgb: 20.0 * libm::log10(255.0 / rms_rgb),
            rms_oklab: (self.oklab / self.pixels).sqrt(),
            worst: self.worst.sqrt(),
        }
    }
}

fn square(a: [f32; 4], b: [f32; 4]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| f64::from(a - b) * f64::from(a - b));
    squares.sum()
}
