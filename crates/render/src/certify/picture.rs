//! A picture whose pixels are proved where they can be.

use std::time::Instant;

use super::points::{Look, Points};
use super::quadtree::{Plan, Proof, Prover};
use super::sheet::Sheet;
use crate::Picture;
use crate::film::{FilmTile, Sums};
use crate::options::{Filter, Options, Rate, Sampling};
use crate::sampling::display::Display;
use crate::stats::RayStats;
use crate::tile::Frame;
use crate::world::World;
use crate::world::hierarchy::EightBoxRays;

/// What is proved of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Certificates {
    /// Share of the picture, by area, of which it is proved what surface is seen first, or that none is.
    pub certain: f64,
    /// The rest, which is sampled.
    pub undecided: f64,
    /// The most by which that rest can be wrong, as the root of the mean square over the picture in display steps of
    /// 1/255: as if all of it were black but should be white, or the other way.
    pub bound: f64,
    /// Share of the tiles that have too many solids to be sorted out.
    pub given_up: f64,
    /// What the proofs took, of all threads together.
    pub seconds: f64,
}

/// Sums of one tile.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    pixels: f64,
    certain: f64,
    square: f64,
    given_up: f64,
    seconds: f64,
}

/// Why there can be no proofs of a picture, if there cannot.
pub(crate) fn obstacle(world: &World, options: &Options) -> Option<&'static str> {
    if options.filter != Filter::Box {
        return Some(
            "what is proved is proved of the square of a pixel, and other filters reach beyond it",
        );
    }
    match options.sampling {
        Sampling::Subdivided { .. } => {
            return Some("pixels are divided by what is proved, not by what their corners show");
        }
        Sampling::Stochastic(Rate::Error(_) | Rate::Time(_)) => {
            return Some("the parts of a pixel have as many samples as their area asks for");
        }
        Sampling::Grid(_) | Sampling::Stochastic(Rate::Samples(_)) => {}
    }
    if !EightBoxRays::can_trace(world.magnitude) {
        return Some(
            "coordinates are beyond 1e-18 … 1e30, where boxes prove nothing; take another unit",
        );
    }
    world.lens.is_some().then_some(
        "rays through a lens come from many places, and proofs are for one; leave `aperture` out of the scene",
    )
}

/// Renders all tiles; nothing if the picture is given up before.
pub(crate) fn render(
    frame: &Frame<'_>,
    points: &Points,
    progress: &(dyn Fn(u64) + Sync),
) -> Option<Picture> {
    let (world, options) = (frame.world, frame.options);
    let size = (options.columns, options.rows);
    let sheet = Sheet::new(world.eye, frame.view(), size);
    let counts = points.counts();
    let background = frame.background();
    let slack = world.slack();
    let made = frame.over_tiles_with(
        || (Prover::new(world, &sheet), Vec::new()),
        |tracer, (prover, looks), number| {
            let piece = frame.piece(number);
            tracer.stats = RayStats::default();
            let start = Instant::now();
            let beam = frame.beam(&piece);
            let region = world.reached(&beam, usize::MAX);
            let region = region.as_ref().unwrap_or(&world.whole);
            let plan = prover.tile(&piece, &beam, region, slack);
            let seconds = start.elapsed().as_secs_f64();
            points.looks(&piece, plan, looks);
            let mut tile = FilmTile::new(piece.width, piece.height, counts);
            let shots = looks.iter().map(|look: &Look| (look, look.shot));
            frame.follow(tracer, Some(region), shots, |look, light| {
                tile.add(look.half, look.pixel, [0.0; 2], look.weight, light);
            });
            let tally = Tally { seconds, ..tally(plan, &tile, counts, background) };
            progress(piece.area() as u64);
            (tile, tracer.stats, tally)
        },
    );
    if frame.is_stopped() {
        return None;
    }
    let (mut stats, mut all, mut tiles) = (RayStats::default(), Tally::default(), Vec::new());
    for (tile, counted, tally) in made {
        stats.add(&counted);
        all.pixels += tally.pixels;
        all.certain += tally.certain;
        all.square += tally.square;
        all.given_up += tally.given_up;
        all.seconds += tally.seconds;
        tiles.push(tile);
    }
    let certain = all.certain / all.pixels;
    let certificates = Certificates {
        certain,
        undecided: 1.0 - certain,
        bound: (all.square / all.pixels).sqrt(),
        given_up: all.given_up / tiles.len() as f64,
        seconds: all.seconds,
    };
    let film = frame.film(counts, tiles);
    Some(Picture { certificates: Some(certificates), ..frame.picture(film, stats) })
}

fn tally(plan: &Plan, tile: &FilmTile, counts: [u32; 2], background: [f32; 3]) -> Tally {
    let display = Display::get();
    let mut tally = Tally {
        pixels: plan.proofs.len() as f64,
        given_up: f64::from(u8::from(plan.given_up)),
        ..Tally::default()
    };
    #[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
    let share = 1.0 / (counts[0] + counts[1]) as f32;
    for (pixel, proof) in plan.proofs.iter().enumerate() {
        let open = match *proof {
            Proof::Whole(_) => 0.0,
            Proof::Open { .. } => 1.0,
            Proof::Parts { first, count } => {
                let parts = &plan.parts[first as usize..][..count as usize];
                let open = parts.iter().filter(|part| part.proved.is_none());
                open.map(|part| 4.0 * part.cell.half * part.cell.half).sum::<f64>()
            }
        };
        tally.certain += 1.0 - open;
        if open <= 0.0 {
            continue;
        }
        let halves = tile.halves.iter().filter_map(|half| half.get(pixel));
        let mut sum = crate::Half::default();
        halves.for_each(|half| sum.add(share, half));
        #[expect(clippy::cast_possible_truncation, reason = "as on film")]
        let open = open as f32;
        let off = (0..3).map(|k| {
            let shown = (sum.color[k] + (1.0 - sum.coverage) * background[k]).clamp(0.0, 1.0);
            let steps = |light: f32| f64::from(display.steps(light.clamp(0.0, 1.0)));
            let (up, down) =
                (steps(shown + open) - steps(shown), steps(shown) - steps(shown - open));
            if up > down { up } else { down }
        });
        tally.square += off.map(|off| off * off).sum::<f64>() / 3.0;
    }
    tally
}
