//! How much sooner a picture is there with more threads.
//!
//! `cargo bench -p render --bench threads` prints the median of nine alternating runs on one and on two threads, then
//! what 16 and 64 threads would make of the tiles: each tile is timed alone on one thread, and a thread that is done takes
//! the next tile from the middle of the picture on, as the renderer does.

use std::io::Write;
use std::time::Instant;

use render::{Options, World, radiance, render};

const SCENES: [&str; 2] = ["wine-glass/wine-glass.sdl", "gallery/aquarium.sdl"];
const RUNS: usize = 9;
/// Side of a tile, and of the picture in tiles.
const SIDE: u32 = 32;
/// Rays along each side of a pixel where tiles are timed.
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
            let costs = tile_costs(&world, side)?;
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

/// Seconds that each tile of a square picture takes, from its middle to its rim; the least of three.
fn tile_costs(world: &World, side: u32) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let options = Options { columns: side, rows: side, ..Options::default() };
    let across = side / SIDE;
    let mut tiles: Vec<(u32, u32)> =
        (0..across).flat_map(|row| (0..across).map(move |column| (column, row))).collect();
    let off = |place: u32| u64::from((2 * place + 1).abs_diff(across));
    tiles.sort_by_key(|&(column, row)| off(column) * off(column) + off(row) * off(row));
    let mut costs = Vec::with_capacity(tiles.len());
    for (column, row) in tiles {
        let places: Vec<(f64, f64)> = (0..SIDE * SIDE * GRID * GRID)
            .map(|k| {
                // Ray by ray of a pixel, pixel by pixel of the tile.
                let (pixel, ray) = (k / (GRID * GRID), k % (GRID * GRID));
                let within = |k: u32| (f64::from(k) + 0.5) / f64::from(GRID);
                let x = f64::from(column * SIDE + pixel % SIDE) + within(ray % GRID);
                (x, f64::from(row * SIDE + pixel / SIDE) + within(ray / GRID))
            })
            .collect();
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            radiance(world, &options, &places)?;
            best = best.min(start.elapsed().as_secs_f64());
        }
        costs.push(best);
    }
    Ok(costs)
}

/// Seconds until the last of some threads is done, each taking the next tile when it is free.
fn scheduled(costs: &[f64], threads: usize) -> f64 {
    let mut free = vec![0.0_f64; threads];
    for cost in costs {
        free.sort_by(f64::total_cmp);
        free[0] += cost;
    }
    free.into_iter().fold(0.0, f64::max)
}
