//! The command line of `prreport`: which scenes, what is asked, where the report goes.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use clap::{Args, Parser, Subcommand};
use idf::command::{Talk, Threads, UsageError, print, write_text};
use scene::Scene;

use crate::journal::Journal;
use crate::passes::command::PassesArguments;
use crate::plot::Form;
use crate::sheet;
use crate::speed::command::{MeasureArguments, SpeedArguments};
use crate::sweep::{Found, Settings, Subject, sweep};
use crate::{page, way};

/// Measures error against run time, and writes tables, plots, pictures and one page
///
/// Each scene is rendered by many ways of sampling, with depth and weight cut-offs, by all ways of tracing, and in 256
/// colours; two independent references tell how far off each picture is. `report.html` in the folder shows all of it and
/// names the settings to use. A run that was stopped goes on where it was when it is started again. Tables that decide
/// are printed.
#[derive(Parser, Debug)]
#[command(
    name = "prreport",
    version,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Examples:\n  prreport scenes/wine-glass/wine-glass.sdl --quick -o report\n  \
                  prreport scenes/gallery/*.sdl --seeds 8 -o report\n  \
                  prreport passes scenes/gallery/*.sdl -o passes\n  prreport speed -o speed"
)]
pub struct Arguments {
    #[command(subcommand)]
    job: Option<Job>,
    /// Scenes: descriptions (.sdl) or compiled ones (.prc)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The folder of the report; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER", required = true)]
    output: Option<PathBuf>,
    /// Columns and rows of all pictures [default: 256x256; with --quick 160x160]
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// A first report in about a minute: fewer ways, and no more than 60 seconds
    #[arg(long)]
    quick: bool,
    /// Stop measuring after T seconds, and report what there is
    #[arg(long, value_name = "T", value_parser = seconds)]
    seconds: Option<f64>,
    /// Pictures of each way that draws by lot; their mean is told
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
    /// Samples a pixel of each reference [default: 256, or as many as there is time for]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    reference: Option<u32>,
    /// The scene as POV-Ray reads it, to measure that beside [default: a .pov beside the scene, of its name]
    #[arg(long, value_name = "FILE.pov")]
    povray: Option<PathBuf>,
    /// Give the number that a `let` names another value
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = compile::definition, allow_hyphen_values = true)]
    definitions: Vec<(String, f64)>,
    #[command(flatten)]
    common: Common,
}

/// What both reports can be asked.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Common {
    /// Forget what was measured before
    #[arg(long)]
    pub(crate) fresh: bool,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) talk: Talk,
}

#[derive(Subcommand, Debug)]
enum Job {
    Passes(PassesArguments),
    Speed(SpeedArguments),
    #[command(hide = true)]
    Measure(MeasureArguments),
}

/// Columns and rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size(pub(crate) (u32, u32));

/// Seconds of a quick report.
const QUICK_SECONDS: f64 = 60.0;

/// Ten years: longer than anyone waits, and a number of seconds that clocks take.
const MOST_SECONDS: f64 = 3e8;

/// The largest side of a picture: each is held several times as numbers of 64 bits.
const MOST_SIDE: u32 = 4096;

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |word: &str| word.parse().ok().filter(|n: &u32| (1..=MOST_SIDE).contains(n));
        let sides = text.split_once('x').ok_or("expected columns and rows as in 256x256")?;
        match (side(sides.0), side(sides.1)) {
            (Some(columns), Some(rows)) => Ok(Self((columns, rows))),
            _ => Err(format!("each side is a whole number from 1 to {MOST_SIDE}")),
        }
    }
}

pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds| *seconds > 0.0 && *seconds <= MOST_SECONDS);
    number.ok_or_else(|| format!("expected a number above 0 and up to {MOST_SECONDS}"))
}

/// Does what the command line says.
///
/// # Errors
///
/// [`UsageError`] for arguments that make no sense together; else what kept the report from being made.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let Common { threads, talk, .. } = arguments.common;
    match &arguments.job {
        Some(Job::Passes(passes)) => return crate::passes::command::run(passes),
        Some(Job::Speed(speed)) => return crate::speed::command::run(speed),
        Some(Job::Measure(measure)) => return crate::speed::command::measure(measure),
        None => {}
    }
    let begun = Instant::now();
    if arguments.povray.is_some() && arguments.scenes.len() > 1 {
        return Err(
            UsageError("--povray: one file shows one scene, and several are given".into()).into()
        );
    }
    let folder = arguments.output.as_deref().unwrap_or(Path::new("report"));
    let subjects = subjects(&arguments.scenes, &arguments.definitions, arguments.common.talk)?;
    fs::create_dir_all(folder.join("plots"))
        .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    let mut journal = Journal::open(folder, arguments.common.fresh)?;
    let budget = arguments.seconds.or(arguments.quick.then_some(QUICK_SECONDS));
    let side = if arguments.quick { 160 } else { 256 };
    let settings = Settings {
        size: arguments.size.map_or((side, side), |size| size.0),
        seeds: arguments.seeds,
        reference: arguments.reference,
        deadline: None,
        threads: threads.count().map_or(0, std::num::NonZeroUsize::get),
        quick: arguments.quick,
        peer: None,
    };
    let ways = way::ways(settings.quick).len() as u64;
    let progress = talk.progress(subjects.len() as u64 * (ways + 40));
    let mut all: Vec<Found> = Vec::new();
    for (number, subject) in subjects.iter().enumerate() {
        // Each scene has an equal share of the time that is left.
        let deadline = budget.map(|budget| {
            let left = (budget - begun.elapsed().as_secs_f64()).max(0.0);
            #[expect(clippy::cast_precision_loss, reason = "a few scenes")]
            let share = left / (subjects.len() - number) as f64;
            Instant::now() + Duration::from_secs_f64(share)
        });
        let peer = peer_file(arguments, subject);
        let settings = Settings { deadline, peer, ..settings.clone() };
        let said = |what: &str| {
            progress.stage(what.to_owned());
            progress.advance(1);
            talk.note(what);
        };
        all.push(sweep(subject, &settings, &mut journal, folder, &said)?);
        // A run that is killed in the next scene leaves a report.
        write(&all, folder)?;
    }
    drop(progress);
    told(&all, folder, talk)
}

/// What is printed in the end.
fn told(all: &[Found], folder: &Path, talk: Talk) -> Result<(), Box<dyn Error>> {
    let missing: usize = all.iter().map(|found| found.missing.len()).sum();
    if missing > 0 {
        talk.warn(format_args!(
            "{missing} measurements are missing, most for want of time; the same command again goes on"
        ));
    }
    let tables = sheet::tables(all);
    let shown = tables.iter().take(3).filter(|table| !table.rows.is_empty());
    let text: Vec<String> =
        shown.map(|table| format!("{}\n\n{}", table.title, table.markdown())).collect();
    write_text(Path::new("-"), &text.join("\n"))?;
    if !talk.is_quiet() {
        print(&format!("{}\n", folder.join("report.html").display()));
    }
    Ok(())
}

/// Tables, plots and the page.
fn write(all: &[Found], folder: &Path) -> Result<(), Box<dyn Error>> {
    for table in sheet::tables(all) {
        write_text(&folder.join(format!("{}.csv", table.name)), &table.csv())?;
    }
    for found in all {
        let path = folder.join("plots").join(format!("{}.svg", found.name));
        write_text(&path, &found.plot().svg(Form::Wide))?;
    }
    Ok(write_text(&folder.join("report.html"), &page::of_sweep(all, folder))?)
}

/// What POV-Ray reads for a scene: the file that is named, or that of its name beside it.
fn peer_file(arguments: &Arguments, subject: &Subject) -> Option<PathBuf> {
    let beside = || Some(subject.path.with_extension("pov")).filter(|path| path.is_file());
    arguments.povray.clone().or_else(beside)
}

/// Scenes with names that tell them apart.
pub(crate) fn subjects(
    paths: &[PathBuf],
    definitions: &[(String, f64)],
    talk: Talk,
) -> Result<Vec<Subject>, Box<dyn Error>> {
    let mut subjects: Vec<Subject> = Vec::new();
    for path in paths {
        let scene = scene(path, definitions, talk)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' };
        let stem: String = stem.chars().map(plain).collect();
        let taken = |name: &str| subjects.iter().any(|other| other.name == name);
        let numbered = (2..).map(|number: u32| format!("{stem}-{number}"));
        let name = std::iter::once(stem.clone()).chain(numbered).find(|name| !taken(name));
        subjects.push(Subject { name: name.unwrap_or(stem), path: path.clone(), scene });
    }
    Ok(subjects)
}

/// Reads a compiled scene, or compiles a description.
pub(crate) fn scene(
    path: &Path,
    definitions: &[(String, f64)],
    talk: Talk,
) -> Result<Scene, Box<dyn Error>> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("prc")) {
        if let Some((name, _)) = definitions.first() {
            let message = "numbers are given when a scene is compiled, and this one is already";
            return Err(UsageError(format!("-D {name}: {message}")).into());
        }
        let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut scene =
            scene::format::read(&bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        // Paths in a compiled scene begin at its own folder.
        let folder = path.parent().unwrap_or(Path::new(""));
        for image in &mut scene.images {
            image.source = path.display().to_string();
            if let Some(joined) = folder.join(&image.path).to_str() {
                image.path = joined.to_owned();
            }
        }
        return Ok(scene);
    }
    let options =
        compile::Options { definitions: definitions.to_vec(), ..compile::Options::default() };
    let compiled = compile::compile_path_with(path, &options);
    let report = if talk.is_quiet() { compiled.error_report() } else { compiled.report() };
    print(&report);
    compiled.scene.ok_or_else(|| format!("{}: the scene has errors", path.display()).into())
}
