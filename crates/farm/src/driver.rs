//! The driver: sees what is missing, has it rendered, and puts finished pictures together.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::time::Instant;

use idf::command::{Job as History, Progress, UsageError, is_stream};
use render::command::plan;

use crate::command::{EngineWord, RenderArguments};
use crate::engine::local::Local;
use crate::engine::slurm::Slurm;
use crate::engine::{Engine, messages, ranges};
use crate::folder::{Folder, Job};
use crate::merge::merge;
use crate::picture::{Picture, Work};
use crate::report::{Figures, Report};

/// Parts of one picture where no number is given.
const PARTS: u32 = 16;
/// How often a part is tried whose worker says what is wrong: it may have been a full disk.
const TRIES: u32 = 3;

/// Renders what is missing.
pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Box<dyn Error>> {
    let talk = arguments.picture.talk();
    let history = History::start("prfarm", env!("CARGO_PKG_VERSION"));
    check(arguments)?;
    let plan = plan(&arguments.picture)?;
    if is_stream(&plan.output) {
        let message = "-o -: a farm writes files, expected a name";
        return Err(UsageError(message.into()).into());
    }
    let is_sequence = arguments.picture.frames().is_some();
    let parts = arguments.parts.unwrap_or(if is_sequence { 1 } else { PARTS });
    let side = arguments.picture.tile().unwrap_or_else(|| plan.fitting_side(parts));
    let job = Job { words: words()?, parts, side };
    // What a worker would refuse is refused before there is one.
    let (scene, part) = (arguments.picture.scene(), plan.output.with_extension("idf"));
    render::command::plan(&arguments.picture.of_part(scene, job.tiles(0), &part))?;
    let folder = Folder::of(&plan.output);
    let lock = folder.lock()?;
    if folder.job().ok().as_ref() != Some(&job) {
        Slurm::forget(&folder);
        folder.write_job(&job)?;
    }
    let work = Work::new(arguments, plan, job, &folder)?;
    if work.finished > 0 {
        let said = format!("{} pictures were finished before", work.finished);
        if work.pictures.is_empty() && !talk.is_quiet() {
            idf::command::print(&format!("{said}\n"));
        } else {
            talk.note(said);
        }
    }
    let mut driver = Driver::new(arguments, folder.clone(), work, history)?;
    let done = driver.work();
    if done.is_err() {
        driver.engine.stop();
    }
    if let Err(error) = done {
        let left = driver.missing.len();
        let all = driver.all;
        return Err(format!(
            "{error}; {} of {all} parts are finished, the same command goes on",
            all - left
        )
        .into());
    }
    drop(lock);
    if !arguments.keep_parts {
        // Whatever is left does no harm.
        fs::remove_dir_all(&folder.path).ok();
    }
    if !talk.is_quiet() && driver.pictures > 0 {
        idf::command::print(&format!("{}\n", driver.report().line()));
    }
    Ok(())
}

/// What a farm cannot do.
fn check(arguments: &RenderArguments) -> Result<(), UsageError> {
    arguments.picture.check_in_parts()?;
    if arguments.engine == EngineWord::Slurm && arguments.jobs.is_some() {
        let message = "--jobs is for --engine local; a cluster decides by itself";
        return Err(UsageError(message.into()));
    }
    if arguments.engine == EngineWord::Local && !arguments.sbatch.is_empty() {
        return Err(UsageError("--sbatch is for --engine slurm".into()));
    }
    Ok(())
}

/// The command line, for workers.
fn words() -> Result<Vec<String>, Box<dyn Error>> {
    let text = |word: std::ffi::OsString| {
        word.into_string().map_err(|word| {
            format!("expected arguments in UTF-8, found `{}`", word.to_string_lossy()).into()
        })
    };
    std::env::args_os().skip(1).map(text).collect()
}

struct Driver<'a> {
    arguments: &'a RenderArguments,
    folder: Folder,
    work: Work,
    history: History,
    engine: Box<dyn Engine>,
    /// Units that are not done.
    missing: BTreeSet<usize>,
    /// All of them.
    all: usize,
    /// How often a unit has ended without a part: its worker said why, or not.
    failures: BTreeMap<usize, [u32; 2]>,
    figures: Figures,
    rendered: usize,
    pictures: usize,
    begun: Instant,
    progress: Progress,
}

impl<'a> Driver<'a> {
    fn new(
        arguments: &'a RenderArguments,
        folder: Folder,
        work: Work,
        history: History,
    ) -> Result<Self, Box<dyn Error>> {
        let threads = arguments.picture.worker_threads();
        let messages = messages()?;
        let engine: Box<dyn Engine> = match arguments.engine {
            EngineWord::Local => {
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                let jobs = arguments.jobs.map_or_else(|| cores.div_ceil(threads), usize::from);
                Box::new(Local::new(folder.clone(), jobs, messages)?)
            }
            EngineWord::Slurm => {
                Box::new(Slurm::new(folder.clone(), &arguments.sbatch, threads, messages.1)?)
            }
        };
        let units: Vec<usize> =
            work.pictures.iter().flat_map(|picture| work.units(picture)).collect();
        Ok(Self {
            arguments,
            folder,
            work,
            history,
            engine,
            all: units.len(),
            progress: arguments.picture.talk().progress(units.len() as u64),
            missing: units.into_iter().collect(),
            failures: BTreeMap::new(),
            figures: Figures::default(),
            rendered: 0,
            pictures: 0,
            begun: Instant::now(),
        })
    }

