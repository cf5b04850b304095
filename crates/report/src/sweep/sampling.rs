//! Ways of sampling, each against references with its own filter.

use render::{Filter, Rate, Sampling};

use super::bench::{Bench, timed};
use super::{Found, GAIN, Result};
use crate::journal::Figures;
use crate::truth::{References, Shown, light};
use crate::way::{self, Way};

impl Bench<'_> {
    pub(super) fn sampling(&mut self, found: &mut Found) -> Result<()> {
        let samples = self.reference_samples();
        let Some(references) = self.with_references(Filter::Box, samples, found)? else {
            return Ok(());
        };
        for way in way::ways(self.settings.quick) {
            // Errors fall a little slower than with the square root of the samples.
            let promised = |found: &Found, error: f64| {
                let known =
                    found.ways.iter().find(|(way, _)| way.label() == "16" && way.is_drawn());
                known.map_or(64.0, |(_, figures)| {
                    let ratio = figures.number("error") / error;
                    if ratio > 1.0 { 24.0 * ratio * ratio.sqrt() } else { 24.0 }
                })
            };
            let cost = way.cost().unwrap_or_else(|| match way.sampling {
                Sampling::Stochastic(Rate::Error(error)) => promised(found, error),
                _ => 0.0,
            });
            if let Some(figures) = self.way(&way, cost, &references, samples)? {
                found.ways.push((way, figures));
            }
        }
        Ok(())
    }

    /// Other filters, each against its own references.
    pub(super) fn filtering(&mut self, found: &mut Found) -> Result<()> {
        let samples = self.reference_samples();
        for filter in [Filter::Tent, Filter::Mitchell] {
            let Some(references) = self.with_references(filter, samples, found)? else {
                continue;
            };
            for way in way::filtered().into_iter().filter(|way| way.filter == filter) {
                let cost = way.cost().unwrap_or_default();
                if let Some(figures) = self.way(&way, cost, &references, samples)? {
                    found.ways.push((way, figures));
                }
            }
        }
        Ok(())
    }

    /// All seeds of a way, as one row.
    fn way(
        &mut self,
        way: &Way,
        cost: f64,
        references: &References,
        samples: u32,
    ) -> Result<Option<Figures>> {
        let seeds = if way.is_drawn() { self.settings.seeds } else { 1 };
        let mut all = Vec::new();
        for seed in 0..seeds {
            let words = format!("{} seed {seed} references {samples}", way.words());
            let figures = self.measured(&words, cost * self.sample_seconds, |bench| {
                let options = bench.options(way.sampling, way.filter, seed);
                let (picture, seconds) = timed(&bench.world, &options)?;
                let image = light(&picture.film, bench.world.background())?;
                let shown = Shown::of(&image)?;
                if seed == 0 {
                    bench.save("pictures", &format!("{}.png", way.file()), &shown.image()?)?;
                    let off = shown.difference(&references.mean(), GAIN)?;
                    bench.save("pictures", &format!("{}-off.png", way.file()), &off)?;
                }
                let truth = references.error(&shown);
                let mut figures = Figures::default()
                    .with("seconds", seconds)
                    .with("samples", picture.samples)
                    .with("error", truth.error)
                    .with("deviation", truth.deviation);
                if let Some(reported) = picture.error {
                    figures = figures.with("reported", reported);
                }
                Ok(figures)
            })?;
            all.extend(figures);
        }
        Ok(mean(&all))
    }
}

/// Geometric means over seeds; none of none.
fn mean(all: &[Figures]) -> Option<Figures> {
    if all.is_empty() {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a few seeds")]
    let count = all.len() as f64;
    let mean = |name: &str| {
        let sum: f64 = all.iter().map(|figures| libm::log(figures.number(name))).sum();
        libm::exp(sum / count)
    };
    let mut found = Figures::default();
    for name in ["seconds", "samples", "error"] {
        found = found.with(name, mean(name));
    }
    let deviation = all.iter().map(|figures| figures.number("deviation")).sum::<f64>() / count;
    found = found.with("deviation", deviation / count.sqrt()).with("seeds", count);
    if all.iter().all(|figures| figures.get("reported").is_some_and(|reported| reported > 0.0)) {
        let ratios = all.iter().map(|one| one.number("reported") / one.number("error"));
        let (least, most) = ratios.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
        found = found
            .with("reported", mean("reported"))
            .with("ratio", mean("reported") / mean("error"))
            .with("ratio_least", least)
            .with("ratio_most", most);
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_seeds_are_geometric() {
        let one = |error: f64, reported: f64| {
            Figures::default()
                .with("seconds", 2.0)
                .with("samples", 16.0)
                .with("error", error)
                .with("deviation", 0.1)
                .with("reported", reported)
        };
        let found = mean(&[one(1.0, 2.0), one(4.0, 2.0)]).unwrap();
        // √(1 · 4), √(2 · 2), their ratio, and the ratios 2/1 and 2/4.
        for (name, expected) in [
            ("error", 2.0),
            ("reported", 2.0),
            ("ratio", 1.0),
            ("ratio_least", 0.5),
            ("ratio_most", 2.0),
            ("deviation", 0.1 / 2.0_f64.sqrt()),
            ("seeds", 2.0),
        ] {
            assert!((found.number(name) - expected).abs() < 1e-12, "{name}: {found:?}");
        }
        assert_eq!(mean(&[]), None);
    }
}
