//! Tiles over threads. A pixel depends on its place alone, so neither the number of threads nor the order of the tiles
//! can be seen in the picture.

use rayon::prelude::*;
use scene::View;

use crate::film::{Film, FilmTile};
use crate::options::Options;
use crate::sample::{Sample, direction, grid, spread};
use crate::stats::RayStats;
use crate::trace::tree::{BATCH, Tracer};
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
    let spread = spread(&view, (options.columns, options.rows)) / f64::from(options.grid);
    let plan = Plan { world, view, options, samples: &samples, counts };
    let tiles: Vec<(FilmTile, RayStats)> = (0..across * down)
        .into_par_iter()
        .with_max_len(1)
        .map_init(
            || Tracer::new(world, options.accel, options.depth, options.min_weight, spread),
            |tracer, number| {
                let tile = plan.tile(tracer, number % across * SIDE, number / across * SIDE);
                progress(tile.0.halves[0].len() as u64);
                tile
            },
        )
        .collect();
    let mut stats = RayStats::default();
    let pieces = tiles.into_iter().map(|(tile, counted)| {
        // Sums run in the order of the tiles.
        stats.add(&counted);
        tile
    });
    let pieces = pieces.collect();
    (Film::new((options.columns, options.rows), SIDE, counts, pieces), stats)
}

impl Plan<'_> {
    fn tile(&self, tracer: &mut Tracer<'_>, column: u32, row: u32) -> (FilmTile, RayStats) {
        let Options { columns, rows, clamp, .. } = *self.options;
        let (width, height) = (SIDE.min(columns - column), SIDE.min(rows - row));
        let region = self.world.within(&self.beam(column, row, width, height));
        let region = region.as_ref().unwrap_or(&self.world.whole);
        tracer.stats = RayStats::default();
        let mut tile = FilmTile::new(width, height, self.counts);
        let places = (0..width * height).flat_map(|pixel| {
            let corner = (f64::from(column + pixel % width), f64::from(row + pixel / width));
            self.samples.iter().map(move |sample| (pixel as usize, corner, sample))
        });
        // A whole number of batches at a time: many samples a pixel take no more memory than one.
        let mut places = places.peekable();
        let (mut rays, mut targets, mut seen) = (Vec::new(), Vec::new(), Vec::new());
        while places.peek().is_some() {
            for (pixel, corner, sample) in places.by_ref().take(BATCH) {
                let place = (corner.0 + sample.x, corner.1 + sample.y);
                rays.push(tracer.primary(direction(&self.view, place, (columns, rows))));
                targets.push((sample.half, pixel));
            }
            tracer.look(region, &rays, &mut seen);
            for (&(half, pixel), seen) in targets.iter().zip(&seen) {
                tile.halves[half][pixel].add(seen, clamp, self.world.background);
            }
            rays.clear();
            targets.clear();
            seen.clear();
        }
        (tile, tracer.stats)
    }

    /// All rays of a tile, and a pixel more on each side for rounding.
    fn beam(&self, column: u32, row: u32, width: u32, height: u32) -> Beam {
        let size = (self.options.columns, self.options.rows);
        let (left, top) = (f64::from(column) - 1.0, f64::from(row) - 1.0);
        let (right, bottom) = (left + f64::from(width) + 2.0, top + f64::from(height) + 2.0);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        Beam::new(self.world.eye, corners.map(|place| direction(&self.view, place, size)))
    }
}
