//! How much sooner a picture is there with more threads.
//!
//! `cargo bench -p render --bench threads` prints the median of nine alternating runs on one and on two threads, then
//! what 16 and 64 threads would make of the tiles: each tile is timed alone on one thread, and a thread that is done takes
//! the next tile from the middle of the picture on, as the renderer does.

use std::io::Write;
use std::time::Instant;

use render::{Options, Sampling, World, render, scheduled, tile_seconds};

const SCENES: [&str; 2] = ["wine-glass/wine-glass.sdl", "gallery/aquarium.sdl"];
const RUNS: usize = 9;
/// Samples along each side of a pixel where tiles are timed.
const GRID: u32 = 4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout().lock();
    for name in SCENES {
        let path = format!("{}/../../scenes/{name}", env!("CARGO_MANIFEST_DIR"));
        let compiled = compile::compile_path(path.as_ref());
        let scene = compiled.scene.as_ref().ok_or_else(|| compiled.report())?;
        let world = World::load(scene)?;
        let mut seconds = [Vec::new(), Vec::new()];
        for _ in 0..RUNS {
            for (threads, seconds) in (1..).zip(&mut seconds) {
                let options = Options { threads, columns: 1024, rows: 1024, ..Options::default() };
                let start = Instant::now();
                render(&world, &options, &|_| ())?;
                seconds.push(start.elapsed().as_secs_f64());
            }
        }
        let [one, two] = seconds.map(median);
        writeln!(out, "{name}: {one:.4} s on one thread, {two:.4} s on two: {:.2} ×", one / two)?;
        for side in [512, 1024] {
            let sampling = Sampling::Grid(GRID);
            let options = Options { columns: side, rows: side, sampling, ..Options::default() };
            let costs = tile_seconds(&world, &options)?;
            let whole: f64 = costs.iter().sum();
            write!(out, "{name}, {side} × {side}, simulated:")?;
            for threads in [2, 4, 16, 64] {
                write!(out, " {threads} threads {:.1} ×", whole / scheduled(&costs, threads))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
