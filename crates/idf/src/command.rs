//! What every image program shares: argument groups, files by name, history, the ending.

mod color;
mod layered;
mod output;
mod parts;
mod progress;

use std::error::Error;
use std::ffi::OsString;
use std::fmt;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Parser, value_parser};
use clap_complete::Shell;
use signal_hook::consts::SIGABRT;
use signal_hook::flag;

use crate::description::Encoding;
use crate::error::{ReadError, WriteError};
use crate::exchange::{Format, read_image, read_stream, write_image, write_stream};
use crate::history::Entry;
use crate::image::Image;
use crate::plane::{COLOR, Kind};
use crate::read::{Ask, ReadOptions, description_path, read_description};
use crate::rows::Reader;
use crate::write::WriteOptions;

pub use color::Color;
pub use layered::{open_layer, open_layered, save_layered};
pub use output::check_output;
pub use parts::{Parts, assembled, parts};
pub use progress::Progress;

/// The name that stands for standard input or output.
const STREAM: &str = "-";

/// Most threads: more than any machine has, and fewer than stacks have room for.
const MOST_THREADS: usize = 4096;

/// How much a program says.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Talk {
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Say what is done
    #[arg(short, long)]
    verbose: bool,
}

/// How many threads a program uses.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Threads {
    /// Number of threads [default: the cores available]
    #[arg(long = "threads", value_name = "N", value_parser = thread_count, allow_hyphen_values = true)]
    count: Option<NonZeroUsize>,
}

/// How files of this crate's format are written.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Coding {
    /// Write data files as they are
    #[arg(long, conflicts_with = "rle")]
    raw: bool,
    /// Write data files run-length coded where that is shorter (default)
    #[arg(long)]
    rle: bool,
}

/// How files of this crate's format are written and followed.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Storage {
    #[command(flatten)]
    coding: Coding,
    /// Follow file names that lead out of the folder of their image
    #[arg(long)]
    outside: bool,
}

/// Channels of an image: words of [`crate::plane::TABLE`] with commas; those of [`GROUPS`] stand for several, or are
/// other names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channels(pub Vec<Kind>);

/// Names of channels that go together, and longer names.
pub const GROUPS: [(&str, &[Kind]); 4] = [
    ("rgb", &COLOR),
    ("depth", &[Kind::Dep]),
    ("normal", &[Kind::Nrx, Kind::Nry, Kind::Nrz]),
    ("object", &[Kind::Obj]),
];

/// A command line that is wrong in a way that only the work finds; exit status 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsageError(pub String);

/// What is wrong with an argument.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArgumentError(String);

/// Time and name of a program, for its line of history.
#[derive(Clone, Debug)]
pub struct Job {
    entry: Entry,
    start: Instant,
}

impl Talk {
    /// Says what is done, with `-v`.
    pub fn note(self, message: impl fmt::Display) {
        if self.verbose {
            say(message);
        }
    }

    /// Warns, unless `-q`.
    pub fn warn(self, message: impl fmt::Display) {
        if !self.quiet {
            say(format_args!("warning: {message}"));
        }
    }

    /// Whether the program says what it does.
    pub fn is_verbose(self) -> bool {
        self.verbose
    }

    /// Whether the program says nothing but errors.
    pub fn is_quiet(self) -> bool {
        self.quiet
    }
}

impl Threads {
    /// Does `work` on as many threads as the command line says.
    ///
    /// # Errors
    ///
    /// If the system gives no threads.
    pub fn run<T: Send>(
        self,
        work: impl FnOnce() -> T + Send,
    ) -> Result<T, rayon::ThreadPoolBuildError> {
        let Some(count) = self.count else { return Ok(work()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count.get()).build()?;
        Ok(pool.install(work))
    }

    /// A number of threads, at least 1.
    pub fn of(count: usize) -> Self {
        Self { count: NonZeroUsize::new(count.max(1)) }
    }

    /// The number on the command line.
    pub fn count(self) -> Option<NonZeroUsize> {
        self.count
    }
}

impl ArgumentError {
    /// An error with this message.
    pub fn new(message: String) -> Self {
        Self(message)
    }
}

impl Coding {
    /// How to write an image that follows no others.
    pub fn write_options(self) -> WriteOptions {
        let encoding = if self.raw { Encoding::Raw } else { Encoding::Rle };
        WriteOptions { encoding, outside: false }
    }
}

impl Storage {
    /// How to read.
    pub fn read_options(self, ask: Ask) -> ReadOptions {
        ReadOptions { ask, outside: self.outside, history: true }
    }

    /// How to write.
    pub fn write_options(self) -> WriteOptions {
        WriteOptions { outside: self.outside, ..self.coding.write_options() }
    }
}

impl Job {
    /// The job of this process, from now on. `program` and `version` are those of the program.
    pub fn start(program: &str, version: &str) -> Self {
        Self { entry: Entry::now(program, version), start: Instant::now() }
    }

