//! Depth and weight cut-offs.

use render::{Filter, Options, Rate, Sampling};

use super::bench::{Bench, timed};
use super::{Found, Result};
use crate::journal::Figures;
use crate::truth::{Shown, light};

/// What cut-offs are compared with: no deeper ray and no fainter one is followed. Without a least weight, rays between
/// clear surfaces would double at each.
pub const DEEPEST: (u32, f64) = (30, 1.0 / 4096.0);

/// Depths and least weights that are tried.
#[must_use]
pub fn cuts() -> Vec<(u32, f64)> {
    let usual = Options::default();
    let depths = [1, 2, 3, 5, 8, 15].map(|depth| (depth, DEEPEST.1));
    let weights = [16.0, 64.0, 256.0, 1024.0].map(|share: f64| (usual.depth, 1.0 / share));
    weights.into_iter().chain(depths).chain([DEEPEST]).collect()
}

impl Bench<'_> {
    pub(super) fn cutting(&mut self, found: &mut Found) -> Result<()> {
        const SAMPLES: f64 = 4.0;
        let with = |bench: &Self, (depth, min_weight): (u32, f64)| {
            let sampling = Sampling::Stochastic(Rate::Samples(4));
            Options { depth, min_weight, ..bench.options(sampling, Filter::Box, 0) }
        };
        let cost = 4.0 * SAMPLES * self.sample_seconds;
        let mut deepest: Option<Shown> = None;
        for (depth, weight) in cuts() {
            let words = format!("--depth {depth} --min-weight {weight}");
            let figures = self.measured(&words, cost, |bench| {
                // The same samples, so that nothing else differs.
                let options = with(bench, (depth, weight));
                let (picture, seconds) = timed(&bench.world, &options)?;
                let shown = Shown::of(&light(&picture.film, bench.world.background())?)?;
                let reference = match &deepest {
                    Some(reference) => reference,
                    None => {
                        let options = with(bench, DEEPEST);
                        let name = bench.keyed("deepest.exr");
                        deepest.insert(bench.kept(&name, &options)?)
                    }
                };
                #[expect(clippy::cast_precision_loss, reason = "a count for a table")]
                let rays = picture.stats.rays() as f64;
                Ok(Figures::default()
                    .with("seconds", seconds)
                    .with("rays", rays)
                    .with("off", shown.apart(reference))
                    .with("bound", picture.cut[0] + picture.cut[1]))
            })?;
            found.cuts.extend(figures.map(|figures| (depth, weight, figures)));
        }
        Ok(())
    }
}
