//! The sweep over one scene: each measurement is looked up, or made and kept.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use idf::exchange::{read_image, write_image};
use idf::{Ask, Image, ReadOptions, WriteOptions};
use render::{
    Accel, Filter, LoadOptions, Omission, Options, Picture, Rate, Sampling, World, render,
};
use scene::Scene;

use crate::colors;
use crate::journal::{Digest, Figures, Journal};
use crate::peer;
use crate::truth::{References, Shown, light};
use crate::way::{self, Way, filter_word};

/// What is asked of a sweep.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Columns and rows of all pictures.
    pub size: (u32, u32),
    /// Seeds of which the mean is taken, for what is drawn by lot.
    pub seeds: u32,
    /// Samples a pixel of each reference; else as many as there is time for, from 32 to 256.
    pub reference: Option<u32>,
    /// When to stop measuring.
    pub deadline: Option<Instant>,
    /// Threads for what is not timed; 0 for as many as there are processors.
    pub threads: usize,
    /// Fewer ways, and no other filters.
    pub quick: bool,
    /// Render what POV-Ray has to show beside, from this file.
    pub peer: Option<PathBuf>,
}

/// A scene to be swept.
#[derive(Debug)]
pub struct Subject {
    /// A name for files, unlike those of the others.
    pub name: String,
    /// Where it is from, as it was named.
    pub path: PathBuf,
    /// The scene.
    pub scene: Scene,
}

