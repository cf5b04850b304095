//! The command line of `prreport speed`, and of the processes that it starts.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use idf::command::{UsageError, print, write_text};

use super::case::{CASES, Case, MOST, STATION, WINE_GLASS_NAME};
use super::measure::{Task, apart, available_bytes, end_with_input};
use super::sheet::{Found, Row};
use crate::command::{Common, Size, scene, seconds};
use crate::journal::{Digest, Figures, Journal};
use crate::plot::Form;

/// Seconds, rays and memory of scenes as they grow, and of ways of tracing
///
/// Generated scenes of 10, 100, … solids, the wine glass, the station where there is scenes/station/station.sdl, and
/// scenes of your own are compiled, built and traced on one thread, each in a process of its own. Then all ways of
/// tracing, and one thread against two.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  prreport speed --max-n 10000 -o speed")]
pub(crate) struct SpeedArguments {
    /// Scene descriptions beside the generated ones
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The folder of the report; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Generated scenes to try, with commas: scattered, drilled, heap, chain, mirrors, chess [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = case)]
    cases: Option<Vec<&'static Case>>,
    /// The most solids of a generated scene, as far as there is memory
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(10..=i64::from(MOST)))]
    max_n: u32,
    /// Stop measuring after T seconds, and report what there is
    #[arg(long, value_name = "T", value_parser = seconds)]
    seconds: Option<f64>,
    /// Columns and rows of all pictures
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: Size,
    #[command(flatten)]
    common: Common,
}

/// What a process of one measurement is told.
#[derive(Args, Debug)]
pub(crate) struct MeasureArguments {
    task: TaskWord,
    name: String,
    count: u32,
    size: Size,
    /// End when standard input does, as it does with the process that started this one
    #[arg(long)]
    while_input: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TaskWord {
    Growth,
    Tracing,
    Threads,
}

/// A scene that is expected to take longer is not tried.
const PATIENCE: f64 = 120.0;

/// Ways of tracing are tried with so many solids: some take time as N for every ray.
const TRACED: [u32; 3] = [10, 100, 1000];

fn case(name: &str) -> Result<&'static Case, String> {
    let names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
    Case::by_name(name).ok_or_else(|| format!("expected some of {}", names.join(" ")))
}

/// Measures one scene and writes a line.
///
/// # Errors
///
/// If it cannot be measured.
pub(crate) fn measure(arguments: &MeasureArguments) -> Result<(), Box<dyn Error>> {
    if arguments.while_input {
        end_with_input();
    }
    let task = match arguments.task {
        TaskWord::Growth => Task::Growth,
        TaskWord::Tracing => Task::Tracing,
        TaskWord::Threads => Task::Threads,
    };
    let figures = task.measured(&arguments.name, arguments.count, arguments.size.0)?;
    Ok(write_text(Path::new("-"), &figures.line(&arguments.name))?)
}

/// Does what the command line says.
///
/// # Errors
///
/// What kept the report from being made.
pub(crate) fn run(arguments: &SpeedArguments) -> Result<(), Box<dyn Error>> {
    let SpeedArguments { output: folder, common, .. } = arguments;
    let talk = common.talk;
    if common.threads.count().is_some() {
        return Err(UsageError("--threads: `speed` measures one thread and two".into()).into());
    }
    for path in &arguments.scenes {
        // What is wrong with a scene is told before anything is measured.
        scene(path, &[], talk)?;
    }
    let own = own_scenes(&arguments.scenes)?;
    fs::create_dir_all(folder.join("plots"))
        .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    let mut journal = Journal::open(folder, common.fresh)?;
    let end = arguments.seconds.map(|budget| Instant::now() + Duration::from_secs_f64(budget));
    let progress = talk.progress(40);
    let said = |what: &str| {
        progress.stage(what.to_owned());
        progress.advance(1);
        talk.note(what);
    };
    let mut bench = Bench {
        journal: &mut journal,
        size: arguments.size.0,
        end,
        said: &said,
        missing: Vec::new(),
    };
    let mut found = Found { size: arguments.size.0, ..Found::default() };
    let cases: Vec<&Case> = arguments.cases.clone().unwrap_or_else(|| CASES.iter().collect());
    for &case in &cases {
        found.growth.extend(bench.growth(case.name, arguments.max_n)?);
    }
    let mut fixed = vec![WINE_GLASS_NAME];
    if Path::new(STATION).is_file() {
        fixed.push(STATION);
    } else {
        bench.missing.push(format!("{STATION}: there is none in this folder"));
    }
    fixed.extend(own.iter().copied().filter(|&name| name != STATION));
    for &name in &fixed {
        let row = bench.row(Task::Growth, name, 0, 0.0)?;
        found.growth.extend(row);
    }
    for &case in &cases {
        for count in TRACED.into_iter().filter(|&count| count <= arguments.max_n) {
            found.tracing.extend(bench.row(Task::Tracing, case.name, count, 0.0)?);
        }
    }
    found.tracing.extend(bench.row(Task::Tracing, WINE_GLASS_NAME, 0, 0.0)?);
    for &name in &fixed {
        found.threads.extend(bench.row(Task::Threads, name, 0, 0.0)?);
    }
    for &case in &cases {
        let count = 1000.min(arguments.max_n);
        found.threads.extend(bench.row(Task::Threads, case.name, count, 0.0)?);
    }
    found.missing = bench.missing;
    write(&found, folder)?;
    let text: Vec<String> = found
        .tables()
        .iter()
        .filter(|table| !table.rows.is_empty())
        .map(|table| format!("{}\n\n{}", table.title, table.markdown()))
        .collect();
    write_text(Path::new("-"), &text.join("\n"))?;
    if !talk.is_quiet() {
        print(&format!("{}\n", folder.join("report.html").display()));
    }
    Ok(())
}