    fn work(&mut self) -> Result<(), Box<dyn Error>> {
        let before: Vec<usize> = self.missing.iter().copied().collect();
        for unit in before {
            if self.is_done(unit, false) {
                self.missing.remove(&unit);
                self.progress.advance(1);
            }
        }
        let pictures: Vec<Picture> = self.work.pictures.clone();
        let missing: Vec<usize> = self.missing.iter().copied().collect();
        if !missing.is_empty() {
            let talk = self.arguments.picture.talk();
            talk.note(format_args!("missing of {} parts: {}", self.all, ranges(&missing)));
            self.engine.submit(&missing)?;
        }
        // Pictures of which all parts were there.
        for picture in &pictures {
            self.merge_if_complete(picture)?;
        }
        while !self.missing.is_empty() {
            let ended = self.engine.ended()?;
            let mut again = Vec::new();
            let mut touched = BTreeSet::new();
            for unit in ended {
                if !self.missing.contains(&unit) {
                    continue;
                }
                if self.is_done(unit, true) {
                    self.missing.remove(&unit);
                    self.rendered += 1;
                    self.progress.advance(1);
                    touched.insert(unit / self.work.job.parts as usize);
                } else {
                    self.check_failure(unit)?;
                    again.push(unit);
                }
            }
            if !again.is_empty() {
                self.engine.submit(&again)?;
            }
            let first = self.work.first().unwrap_or_default();
            for picture in &pictures {
                let place = picture.frame.map_or(0, |frame| (frame - first) as usize);
                if touched.contains(&place) {
                    self.merge_if_complete(picture)?;
                }
            }
        }
        Ok(())
    }

    /// Whether the part is on disk; `now` if it was rendered by a worker of this driver.
    fn is_done(&mut self, number: usize, now: bool) -> bool {
        let unit = self.work.unit(number);
        let picture = unit
            .and_then(|unit| self.work.pictures.iter().find(|picture| picture.frame == unit.frame));
        let Some((unit, picture)) = unit.zip(picture) else { return false };
        let Some(image) = self.folder.finished(unit, &self.work.job, &picture.part) else {
            return false;
        };
        if now {
            self.figures.add(&image.properties.history);
        }
        fs::remove_file(self.folder.errors(number)).ok();
        true
    }

    /// A unit has ended without a part: an error if it would do so for ever.
    fn check_failure(&mut self, number: usize) -> Result<(), Box<dyn Error>> {
        let said = fs::read(self.folder.errors(number)).unwrap_or_default();
        let said = String::from_utf8_lossy(&said).into_owned();
        let message = said.lines().rev().find_map(|line| line.split_once("error: "));
        let [told, killed] = self.failures.entry(number).or_default();
        let talk = self.arguments.picture.talk();
        if let Some((_, message)) = message {
            *told += 1;
            if *told >= TRIES {
                idf::command::print(&said);
                return Err(format!("part {number} has failed {TRIES} times: {message}").into());
            }
            talk.note(format_args!("part {number} is rendered again, as it failed: {message}"));
        } else {
            *killed += 1;
            if *killed > self.arguments.retries {
                let times =
                    if *killed == 1 { "once".to_owned() } else { format!("{killed} times") };
                return Err(format!(
                    "the worker of part {number} was killed {times} without a word; --retries N allows more"
                )
                .into());
            }
            talk.note(format_args!("part {number} is rendered again, as its worker was killed"));
        }
        Ok(())
    }

    fn merge_if_complete(&mut self, picture: &Picture) -> Result<(), Box<dyn Error>> {
        let units = self.work.units(picture);
        if units.iter().any(|unit| self.missing.contains(unit)) {
            return Ok(());
        }
        let history = self.history.clone();
        match merge(self.arguments, &self.folder, &mut self.work, picture, history)? {
            Ok(()) => {
                self.pictures += 1;
                self.arguments.picture.talk().note(format_args!("{}", picture.name.display()));
            }
            // Somebody took a part away after it was seen.
            Err(again) => {
                self.missing.extend(&again);
                self.engine.submit(&again)?;
            }
        }
        Ok(())
    }

    fn report(&self) -> Report {
        let again: u32 = self.failures.values().flatten().sum();
        Report {
            parts: self.rendered,
            pictures: self.pictures,
            again: again as usize,
            seconds: self.figures.seconds,
            elapsed: self.begun.elapsed(),
            workers: self.engine.workers(),
        }
    }
}
