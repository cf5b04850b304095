//! Tiles over threads. A pixel depends on its place alone, so neither the number of threads nor the order of the tiles
//! can be seen in the picture.

use std::sync::atomic::{AtomicUsize, Ordering};

use scene::View;

use crate::film::{Film, FilmTile};
use crate::options::Options;
use crate::sample::{Sample, cone, grid, sight};
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
    let cone = cone(&view, (options.columns, options.rows), options.grid);
    let plan = Plan { world, view, options, samples: &samples, counts };
    let (order, next) = (from_the_middle(across, down), AtomicUsize::new(0));
    let made = rayon::broadcast(|_| {
        let &Options { accel, depth, min_weight, clamp, .. } = options;
        let mut tracer = Tracer::new(world, accel, depth, min_weight, cone).clamped(clamp);
        let mut made = Vec::new();
        while let Some(&number) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            let tile = plan.tile(&mut tracer, number % across * SIDE, number / across * SIDE);
            progress(tile.0.halves[0].len() as u64);
            made.push((number, tile));
        }
        made
    });
    let mut tiles: Vec<_> = made.into_iter().flatten().collect();
    tiles.sort_unstable_by_key(|&(number, _)| number);
    let mut stats = RayStats::default();
    let pieces = tiles.into_iter().map(|(_, (tile, counted))| {
        // Sums run in the order of the tiles.
        stats.add(&counted);
        tile
    });
    let pieces = pieces.collect();
    (Film::new((options.columns, options.rows), SIDE, counts, pieces), stats)
}

/// The tiles of a picture from its middle to its rim: what is there takes longest as a rule, and the last tiles should
/// take little, so that all threads end together.
fn from_the_middle(across: u32, down: u32) -> Vec<u32> {
    let mut tiles: Vec<u32> = (0..across * down).collect();
    tiles.sort_by_key(|number| {
        let off = |place: u32, count: u32| u64::from((2 * place + 1).abs_diff(count));
        let (x, y) = (off(number % across, across), off(number / across, down));
        x * x + y * y
    });
    tiles
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
                rays.push(tracer.primary(sight(&self.view, place, (columns, rows))));
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
        let [a, b, c, d] = corners.map(|place| sight(&self.view, place, size));
        if self.view.parallel {
            let points = [a, b, c, d].map(|sight| self.world.eye + sight.offset);
            return Beam::parallel(points, self.view.forward);
        }
        Beam::new(self.world.eye, [a, b, c, d].map(|sight| sight.direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_once_and_the_middle_first() {
        assert_eq!(from_the_middle(3, 3), [4, 1, 3, 5, 7, 0, 2, 6, 8]);
        assert_eq!(from_the_middle(4, 1), [1, 2, 0, 3]);
        let mut tiles = from_the_middle(13, 7);
        tiles.sort_unstable();
        assert!(tiles.into_iter().eq(0..13 * 7), "a permutation");
    }
}
