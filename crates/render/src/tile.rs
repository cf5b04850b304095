//! Tiles over threads. A pixel depends on its place alone, so neither the number of threads nor the order of the tiles
//! can be seen in the picture.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use scene::View;

use crate::certify::picture::render as certified;
use crate::certify::points::Points;
use crate::film::{Film, FilmTile, Half, Piece, Sums, WideTile};
use crate::options::{Filter, Options, Rate, Sampling};
use crate::sampling::pattern::{Pattern, pixel_seed};
use crate::sampling::place::{cone, sight};
use crate::sampling::progressive::{until_error, until_time};
use crate::sampling::sequence::Draw;
use crate::sampling::subdivision::{Corner, Lattice};
use crate::shade::footprint::Cone;
use crate::stats::RayStats;
use crate::trace::record::Seen;
use crate::trace::tree::{BATCH, Branch, Tracer};
use crate::world::World;
use crate::world::region::{Beam, Region};
use crate::{Ending, Picture};

/// Side of a tile: small enough that the last one to finish does not hold up many threads.
pub(crate) const SIDE: u32 = 32;

/// A picture to be made: the pixels whose samples count in it, in tiles.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'w> {
    pub(crate) world: &'w World,
    pub(crate) options: &'w Options,
    view: View,
    /// What a ray stands for if it is alone in its pixel.
    cone: Cone,
    /// Once it says so the picture is given up.
    stopped: Option<Stopped<'w>>,
}

/// Whether a picture is not wanted any more; once it is not it stays so.
pub(crate) type Stopped<'s> = &'s (dyn Fn() -> bool + Sync);

/// A ray of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    /// In pixels; (0, 0) is the top left corner of the picture.
    pub(crate) place: (f64, f64),
    /// Side of the square it stands for, in pixels.
    pub(crate) side: f64,
    pub(crate) draw: Draw,
}

/// Renders all tiles on the current thread pool and tells `progress` how many pixels each brought.
pub(crate) fn render(
    world: &World,
    view: View,
    options: &Options,
    progress: &(dyn Fn(u64) + Sync),
) -> Picture {
    let frame = Frame::new(world, view, options);
    sampled(&frame, progress, None).expect("nothing stops it")
}

/// The same until it is not wanted any more; `show` is given what there is after each round, if there are rounds.
pub(crate) fn render_while_wanted(
    world: &World,
    view: View,
    options: &Options,
    stopped: Stopped<'_>,
    show: Option<&mut (dyn FnMut(Picture) + Send)>,
) -> Option<Picture> {
    let frame = Frame { stopped: Some(stopped), ..Frame::new(world, view, options) };
    sampled(&frame, &|_| (), show)
}

/// The picture of a frame, if it is not stopped.
fn sampled(
    frame: &Frame<'_>,
    progress: &(dyn Fn(u64) + Sync),
    show: Option<&mut (dyn FnMut(Picture) + Send)>,
) -> Option<Picture> {
    let options = frame.options;
    let points = Points::new(options.sampling, options.seed).filter(|_| options.certify);
    if let Some(points) = points {
        return certified(frame, &points, progress);
    }
    match options.sampling {
        Sampling::Stochastic(Rate::Error(wanted)) => until_error(frame, wanted, progress, show),
        Sampling::Stochastic(Rate::Time(time)) => until_time(frame, time, progress),
        Sampling::Stochastic(Rate::Samples(_))
        | Sampling::Grid(_)
        | Sampling::Subdivided { .. } => at_once(frame, progress),
    }
}

/// Each tile as it will be; nothing if there are not all of them.
fn at_once(frame: &Frame<'_>, progress: &(dyn Fn(u64) + Sync)) -> Option<Picture> {
    let options = frame.options;
    let size = (options.columns, options.rows);
    let counts = Pattern::new(options.sampling, options.seed).map_or([1, 0], |p| p.counts());
    if options.filter == Filter::Box {
        let start = |piece: Piece| FilmTile::new(piece.width, piece.height, counts);
        let (tiles, stats) = frame.tiles(progress, start);
        let is_whole = !frame.is_stopped();
        is_whole.then(|| frame.picture(frame.film(counts, tiles), stats))
    } else {
        let start = |piece| WideTile::new(piece, options.filter, counts);
        let (tiles, stats) = frame.tiles(progress, start);
        let is_whole = !frame.is_stopped();
        is_whole.then(|| frame.picture(Film::of_wide(size, [0; 2], counts, tiles), stats))
    }
}

