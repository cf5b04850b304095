//! Tiles over threads. A pixel depends on its place alone, so neither the number of threads nor the order of the tiles
//! can be seen in the picture.

use rayon::prelude::*;
use scene::View;

use crate::film::{Film, Half};
use crate::options::Options;
use crate::sample::grid;
use crate::stats::RayStats;
use crate::trace::tree::Tracer;
use crate::world::World;

/// Side of a tile: small enough that the last one to finish does not hold up many threads.
const SIDE: u32 = 32;

struct Tile {
    column: u32,
    row: u32,
    columns: u32,
    pixels: Vec<[Half; 2]>,
    stats: RayStats,
}

/// Renders all tiles on the current thread pool and tells `progress` how many pixels each brought.
pub(crate) fn render(
    world: &World,
    view: &View,
    options: &Options,
    progress: &(dyn Fn(u64) + Sync),
) -> (Film, RayStats) {
    let (across, down) = (options.columns.div_ceil(SIDE), options.rows.div_ceil(SIDE));
    let samples = grid(options.grid);
    let tiles: Vec<Tile> = (0..across * down)
        .into_par_iter()
        .with_max_len(1)
        .map_init(
            || Tracer::new(world, options.accel, options.depth, options.min_weight),
            |tracer, number| {
                tracer.stats = RayStats::default();
                let (column, row) = (number % across * SIDE, number / across * SIDE);
                let columns = SIDE.min(options.columns - column);
                let rows = SIDE.min(options.rows - row);
                let mut pixels = Vec::with_capacity(columns as usize * rows as usize);
                for y in row..row + rows {
                    for x in column..column + columns {
                        let mut halves = [Half::default(); 2];
                        for sample in &samples {
                            let size = (options.columns, options.rows);
                            let seen = tracer.primary(sample.direction(view, x, y, size));
                            halves[sample.half].add(&seen, options.clamp, world.background);
                        }
                        pixels.push(halves);
                    }
                }
                progress(u64::from(columns) * u64::from(rows));
                Tile { column, row, columns, pixels, stats: tracer.stats }
            },
        )
        .collect();
    assemble(options, &tiles)
}

/// Puts the tiles in their places; sums run in the order of the tiles.
fn assemble(options: &Options, tiles: &[Tile]) -> (Film, RayStats) {
    let columns = options.columns as usize;
    let mut halves = vec![[Half::default(); 2]; columns * options.rows as usize];
    let mut stats = RayStats::default();
    for tile in tiles {
        stats.add(&tile.stats);
        for (y, row) in tile.pixels.chunks(tile.columns as usize).enumerate() {
            let start = (tile.row as usize + y) * columns + tile.column as usize;
            halves[start..start + row.len()].copy_from_slice(row);
        }
    }
    (Film::new(options.columns, options.rows, halves), stats)
}
