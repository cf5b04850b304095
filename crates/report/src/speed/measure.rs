//! One scene, compiled, built and traced: seconds, rays, memory.

use std::error::Error;
use std::io;
use std::path::Path;
use std::process::{self, Command, Stdio};
use std::thread;
use std::time::Instant;

use idf::command::Talk;
use render::{Accel, Options, Sampling, World, render, scheduled, tile_seconds};
use scene::Scene;

use super::case::{Case, WINE_GLASS, WINE_GLASS_NAME};
use crate::clock::Stopwatch;
use crate::command::scene;
use crate::journal::Figures;
use crate::sweep::film_digest;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// How long it takes: `compile`, `build`, `trace` in seconds, rays by kind, `memory` in bytes.
    Growth,
    /// All ways of tracing in turn: seconds by the word of each; `same` is 1 if all give the same bytes.
    Tracing,
    /// One and two threads in turn, `one` and `two`, medians of nine, and what the schedule would make of the tiles with
    /// more, `times_16` and `times_64`.
    Threads,
}

/// Ways of tracing: the word in tables, and whether only small scenes are tried.
pub const TRACING: [(&str, Accel); 7] = [
    ("bvh", Accel::Bvh),
    ("coherence", Accel::Coherence),
    ("remembered", Accel::Remembered),
    ("boxes", Accel::Boxes),
    ("slanted", Accel::Slanted),
    ("flat", Accel::Flat),
    ("none", Accel::None),
];

/// Runs of which the least counts.
const RUNS: usize = 5;
/// Runs of which the median counts.
const MEDIAN_OF: usize = 9;
/// Runs of a growing scene end after so many seconds.
const ENOUGH: f64 = 0.5;
/// Runs of all ways of tracing end after so many.
const ENOUGH_IN_TURN: f64 = 10.0;

impl Task {
    /// All, in the order of the report.
    pub const ALL: [Self; 3] = [Self::Growth, Self::Tracing, Self::Threads];

    /// The word on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Growth => "growth",
            Self::Tracing => "tracing",
            Self::Threads => "threads",
        }
    }

    /// Measures a scene: a case with its number of solids, the wine glass without one, or else a file.
    ///
    /// # Errors
    ///
    /// If it cannot be compiled, loaded or rendered.
    pub fn measured(
        self,
        name: &str,
        count: u32,
        (columns, rows): (u32, u32),
    ) -> Result<Figures, Box<dyn Error>> {
        let options = Options { columns, rows, threads: 1, ..Options::default() };
        let text = text(name, count);
        let begun = Stopwatch::start();
        let scene = compiled(name, text)?;
        let compile = begun.seconds();
        let begun = Stopwatch::start();
        let world = World::load(&scene)?;
        let build = begun.seconds();
        drop(scene);
        match self {
            Self::Growth => {
                let figures = growth(&world, &options)?;
                Ok(figures.with("compile", compile).with("build", build))
            }
            Self::Tracing => tracing(&world, &options),
            Self::Threads => threads(&world, &options),
        }
    }
}

/// The text of a case; none for a file.
fn text(name: &str, count: u32) -> Option<String> {
    match Case::by_name(name) {
        Some(case) => Some(case.description(count)),
        None if name == WINE_GLASS_NAME => Some(WINE_GLASS.to_owned()),
        None => None,
    }
}

fn compiled(name: &str, text: Option<String>) -> Result<Scene, Box<dyn Error>> {
    let options = compile::Options { max_primitives: u64::MAX, ..compile::Options::default() };
    let Some(text) = text else { return scene(Path::new(name), &[], Talk::default()) };
    let compiled = compile::compile_text_with(text, &options);
    let report = compiled.error_report();
    compiled.scene.ok_or_else(|| report.into())
}

#[expect(clippy::cast_precision_loss, reason = "counts for a table")]
fn growth(world: &World, options: &Options) -> Result<Figures, Box<dyn Error>> {
    let (mut trace, begun) = (f64::INFINITY, Instant::now());
    let mut figures = Figures::default().with("primitives", world.stands_for() as f64);
    for _ in 0..RUNS {
        let start = Stopwatch::start();
        let stats = render(world, options, &|_| ())?.stats;
        trace = trace.min(start.seconds());
        let counts = [stats.primary, stats.secondary, stats.shadow];
        for (name, count) in ["primary", "secondary", "shadow"].into_iter().zip(counts) {
            figures = figures.with(name, count as f64);
        }
        if begun.elapsed().as_secs_f64() > ENOUGH {
            break;
        }
    }
    figures = figures.with("trace", trace);
    Ok(match peak_bytes() {
        Some(bytes) => figures.with("memory", bytes as f64),
        None => figures,
    })
}

