//! `Quality`: how far a picture in the colours of a table is from the original.

use idf::Lut;
use rayon::prelude::*;

use crate::{Metric, Pixels, Table, oklab};

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

/// Pixels that are turned into Oklab at once.
const LANES: usize = 16;

/// Opaque colours of a table in Oklab.
type Places = [[f32; 3]; Lut::MOST];

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
    let is_opaque = pixels.is_opaque() && table.colors().iter().all(|color| color[3] == u8::MAX);
    let places = |metric: Metric| -> Vec<[f32; 4]> {
        table.colors().iter().map(|&color| metric.place_with_alpha(color)).collect()
    };
    let (rgb, oklab) = (places(Metric::Rgb), places(Metric::Oklab));
    let mut seen: Places = [[0.0; 3]; Lut::MOST];
    for (seen, &[red, green, blue, _]) in seen.iter_mut().zip(table.colors()) {
        *seen = Metric::Oklab.place([red, green, blue]);
    }
    let chunks = pixels.colors().par_chunks(CHUNK).zip(indices.par_chunks(CHUNK));
    let chunks = chunks.map(|(colors, indices)| {
        if is_opaque {
            let mut sums = opaque_rgb(colors, table.colors(), indices);
            if OKLAB {
                sums.oklab = opaque_oklab(colors, &seen, indices);
            }
            return sums;
        }
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

/// What opaque colours add to the sums, Oklab aside; in whole numbers.
#[expect(clippy::cast_precision_loss, reason = "sums of squares of bytes are far below 2^53")]
fn opaque_rgb(colors: &[[u8; 4]], table: &[[u8; 4]], indices: &[u8]) -> Sums {
    let (mut sum, mut worst) = (0_u64, 0_u32);
    for (&color, &index) in colors.iter().zip(indices) {
        let near = table[usize::from(index)];
        let square = |channel: usize| u32::from(color[channel].abs_diff(near[channel])).pow(2);
        let square = square(0) + square(1) + square(2);
        sum += u64::from(square);
        worst = worst.max(square);
    }
    let pixels = colors.len().min(indices.len()) as f64;
    Sums { pixels, rgb: sum as f64, oklab: 0.0, worst: f64::from(worst) }
}

/// Sum of squared distances of opaque colours to places of a table, in Oklab, several at once.
fn opaque_oklab(colors: &[[u8; 4]], places: &Places, indices: &[u8]) -> f64 {
    let mut sums = [0.0; LANES];
    let (rows, last) = colors.as_chunks();
    let (index_rows, last_indices) = indices.as_chunks();
    for (colors, indices) in rows.iter().zip(index_rows) {
        add_oklab(colors, places, indices, &mut sums);
    }
    // The rest is filled up with its first pixel, whose lanes are not added.
    if let (Some(&color), Some(&index)) = (last.first(), last_indices.first()) {
        let (mut colors, mut indices, mut rest) = ([color; LANES], [index; LANES], [0.0; LANES]);
        colors[..last.len()].copy_from_slice(last);
        indices[..last.len()].copy_from_slice(&last_indices[..last.len()]);
        add_oklab(&colors, places, &indices, &mut rest);
        sums.iter_mut().zip(&rest[..last.len()]).for_each(|(sum, rest)| *sum += rest);
    }
    sums.iter().sum()
}

fn add_oklab(
    colors: &[[u8; 4]; LANES],
    places: &Places,
    indices: &[u8; LANES],
    sums: &mut [f64; LANES],
) {
    let (mut light, mut near) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
    for lane in 0..LANES {
        let [red, green, blue, _] = colors[lane];
        let (color, place) =
            (oklab::linear([red, green, blue]), places[usize::from(indices[lane])]);
        for axis in 0..3 {
            light[axis][lane] = color[axis];
            near[axis][lane] = place[axis];
        }
    }
    let found = oklab::lanes_from_linear(&light);
    for lane in 0..LANES {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| found[axis][lane] - near[axis][lane]);
        sums[lane] += f64::from(x * x + y * y + z * z);
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of opaque colours the sums are taken several at once: one pixel more or less than goes into
    /// the lanes, and one that is covered in part and takes the other way.
    #[test]
    fn both_ways_add_up_the_same() {
        let table = Table::new(vec![[9, 200, 30, 255], [250, 3, 77, 255], [0, 0, 0, 255]]).unwrap();
        let covered = Table::new([table.colors(), &[[7, 7, 7, 128]]].concat()).unwrap();
        for count in [1_u8, 15, 16, 17, 250] {
            let color = |at: u8| [at, at.wrapping_mul(37), at.wrapping_mul(91), 255];
            let colors: Vec<[u8; 4]> = (0..count).map(color).collect();
            let indices: Vec<u8> = (0..count).map(|at| at % 3).collect();
            let pixels = Pixels::new(u32::from(count), 1, colors.clone()).unwrap();
            let [one, other] = [&table, &covered].map(|table| quality(&pixels, table, &indices));
            assert!((one.rms_rgb - other.rms_rgb).abs() < 1e-12, "{count}: {one:?}, {other:?}");
            assert!((one.worst - other.worst).abs() < 1e-12, "{count}: {one:?}, {other:?}");
            assert!((one.rms_oklab - other.rms_oklab).abs() < 1e-4, "{count}: {one:?}, {other:?}");
            let squares = colors.iter().zip(&indices).map(|(color, &index)| {
                let near = table.colors()[usize::from(index)];
                let off = |channel: usize| f64::from(color[channel]) - f64::from(near[channel]);
                (0..3).map(|channel| off(channel) * off(channel)).sum::<f64>()
            });
            let mean = squares.sum::<f64>() / (3.0 * f64::from(count));
            assert!((one.rms_rgb - mean.sqrt()).abs() < 1e-9, "{count}: {one:?}, {mean}");
        }
    }
}
