//! Stars as light in pixels.

use std::ops::Range;

use rayon::prelude::*;

use crate::band::Band;
use crate::catalogue::{Catalogue, Star, TooManyStars, flux};
use crate::color::black_body;
use crate::profile::Profile;

/// What a sky is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Width of the picture in pixels, at least 1.
    pub columns: u32,
    /// Height of the picture in pixels, at least 1.
    pub rows: u32,
    /// Which sky: another number, other stars.
    pub seed: u64,
    /// Magnitude of the faintest stars.
    pub faintest: f64,
    /// Degrees of the sky from the left to the right edge, above 0, at most 180; as many pixels a degree downward.
    pub field_degrees: f64,
    /// Where stars are dense.
    pub band: Band,
    /// How light is spread.
    pub profile: Profile,
    /// Magnitude of a star whose light, all in one pixel, would be display white.
    pub white: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            columns: 512,
            rows: 512,
            seed: 1,
            faintest: 10.0,
            field_degrees: 60.0,
            band: Band { strength: 8.0, width: 0.12, tilt_degrees: 25.0, dust: 0.6 },
            profile: Profile { core: 0.55, halo: 0.08 },
            white: 4.0,
        }
    }
}

/// Stars taken at a time: a few megabytes.
const BATCH: u64 = 1 << 16;
/// Rows of the picture that one thread fills.
const BAND_ROWS: usize = 32;
/// Temperatures whose colours are worked out, spread evenly by their logarithm.
const TABLED: usize = 512;
/// Coldest and hottest of them.
const KELVINS: [f64; 2] = [2000.0, 50_000.0];

/// Red, green and blue of the sky: linear light, row by row, 0 or more; 1 is display white.
///
/// Stars are added in the order of their numbers, so the sums are the same with any number of threads.
///
/// # Errors
///
/// [`TooManyStars`].
pub fn light(options: &Options) -> Result<[Vec<f32>; 3], TooManyStars> {
    let catalogue = Catalogue::new(options)?;
    let columns = options.columns as usize;
    let size = columns * options.rows as usize;
    let mut pixels = vec![[0.0_f32; 3]; size];
    let colors = colors();
    let mut first = 0;
    while first < catalogue.len() {
        let last = catalogue.len().min(first + BATCH);
        let lit = |index| Lit::new(&catalogue.star(index), options, &colors);
        let stars: Vec<Lit> = (first..last).into_par_iter().map(lit).collect();
        pixels.par_chunks_mut(columns * BAND_ROWS).enumerate().for_each(|(band, rows)| {
            add(rows, columns, band * BAND_ROWS, &stars, &options.profile);
        });
        first = last;
    }
    Ok([0, 1, 2].map(|channel| pixels.iter().map(|pixel| pixel[channel]).collect()))
}

/// A star as light.
#[derive(Clone, Copy, Debug)]
struct Lit {
    place: [f64; 2],
    light: [f64; 3],
    reach: f64,
}

impl Lit {
    fn new(star: &Star, options: &Options, colors: &[[f64; 3]; TABLED]) -> Self {
        let strength = flux(star.magnitude - options.white);
        let [low, high] = KELVINS;
        let share = libm::log(star.kelvins / low) / libm::log(high / low);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let entry = (share * (TABLED - 1) as f64 + 0.5) as usize;
        let light = colors[entry.min(TABLED - 1)].map(|value| strength * value);
        let brightest =
            light.iter().fold(0.0, |most, &value| if value > most { value } else { most });
        Self { place: star.place, light, reach: options.profile.reach(brightest) }
    }
}

fn colors() -> [[f64; 3]; TABLED] {
    let [low, high] = KELVINS;
    std::array::from_fn(|entry| {
        let share = entry as f64 / (TABLED - 1) as f64;
        black_body(low * libm::pow(high / low, share))
    })
}

