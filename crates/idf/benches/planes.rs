//! Rows per second, coded and plain, and samples per second through the table of a transfer.
//!
//! `cargo bench -p idf` prints the best of several runs of each.

use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

use idf::transfer::rounded_8;
use idf::{Transfer, rle, srgb8};

const COLUMNS: u16 = 2048;
const ROWS: usize = 2048;

fn main() -> std::io::Result<()> {
    let columns = usize::from(COLUMNS);
    let flat = vec![7; columns * ROWS];
    // Runs of 1 to 16 bytes.
    let mixed: Vec<u8> =
        (0..ROWS).flat_map(|_| (0..COLUMNS).map(|x| (x / (x % 16 + 1)).to_le_bytes()[0])).collect();
    for (name, rows) in [("flat", &flat), ("mixed", &mixed)] {
        let file = rle::encode(rows, columns);
        report(&format!("encode {name} rows"), ROWS, || rle::encode(black_box(rows), columns))?;
        report(&format!("decode {name} rows"), ROWS, || {
            rle::decode(black_box(&file), columns, ROWS)
        })?;
    }
    report("copy rows", ROWS, || black_box(&flat).clone())?;
    let light: Vec<f64> = (0..1_u32 << 20).map(|i| f64::from(i) / f64::from(1 << 20)).collect();
    let sum =
        |byte: fn(f64) -> u8| light.iter().map(|&l| u64::from(byte(black_box(l)))).sum::<u64>();
    report("bytes by table", light.len(), || sum(srgb8))?;
    report("bytes by formula", light.len(), || sum(|l| rounded_8(Transfer::Srgb, l)))
}

/// Prints the number per second of `count` things that `work` does.
fn report<T>(name: &str, count: usize, work: impl Fn() -> T) -> std::io::Result<()> {
    let run = || {
        let start = Instant::now();
        black_box(work());
        start.elapsed().as_secs_f64()
    };
    let best = (0..7).map(|_| run()).fold(f64::INFINITY, f64::min);
    let count = f64::from(u32::try_from(count).unwrap_or(u32::MAX));
    let (nanoseconds, rate) = (best / count * 1e9, count / best);
    writeln!(std::io::stdout(), "{name:20} {nanoseconds:10.1} ns {rate:14.0} per second")
}
