//! The tracer's picture against the oracle's, pixel by pixel.

use std::num::NonZero;
use std::sync::atomic::{AtomicU32, Ordering};

use render::{Accel, Options, World, render};
use scene::Scene;

use super::trace::{Limits, Oracle};

/// Where a surface is as many rounding bounds from the eye, the eye may be on either side of it.
const NEAR_EYE: f64 = 64.0;

/// Rays of the picture start this many rounding bounds from the eye.
const START: f64 = 4.0;
/// Lots that are drawn of one kind.
const LOTS: u64 = 32;
/// A grain at which only those faces coincide that numbers cannot tell apart.
const EXACT: f64 = 1e-6;

/// A pixel whose colours differ, and no edge is to blame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrong {
    pub(crate) column: u32,
    pub(crate) row: u32,
    pub(crate) tracer: [f64; 3],
    pub(crate) oracle: [f64; 3],
}

/// What a comparison found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: u64,
    pub(crate) pixels: u64,
    /// Pixels that differ, and where the oracle sees another colour when its rays are moved by a few rounding bounds, or
    /// when other faces coincide.
    pub(crate) edges: u64,
    /// Of these, pixels that have a colour which the oracle sees then.
    pub(crate) explained: u64,
    /// Pixels that see from inside of an opaque body: nothing is said of them.
    pub(crate) buried: u64,
    pub(crate) wrong: Vec<Wrong>,
}

impl Tally {
    pub(crate) fn add(&mut self, more: Self) {
        self.rays += more.rays;
        self.pixels += more.pixels;
        self.edges += more.edges;
        self.explained += more.explained;
        self.buried += more.buried;
        self.wrong.extend(more.wrong);
    }

    #[expect(clippy::print_stderr, reason = "the counts are the report")]
    pub(crate) fn report(&self, name: &str) {
        let Self { rays, pixels, edges, .. } = self;
        let wrong = self.wrong.len();
        eprintln!("{name}: {rays} rays, {pixels} pixels, {edges} on edges, {wrong} wrong");
        for Wrong { column, row, tracer, oracle } in self.wrong.iter().take(3) {
            eprintln!("  column {column} row {row}: tracer {tracer:.6?}, oracle {oracle:.6?}");
        }
    }
}

/// More than the least step of an 8-bit picture apart, of light brighter than white as large a share, or not numbers.
fn differ(a: [f64; 3], b: [f64; 3]) -> bool {
    let step = |b: f64| f64::max(1.0, b.abs()) / 255.0;
    a.into_iter().zip(b).any(|(a, b)| (a - b).is_nan() || (a - b).abs() > step(b))
}

/// The tracer's linear colours, background included.
fn traced(scene: &Scene, options: &Options) -> (Vec<[f64; 3]>, u64) {
    let world = World::load(scene).expect("the scene loads");
    let picture = render(&world, options, &|_| ()).expect("threads start");
    let background = scene.background.to_array();
    let colors = picture.film.pixels().map(|pixel| {
        let open = 1.0 - f64::from(pixel.coverage);
        std::array::from_fn(|k| f64::from(pixel.color[k]) + open * background[k])
    });
    (colors.collect(), picture.stats.rays())
}

/// Room for chains of a thousand rays.
const STACK: usize = 1 << 28;

/// Does something for each row on all processors and gives the results in any order.
pub(crate) fn by_rows<T: Send>(rows: u32, work: impl Fn(u32) -> T + Sync) -> Vec<T> {
    let next = AtomicU32::new(0);
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads)
            .map(|_| {
                let thread = std::thread::Builder::new().stack_size(STACK);
                let spawned = thread.spawn_scoped(scope, || {
                    let mut done = Vec::new();
                    loop {
                        let row = next.fetch_add(1, Ordering::Relaxed);
                        if row >= rows {
                            return done;
                        }
                        done.push(work(row));
                    }
                });
                spawned.expect("a thread")
            })
            .collect();
        handles.into_iter().flat_map(|handle| handle.join().expect("no panic")).collect()
    })
}

/// Four rounding bounds to every side, and none.
fn nudges() -> impl Iterator<Item = [f64; 3]> {
    let sides = [-1.0, 0.0, 1.0];
    sides.into_iter().flat_map(move |x| {
        sides.into_iter().flat_map(move |y| sides.map(|z| [x, y, z].map(|step| 4.0 * step)))
    })
}