    /// Adds a figure to the line of history.
    #[must_use]
    pub fn with_figure(mut self, name: &str, value: impl fmt::Display) -> Self {
        self.entry = self.entry.with_figure(name, value);
        self
    }

    /// The line of history, with the seconds so far.
    pub fn entry(&self) -> Entry {
        let seconds = self.start.elapsed().as_secs_f64();
        self.entry.clone().with_figure("seconds", format_args!("{seconds:.3}"))
    }
}

/// Whether `name` stands for standard input or output.
pub fn is_stream(name: &Path) -> bool {
    name == Path::new(STREAM)
}

/// Set by `-q`, for what is said where no [`Talk`] is at hand.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Opens the rows of an image in this crate's format, and warns of what is perhaps misspelt in its
/// description, unless `-q`.
///
/// # Errors
///
/// As [`Reader::open`].
pub fn open_rows(name: &Path, options: &ReadOptions) -> Result<Reader, ReadError> {
    let reader = Reader::open(name, options)?;
    warn_of_misses(name);
    Ok(reader)
}

fn warn_of_misses(name: &Path) {
    let Ok(description) = read_description(name) else { return };
    for (key, known) in description.near_misses() {
        if !IS_QUIET.load(Ordering::Relaxed) {
            let path = description_path(name);
            say(format_args!(
                "warning: {}: the line of the unknown key `{key}` is kept; is `{known}` meant?",
                path.display()
            ));
        }
    }
}

/// Opens an image by name: this crate's format with or without ending, any other by its ending,
/// `-` for standard input. Warns as [`open_rows`].
///
/// # Errors
///
/// As [`read_image`].
pub fn open(name: &Path, options: &ReadOptions) -> Result<Image, ReadError> {
    if is_stream(name) {
        read_stream(Path::new("standard input"), io::stdin().lock(), options)
    } else {
        let image = read_image(name, options)?;
        if Format::of(name) == Some(Format::Idf) {
            warn_of_misses(name);
        }
        Ok(image)
    }
}

/// Writes an image by name, with a line of history where the format has one; `-` writes PNG to
/// standard output.
///
/// # Errors
///
/// As [`write_image`].
pub fn save(
    name: &Path,
    mut image: Image,
    options: &WriteOptions,
    job: &Job,
) -> Result<(), WriteError> {
    if is_stream(name) {
        return write_stream(Path::new("standard output"), io::stdout().lock(), &image);
    }
    if Format::of(name) == Some(Format::Idf) {
        image.properties.history.push(job.entry().to_string());
    }
    write_image(name, &image, options)
}

/// Parses the command line, does the work, and ends as every program does: exit status 1 and one
/// line on standard error where the work fails, 2 where the command line is wrong.
///
/// Each program also gets `--completions SHELL` and `--man`, which write what a packager needs to
/// standard output.
pub fn run_main<A: Parser>(work: fn(&A) -> Result<(), Box<dyn Error>>) -> ExitCode {
    fail_without_memory();
    finish::<A>(std::env::args_os(), work)
}

/// Where memory runs out unforeseen the standard library says how much was wanted, and aborts: exit status 1 then, as of any
/// work that fails.
fn fail_without_memory() {
    let always = Arc::new(AtomicBool::new(true));
    // Without it the status is that of the signal.
    flag::register_conditional_shutdown(SIGABRT, 1, always).ok();
}

fn finish<A: Parser>(
    arguments: impl Iterator<Item = OsString>,
    work: fn(&A) -> Result<(), Box<dyn Error>>,
) -> ExitCode {
    let command = with_packaging(A::command());
    let program = command.get_name().to_owned();
    if let Err(message) = processor::check() {
        say(format_args!("{program}: error: {message}"));
        return ExitCode::FAILURE;
    }
    let parsed =
        command.clone().try_get_matches_from(with_negatives(arguments)).and_then(|matches| {
            match packaging(&matches) {
                Some(wanted) => Ok(Err(wanted)),
                None => {
                    IS_QUIET.store(is_quiet(&matches), Ordering::Relaxed);
                    A::from_arg_matches(&matches).map(Ok)
                }
            }
        });
    let result = match parsed {
        Err(error) => return usage(&program, &error),
        Ok(Err(wanted)) => write_packaging(A::command(), &wanted),
        Ok(Ok(arguments)) => work(&arguments),
    };
    let Err(error) = result else { return ExitCode::SUCCESS };
    let status = if error.is::<UsageError>() { 2 } else { 1 };
    say(format_args!("{program}: error: {}", chain(error.as_ref())));
    ExitCode::from(status)
}

/// Shows a text on standard error as it is: diagnostics that bring their own lines.
pub fn print(text: &str) {
    progress::aside(|| {
        write!(io::stderr(), "{text}").ok();
    });
}

/// Writes a text to a file so that a crash leaves the old one or the new one; `-` is standard output.
///
/// # Errors
///
/// If it cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    if is_stream(path) {
        let mut written = Ok(());
        progress::aside(|| written = io::stdout().write_all(text.as_bytes()));
        return written
            .map_err(|source| crate::file::io_error(Path::new("standard output"), source));
    }
    crate::file::replace(path, text.as_bytes())
}

