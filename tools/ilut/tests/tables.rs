//! Tables and maps against plain, slow ones; claims about whole pictures.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::BTreeSet;

use ilut::{Method, Metric, Nearest, Options, Pixels, Table, TableError, quality, quantize, table};
use kiddo::{KdTree, SquaredEuclidean};

/// Numbers without a pattern (Marsaglia's xorshift).
struct Noise(u32);

impl Noise {
    fn word(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    fn color(&mut self) -> [u8; 4] {
        self.word().to_le_bytes()
    }
}

/// A shaded sky, a lit ball and a floor of stripes, with a grain of up to `grain` steps: as many
/// distinct colours as a photograph of this size.
fn scene(columns: u32, rows: u32, grain: u32) -> Pixels {
    let mut noise = Noise(7);
    let mut colors = Vec::new();
    for y in 0..rows {
        for x in 0..columns {
            let [u, v] = [f64::from(x) / f64::from(columns), f64::from(y) / f64::from(rows)];
            let (a, b) = (u - 0.4, v - 0.5);
            let squares = 0.09 - a * a - b * b;
            let light = if squares > 0.0 {
                let shade = (squares.sqrt() - a - b).max(0.0) * 1.6;
                [0.9 * shade + 0.05, 0.35 * shade + 0.05, 0.2 * shade]
            } else if v > 0.7 {
                let stripe = if (x * 12 / columns).is_multiple_of(2) { 0.8 } else { 0.3 };
                [stripe * v, stripe * 0.9 * u, 0.1 + stripe * 0.2]
            } else {
                [0.3 + 0.4 * v, 0.5 + 0.3 * v, 0.9 - 0.3 * u * v]
            };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "light from 0 to 2"
            )]
            let byte = |value: f64| (value * 250.0) as u32 + noise.word() % (grain + 1);
            let [r, g, b] = light.map(byte).map(|value| u8::try_from(value.min(255)).unwrap());
            colors.push([r, g, b, 255]);
        }
    }
    Pixels::new(columns, rows, colors).unwrap()
}

/// The picture with alpha that falls from left to right, some columns opaque, some clear.
fn faded(pixels: &Pixels) -> Pixels {
    let columns = pixels.columns();
    let colors = (0..).zip(pixels.colors()).map(|(at, &[r, g, b, _])| {
        let share = 320 * (at % columns) / columns;
        let alpha = 290_u32.saturating_sub(share).min(255);
        [r, g, b, u8::try_from(alpha.saturating_sub(20 * (share / 280))).unwrap()]
    });
    Pixels::new(columns, pixels.rows(), colors.collect()).unwrap()
}

fn options(method: Method, metric: Metric) -> Options {
    Options { method, metric, ..Options::default() }
}

fn distinct(pixels: &Pixels) -> BTreeSet<[u8; 4]> {
    let one = |color: &[u8; 4]| if color[3] == 0 { [0; 4] } else { *color };
    pixels.colors().iter().map(one).collect()
}

/// The place of a colour, by the formulas as they are written, in 64 bits.
fn place(metric: Metric, color: [u8; 4]) -> [f64; 4] {
    let alpha = f64::from(color[3]) / 255.0;
    let half = 255.0 * alpha / 2.0;
    let rgb = [color[0], color[1], color[2]];
    match metric {
        Metric::Rgb => {
            let [r, g, b] = rgb.map(|byte| alpha * f64::from(byte) - half);
            [r, g, b, 0.75_f64.sqrt() * 255.0 * alpha]
        }
        Metric::Oklab => {
            use palette::{FromColor, Oklab, Srgb};
            let [r, g, b] = rgb.map(|byte| f64::from(byte) / 255.0);
            let oklab = Oklab::from_color(Srgb::new(r, g, b));
            let [l, a, b] = [oklab.l, oklab.a, oklab.b].map(|value| 255.0 * alpha * value);
            [l - half, a, b, half]
        }
    }
}