/// The names of scenes from files, none of which may be taken for a generated one.
fn own_scenes(paths: &[PathBuf]) -> Result<Vec<&str>, UsageError> {
    let name = |path: &'_ PathBuf| -> Result<(), UsageError> {
        let name = path
            .to_str()
            .ok_or_else(|| UsageError(format!("{}: expected a name in UTF-8", path.display())))?;
        if name == WINE_GLASS_NAME || Case::by_name(name).is_some() {
            return Err(UsageError(format!(
                "{name}: a generated scene has this name; try ./{name}"
            )));
        }
        Ok(())
    };
    paths.iter().try_for_each(name)?;
    Ok(paths.iter().filter_map(|path| path.to_str()).collect())
}

struct Bench<'a> {
    journal: &'a mut Journal,
    size: (u32, u32),
    end: Option<Instant>,
    said: &'a dyn Fn(&str),
    missing: Vec<String>,
}

impl Bench<'_> {
    /// A case with ever more solids, as long as the next takes no longer than there is time and patience, and no more
    /// memory than there is.
    fn growth(&mut self, name: &str, most: u32) -> Result<Vec<Row>, Box<dyn Error>> {
        let (mut rows, mut count) = (Vec::new(), 10);
        let mut expected = 0.0;
        while count <= most {
            let Some(row) = self.row(Task::Growth, name, count, expected)? else { break };
            let taken = ["compile", "build", "trace"].map(|part| row.figures.number(part));
            // Ten times the solids take at most ten times as long, and as much memory.
            expected = 10.0 * taken.into_iter().sum::<f64>();
            let bytes = 10.0 * row.figures.number("memory");
            rows.push(row);
            count = count.saturating_mul(10);
            if count <= most && available_bytes().is_some_and(|available| bytes > available) {
                let word = Task::Growth.word();
                self.missing.push(format!("{word} {name} {count}: no memory"));
                break;
            }
        }
        Ok(rows)
    }

    /// What is known of a scene, or is measured now if there is time.
    fn row(
        &mut self,
        task: Task,
        name: &str,
        count: u32,
        expected: f64,
    ) -> Result<Option<Row>, Box<dyn Error>> {
        let (columns, rows) = self.size;
        let words = match count {
            0 => format!("{} {name}", task.word()),
            count => format!("{} {name} {count}", task.word()),
        };
        let text = Case::by_name(name)
            .map_or_else(|| fs::read(name).unwrap_or_default(), |case| case.name.into());
        let digest = Digest::default().and(&text);
        let version = env!("CARGO_PKG_VERSION");
        let key = format!("{version} speed {digest} {columns}x{rows} {words}");
        let row =
            |figures: &Figures| Row { name: name.to_owned(), count, figures: figures.clone() };
        if let Some(known) = self.journal.get(&key) {
            return Ok(Some(row(known)));
        }
        let left = self.end.map_or(f64::INFINITY, |end| {
            end.saturating_duration_since(Instant::now()).as_secs_f64()
        });
        if expected > PATIENCE || expected > left || left <= 0.0 {
            self.missing.push(format!("{words}: no time"));
            return Ok(None);
        }
        (self.said)(&words);
        match apart(task, name, count, self.size) {
            Ok(figures) => {
                self.journal.keep(&key, &figures)?;
                Ok(Some(row(&figures)))
            }
            Err(error) => {
                self.missing.push(format!("{words}: {error}"));
                Ok(None)
            }
        }
    }
}

fn write(found: &Found, folder: &Path) -> Result<(), Box<dyn Error>> {
    for table in found.tables() {
        write_text(&folder.join(format!("{}.csv", table.name)), &table.csv())?;
    }
    for (name, plot) in found.plots() {
        let path = folder.join("plots").join(format!("{name}.svg"));
        write_text(&path, &plot.svg(Form::Wide))?;
    }
    Ok(write_text(&folder.join("report.html"), &found.page())?)
}