/// Size, depth and channels of an image, for a line of `-v`.
pub fn summary(image: &Image) -> String {
    let words: Vec<&str> = image.kinds().iter().map(|kind| kind.word()).collect();
    let [columns, rows] = image.size();
    format!("{columns} x {rows}, depth {}, {}", image.depth().word(), words.join(" "))
}

/// An error and what it came from, in one line.
pub fn chain(error: &dyn Error) -> String {
    let mut message = error.to_string();
    let mut next = error.source();
    while let Some(source) = next {
        message.push_str(": ");
        message.push_str(&source.to_string());
        next = source.source();
    }
    message.replace('\n', " ")
}

/// Arguments, where numbers with commas of which the first is negative are the value of the option before
/// them, not options, so that the option says what is wrong with them.
fn with_negatives(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut all: Vec<OsString> = Vec::new();
    for argument in arguments {
        let is_option = |last: &OsString| {
            last.to_str().is_some_and(|word| word.starts_with("--") && !word.contains('='))
        };
        let is_numbers =
            argument.to_str().and_then(|text| text.strip_prefix('-')).is_some_and(|rest| {
                rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') && rest.contains(',')
            });
        match all.last_mut().filter(|last| is_numbers && *last != "--" && is_option(last)) {
            Some(last) => {
                last.push("=");
                last.push(argument);
            }
            None => all.push(argument),
        }
    }
    all
}

/// What a packager asks for.
enum Packaging {
    Completions(Shell),
    Manual,
}

fn with_packaging(command: Command) -> Command {
    let packaging = |name: &'static str| Arg::new(name).long(name).exclusive(true);
    command
        .arg(
            packaging("completions")
                .value_name("SHELL")
                .value_parser(value_parser!(Shell))
                .help("Write the completions of a shell"),
        )
        .arg(packaging("man").action(ArgAction::SetTrue).help("Write the manual page"))
}

/// Whether `-q` is given, before or behind a subcommand; programs without it are not.
fn is_quiet(matches: &ArgMatches) -> bool {
    let own = matches.try_get_one::<bool>("quiet").ok().flatten().copied().unwrap_or_default();
    own || matches.subcommand().is_some_and(|(_, matches)| is_quiet(matches))
}

fn packaging(matches: &ArgMatches) -> Option<Packaging> {
    if matches.get_flag("man") {
        return Some(Packaging::Manual);
    }
    matches.get_one("completions").copied().map(Packaging::Completions)
}

fn write_packaging(command: Command, wanted: &Packaging) -> Result<(), Box<dyn Error>> {
    let mut command = with_packaging(command);
    let mut text = Vec::new();
    match wanted {
        Packaging::Manual => clap_mangen::Man::new(command).render(&mut text)?,
        Packaging::Completions(shell) => {
            let name = command.get_name().to_owned();
            clap_complete::generate(*shell, &mut command, name, &mut text);
        }
    }
    io::stdout().write_all(&text)?;
    Ok(())
}

/// Help on standard output with status 0, or what is wrong on standard error with 2.
fn usage(program: &str, error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let shown = write!(io::stdout(), "{}", error.render());
        return if shown.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    say(format_args!("{program}: {}", error.render().to_string().trim_end()));
    ExitCode::from(2)
}

/// One message on standard error. That it cannot be written there can be told to nobody.
fn say(message: impl fmt::Display) {
    progress::aside(|| {
        writeln!(io::stderr(), "{message}").ok();
    });
}

fn thread_count(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.parse::<NonZeroUsize>().ok().filter(|count| count.get() <= MOST_THREADS);
    count.ok_or_else(|| format!("expected a whole number from 1 to {MOST_THREADS}"))
}

impl FromStr for Channels {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let mut kinds = Vec::new();
        for word in text.split(',') {
            let group = GROUPS.iter().find(|(name, _)| *name == word);
            match (Kind::from_word(word).filter(|kind| *kind != Kind::Log), group) {
                (Some(kind), _) => kinds.push(kind),
                (None, Some((_, group))) => kinds.extend(*group),
                (None, None) => {
                    return Err(ArgumentError(format!("no channel is called `{word}`")));
                }
            }
        }
        Ok(Self(kinds))
    }
}

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Display for ArgumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for UsageError {}
impl Error for ArgumentError {}