fn distance(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Squared distances to the chosen and to the nearest entry that a colour may have.
fn chosen_and_nearest(table: &Table, metric: Metric, color: [u8; 4], index: u8) -> (f64, f64) {
    let colors = table.colors();
    let own = place(metric, color);
    let has_opaque = colors.iter().any(|entry| entry[3] == 255);
    let may = |entry: &&[u8; 4]| color[3] < 255 || entry[3] == 255 || !has_opaque;
    let nearest = colors.iter().filter(may).map(|&entry| distance(own, place(metric, entry)));
    let chosen = colors[usize::from(index)];
    assert!(may(&&chosen), "{color:?} -> {chosen:?}");
    (distance(own, place(metric, chosen)), nearest.fold(f64::MAX, f64::min))
}

#[test]
fn the_map_is_exact_with_any_table() {
    let mut noise = Noise(1);
    let opaque = |[r, g, b, _]: [u8; 4]| [r, g, b, 255];
    let scattered: Vec<[u8; 4]> = (0..256).map(|_| opaque(noise.color())).collect();
    let clumped: Vec<[u8; 4]> = (0..200)
        .map(|at| noise.color().map(|byte| byte % 24 + [0, 90, 200][at % 3]))
        .map(opaque)
        .collect();
    let translucent: Vec<[u8; 4]> = (0..100).map(|_| noise.color()).collect();
    let mixed = scattered[..40].iter().chain(&translucent).copied().collect();
    let one = vec![[9, 200, 31, 255]];
    let twice = vec![[50, 60, 70, 255], [50, 60, 70, 255], [0, 0, 0, 0]];
    let random: Vec<[u8; 4]> = (0..3000).map(|_| noise.color()).collect();
    let random = Pixels::new(60, 50, random).unwrap();
    let scene = scene(60, 50, 30);
    for colors in [scattered, clumped, translucent, mixed, one, twice] {
        let table = Table::new(colors).unwrap();
        for metric in Metric::ALL {
            let nearest = Nearest::new(&table, metric);
            for picture in [&scene, &random, &faded(&scene)] {
                let indices = nearest.indices(picture);
                for (&color, &index) in picture.colors().iter().zip(&indices) {
                    assert_eq!(index, nearest.index(color), "{metric:?} {color:?}");
                    let (chosen, least) = chosen_and_nearest(&table, metric, color, index);
                    // In RGB opaque distances are whole numbers; else 32 bits round.
                    let whole = metric == Metric::Rgb && color[3] == 255;
                    let slack = if whole { 1e-6 } else { 1e-3 + 1e-5 * least };
                    assert!(chosen <= least + slack, "{metric:?} {color:?}: {chosen} {least}");
                }
            }
        }
    }
}

#[test]
fn of_several_nearest_the_first_is_taken() {
    let table = Table::new(vec![[7, 7, 7, 255], [10, 0, 0, 255], [14, 0, 0, 255], [10, 0, 0, 255]]);
    let nearest = Nearest::new(&table.unwrap(), Metric::Rgb);
    let picture = Pixels::new(3, 1, vec![[12, 0, 0, 255], [10, 0, 0, 255], [13, 0, 0, 255]]);
    assert_eq!(nearest.indices(&picture.unwrap()), [1, 1, 2]);
}

#[test]
fn a_tree_of_another_library_finds_the_same_distances() {
    let picture = scene(80, 60, 12);
    let table = table(&[&picture], &Options::default()).unwrap();
    let place = |color: [u8; 4]| [color[0], color[1], color[2]].map(f64::from);
    let points: Vec<[f64; 3]> = table.colors().iter().map(|&color| place(color)).collect();
    let mut tree: KdTree<f64, 3> = KdTree::new();
    for (index, point) in (0..).zip(&points) {
        tree.add(point, index);
    }
    let indices = Nearest::new(&table, Metric::Rgb).indices(&picture);
    for (&color, &index) in picture.colors().iter().zip(&indices) {
        let point = points[usize::from(index)];
        let own: f64 = point.iter().zip(place(color)).map(|(a, b)| (a - b) * (a - b)).sum();
        let nearest = tree.nearest_one::<SquaredEuclidean>(&place(color));
        assert!((own - nearest.distance).abs() < 1e-9, "{color:?}: {own} {nearest:?}");
    }
}

#[test]
fn few_colors_are_the_table_and_nothing_changes() {
    let mut noise = Noise(3);
    for count in [1, 2, 16, 255, 256] {
        let colors: Vec<[u8; 4]> = (0..count).map(|_| noise.color()).collect();
        let all = (0..4000).map(|at| colors[at % count]).collect();
        let picture = Pixels::new(80, 50, all).unwrap();
        for method in Method::ALL {
            let exact = Options { colors: count, ..options(method, Metric::Rgb) };
            let quantized = quantize(&[&picture], &exact).unwrap();
            let entries: BTreeSet<[u8; 4]> = quantized.table.colors().iter().copied().collect();
            assert_eq!(entries, distinct(&picture), "{method:?} {count}");
            assert_eq!(quantized.table.colors().len(), entries.len());
            let figures = quality(&picture, &quantized.table, &quantized.indices[0]);
            assert!(figures.worst <= 0.0 && figures.rms_oklab <= 0.0, "{figures:?}");
        }
    }
}

#[test]
fn every_method_and_metric_gives_a_table_of_the_size_that_is_asked_for() {
    let picture = scene(90, 70, 9);
    for picture in [&picture, &faded(&picture)] {
        for method in Method::ALL {
            for metric in Metric::ALL {
                for colors in [1, 2, 3, 7, 64, 256] {
                    let options = Options { colors, ..options(method, metric) };
                    let quantized = quantize(&[picture], &options).unwrap();
                    let entries = quantized.table.colors();
                    assert!(entries.len() <= colors, "{options:?}");
                    assert!(colors > 64 || entries.len() == colors, "{options:?}");
                    assert_eq!(table(&[picture], &options).unwrap(), quantized.table);
                    for (color, &index) in picture.colors().iter().zip(&quantized.indices[0]) {
                        let entry = entries[usize::from(index)];
                        assert!(color[3] < 255 || entry[3] == 255, "{options:?} {color:?}");
                        assert!(color[3] > 0 || colors < 4 || entry == [0; 4], "{options:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    // Enough pixels that several threads count, and both kinds of histograms.
    for (picture, grain) in [(scene(800, 700, 40), 40), (scene(300, 200, 3), 3)] {
        for picture in [&picture, &faded(&picture)] {
            for method in Method::ALL {
                for metric in Metric::ALL {
                    let options = options(method, metric);
                    let [one, two] = [1, 2].map(|threads| {
                        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                        pool.build().unwrap().install(|| quantize(&[picture], &options).unwrap())
                    });
                    assert!(one == two, "{options:?}, grain {grain}");
                }
            }
        }
    }
}

#[test]
fn better_methods_are_better_on_their_own_terms() {
    let picture = scene(400, 300, 24);
    let figures = |method, metric| {
        let quantized = quantize(&[&picture], &options(method, metric)).unwrap();
        quality(&picture, &quantized.table, &quantized.indices[0])
    };
    let heckbert = figures(Method::Heckbert, Metric::Rgb);
    let fast = figures(Method::Fast, Metric::Rgb);
    let best = figures(Method::Best, Metric::Rgb);
    let oklab = figures(Method::Best, Metric::Oklab);
    // Reached: 35.6 and 36.4 dB, and 0.3 more.
    let floors = [(heckbert, 35.2), (fast, 36.0), (best, 36.4)];
    for (figures, floor) in floors {
        assert!(figures.psnr_rgb > floor, "{floors:?}");
    }
    assert!(heckbert.psnr_rgb + 0.5 < fast.psnr_rgb, "{heckbert:?} {fast:?}");
    assert!(fast.psnr_rgb + 0.2 < best.psnr_rgb, "{fast:?} {best:?}");
    assert!(oklab.rms_oklab < best.rms_oklab, "{oklab:?} {best:?}");
    assert!(oklab.psnr_rgb < best.psnr_rgb, "{oklab:?} {best:?}");
}

#[test]
fn a_table_for_a_dither_reaches_out_and_stays_in_the_gamut() {
    // All greys alike: what mixes lack below the darker entry `a`, a² / 2, against half of what its
    // own half of the greys draw inward, (127.5² / 2 - 127.5 a) / 2: a² + 127.5 a = 8128, a = 46.7.
    let ramp = (0..256 * 16).map(|at: u32| {
        let [grey, ..] = (at % 256).to_le_bytes();
        [grey, grey, grey, 255]
    });
    let ramp = Pixels::new(256, 16, ramp.collect()).unwrap();
    for method in [Method::Fast, Method::Best] {
        let two = Options { colors: 2, ..options(method, Metric::Rgb) };
        let greys = |options: &Options| {
            let mut colors = table(&[&ramp], options).unwrap().colors().to_vec();
            colors.sort_unstable();
            [f64::from(colors[0][0]), f64::from(colors[1][1])]
        };
        let [dark, light] = greys(&two);
        assert!((dark - 63.5).abs() < 2.0 && (light - 191.5).abs() < 2.0, "{dark} {light}");
        let [dark, light] = greys(&Options { spread: true, ..two });
        assert!((dark - 46.7).abs() < 2.0 && (light - 208.3).abs() < 2.0, "{dark} {light}");
    }
    // The hull of eight entries takes in more of the scene, and that of 33 is left as it is.
    let picture = scene(200, 150, 24);
    for metric in Metric::ALL {
        let plain = Options { colors: 8, ..options(Method::Best, metric) };
        let spread = Options { spread: true, ..plain.clone() };
        let width = |options: &Options| {
            let table = table(&[&picture], options).unwrap();
            let greens = table.colors().iter().map(|color| color[1]);
            greens.clone().max().unwrap() - greens.min().unwrap()
        };
        assert!(width(&spread) > width(&plain), "{metric:?}");
        let [plain, spread] = [plain, spread]
            .map(|options| table(&[&picture], &Options { colors: 33, ..options }).unwrap());
        assert_eq!(plain, spread);
    }
}

#[test]
fn kept_colors_come_first_and_exactly() {
    let picture = scene(120, 90, 9);
    let keep = vec![[255, 0, 255, 255], [1, 2, 3, 255], [0, 0, 0, 0], [9, 8, 7, 100]];
    for method in Method::ALL {
        for colors in [4, 5, 40] {
            let options = Options { colors, keep: keep.clone(), ..options(method, Metric::Oklab) };
            let table = table(&[&picture], &options).unwrap();
            assert_eq!(table.colors()[..4], keep);
            assert_eq!(table.colors().len(), colors);
        }
    }
    // A kept colour that the picture has is not in the table twice.
    let few = Pixels::new(2, 1, vec![[5, 5, 5, 255], [6, 6, 6, 255]]).unwrap();
    let options = Options { keep: vec![[6, 6, 6, 255]], ..Options::default() };
    let table = table(&[&few], &options).unwrap();
    assert_eq!(table.colors(), [[6, 6, 6, 255], [5, 5, 5, 255]]);
}

#[test]
fn an_error_bound_takes_as_few_colors_as_it_can() {
    let picture = scene(120, 90, 9);
    for (metric, most) in [(Metric::Rgb, 6.0), (Metric::Rgb, 30.0), (Metric::Oklab, 7.5)] {
        let error = |colors| {
            let options = Options { colors, ..options(Method::Best, metric) };
            let quantized = quantize(&[&picture], &options).unwrap();
            let figures = quality(&picture, &quantized.table, &quantized.indices[0]);
            if metric == Metric::Rgb { figures.rms_rgb } else { figures.rms_oklab }
        };
        let options = Options { max_error: Some(most), ..options(Method::Best, metric) };
        let count = table(&[&picture], &options).unwrap().colors().len();
        assert!((2..256).contains(&count), "{count}");
        assert!(error(count) <= most && error(count - 1) > most, "{metric:?} {most}: {count}");
    }
    let options = Options { max_error: Some(0.1), ..Options::default() };
    let error = table(&[&picture], &options).unwrap_err();
    assert!(matches!(error, TableError::MaxError { colors: 256, .. }), "{error}");
}

#[test]
fn one_table_serves_all_pictures() {
    let red = Pixels::new(2, 1, vec![[200, 0, 0, 255], [201, 0, 0, 255]]).unwrap();
    let blue = Pixels::new(3, 1, vec![[0, 0, 9, 255], [0, 0, 9, 255], [0, 0, 200, 7]]).unwrap();
    let quantized = quantize(&[&red, &blue], &Options::default()).unwrap();
    assert_eq!(quantized.table.colors().len(), 4);
    for (picture, indices) in [&red, &blue].into_iter().zip(&quantized.indices) {
        let colors = indices.iter().map(|&index| quantized.table.colors()[usize::from(index)]);
        assert_eq!(colors.collect::<Vec<_>>(), picture.colors());
    }
}

#[test]
fn options_that_cannot_be_met_are_refused() {
    let picture = Pixels::new(1, 1, vec![[1, 2, 3, 255]]).unwrap();
    assert_eq!(table(&[], &Options::default()), Err(TableError::NoPicture));
    for colors in [0, 257] {
        let options = Options { colors, ..Options::default() };
        assert_eq!(table(&[&picture], &options), Err(TableError::Colors(colors)));
    }
    let options = Options { colors: 1, keep: vec![[0; 4]; 2], ..Options::default() };
    assert_eq!(table(&[&picture], &options), Err(TableError::Keep { found: 2, most: 1 }));
}

#[test]
fn a_picture_of_noise_gets_the_nearest_entries_too() {
    let mut noise = Noise(11);
    // More than a quarter as many cells as pixels: indices are found color by color.
    let colors: Vec<[u8; 4]> = (0..300 * 300).map(|_| noise.color()).collect();
    let opaque = colors.iter().map(|&[r, g, b, _]| [r, g, b, 255]).collect();
    let mixed = colors.iter().map(|&[r, g, b, a]| [r, g, b, if a < 200 { 255 } else { a }]);
    for picture in [opaque, mixed.collect()] {
        let picture = Pixels::new(300, 300, picture).unwrap();
        for metric in Metric::ALL {
            let found = quantize(&[&picture], &Options { metric, ..Options::default() }).unwrap();
            let nearest = Nearest::new(&found.table, metric);
            let expected: Vec<u8> =
                picture.colors().iter().map(|&color| nearest.index(color)).collect();
            assert_eq!(found.indices[0], expected);
        }
    }
}

#[test]
fn a_table_without_an_opaque_entry_serves_opaque_pixels() {
    let table = Table::new(vec![[0, 0, 0, 9], [255, 255, 255, 254], [0; 4]]).unwrap();
    let opaque = Pixels::new(2, 1, vec![[3, 2, 1, 255], [250, 240, 230, 255]]).unwrap();
    let mixed = Pixels::new(2, 1, vec![[200, 220, 240, 255], [9, 9, 9, 0]]).unwrap();
    for metric in Metric::ALL {
        let nearest = Nearest::new(&table, metric);
        assert_eq!(nearest.indices(&opaque)[1], 1);
        assert_eq!(nearest.indices(&mixed), [1, 2]);
    }
}
