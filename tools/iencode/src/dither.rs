//! The table of dithers: how indices are chosen so that errors of neighbours cancel.

use ilut::{Metric, Nearest, Pixels, Table};

use crate::{blue_noise, floyd_steinberg};

/// A way to choose indices.
#[derive(Clone, Copy, Debug)]
pub struct Dither {
    /// The word on a command line.
    pub name: &'static str,
    /// Share of the error that is made up for with 256 colours, unless told otherwise.
    pub strength: f32,
    indices: fn(&Pixels, &Table, Metric, f32) -> Vec<u8>,
}

/// The nearest entry for each pixel.
pub const NONE: Dither = Dither {
    name: "none",
    strength: 0.0,
    indices: |pixels, table, metric, _| nearest(pixels, table, metric),
};

/// Errors go on to the neighbours (Floyd and Steinberg, "An adaptive algorithm for spatial
/// greyscale", 1976), row by row there and back.
pub const FLOYD_STEINBERG: Dither =
    Dither { name: "floyd-steinberg", strength: 0.75, indices: floyd_steinberg::indices };

/// Of the entries about a pixel one or the other, by the thresholds of a blue noise mask: of two,
/// or on a table of up to 64 colours of as many as it needs.
/// A pixel depends on itself alone, so parts of moving pictures that stand still stay still.
pub const BLUE_NOISE: Dither =
    Dither { name: "blue-noise", strength: 0.5, indices: blue_noise::indices };

/// All dithers. A new one is a new row.
pub const TABLE: &[Dither] = &[NONE, FLOYD_STEINBERG, BLUE_NOISE];

impl Dither {
    /// Finds a row of [`TABLE`].
    pub fn by_name(name: &str) -> Option<&'static Self> {
        TABLE.iter().find(|dither| dither.name == name)
    }

    /// The share that suits a table: all of the error for up to 16 colours, of which the shades
    /// between would else be lost; with more, the less the finer they are.
    #[expect(clippy::cast_precision_loss, reason = "at most 4")]
    pub fn strength_for(&self, table: &Table) -> f32 {
        if self.strength <= 0.0 {
            return 0.0;
        }
        // Doublings from 16 on: 256 are four.
        let doublings = [32, 64, 128, 256].iter().filter(|&&n| table.colors().len() >= n).count();
        1.0 - (1.0 - self.strength) * 0.25 * doublings as f32
    }

    /// An entry of `table` for each pixel, row by row from the top. `strength` is from 0 to 1; at
    /// 0 the entries are the nearest. A pixel of an entry's colour gets it where its neighbours
    /// have their entries' too, opaque pixels get opaque entries where there are any, and
    /// uncovered ones are not dithered.
    pub fn indices(
        &self,
        pixels: &Pixels,
        table: &Table,
        metric: Metric,
        strength: f32,
    ) -> Vec<u8> {
        if strength > 0.0 {
            (self.indices)(pixels, table, metric, strength)
        } else {
            (NONE.indices)(pixels, table, metric, strength)
        }
    }
}

/// The nearest entry for each pixel.
pub(crate) fn nearest(pixels: &Pixels, table: &Table, metric: Metric) -> Vec<u8> {
    Nearest::new(table, metric).indices(pixels)
}

#[expect(clippy::cast_possible_truncation, reason = "small numbers of the tests")]
#[cfg(test)]
mod tests {
    use super::*;
    use rayon::ThreadPoolBuilder;