fn tracing(world: &World, options: &Options) -> Result<Figures, Box<dyn Error>> {
    let mut best = [f64::INFINITY; TRACING.len()];
    let mut digests: Vec<String> = Vec::new();
    let begun = Instant::now();
    for run in 0..RUNS {
        for ((_, accel), best) in TRACING.iter().zip(&mut best) {
            let options = Options { accel: *accel, ..*options };
            let start = Stopwatch::start();
            let picture = render(world, &options, &|_| ())?;
            *best = best.min(start.seconds());
            if run == 0 {
                digests.push(film_digest(&picture));
            }
        }
        if begun.elapsed().as_secs_f64() > ENOUGH_IN_TURN {
            break;
        }
    }
    digests.dedup();
    let same = if digests.len() == 1 { 1.0 } else { 0.0 };
    let times = TRACING.iter().zip(best);
    let figures = times.fold(Figures::default(), |f, ((word, _), best)| f.with(word, best));
    Ok(figures.with("same", same))
}

fn threads(world: &World, options: &Options) -> Result<Figures, Box<dyn Error>> {
    let mut seconds = [Vec::new(), Vec::new()];
    for _ in 0..MEDIAN_OF {
        for (threads, seconds) in (1..).zip(&mut seconds) {
            let options = Options { threads, ..*options };
            let start = Instant::now();
            render(world, &options, &|_| ())?;
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    let [one, two] = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[MEDIAN_OF / 2]
    });
    // Sixteen samples a pixel: a tile takes long enough to be timed.
    let options = Options { sampling: Sampling::Grid(4), ..*options };
    let tiles = tile_seconds(world, &options)?;
    let whole = scheduled(&tiles, 1);
    #[expect(clippy::cast_precision_loss, reason = "tiles of a picture")]
    let count = tiles.len() as f64;
    let figures = Figures::default().with("one", one).with("two", two).with("tiles", count);
    Ok([2, 4, 16, 64].into_iter().fold(figures, |figures, threads| {
        figures.with(&format!("times_{threads}"), whole / scheduled(&tiles, threads))
    }))
}

/// The most memory that this process has had at once; known on Linux.
fn peak_bytes() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes << 10)
}

/// Memory that other processes leave, in bytes; known on Linux.
#[must_use]
pub fn available_bytes() -> Option<f64> {
    available_of(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

fn available_of(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// Lets this process end, whatever it is at, when its standard input does: nobody waits for its figures any more.
pub(crate) fn end_with_input() {
    thread::spawn(|| {
        // An input that cannot be read is no one's either.
        io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
        process::exit(1);
    });
}

/// [`Task::measured`] in another process of this program, which ends with this one.
///
/// # Errors
///
/// If it cannot be started, or fails.
pub fn apart(
    task: Task,
    name: &str,
    count: u32,
    (columns, rows): (u32, u32),
) -> Result<Figures, Box<dyn Error>> {
    let mut child = Command::new(std::env::current_exe()?)
        .args(["measure", task.word(), name, &count.to_string()])
        .args([&format!("{columns}x{rows}"), "--while-input"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    // Open until the child is done, or until this process is no more.
    let input = child.stdin.take();
    let output = child.wait_with_output()?;
    drop(input);
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let last = said.lines().last().unwrap_or("the process ended");
        return Err(last.to_owned().into());
    }
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let parsed = Figures::parse(said.trim_end_matches('\n'));
    parsed.map(|(_, figures)| figures).ok_or_else(|| "the process said nothing of use".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_in_kilobytes() {
        assert_eq!(peak_of("VmPeak:\t   9 kB\nVmHWM:\t  1234 kB\n"), Some(1234 << 10));
        assert_eq!(peak_of("nothing"), None);
        assert_eq!(available_of("MemFree: 1 kB\nMemAvailable:    3 kB\n"), Some(3072.0));
        assert_eq!(available_of("MemAvailable: much"), None);
    }

    #[test]
    fn a_small_case_is_measured_by_every_task() {
        let size = (64, 40);
        let found = Task::Growth.measured("drilled", 10, size).unwrap();
        assert_eq!(found.get("primary"), Some(2560.0));
        assert_eq!(found.get("primitives"), Some(11.0));
        assert!(found.number("trace") > 0.0 && found.number("compile") > 0.0, "{found:?}");
        let found = Task::Tracing.measured("chain", 10, size).unwrap();
        assert_eq!(found.get("same"), Some(1.0), "{found:?}");
        let found = Task::Threads.measured("wine-glass", 0, size).unwrap();
        // Four tiles: no more than four threads have anything to do.
        assert_eq!(found.get("tiles"), Some(4.0));
        let most = found.number("times_64");
        assert!((1.0..=4.0).contains(&most), "{found:?}");
        assert!(Task::Growth.measured("no such scene.sdl", 1, size).is_err());
    }
}
