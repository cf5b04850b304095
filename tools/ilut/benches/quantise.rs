//! Milliseconds to quantise pictures with every method, map included, on one thread and on two: the
//! least of several runs. `cargo bench -p ilut` takes a made picture in four sizes;
//! `cargo bench -p ilut --bench quantise -- 40 photo.png` the files named, with 40 runs each.
#![expect(clippy::print_stdout, reason = "the table is the output")]

use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use idf::ReadOptions;
use idf::exchange::read_image;
use ilut::{Method, Metric, Options, Pixels, quantize};

const SIZES: [[u32; 2]; 4] = [[592, 444], [1024, 768], [1536, 1152], [4000, 3000]];

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:>5} {:>9} {:>6} {:>9} {:>9} {:>6}", "Mpx", "method", "metric", "1 thread", "2", "");
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let (runs, files) = match words.split_first() {
        Some((first, others)) => match first.parse() {
            Ok(runs) => (Some(runs), others),
            Err(_) => (None, &words[..]),
        },
        None => (None, &words[..]),
    };
    for file in files {
        let image = read_image(Path::new(file), &ReadOptions::default())?;
        measure(&Pixels::of(&image, None)?, runs)?;
    }
    if files.is_empty() {
        for [columns, rows] in SIZES {
            measure(&picture(columns, rows)?, runs)?;
        }
    }
    Ok(())
}

/// Prints a line for each method.
fn measure(picture: &Pixels, runs: Option<usize>) -> Result<(), Box<dyn Error>> {
    let megapixels = f64::from(picture.columns()) * f64::from(picture.rows()) / 1e6;
    let runs = runs.unwrap_or(if megapixels > 5.0 { 5 } else { 15 });
    for method in Method::ALL {
        for metric in Metric::ALL {
            let options = Options { method, metric, ..Options::default() };
            let [one, two] = times(picture, &options, runs)?;
            println!(
                "{megapixels:>5.2} {:>9} {:>6} {one:>9.2} {two:>9.2} x{:>5.2}",
                method.word(),
                metric.word(),
                one / two
            );
        }
    }
    Ok(())
}

/// Milliseconds on one thread and on two, in turn, so that both see the same load.
fn times(picture: &Pixels, options: &Options, runs: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let pools: Vec<_> = pools.into_iter().collect::<Result<_, _>>()?;
    let mut least = [f64::MAX; 2];
    for _ in 0..runs {
        for (least, pool) in least.iter_mut().zip(&pools) {
            let start = Instant::now();
            black_box(pool.install(|| quantize(&[black_box(picture)], options))?);
            *least = least.min(1e3 * start.elapsed().as_secs_f64());
        }
    }
    Ok(least)
}

/// Soft shades with an edge here and there and the grain of a sensor: as many distinct colours and
/// cells as a photograph of the size.
fn picture(columns: u32, rows: u32) -> Result<Pixels, Box<dyn Error>> {
    let mut state = 1_u32;
    let mut grain = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        // The sum of two: a triangle of -8 to 8.
        f64::from((state & 7) + (state >> 8 & 7)) - 7.0
    };
    let mut colors = Vec::new();
    for y in 0..rows {
        for x in 0..columns {
            let [u, v] = [f64::from(x) / f64::from(columns), f64::from(y) / f64::from(rows)];
            let wave = |a: f64, b: f64, c: f64| 0.5 + 0.5 * libm::sin(a * u + b * v + c);
            let edge = if wave(9.0, 14.0, 0.0) > 0.6 { 0.35 } else { 1.0 };
            let shade = [wave(5.0, 2.0, 0.5), wave(4.0, -3.0, 2.0), wave(-3.0, 6.0, 4.0)];
            let byte = |light: f64| byte(215.0 * edge * light + 20.0 + grain());
            let [red, green, blue] = shade.map(byte);
            colors.push([red, green, blue, u8::MAX]);
        }
    }
    Ok(Pixels::new(columns, rows, colors)?)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is clamped to a byte"
)]
fn byte(value: f64) -> u8 {
    value.clamp(0.0, 255.0) as u8
}