    /// Numbers of a fixed sequence, 0 to 255.
    fn noise() -> impl FnMut() -> u8 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        }
    }

    /// A smooth picture with some noise, so that no two rows agree.
    fn photograph(columns: u32, rows: u32) -> Pixels {
        let mut noise = noise();
        let place = |at: u32, length: u32| at * 230 / length;
        let colors = (0..columns * rows).map(|at| {
            let (x, y) = (place(at % columns, columns), place(at / columns, rows));
            let channel = |value: u32, noise: u8| value as u8 + noise / 16;
            [channel(x, noise()), channel(y, noise()), channel((x + y) / 2, noise()), 255]
        });
        Pixels::new(columns, rows, colors.collect()).unwrap()
    }

    fn random_table(count: usize) -> Table {
        let mut noise = noise();
        Table::new((0..count).map(|_| [noise(), noise(), noise(), 255]).collect()).unwrap()
    }

    fn indices(dither: &Dither, pixels: &Pixels, table: &Table, metric: Metric) -> Vec<u8> {
        dither.indices(pixels, table, metric, dither.strength)
    }

    #[test]
    fn names_are_found() {
        for dither in TABLE {
            assert_eq!(Dither::by_name(dither.name).map(|row| row.name), Some(dither.name));
        }
        assert!(Dither::by_name("None").is_none());
    }

    #[test]
    fn a_picture_in_the_colors_of_the_table_is_unchanged() {
        let mut noise = noise();
        let mut colors: Vec<[u8; 4]> = (0..256).map(|_| [noise(), noise(), noise(), 255]).collect();
        // Some coverage, and none of two colours.
        for (color, alpha) in colors.iter_mut().zip([0, 0, 1, 100, 254]) {
            color[3] = alpha;
        }
        let pixels: Vec<[u8; 4]> = (0..97 * 140).map(|_| colors[usize::from(noise())]).collect();
        let table = Table::new(colors.clone()).unwrap();
        let picture = Pixels::new(97, 140, pixels.clone()).unwrap();
        for (dither, metric) in TABLE.iter().flat_map(|d| Metric::ALL.map(|metric| (d, metric))) {
            let found = indices(dither, &picture, &table, metric);
            for (&index, &pixel) in found.iter().zip(&pixels) {
                let color = colors[usize::from(index)];
                let same = color == pixel || color[3] == 0 && pixel[3] == 0;
                assert!(same, "{} {metric:?}: {color:?} for {pixel:?}", dither.name);
            }
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same() {
        // Three strips and a part of one; the last pair has one strip.
        for (columns, rows) in [(50, 3 * 128 + 20), (1, 300), (300, 1)] {
            let picture = photograph(columns, rows);
            let table = random_table(64);
            for dither in TABLE {
                let with = |threads| {
                    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    pool.install(|| indices(dither, &picture, &table, Metric::Oklab))
                };
                let one = with(1);
                assert_eq!(one, with(3), "{}", dither.name);
                assert_eq!(one.len(), picture.colors().len());
            }
        }
    }

    #[test]
    fn no_strength_is_no_dither() {
        let (picture, table) = (photograph(60, 40), random_table(20));
        let plain = indices(&NONE, &picture, &table, Metric::Rgb);
        for dither in TABLE {
            assert_eq!(dither.indices(&picture, &table, Metric::Rgb, 0.0), plain);
            let dithered = indices(dither, &picture, &table, Metric::Rgb);
            assert_eq!(dithered == plain, dither.name == "none", "{}", dither.name);
        }
    }

    /// The mean over blocks of 8 x 8 comes nearer with each dither, under both metrics.
    #[test]
    fn dithers_make_up_for_errors_nearby() {
        let picture = photograph(128, 160);
        let table = random_table(24);
        let error = |found: &[u8]| {
            let mut sum = 0.0;
            for (top, left) in (0..20).flat_map(|y| (0..16).map(move |x| (8 * y, 8 * x))) {
                let mut off = [0.0; 3];
                for (y, x) in (0..8).flat_map(|y| (0..8).map(move |x| (top + y, left + x))) {
                    let at = y * 128 + x;
                    let got = table.colors()[usize::from(found[at])];
                    for channel in 0..3 {
                        let wanted = picture.colors()[at][channel];
                        off[channel] += (f64::from(got[channel]) - f64::from(wanted)) / 64.0;
                    }
                }
                sum += off.iter().map(|off| off * off).sum::<f64>();
            }
            sum
        };
        for metric in Metric::ALL {
            let plain = error(&indices(&NONE, &picture, &table, metric));
            for (dither, share) in [(FLOYD_STEINBERG, 0.55), (BLUE_NOISE, 0.75)] {
                let found = error(&indices(&dither, &picture, &table, metric));
                assert!(found < share * plain, "{} {metric:?}: {found}, {plain}", dither.name);
            }
        }
    }

    #[test]
    fn flat_areas_of_a_table_color_stay_flat_beside_a_gradient() {
        let table = random_table(8);
        let flat = table.colors()[5];
        let ramp = |at: u32| [(at % 64 * 4) as u8, 90, 200 - (at % 64) as u8, 255];
        let colors = (0..128 * 64).map(|at| if at % 128 < 64 { ramp(at) } else { flat });
        let picture = Pixels::new(128, 64, colors.collect()).unwrap();
        for dither in TABLE {
            let found = indices(dither, &picture, &table, Metric::Oklab);
            for (at, &index) in found.iter().enumerate() {
                // The one column at the edge is not flat.
                assert!(at % 128 <= 64 || index == 5, "{}: {index} at {at}", dither.name);
            }
        }
    }

    #[test]
    fn opaque_pixels_get_opaque_entries_and_uncovered_ones_none() {
        let mut noise = noise();
        let mut colors: Vec<[u8; 4]> = (0..40).map(|_| [noise(), noise(), noise(), 255]).collect();
        colors[0] = [0; 4];
        for (color, alpha) in colors[1..].iter_mut().zip([60, 128, 190, 250]) {
            color[3] = alpha;
        }
        let table = Table::new(colors).unwrap();
        let alpha = |at: usize| [255, 0, 255, 120][at / 32 % 4];
        let pixels = photograph(32, 64);
        let colors = pixels.colors().iter().enumerate();
        let colors = colors.map(|(at, &[r, g, b, _])| [r, g, b, alpha(at)]).collect();
        let picture = Pixels::new(32, 64, colors).unwrap();
        for (dither, metric) in TABLE.iter().flat_map(|d| Metric::ALL.map(|metric| (d, metric))) {
            let found = indices(dither, &picture, &table, metric);
            for (at, &index) in found.iter().enumerate() {
                let got = table.colors()[usize::from(index)][3];
                match alpha(at) {
                    255 => assert_eq!(got, 255, "{} {metric:?}", dither.name),
                    0 => assert_eq!(index, 0, "{} {metric:?}", dither.name),
                    // Of a random table's few entries with alpha none needs to be near.
                    _ => assert!(got > 0, "{} {metric:?}", dither.name),
                }
            }
        }
    }

    #[test]
    fn tables_of_one_color_and_without_an_opaque_one_do() {
        let picture = photograph(20, 20);
        for colors in
            [vec![[9, 8, 7, 255]], vec![[9, 8, 7, 0]], vec![[0, 0, 0, 9], [255, 255, 255, 254]]]
        {
            let table = Table::new(colors.clone()).unwrap();
            for dither in TABLE {
                let found = indices(dither, &picture, &table, Metric::Oklab);
                let most = found.iter().max().unwrap();
                assert!(usize::from(*most) < colors.len(), "{}: {colors:?}, {most}", dither.name);
            }
        }
    }
}