/// The number of a corner of the finest squares along one side of the picture; those before its first count down from 2³².
fn corner_number(place: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "below 2²¹")]
    let number = (place * f64::from(1 << Sampling::MOST_LEVELS)) as i32;
    number.cast_unsigned()
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

impl<'w> Frame<'w> {
    pub(crate) fn new(world: &'w World, view: View, options: &'w Options) -> Self {
        let cone = cone(&view, (options.columns, options.rows));
        Self { world, options, view, cone, stopped: None }
    }

    /// Whether the picture is given up: tiles may be missing.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.is_some_and(|stopped| stopped())
    }

    pub(crate) fn view(&self) -> &View {
        &self.view
    }

    /// A film of all tiles in their order.
    pub(crate) fn film(&self, counts: [u32; 2], tiles: Vec<FilmTile>) -> Film {
        Film::new((self.options.columns, self.options.rows), SIDE, counts, tiles)
    }

    /// A finished picture.
    pub(crate) fn picture(&self, film: Film, stats: RayStats) -> Picture {
        let (columns, rows) = self.sampled();
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let samples = stats.primary as f64 / (f64::from(columns) * f64::from(rows));
        let independent = matches!(self.options.sampling, Sampling::Stochastic(_));
        let error = if independent { film.error(self.background()) } else { None };
        let (cut, ending) = (stats.cut(), Ending::Done);
        Picture { film, stats, samples, error, cut, ending, certificates: None }
    }

    pub(crate) fn background(&self) -> [f32; 3] {
        #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
        self.world.background.to_array().map(|channel| channel as f32)
    }

    /// Columns and rows of the pixels that are sampled: where the filter reaches beyond a pixel, those around the
    /// picture, too.
    pub(crate) fn sampled(&self) -> (u32, u32) {
        let grown = |side: u32| side + 2 * self.options.filter.reach();
        (grown(self.options.columns), grown(self.options.rows))
    }

    /// Tiles across and down.
    fn across_and_down(&self) -> (u32, u32) {
        let (columns, rows) = self.sampled();
        (columns.div_ceil(SIDE), rows.div_ceil(SIDE))
    }

    pub(crate) fn tile_count(&self) -> u32 {
        let (across, down) = self.across_and_down();
        across * down
    }

    /// A tile by its number, row by row.
    pub(crate) fn piece(&self, number: u32) -> Piece {
        let (across, _) = self.across_and_down();
        let (columns, rows) = self.sampled();
        let reach = self.options.filter.reach();
        let side = |tile: u32, side: u32| {
            let first = tile * SIDE;
            let whole = |number: u32| i32::try_from(number).expect("below 2¹⁷");
            (whole(first) - whole(reach), SIDE.min(side - first))
        };
        let (column, width) = side(number % across, columns);
        let (row, height) = side(number / across, rows);
        Piece { column, row, width, height }
    }

    pub(crate) fn tracer(&self) -> Tracer<'w> {
        let Options { accel, depth, min_weight, clamp, .. } = *self.options;
        Tracer::new(self.world, accel, depth, min_weight).clamped(clamp)
    }

    /// Does some work for each tile, on all threads, from the middle of the picture on. Results come in the order of the
    /// tiles.
    pub(crate) fn over_tiles<R: Send>(
        &self,
        work: impl Fn(&mut Tracer<'w>, u32) -> R + Sync,
    ) -> Vec<R> {
        self.over_tiles_with(|| (), |tracer, (), number| work(tracer, number))
    }

    /// [`Frame::over_tiles`], with something of its own for each thread.
    pub(crate) fn over_tiles_with<T, R: Send>(
        &self,
        start: impl Fn() -> T + Sync,
        work: impl Fn(&mut Tracer<'w>, &mut T, u32) -> R + Sync,
    ) -> Vec<R> {
        let (across, down) = self.across_and_down();
        self.over(&from_the_middle(across, down), start, work)
    }

    /// Does some work for each number of `order`, begun in that order, until the picture is given up, with something of its
    /// own for each thread. Results come in the order of the numbers.
    pub(crate) fn over<T, R: Send>(
        &self,
        order: &[u32],
        start: impl Fn() -> T + Sync,
        work: impl Fn(&mut Tracer<'w>, &mut T, u32) -> R + Sync,
    ) -> Vec<R> {
        let next = AtomicUsize::new(0);
        let made = rayon::broadcast(|_| {
            let (mut tracer, mut own) = (self.tracer(), start());
            let mut made = Vec::new();
            while let Some(&number) = order.get(next.fetch_add(1, Ordering::Relaxed))
                && !self.is_stopped()
            {
                made.push((number, work(&mut tracer, &mut own, number)));
            }
            made
        });
        let mut made: Vec<_> = made.into_iter().flatten().collect();
        made.sort_unstable_by_key(|&(number, _)| number);
        made.into_iter().map(|(_, result)| result).collect()
    }

    /// Fills what `start` makes for each tile.
    fn tiles<S: Sums + Send>(
        &self,
        progress: &(dyn Fn(u64) + Sync),
        start: impl Fn(Piece) -> S + Sync,
    ) -> (Vec<S>, RayStats) {
        let pattern = Pattern::new(self.options.sampling, self.options.seed);
        let made = self.over_tiles(|tracer, number| {
            let piece = self.piece(number);
            let mut sums = start(piece);
            let stats = self.fill(tracer, piece, pattern.as_ref(), &mut sums);
            progress(piece.area() as u64);
            (sums, stats)
        });
        let mut stats = RayStats::default();
        let tiles = made.into_iter().map(|(sums, counted)| {
            // Sums run in the order of the tiles.
            stats.add(&counted);
            sums
        });
        (tiles.collect(), stats)
    }

    /// Seconds that each tile takes on the current thread, in the order in which threads take them.
    pub(crate) fn seconds(&self) -> Vec<f64> {
        let (across, down) = self.across_and_down();
        let pattern = Pattern::new(self.options.sampling, self.options.seed);
        let counts = pattern.as_ref().map_or([1, 0], Pattern::counts);
        let mut tracer = self.tracer();
        let timed = |number| {
            let (piece, begun) = (self.piece(number), Instant::now());
            let mut sums = WideTile::new(piece, self.options.filter, counts);
            self.fill(&mut tracer, piece, pattern.as_ref(), &mut sums);
            begun.elapsed().as_secs_f64()
        };
        from_the_middle(across, down).into_iter().map(timed).collect()
    }

    /// Samples all pixels of a piece, by a pattern or divided where there is none.
    pub(crate) fn fill(
        &self,
        tracer: &mut Tracer<'w>,
        piece: Piece,
        pattern: Option<&Pattern>,
        sums: &mut impl Sums,
    ) -> RayStats {
        tracer.stats = RayStats::default();
        match pattern {
            Some(pattern) => self.sample(tracer, piece, pattern, sums),
            None => self.divide(tracer, piece, sums),
        }
        tracer.stats
    }

    /// Samples of all pixels of a piece by a pattern.
    fn sample(
        &self,
        tracer: &mut Tracer<'w>,
        piece: Piece,
        pattern: &Pattern,
        sums: &mut impl Sums,
    ) {
        let side = pattern.side();
        let region = self.region(&piece);
        let shots = piece.in_blocks().into_iter().flat_map(|number| {
            let pixel = piece.pixel(number);
            let corner = pixel.map(f64::from);
            pattern.samples(pixel.map(i32::cast_unsigned)).map(move |sample| {
                let place = (corner[0] + sample.x, corner[1] + sample.y);
                ((number, sample), Shot { place, side, draw: sample.draw })
            })
        });
        self.follow(tracer, region.as_ref(), shots, |(number, sample), light| {
            sums.add(sample.half, number, [sample.x, sample.y], 1.0, light);
        });
    }

    /// All pixels of a piece, divided where their corners differ.
    fn divide(&self, tracer: &mut Tracer<'w>, piece: Piece, sums: &mut impl Sums) {
        let Sampling::Subdivided { levels } = self.options.sampling else { return };
        let region = self.region(&piece);
        let background = self.background();
        Lattice::new(piece, levels).divide(sums, |places, side, corners| {
            tracer.firsts = Some(Vec::with_capacity(places.len()));
            let shots = places.iter().map(|&[x, y]| {
                let place = (f64::from(piece.column) + x, f64::from(piece.row) + y);
                // Corners are shared by tiles.
                let [column, row] = [place.0, place.1].map(corner_number);
                let draw = Draw::new(0, pixel_seed([column, row], 0, self.options.seed));
                ((), Shot { place, side, draw })
            });
            let mut lights = Vec::with_capacity(places.len());
            self.follow(tracer, region.as_ref(), shots, |(), light| lights.push(light));
            let mut firsts = tracer.firsts.take().unwrap_or_default();
            // Those that were not looked at because the picture is given up.
            firsts.resize(lights.len(), 0);
            let corner = |(light, first): (Half, usize)| Corner::new(light, background, first);
            corners.extend(lights.into_iter().zip(firsts).map(corner));
        });
    }

    /// What can be met in a piece, or all of the world. Rays through a lens are in no beam.
    pub(crate) fn region(&self, piece: &Piece) -> Option<Region> {
        if self.world.lens.is_some() { None } else { self.world.within(&self.beam(piece)) }
    }

    /// Follows rays a batch at a time: many samples a pixel take no more memory than one. `take` hears what each saw, in
    /// their order; nothing of a batch that begins when the picture is given up.
    pub(crate) fn follow<T>(
        &self,
        tracer: &mut Tracer<'w>,
        region: Option<&Region>,
        shots: impl Iterator<Item = (T, Shot)>,
        mut take: impl FnMut(T, Half),
    ) {
        let Options { columns, rows, clamp, .. } = *self.options;
        let region = region.unwrap_or(&self.world.whole);
        let (mut rays, mut targets) = (Vec::with_capacity(BATCH), Vec::with_capacity(BATCH));
        let mut seen: Vec<Seen> = Vec::new();
        let mut look = |tracer: &mut Tracer<'w>, rays: &mut Vec<Branch>, targets: &mut Vec<T>| {
            if self.is_stopped() {
                // No one sees it.
                targets.drain(..).for_each(|target| take(target, Half::default()));
            } else {
                tracer.look(region, rays, &mut seen);
                for (target, seen) in targets.drain(..).zip(&seen) {
                    take(target, Half::of(seen, clamp, self.world.background));
                }
            }
            rays.clear();
            seen.clear();
        };
        // From within: nested iterators are slow when they are asked for one after the other.
        shots.for_each(|(target, Shot { place, side, draw })| {
            let Cone { width, spread } = self.cone;
            let cone = Cone { width: side * width, spread: side * spread };
            let mut sight = sight(&self.view, place, (columns, rows));
            if let Some(lens) = &self.world.lens {
                let [.., u, v] = draw.start();
                sight = lens.through(&self.view, sight, [u, v]);
            }
            rays.push(tracer.primary(sight, cone, draw));
            targets.push(target);
            if rays.len() == BATCH {
                look(tracer, &mut rays, &mut targets);
            }
        });
        look(tracer, &mut rays, &mut targets);
    }

    /// All rays of a piece, and a pixel more on each side for rounding.
    pub(crate) fn beam(&self, piece: &Piece) -> Beam {
        let size = (self.options.columns, self.options.rows);
        let (left, top) = (f64::from(piece.column) - 1.0, f64::from(piece.row) - 1.0);
        let right = left + f64::from(piece.width) + 2.0;
        let bottom = top + f64::from(piece.height) + 2.0;
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

    #[test]
    fn a_picture_may_be_given_up_at_any_time() {
        use glam::DVec3;
        use scene::{Camera, Placement, Primitive, Rgb, Scene, Solid};

        let mut scene = Scene { ambient: Rgb::ONE, ..Scene::default() };
        scene.add_object(None, Solid::primitive(Primitive::Sphere, Placement::default()));
        let (position, target) = (DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO);
        scene.camera = Some(Camera { parallel: false, position, target, focal_length_mm: 50.0 });
        let world = World::load(&scene).unwrap();
        for (sampling, certify) in [
            (Sampling::Grid(3), true),
            (Sampling::Stochastic(Rate::Samples(9)), true),
            (Sampling::Grid(3), false),
            (Sampling::Subdivided { levels: 2 }, false),
            (Sampling::Stochastic(Rate::Samples(9)), false),
            (Sampling::Stochastic(Rate::Error(2.0)), false),
        ] {
            let options = Options {
                columns: 40,
                rows: 35,
                sampling,
                certify,
                threads: 1,
                ..Options::default()
            };
            let whole = crate::render(&world, &options, &|_| ()).unwrap();
            let (mut given_up, mut most) = (0, 0);
            loop {
                let asked = AtomicUsize::new(0);
                let stopped = || asked.fetch_add(1, Ordering::Relaxed) >= most;
                let made = crate::render_while_wanted(&world, &options, &stopped, None);
                if let Some(picture) = made.unwrap() {
                    assert!(picture.film.pixels().eq(whole.film.pixels()), "{sampling:?}");
                    break;
                }
                given_up += 1;
                most += 1 + most / 4;
            }
            assert!(given_up > 2, "{sampling:?} was given up {given_up} times");
        }
    }
}
