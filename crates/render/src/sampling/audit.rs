//! How far off a picture is, whatever made it: some of its pixels, chosen by lot, are sampled twice more.

use super::display::Display;
use super::estimate::shown;
use super::pattern::pixel_seed;
use super::sequence::{Draw, hash};
use crate::film::{Film, Half, Piece, Weighed};
use crate::options::Options;
use crate::tile::{Frame, Shot};
use crate::world::World;
use crate::{RenderError, pool};

/// Pixels that are looked at again, of pictures that have so many.
const PIXELS: u32 = 4000;
/// Samples of each of the two looks, for a filter as wide as a pixel.
const SAMPLES: u32 = 64;
/// Seeds of the two looks; the halves of a picture have 0 and 1.
const LOOKS: [u32; 2] = [2, 3];

/// The error of a picture, by a random sample of its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Audit {
    /// The root of the mean square error in display steps of 1/255, before rounding.
    pub error: f64,
    /// Standard deviation of `error`.
    pub deviation: f64,
    /// Pixels that were looked at.
    pub pixels: u32,
}

/// Finds out the error of `film`, which `options` describe, by pixels that are chosen by lot.
///
/// Each is sampled twice more. The mean of (P − R₁)(P − R₂) over them is the mean square error of P, though the R are off
/// by more than P may be: what they are off by has nothing to do with each other.
///
/// # Errors
///
/// [`RenderError::Threads`] when there are no threads to be had.
pub fn audit(world: &World, options: &Options, film: &Film) -> Result<Audit, RenderError> {
    let view = world.view_from.view(options.columns, options.rows);
    let frame = Frame::new(world, view, options);
    let background = frame.background();
    let pixels: Vec<Half> =
        film.pixels().map(|pixel| Half { color: pixel.color, coverage: pixel.coverage }).collect();
    let chosen = chosen(options);
    let display = Display::get();
    let products = pool(world, options, options.threads)?.install(|| {
        frame.over_tiles(|tracer, number| {
            let piece = frame.piece(number);
            let inside: Vec<[u32; 2]> =
                chosen.iter().copied().filter(|&pixel| piece.contains(pixel)).collect();
            let looks = LOOKS.map(|look| frame.look_again(tracer, &piece, &inside, look));
            let product = |(at, &[column, row]): (usize, &[u32; 2])| {
                let place = row as usize * options.columns as usize + column as usize;
                let found = shown(&pixels[place], background, display);
                let [a, b] = [0, 1].map(|look: usize| shown(&looks[look][at], background, display));
                let off = |k: usize| f64::from(found[k] - a[k]) * f64::from(found[k] - b[k]);
                (off(0) + off(1) + off(2)) / 3.0
            };
            inside.iter().enumerate().map(product).collect::<Vec<f64>>()
        })
    });
    let products: Vec<f64> = products.into_iter().flatten().collect();
    let pixels = u32::try_from(products.len()).unwrap_or(PIXELS);
    let n = f64::from(pixels);
    let mean = products.iter().sum::<f64>() / n;
    let square = products.iter().map(|p| (p - mean) * (p - mean)).sum::<f64>();
    let deviation = (square / (n - 1.0).max(1.0) / n).sqrt();
    let error = if mean > 0.0 { mean.sqrt() } else { 0.0 };
    // By the slope of the root; where the error is lost in it, the root itself.
    let widest = if deviation > mean { deviation.sqrt() } else { 0.5 * deviation / error };
    let deviation = if mean > 0.0 || deviation > 0.0 { widest } else { 0.0 };
    Ok(Audit { error, deviation, pixels })
}

/// Pixels by lot, one of each of as many runs of about the same length; none twice, and all of a small picture.
fn chosen(options: &Options) -> Vec<[u32; 2]> {
    let area = u64::from(options.columns) * u64::from(options.rows);
    let count = u64::from(PIXELS).min(area);
    let start = |run: u64| run * area / count;
    (0..PIXELS)
        .zip(0..count)
        .map(|(number, run)| {
            let chance = hash(number, hash(options.seed, LOOKS[1] + 1));
            let place = start(run) + ((u64::from(chance) * (start(run + 1) - start(run))) >> 32);
            let columns = u64::from(options.columns);
            [place % columns, place / columns]
                .map(|at| u32::try_from(at).expect("within the picture"))
        })
        .collect()
}

impl<'w> Frame<'w> {
    /// What pixels of a piece are, by samples of their own.
    fn look_again(
        &self,
        tracer: &mut crate::trace::tree::Tracer<'w>,
        piece: &Piece,
        pixels: &[[u32; 2]],
        look: u32,
    ) -> Vec<Half> {
        let Options { filter, seed, .. } = *self.options;
        let width = 2.0 * filter.radius();
        let samples = SAMPLES << (2 * filter.reach());
        let shots = pixels.iter().enumerate().flat_map(|(at, &pixel)| {
            let seed = pixel_seed(pixel, look, seed);
            (0..samples).map(move |number| {
                let draw = Draw::new(number, seed);
                let [x, y, ..] = draw.start();
                let off = [x, y].map(|x| (x - 0.5) * width);
                let [column, row] = pixel.map(|at| f64::from(at) + 0.5);
                #[expect(clippy::cast_possible_truncation, reason = "as on film")]
                let weight = (filter.weight(off[0]) * filter.weight(off[1])) as f32;
                // Without extent: paint is as fine as it is.
                let shot = Shot { place: (column + off[0], row + off[1]), side: 0.0, draw };
                ((at, weight), shot)
            })
        });
        let region = self.region(&piece.grown(filter.reach()));
        let mut sums = vec![Weighed::default(); pixels.len()];
        self.follow(tracer, region.as_ref(), shots, |(at, weight), light| {
            sums[at].add(weight, &light);
        });
        sums.iter().map(|sum| sum.mean(1)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_chosen_everywhere_and_none_twice() {
        for (columns, rows) in [(1, 1), (50, 20), (63, 64), (100, 50), (512, 512), (9000, 7000)] {
            let options = Options { columns, rows, ..Options::default() };
            let found = chosen(&options);
            let area = columns * rows;
            assert_eq!(found.len(), area.min(4000) as usize, "{columns} x {rows}");
            let mut places: Vec<u32> = found.iter().map(|[x, y]| y * columns + x).collect();
            assert!(found.iter().all(|&[x, y]| x < columns && y < rows), "{columns} x {rows}");
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), found.len(), "{columns} x {rows}: none twice");
            let gaps = places.windows(2).map(|pair| pair[1] - pair[0]);
            let longest = 2 * area.div_ceil(4000);
            assert!(gaps.max().unwrap_or(0) <= longest, "{columns} x {rows}: everywhere");
        }
    }
}