/// What the oracle sees when its rays are moved, or when other faces coincide, of a pixel that differs.
#[derive(Clone, Copy, Debug, Default)]
struct Variety {
    /// Another colour.
    varies: bool,
    /// The tracer's.
    explains: bool,
}

/// Whether the pixel's colour hangs on where exactly its rays run, or on which faces coincide.
fn variety(scene: &Scene, size: (u32, u32), limits: Limits, pixel: &Wrong) -> Variety {
    let (column, row) = (pixel.column, pixel.row);
    let mut oracle = Oracle::new(scene, size, limits);
    let straight = oracle.pixel(column, row);
    let first = oracle.first(column, row);
    let mut found = Variety {
        varies: first.is_some_and(|at| at.t.value() < NEAR_EYE * at.rounding),
        explains: false,
    };
    // Each surface of a chain of rays has lots of its own.
    let moved = nudges().map(|nudge| (nudge, 0, 0));
    let each_moved = (1..=LOTS).map(|salt| ([4.0; 3], salt, 0));
    let joined = (1..=4 * LOTS).map(|lots| ([0.0; 3], 0, lots));
    let both = (1..=LOTS).map(|lots| ([4.0; 3], lots, lots));
    for (nudge, salt, lots) in moved.chain(each_moved).chain(joined).chain(both) {
        (oracle.nudge, oracle.salt, oracle.solids.salt) = (nudge, salt, lots);
        let seen = oracle.pixel(column, row);
        found.varies |= differ(seen, straight);
        found.explains |= !differ(pixel.tracer, seen);
        if found.varies && found.explains {
            return found;
        }
    }
    (oracle.nudge, oracle.salt, oracle.solids.salt) = ([0.0; 3], 0, 0);
    // A wall thinner than the bound, that the eye stands at, may be seen.
    oracle.solids.grain = EXACT;
    let near = oracle.first(column, row);
    if near.is_some_and(|at| (at.t * at.cosine).value() < START * at.rounding) {
        let seen = oracle.pixel(column, row);
        found.varies |= differ(seen, straight);
        found.explains |= !differ(pixel.tracer, seen);
    }
    found
}

/// The oracle's linear colours, row by row.
pub(crate) fn evaluated(scene: &Scene, options: &Options) -> Vec<[f64; 3]> {
    let limits = Limits { depth: options.depth, min_weight: options.min_weight };
    let oracle = Oracle::new(scene, (options.columns, options.rows), limits);
    let mut rows = by_rows(options.rows, |row| {
        (row, (0..options.columns).map(|column| oracle.pixel(column, row)).collect::<Vec<_>>())
    });
    rows.sort_by_key(|(row, _)| *row);
    rows.into_iter().flat_map(|(_, row)| row).collect()
}

/// Renders a picture both ways.
pub(crate) fn compare(scene: &Scene, size: (u32, u32), accel: Accel) -> Tally {
    let (columns, rows) = size;
    compare_with(scene, &Options { columns, rows, accel, ..Options::default() })
}

/// Renders a picture both ways; pixels that see from inside of an opaque body are left out.
pub(crate) fn compare_with(scene: &Scene, options: &Options) -> Tally {
    let options = Options { clamp: false, ..*options };
    let (columns, rows) = (options.columns, options.rows);
    let size = (columns, rows);
    let limits = Limits { depth: options.depth, min_weight: options.min_weight };
    let (picture, rays) = traced(scene, &options);
    let oracle = Oracle::new(scene, size, limits);
    let rows = by_rows(rows, |row| {
        let mut found = Tally::default();
        for column in 0..columns {
            let tracer = picture[row as usize * columns as usize + column as usize];
            if oracle.first(column, row).is_some_and(|at| at.buried) {
                found.buried += 1;
                continue;
            }
            let oracle = oracle.pixel(column, row);
            if !differ(tracer, oracle) {
                continue;
            }
            let pixel = Wrong { column, row, tracer, oracle };
            let Variety { varies, explains } = variety(scene, size, limits, &pixel);
            if varies {
                found.edges += 1;
                found.explained += u64::from(explains);
            } else {
                found.wrong.push(pixel);
            }
        }
        found
    });
    let pixels = u64::from(columns) * u64::from(options.rows);
    rows.into_iter().fold(Tally { rays, pixels, ..Tally::default() }, |mut sum, row| {
        sum.add(row);
        sum
    })
}
