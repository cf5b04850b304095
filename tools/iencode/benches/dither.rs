//! Nanoseconds a pixel of each dither under each metric, on a smooth picture with some noise.
//!
//! `cargo bench -p iencode` prints the best of several runs of each; `RAYON_NUM_THREADS=1` for one
//! thread.

use std::error::Error;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

use iencode::dither;
use ilut::{Metric, Options, Pixels, table};

const COLUMNS: u32 = 1024;
const ROWS: u32 = 768;
const RUNS: u32 = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let pixels = photograph()?;
    for metric in Metric::ALL {
        let table = table(&[&pixels], &Options { metric, ..Options::default() })?;
        for dither in dither::TABLE {
            let run = || {
                let start = Instant::now();
                black_box(dither.indices(&pixels, &table, metric, dither.strength));
                start.elapsed().as_secs_f64()
            };
            let best = (0..RUNS).map(|_| run()).fold(f64::INFINITY, f64::min);
            let nanoseconds = best * 1e9 / (f64::from(COLUMNS) * f64::from(ROWS));
            let (name, metric) = (dither.name, metric.word());
            writeln!(std::io::stdout(), "{name:16} {metric:6} {nanoseconds:6.1} ns a pixel")?;
        }
    }
    Ok(())
}

/// Red across, green down, blue along the diagonal, and noise of up to 15 in each.
fn photograph() -> Result<Pixels, idf::ImageError> {
    let mut state = 1_u64;
    let mut noise = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::from((state >> 60) as u8)
    };
    let byte = |value: u32| value.to_le_bytes()[0];
    let colors = (0..COLUMNS * ROWS).map(|at| {
        let (x, y) = (at % COLUMNS * 240 / COLUMNS, at / COLUMNS * 240 / ROWS);
        [byte(x + noise()), byte(y + noise()), byte((x + y) / 2 + noise()), u8::MAX]
    });
    Pixels::new(COLUMNS, ROWS, colors.collect())
}
