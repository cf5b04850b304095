//! What all measurements of a scene share: what is known already, the time there is, files, references.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use idf::exchange::{read_image, write_image};
use idf::{Ask, Image, ReadOptions, WriteOptions};
use render::{Filter, Options, Picture, Rate, Sampling, World, render};

use super::{Found, Result, Settings};
use crate::clock::Stopwatch;
use crate::journal::{Digest, Figures, Journal};
use crate::truth::{References, Shown, light};
use crate::way::filter_word;

/// A measurement takes several runs as long as all of them take less than this.
pub(super) const REPEATED_BELOW: Duration = Duration::from_millis(250);
/// Most runs of one measurement.
pub(super) const MOST_RUNS: usize = 5;
/// Samples of a reference, unless told otherwise.
const REFERENCE_SAMPLES: u32 = 256;
/// The fewest that are of use.
const LEAST_REFERENCE: u32 = 32;
/// Seeds of the references; those of pictures are less.
const REFERENCE_SEEDS: [u32; 2] = [900_001, 900_002];

/// The work on one scene.
pub(super) struct Bench<'a> {
    pub(super) settings: &'a Settings,
    pub(super) journal: &'a mut Journal,
    pub(super) folder: &'a Path,
    pub(super) name: &'a str,
    pub(super) world: World,
    /// What all keys begin with.
    pub(super) key: String,
    pub(super) said: &'a dyn Fn(&str),
    pub(super) missing: Vec<String>,
    /// Seconds of one sample a pixel, about.
    pub(super) sample_seconds: f64,
}

/// Renders until that took long enough to be timed: the picture, and the seconds of one core that the run in the middle
/// took. Clocks that count work may be behind for a moment, so the least would be too little.
pub(super) fn timed(world: &World, options: &Options) -> Result<(Picture, f64)> {
    let (mut seconds, mut whole) = (Vec::new(), Duration::ZERO);
    loop {
        let (begun, watch) = (Instant::now(), Stopwatch::start());
        let picture = render(world, options, &|_| ())?;
        seconds.push(watch.seconds());
        whole += begun.elapsed();
        if whole > REPEATED_BELOW || seconds.len() >= MOST_RUNS {
            seconds.sort_unstable_by(f64::total_cmp);
            return Ok((picture, seconds[seconds.len() / 2]));
        }
    }
}

