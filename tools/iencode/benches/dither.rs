//! Milliseconds of each dither under each metric for pictures of four sizes, smooth with some noise,
//! on one thread and on two: the least of several runs, in turn, so that both see the same load.
//! `cargo bench -p iencode`.
#![expect(clippy::print_stdout, reason = "the table is the output")]

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use iencode::dither;
use ilut::{Metric, Options, Pixels, table};

const SIZES: [[u32; 2]; 4] = [[592, 444], [1024, 768], [1536, 1152], [4000, 3000]];

fn main() -> Result<(), Box<dyn Error>> {
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let pools: Vec<_> = pools.into_iter().collect::<Result<_, _>>()?;
    let titles = ["Mpx", "dither", "metric", "1 thread", "2"];
    let [size, dither, metric, one, two] = titles;
    println!("{size:>5} {dither:>15} {metric:>6} {one:>9} {two:>9}");
    for [columns, rows] in SIZES {
        let megapixels = f64::from(columns) * f64::from(rows) / 1e6;
        let runs = if megapixels > 5.0 { 3 } else { 9 };
        let pixels = photograph(columns, rows)?;
        for metric in Metric::ALL {
            let table = table(&[&pixels], &Options { metric, ..Options::default() })?;
            for dither in dither::TABLE {
                let mut least = [f64::MAX; 2];
                for _ in 0..runs {
                    for (least, pool) in least.iter_mut().zip(&pools) {
                        let start = Instant::now();
                        let run = || dither.indices(&pixels, &table, metric, dither.strength);
                        black_box(pool.install(run));
                        *least = least.min(1e3 * start.elapsed().as_secs_f64());
                    }
                }
                let ([one, two], name, metric) = (least, dither.name, metric.word());
                let gain = one / two;
                println!(
                    "{megapixels:>5.2} {name:>15} {metric:>6} {one:>9.1} {two:>9.1} x{gain:>5.2}"
                );
            }
        }
    }
    Ok(())
}

/// Red across, green down, blue along the diagonal, and noise of up to 15 in each.
fn photograph(columns: u32, rows: u32) -> Result<Pixels, idf::ImageError> {
    let mut state = 1_u64;
    let mut noise = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::from((state >> 60) as u8)
    };
    let byte = |value: u32| value.to_le_bytes()[0];
    let colors = (0..columns * rows).map(|at| {
        let (x, y) = (at % columns * 240 / columns, at / columns * 240 / rows);
        [byte(x + noise()), byte(y + noise()), byte((x + y) / 2 + noise()), u8::MAX]
    });
    Pixels::new(columns, rows, colors.collect())
}
