//! What does not change a picture: ways of tracing, and what is left out.

use std::error::Error;
use std::time::Instant;

use render::{Accel, Filter, LoadOptions, Options, Sampling, World, render};
use scene::Scene;

use super::bench::{Bench, MOST_RUNS, REPEATED_BELOW, timed};
use super::{Found, Result, film_digest};
use crate::clock::Stopwatch;
use crate::journal::Figures;

/// A way of tracing that would take longer is left out.
const PATIENCE: f64 = 60.0;

/// Ways of tracing, by their words.
const TRACING: [(&str, Accel); 4] = [
    ("bvh", Accel::Bvh),
    ("coherence", Accel::Coherence),
    ("boxes", Accel::Boxes),
    ("none", Accel::None),
];

impl Bench<'_> {
    pub(super) fn tracing(&mut self, found: &mut Found) -> Result<()> {
        for (word, accel) in TRACING {
            let words = format!("--accel {word}");
            let figures = self.measured(&words, 2.0 * self.sample_seconds, |bench| {
                let options = bench.options(Sampling::Grid(1), Filter::Box, 0);
                let options = Options { accel, ..options };
                // A picture of 1/64 of the pixels tells whether there is time.
                let small = |side: u32| side.div_ceil(8);
                let (columns, rows) = (small(options.columns), small(options.rows));
                let pilot = Options { columns, rows, ..options };
                let refused = |error: &dyn Error| Figures::default().with_note(error);
                let begun = Instant::now();
                if let Err(error) = render(&bench.world, &pilot, &|_| ()) {
                    return Ok(refused(&error));
                }
                let estimate = 64.0 * begun.elapsed().as_secs_f64();
                if accel != Accel::Bvh && (estimate > PATIENCE || !bench.has_time(estimate)) {
                    let note = format!("left out: it would take about {estimate:.0} s");
                    return Ok(Figures::default().with_note(note));
                }
                let (picture, seconds) = timed(&bench.world, &options)?;
                let rays = picture.stats.rays();
                #[expect(clippy::cast_precision_loss, reason = "a count for a table")]
                let figures = Figures::default().with("seconds", seconds).with("rays", rays as f64);
                Ok(figures.with_note(film_digest(&picture)))
            })?;
            found.tracing.extend(figures.map(|figures| (word, figures)));
        }
        Ok(())
    }

    /// The same picture with all that the scene does not need, in turn with the usual.
    pub(super) fn omitting(
        &mut self,
        scene: &Scene,
        load: &dyn Fn(bool) -> LoadOptions,
    ) -> Result<Option<Figures>> {
        let cost = 4.0 * self.sample_seconds;
        self.measured("--keep-all", cost, |bench| {
            let options = bench.options(Sampling::Grid(1), Filter::Box, 0);
            let (mut loading, mut tracing) = ([f64::INFINITY; 2], [f64::INFINITY; 2]);
            let mut digests = [String::new(), String::new()];
            let begun = Instant::now();
            for _ in 0..MOST_RUNS {
                for way in [0, 1] {
                    let start = Stopwatch::start();
                    let world = World::load_with(scene, &load(way == 1))?;
                    loading[way] = loading[way].min(start.seconds());
                    let start = Stopwatch::start();
                    let picture = render(&world, &options, &|_| ())?;
                    tracing[way] = tracing[way].min(start.seconds());
                    digests[way] = film_digest(&picture);
                }
                if begun.elapsed() > 8 * REPEATED_BELOW {
                    break;
                }
            }
            let same = if digests[0] == digests[1] { 1.0 } else { 0.0 };
            Ok(Figures::default()
                .with("load", loading[0])
                .with("load_all", loading[1])
                .with("trace", tracing[0])
                .with("trace_all", tracing[1])
                .with("same", same))
        })
    }
}