impl Bench<'_> {
    pub(super) fn options(&self, sampling: Sampling, filter: Filter, seed: u32) -> Options {
        let (columns, rows) = self.settings.size;
        Options { columns, rows, sampling, filter, seed, threads: 1, ..Options::default() }
    }

    /// True if there is time for so many seconds more.
    pub(super) fn has_time(&self, seconds: f64) -> bool {
        let left = |end: Instant| end.saturating_duration_since(Instant::now()).as_secs_f64();
        self.settings.deadline.is_none_or(|end| left(end) > seconds)
    }

    /// What is known by these words, or comes of the work, if there is time for the seconds that it takes.
    pub(super) fn measured(
        &mut self,
        words: &str,
        seconds: f64,
        work: impl FnOnce(&mut Self) -> Result<Figures>,
    ) -> Result<Option<Figures>> {
        let key = format!("{} {words}", self.key);
        if let Some(known) = self.journal.get(&key) {
            return Ok(Some(known.clone()));
        }
        if !self.has_time(seconds) {
            self.missing.push(format!("{words}: no time"));
            return Ok(None);
        }
        (self.said)(&format!("{}: {words}", self.name));
        let figures = work(self)?;
        self.journal.keep(&key, &figures)?;
        Ok(Some(figures))
    }

    /// A file of this scene in a part of the folder.
    pub(super) fn file(&self, part: &str, name: &str) -> PathBuf {
        self.folder.join(part).join(self.name).join(name)
    }

    pub(super) fn save(&self, part: &str, name: &str, image: &Image) -> Result<()> {
        Ok(write_image(&self.file(part, name), image, &WriteOptions::default())?)
    }

    /// Finds out what a sample costs; done even if there is no time at all.
    pub(super) fn pilot(&mut self) -> Result<()> {
        let key = format!("{} pilot", self.key);
        let seconds = match self.journal.get(&key) {
            Some(known) => known.number("seconds"),
            None => {
                (self.said)(&format!("{}: one sample a pixel", self.name));
                let options = self.options(Sampling::Grid(1), Filter::Box, 0);
                // By the clock, as the time that is left, with whatever else the machine does.
                let (begun, mut runs) = (Instant::now(), 0);
                while runs < MOST_RUNS && begun.elapsed() < REPEATED_BELOW {
                    render(&self.world, &options, &|_| ())?;
                    runs += 1;
                }
                let seconds =
                    begun.elapsed().as_secs_f64() / f64::from(u32::try_from(runs).expect("few"));
                self.journal.keep(&key, &Figures::default().with("seconds", seconds))?;
                seconds
            }
        };
        self.sample_seconds = seconds;
        Ok(())
    }

    /// How many samples a reference has.
    pub(super) fn reference_samples(&self) -> u32 {
        if let Some(samples) = self.settings.reference {
            return samples;
        }
        let Some(end) = self.settings.deadline else { return REFERENCE_SAMPLES };
        // What an earlier run made is taken, however little time there is now.
        let file = |samples: u32| self.keyed(&reference_file(samples, "box", 1));
        let is_there = |samples: &u32| self.file("references", &file(*samples)).exists();
        let sizes = [REFERENCE_SAMPLES, 128, 64, LEAST_REFERENCE];
        if let Some(known) = sizes.into_iter().find(is_there) {
            return known;
        }
        let left = end.saturating_duration_since(Instant::now()).as_secs_f64();
        let cost = |samples: u32| 2.0 * 1.25 * f64::from(samples) * self.sample_seconds;
        let fits = |samples: &u32| cost(*samples) < 0.35 * left;
        sizes.into_iter().find(fits).unwrap_or(LEAST_REFERENCE)
    }

    /// A picture that is made once and kept as light.
    pub(super) fn kept(&mut self, name: &str, options: &Options) -> Result<Shown> {
        let path = self.file("references", name);
        if !path.exists() {
            (self.said)(&format!("{}: {}", self.name, name.trim_end_matches(".exr")));
            let options = Options { threads: self.settings.threads, ..*options };
            let picture = render(&self.world, &options, &|_| ())?;
            let image = light(&picture.film, self.world.background())?;
            self.save("references", name, &image)?;
        }
        // What is read is what another run reads.
        let options = ReadOptions { ask: Ask::Picture, ..ReadOptions::default() };
        Ok(Shown::of(&read_image(&path, &options)?)?)
    }

    fn references(&mut self, samples: u32, filter: Filter) -> Result<References> {
        let mut picture = |number: usize| {
            let sampling = Sampling::Stochastic(Rate::Samples(samples));
            let options = self.options(sampling, filter, REFERENCE_SEEDS[number]);
            let name = reference_file(samples, filter_word(filter), number + 1);
            self.kept(&self.keyed(&name), &options)
        };
        Ok(References::new([picture(0)?, picture(1)?]))
    }

    /// A name with a digest of the scene and the size before it.
    pub(super) fn keyed(&self, name: &str) -> String {
        format!("{}-{name}", Digest::default().and(self.key.as_bytes()))
    }

    /// References of a filter, if there is time for them, with a row about them.
    pub(super) fn with_references(
        &mut self,
        filter: Filter,
        samples: u32,
        found: &mut Found,
    ) -> Result<Option<References>> {
        let word = filter_word(filter);
        let cost = 2.0 * 1.25 * f64::from(samples) * self.sample_seconds;
        let words = format!("references {word} {samples}");
        let mut held = None;
        let figures = self.measured(&words, cost, |bench| {
            let references = bench.references(samples, filter)?;
            let figures = Figures::default()
                .with("samples", f64::from(samples))
                .with("own", references.own_error());
            bench.save(
                "pictures",
                &format!("reference-{word}.png"),
                &references.mean().image()?,
            )?;
            held = Some(references);
            Ok(figures)
        })?;
        let Some(figures) = figures else { return Ok(None) };
        found.references.push((word, figures));
        match held {
            Some(references) => Ok(Some(references)),
            None => Ok(Some(self.references(samples, filter)?)),
        }
    }
}

/// The name of the file of a reference.
fn reference_file(samples: u32, filter: &str, number: usize) -> String {
    format!("{filter}-{samples}-{number}.exr")
}