/// Adds to a band of rows from `top` on what falls there.
fn add(pixels: &mut [[f32; 3]], columns: usize, top: usize, stars: &[Lit], profile: &Profile) {
    let rows = pixels.len() / columns;
    let (mut across, mut down) = (Vec::new(), Vec::new());
    for star in stars {
        let Some(down_cut) = cut(star.place[1], star.reach, top..top + rows) else { continue };
        let Some(cut) = cut(star.place[0], star.reach, 0..columns) else { continue };
        profile.fill(star.place[0], &cut, &mut across);
        profile.fill(star.place[1], &down_cut, &mut down);
        for (row, &of_row) in down_cut.zip(&down) {
            let start = (row - top) * columns;
            let line = &mut pixels[start + cut.start..start + cut.end];
            for (pixel, &of_column) in line.iter_mut().zip(&across) {
                let share = profile.share(of_column, of_row);
                for (sum, value) in pixel.iter_mut().zip(star.light) {
                    #[expect(clippy::cast_possible_truncation, reason = "planes are f32")]
                    let part = (share * value) as f32;
                    *sum += part;
                }
            }
        }
    }
}

/// The pixels of `within` in reach of a place, or none.
fn cut(place: f64, reach: f64, within: Range<usize>) -> Option<Range<usize>> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let [low, high] = [place - reach, place + reach + 1.0].map(|edge| edge as usize);
    let cut = low.max(within.start)..high.min(within.end);
    (cut.start < cut.end).then_some(cut)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_that_of_the_stars() {
        // A halo would leave at the edges.
        let profile = Profile { core: 0.55, halo: 0.0 };
        let options =
            Options { columns: 400, rows: 300, faintest: 7.0, profile, ..Options::default() };
        let catalogue = Catalogue::new(&options).unwrap();
        let inside = |star: &Star| {
            (4.0..396.0).contains(&star.place[0]) && (4.0..296.0).contains(&star.place[1])
        };
        let stars: Vec<Star> = (0..catalogue.len()).map(|index| catalogue.star(index)).collect();
        assert!(stars.len() > 100, "{}", stars.len());
        let all = |stars: &mut dyn Iterator<Item = &Star>| -> f64 {
            stars.map(|star| flux(star.magnitude - options.white)).sum()
        };
        let [least, most] = [all(&mut stars.iter().filter(|s| inside(s))), all(&mut stars.iter())];
        let [red, green, blue] = light(&options).unwrap();
        let sum = |plane: &[f32]| plane.iter().map(|&value| f64::from(value)).sum::<f64>();
        let luminance = 0.2126 * sum(&red) + 0.7152 * sum(&green) + 0.0722 * sum(&blue);
        assert!(
            luminance > 0.995 * least && luminance < 1.005 * most,
            "{least} {luminance} {most}"
        );
    }

    #[test]
    fn a_star_five_magnitudes_brighter_has_a_hundred_times_the_light() {
        let options = Options::default();
        let colors = colors();
        let star = |magnitude| Star { place: [8.3, 8.6], magnitude, kelvins: 5000.0 };
        let sums = [9.0, 4.0].map(|magnitude| {
            let lit = Lit::new(&star(magnitude), &options, &colors);
            let mut pixels = vec![[0.0; 3]; 16 * 16];
            add(&mut pixels, 16, 0, &[lit], &options.profile);
            pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
        });
        // Of the faint one less of the halo is worth a step of 8 bits.
        assert!((sums[1] / sums[0] - 100.0).abs() < 5.0, "{sums:?}");
    }

    #[test]
    fn bands_of_rows_meet() {
        let options = Options { columns: 90, rows: 70, faintest: 8.0, ..Options::default() };
        let whole = light(&options).unwrap();
        let colors = colors();
        let catalogue = Catalogue::new(&options).unwrap();
        let stars: Vec<Lit> = (0..catalogue.len())
            .map(|index| Lit::new(&catalogue.star(index), &options, &colors))
            .collect();
        let mut pixels = vec![[0.0; 3]; 90 * 70];
        add(&mut pixels, 90, 0, &stars, &options.profile);
        for (at, pixel) in pixels.iter().enumerate() {
            for channel in 0..3 {
                assert_eq!(pixel[channel].to_bits(), whole[channel][at].to_bits(), "{at}");
            }
        }
    }
}
