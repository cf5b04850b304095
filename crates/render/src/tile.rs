//! Tiles over threads. A pixel depends on its place alone, so neither the number of threads nor the order of the tiles
//! can be seen in the picture.

use rayon::prelude::*;
use scene::View;

use crate::film::{Film, Half};
use crate::options::Options;
use crate::sample::{Sample, direction, grid};
use crate::stats::RayStats;
use crate::trace::tree::Tracer;
use crate::world::World;
use crate::world::region::Beam;

/// Side of a tile: small enough that the last one to finish does not hold up many threads.
const SIDE: u32 = 32;

/// A picture to be made.
#[derive(Clone, Copy)]
struct Plan<'w> {
    world: &'w World,
    view: View,
    options: &'w Options,
    samples: &'w [Sample],
    counts: [u32; 2],
}

struct Tile {
    column: u32,
    row: u32,
    columns: u32,
    /// Sums of both halves, row by row.
    halves: [Vec<Half>; 2],
    stats: RayStats,
}

/// Renders all tiles on the current thread pool and tells `progress` how many pixels each brought.
pub(crate) fn render(
    world: &World,
    view: View,
    options: &Options,
    progress: &(dyn Fn(u64) + Sync),
) -> (Film, RayStats) {
    let (across, down) = (options.columns.div_ceil(SIDE), options.rows.div_ceil(SIDE));
    let samples = grid(options.grid);
    let mut counts = [0; 2];
    for sample in &samples {
        counts[sample.half] += 1;
    }
    let plan = Plan { world, view, options, samples: &samples, counts };
    let tiles: Vec<Tile> = (0..across * down)
        .into_par_iter()
        .with_max_len(1)
        .map_init(
            || Tracer::new(world, options.accel, options.depth, options.min_weight),
            |tracer, number| {
                let tile = plan.tile(tracer, number % across * SIDE, number / across * SIDE);
                progress(tile.halves[0].len() as u64);
                tile
            },
        )
        .collect();
    plan.assemble(&tiles)
}

impl Plan<'_> {
    fn tile(&self, tracer: &mut Tracer<'_>, column: u32, row: u32) -> Tile {
        let Options { columns, rows, clamp, .. } = *self.options;
        let (width, height) = (SIDE.min(columns - column), SIDE.min(rows - row));
        let region = self.world.within(&self.beam(column, row, width, height));
        let region = region.as_ref().unwrap_or(&self.world.whole);
        tracer.stats = RayStats::default();
        let pixels = width as usize * height as usize;
        let mut halves =
            self.counts.map(|count| vec![Half::default(); if count > 0 { pixels } else { 0 }]);
        for pixel in 0..width * height {
            let (x, y) = (column + pixel % width, row + pixel / width);
            for sample in self.samples {
                let place = (f64::from(x) + sample.x, f64::from(y) + sample.y);
                let seen = tracer.primary(region, direction(&self.view, place, (columns, rows)));
                halves[sample.half][pixel as usize].add(&seen, clamp, self.world.background);
            }
        }
        Tile { column, row, columns: width, halves, stats: tracer.stats }
    }

    /// All rays of a tile, and a pixel more on each side for rounding.
    fn beam(&self, column: u32, row: u32, width: u32, height: u32) -> Beam {
        let size = (self.options.columns, self.options.rows);
        let (left, top) = (f64::from(column) - 1.0, f64::from(row) - 1.0);
        let (right, bottom) = (left + f64::from(width) + 2.0, top + f64::from(height) + 2.0);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        Beam::new(self.world.eye, corners.map(|place| direction(&self.view, place, size)))
    }

    /// Puts the tiles in their places; sums run in the order of the tiles.
    fn assemble(&self, tiles: &[Tile]) -> (Film, RayStats) {
        let mut film = Film::new(self.options.columns, self.options.rows, self.counts);
        let mut stats = RayStats::default();
        for tile in tiles {
            stats.add(&tile.stats);
            for (half, sums) in tile.halves.iter().enumerate() {
                for (row, piece) in (tile.row..).zip(sums.chunks(tile.columns as usize)) {
                    film.put(half, tile.column, row, piece);
                }
            }
        }
        (film, stats)
    }
}