/// What was found of one scene.
#[derive(Debug, Default)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// Where it is from.
    pub path: PathBuf,
    /// Columns and rows.
    pub size: (u32, u32),
    /// Primitives that it stands for.
    pub primitives: u64,
    /// Of the references by the word of their filter: `samples`, `own`.
    pub references: Vec<(&'static str, Figures)>,
    /// Ways of sampling with the geometric means over seeds of `seconds`, `samples`, `error`, `reported`, with `ratio`,
    /// `ratio_least` and `ratio_most` of reported by true error where there is one, and `deviation`.
    pub ways: Vec<(Way, Figures)>,
    /// Depth and least weight, `seconds`, `rays`, `off`, `bound`.
    pub cuts: Vec<(u32, f64, Figures)>,
    /// Ways of tracing: `seconds`; the note is a digest of the picture, or why there is none.
    pub tracing: Vec<(&'static str, Figures)>,
    /// What each pass left out.
    pub omissions: Vec<Omission>,
    /// `load`, `load_all`, `trace`, `trace_all` in seconds, `same` is 1 if the bytes are.
    pub omitting: Option<Figures>,
    /// Colour tables and dithers: `seconds`, `rms_rgb`, `rms_oklab`.
    pub colors: Vec<(colors::Way, Figures)>,
    /// POV-Ray's settings: `seconds`, `error`.
    pub peers: Vec<(&'static peer::Way, Figures)>,
    /// What there was no time for, or what failed.
    pub missing: Vec<String>,
}

/// A measurement takes several runs as long as all of them take less than this.
const REPEATED_BELOW: Duration = Duration::from_millis(250);
/// Most runs of one measurement.
const MOST_RUNS: u32 = 5;
/// Samples of a reference, unless told otherwise.
const REFERENCE_SAMPLES: u32 = 256;
/// The fewest that are of use.
const LEAST_REFERENCE: u32 = 32;
/// Seeds of the references; those of pictures are less.
const REFERENCE_SEEDS: [u32; 2] = [900_001, 900_002];
/// How much brighter differences are shown.
pub const GAIN: f64 = 16.0;
/// A way of tracing that would take longer is left out.
const PATIENCE: f64 = 60.0;
/// What cut-offs are compared with: no deeper ray and no fainter one is followed. Without a least weight, rays between
/// clear surfaces would double at each.
const DEEPEST: (u32, f64) = (30, 1.0 / 4096.0);

/// Ways of tracing, by their words.
const TRACING: [(&str, Accel); 4] = [
    ("bvh", Accel::Bvh),
    ("coherence", Accel::Coherence),
    ("boxes", Accel::Boxes),
    ("none", Accel::None),
];

/// Depths and least weights that are tried.
#[must_use]
pub fn cuts() -> Vec<(u32, f64)> {
    let usual = Options::default();
    let depths = [1, 2, 3, 5, 8, 15].map(|depth| (depth, DEEPEST.1));
    let weights = [16.0, 64.0, 256.0, 1024.0].map(|share: f64| (usual.depth, 1.0 / share));
    weights.into_iter().chain(depths).chain([DEEPEST]).collect()
}

/// The work on one scene.
struct Bench<'a> {
    settings: &'a Settings,
    journal: &'a mut Journal,
    folder: &'a Path,
    name: &'a str,
    world: World,
    /// What all keys begin with.
    key: String,
    said: &'a dyn Fn(&str),
    missing: Vec<String>,
    /// Seconds of one sample a pixel, about.
    sample_seconds: f64,
}

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A digest of all that a picture of the scene depends on.
fn scene_digest(scene: &Scene) -> Result<Digest> {
    let mut text = Vec::new();
    scene::format::write(scene, &mut text)?;
    let mut digest = Digest::default().and(&text);
    for image in &scene.images {
        let path = Path::new(&image.path);
        let described = idf::description_path(path);
        for path in [path, described.as_path()] {
            if let Ok(bytes) = fs::read(path) {
                digest = digest.and(&bytes);
            }
        }
    }
    Ok(digest)
}

/// Measures one scene; what `journal` knows already is taken from there. `said` hears what is done.
///
/// # Errors
///
/// If the scene cannot be rendered, or a file not be written.
pub fn sweep(
    subject: &Subject,
    settings: &Settings,
    journal: &mut Journal,
    folder: &Path,
    said: &dyn Fn(&str),
) -> Result<Found> {
    let (columns, rows) = settings.size;
    let named = |error: &dyn Error| format!("{}: {error}", subject.path.display());
    let load = |keep_all| LoadOptions { keep_all, picture: Some(settings.size) };
    let world = World::load_with(&subject.scene, &load(false)).map_err(|error| named(&error))?;
    let version = env!("CARGO_PKG_VERSION");
    let key = format!("{version} {} {columns}x{rows}", scene_digest(&subject.scene)?);
    for part in ["pictures", "references"] {
        let part = folder.join(part).join(&subject.name);
        fs::create_dir_all(&part).map_err(|error| format!("{}: {error}", part.display()))?;
    }
    let mut bench = Bench {
        settings,
        journal,
        folder,
        name: &subject.name,
        world,
        key,
        said,
        missing: Vec::new(),
        sample_seconds: 0.0,
    };
    let mut found = Found {
        name: subject.name.clone(),
        path: subject.path.clone(),
        size: settings.size,
        primitives: bench.world.stands_for(),
        omissions: bench.world.omissions().to_vec(),
        ..Found::default()
    };
    bench.pilot()?;
    found.omitting = bench.omitting(&subject.scene, &load)?;
    bench.sampling(&mut found)?;
    bench.tracing(&mut found)?;
    bench.cutting(&mut found)?;
    bench.coloring(&mut found)?;
    bench.peers(&mut found)?;
    if !settings.quick {
        bench.filtering(&mut found)?;
    }
    found.missing = bench.missing;
    Ok(found)
}

/// Renders until that took long enough to be timed: the picture, and the least seconds of a run.
fn timed(world: &World, options: &Options) -> Result<(Picture, f64)> {
    let (mut best, mut whole, mut runs) = (f64::INFINITY, Duration::ZERO, 0);
    loop {
        let begun = Instant::now();
        let picture = render(world, options, &|_| ())?;
        let taken = begun.elapsed();
        best = best.min(taken.as_secs_f64());
        whole += taken;
        runs += 1;
        if whole > REPEATED_BELOW || runs >= MOST_RUNS {
            return Ok((picture, best));
        }
    }
}

impl Bench<'_> {
    fn options(&self, sampling: Sampling, filter: Filter, seed: u32) -> Options {
        let (columns, rows) = self.settings.size;
        Options { columns, rows, sampling, filter, seed, threads: 1, ..Options::default() }
    }

    /// True if there is time for so many seconds more.
    fn has_time(&self, seconds: f64) -> bool {
        let left = |end: Instant| end.saturating_duration_since(Instant::now()).as_secs_f64();
        self.settings.deadline.is_none_or(|end| left(end) > seconds)
    }

    /// What is known by these words, or comes of the work, if there is time for the seconds that it takes.
    fn measured(
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
    fn file(&self, part: &str, name: &str) -> PathBuf {
        self.folder.join(part).join(self.name).join(name)
    }

    fn save(&self, part: &str, name: &str, image: &Image) -> Result<()> {
        Ok(write_image(&self.file(part, name), image, &WriteOptions::default())?)
    }

    /// Finds out what a sample costs; done even if there is no time at all.
    fn pilot(&mut self) -> Result<()> {
        let key = format!("{} pilot", self.key);
        let seconds = match self.journal.get(&key) {
            Some(known) => known.number("seconds"),
            None => {
                (self.said)(&format!("{}: one sample a pixel", self.name));
                let options = self.options(Sampling::Grid(1), Filter::Box, 0);
                let (_, seconds) = timed(&self.world, &options)?;
                self.journal.keep(&key, &Figures::default().with("seconds", seconds))?;
                seconds
            }
        };
        self.sample_seconds = seconds;
        Ok(())
    }

    /// How many samples a reference has.
    fn reference_samples(&self) -> u32 {
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
    fn kept(&mut self, name: &str, options: &Options) -> Result<Shown> {
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
    fn keyed(&self, name: &str) -> String {
        format!("{}-{name}", Digest::default().and(self.key.as_bytes()))
    }

    /// References of a filter, if there is time for them, with a row about them.
    fn with_references(
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

    fn sampling(&mut self, found: &mut Found) -> Result<()> {
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
    fn filtering(&mut self, found: &mut Found) -> Result<()> {
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

    fn tracing(&mut self, found: &mut Found) -> Result<()> {
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

    fn cutting(&mut self, found: &mut Found) -> Result<()> {
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

    /// The same picture with all that the scene does not need, in turn with the usual.
    fn omitting(
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
                    let start = Instant::now();
                    let world = World::load_with(scene, &load(way == 1))?;
                    loading[way] = loading[way].min(start.elapsed().as_secs_f64());
                    let start = Instant::now();
                    let picture = render(&world, &options, &|_| ())?;
                    tracing[way] = tracing[way].min(start.elapsed().as_secs_f64());
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

    fn coloring(&mut self, found: &mut Found) -> Result<()> {
        let path = self.file("pictures", "reference-box.png");
        if !path.exists() {
            return Ok(());
        }
        let options = ReadOptions { ask: Ask::Picture, ..ReadOptions::default() };
        let pixels = ilut::Pixels::of(&read_image(&path, &options)?, None)?;
        let digest = Digest::default().and(pixels.colors().as_flattened());
        for way in colors::ways() {
            let words = format!("{} of {digest}", way.words());
            let figures = self.measured(&words, 0.5, |bench| {
                let (figures, image) = way.measured(&pixels)?;
                bench.save("pictures", &format!("{}.png", way.file()), &image)?;
                Ok(figures)
            })?;
            found.colors.extend(figures.map(|figures| (way, figures)));
        }
        Ok(())
    }

    fn peers(&mut self, found: &mut Found) -> Result<()> {
        let Some(file) = &self.settings.peer else { return Ok(()) };
        let Some(version) = peer::version() else {
            self.missing.push("POV-Ray: it is not installed".into());
            return Ok(());
        };
        let text = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
        let source = format!("{version} {}", Digest::default().and(&text));
        let mut reference = None;
        let mut plain = 0.0;
        for way in peer::WAYS {
            let words = format!("povray {} of {source}", way.options);
            let cost = plain * way.cost;
            let size = self.settings.size;
            let figures = self.measured(&words, cost, |bench| {
                let to = bench.file("references", &bench.keyed("povray.png"));
                let picture = bench.file("pictures", &format!("{}.png", way.file()));
                match peer::measured(file, way, size, [&to, &picture], &mut reference) {
                    Ok(figures) => Ok(figures),
                    Err(error) => Ok(Figures::default().with_note(error)),
                }
            })?;
            let Some(figures) = figures else { continue };
            if plain <= 0.0 {
                plain = figures.get("seconds").unwrap_or(0.0);
            }
            if figures.note.is_empty() {
                found.peers.push((way, figures));
            } else {
                self.missing.push(format!("POV-Ray {}: {}", way.options, figures.note));
            }
        }
        Ok(())
    }
}

/// The name of the file of a reference.
fn reference_file(samples: u32, filter: &str, number: usize) -> String {
    format!("{filter}-{samples}-{number}.exr")
}

/// A digest of all samples of a picture.
pub(crate) fn film_digest(picture: &Picture) -> String {
    let pixels = picture.film.pixels().fold(Digest::default(), |digest, pixel| {
        let [r, g, b] = pixel.color.map(f32::to_le_bytes);
        digest.and(&r).and(&g).and(&b).and(&pixel.coverage.to_le_bytes())
    });
    pixels.to_string()
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

    #[test]
    fn scenes_that_differ_have_other_digests() {
        let digest = |text: &str| {
            scene_digest(&compile::compile_text(text).scene.unwrap()).unwrap().to_string()
        };
        let first = digest("camera at (0, 0, 5) object is sphere");
        assert_eq!(first, digest("camera at (0, 0, 5)\n  object is sphere // a ball"));
        assert_ne!(first, digest("camera at (0, 0, 5) object is sphere at (1e-9, 0, 0)"));
    }
}
