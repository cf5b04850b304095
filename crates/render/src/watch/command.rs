//! `portray --watch`: the order of work, and what the text of a scene tells.

use std::collections::BTreeSet;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use clap::Args;
use compile::{Compiled, Diagnostic, Severity, SourceMap, Span};
use idf::command::{UsageError, is_stream};
use live::{Board, Place, Problem, Server};
use scene::{Camera, Lens, Scene};

use super::files::Watched;
use super::session::{Good, Session, Settings, Source, nowhere};
use super::terminal;
use crate::LoadError;
use crate::command::{Arguments, options};
use crate::reading::command::{compile_options, pointed_at, read_scene};

/// Options about what is shown while a scene is written.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct WatchArguments {
    /// Show the picture on a page in the browser, and again whenever the scene changes; it gets better until then. The address is
    /// written to standard output, and Ctrl-C ends it. Without --samples, --aa or --error the picture is refined to an
    /// error of half a display step
    #[arg(long, conflicts_with_all = ["output", "channels", "seconds", "audit", "explain", "window", "part",
          "tile", "part_of", "frames", "stats", "raw", "rle", "certify"])]
    watch: bool,
    /// Show the pictures of --watch in this terminal, by the program ishow, and no page
    #[arg(long, requires = "watch", conflicts_with = "open")]
    terminal: bool,
    /// Open the page of --watch in the browser
    #[arg(long, requires = "watch")]
    open: bool,
}

impl WatchArguments {
    pub(crate) fn is_wanted(self) -> bool {
        self.watch
    }
}

/// The error that pictures are refined to where nothing else is asked for, in display steps: what is left cannot be seen.
const UNSEEN: f64 = 0.5;

/// Shows a scene until the program is ended.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let WatchArguments { terminal, open, .. } = arguments.watch;
    let path = &arguments.scene;
    if is_stream(path) {
        let message = "--watch looks at a file again and again, expected its name, found `-`";
        return Err(UsageError(message.into()).into());
    }
    let settings = settings(arguments)?;
    let ishow = terminal.then(terminal::program).transpose()?;
    // A name that was mistyped is no scene that is not written yet.
    std::fs::metadata(path).map_err(|error| format!("{}: {error}", path.display()))?;

    let board = Arc::new(Board::default());
    let session = Arc::new(Session::new(settings, Arc::clone(&board)));
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    board.say(|shown| shown.scene = name);
    let painter = Arc::clone(&session);
    thread::Builder::new().name("painter".into()).spawn(move || painter.paint())?;
    let watching = arguments.clone();
    let (watched, looked) = (Watched::new(path), Arc::clone(&board));
    if let Some(program) = ishow {
        thread::Builder::new()
            .name("watch".into())
            .spawn(move || watch(&watching, watched, &looked, &session))?;
        return terminal::show_all(&board, &program).map_err(|error| error as Box<dyn Error>);
    }
    let server = Server::start(Arc::clone(&board), Arc::clone(&session) as _)?;
    let url = server.url();
    let mut output = std::io::stdout().lock();
    writeln!(output, "{url}").and_then(|()| output.flush())?;
    drop(output);
    if open {
        open_page(arguments, &url);
    }
    watch(&watching, watched, &looked, &session)
}

fn settings(arguments: &Arguments) -> Result<Settings, UsageError> {
    let options = options(arguments, None)?;
    let is_plain = !arguments.sampling.is_asked() && !arguments.watch.terminal;
    Ok(Settings {
        options,
        load: arguments
            .omit
            .load_options((options.columns, options.rows), arguments.sampling.glossy),
        dither: arguments.dither_output,
        refine: is_plain.then_some(UNSEEN),
    })
}

/// Asks the desktop for its browser. That there is none is no error: the address has been told.
fn open_page(arguments: &Arguments, url: &str) {
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let started = Command::new(program)
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    if let Err(error) = started {
        arguments.talk.warn(format_args!("cannot open a browser with {program}: {error}"));
    }
}

/// Reads the scene again whenever one of its files changes.
fn watch(arguments: &Arguments, mut watched: Watched, board: &Board, session: &Session) -> ! {
    let mut begun = Instant::now();
    // Since the last text without errors.
    let mut changed = BTreeSet::new();
    loop {
        let draft = read(arguments);
        let mut problems = draft.problems;
        let mut files = draft.files;
        let taken = match draft.good {
            Some(good) => session.take(good, begun, &changed).map(|()| changed.clear()),
            None => Ok(()),
        };
        problems.extend(taken.err());
        if problems.iter().any(|problem| problem.is_error) {
            // What is missing may come: in a folder that is known, or where the last good scene had it.
            let folders: Vec<PathBuf> = files.iter().filter_map(|file| folder(file)).collect();
            files.extend(folders);
            files.extend(watched.paths().map(Path::to_owned).collect::<Vec<_>>());
        }
        tell(arguments, &problems);
        board.say(|shown| shown.problems = problems);
        watched.replace(files);
        watched.wait(|| {
            session.halt();
            begun = Instant::now();
        });
        changed.append(&mut watched.take_changed());
    }
}

/// On standard error, as without `--watch`.
fn tell(arguments: &Arguments, problems: &[Problem]) {
    let quiet = arguments.talk.is_quiet();
    for problem in problems.iter().filter(|problem| problem.is_error || !quiet) {
        idf::command::print(&format!("{}\n", problem.text.trim_end()));
    }
}

fn folder(file: &Path) -> Option<PathBuf> {
    let folder = file.parent()?;
    Some(if folder == Path::new("") { PathBuf::from(".") } else { folder.to_owned() })
}

/// What was read.
struct Draft {
    good: Option<Good>,
    problems: Vec<Problem>,
    files: Vec<PathBuf>,
}

fn read(arguments: &Arguments) -> Draft {
    let path = &arguments.scene;
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("prc")) {
        return match read_scene(arguments, false) {
            Ok((scene, sources)) => {
                let source = Text { sources, objects: Vec::new() };
                let files = pictures(&scene);
                Draft { good: Some(good(scene, source)), problems: Vec::new(), files }
            }
            Err(error) => {
                let problems = vec![nowhere(&error.to_string())];
                Draft { good: None, problems, files: Vec::new() }
            }
        };
    }
    let compiled = compile::compile_path_with(path, &compile_options(arguments));
    let Compiled { scene, diagnostics, sources, objects } = compiled;
    let problems = diagnostics.iter().map(|diagnostic| problem(diagnostic, &sources)).collect();
    let mut files: Vec<PathBuf> = sources.paths().map(Path::to_owned).collect();
    files.extend(scene.iter().flat_map(pictures));
    let good = scene.map(|scene| good(scene, Text { sources, objects }));
    Draft { good, problems, files }
}

fn good(scene: Scene, source: Text) -> Good {
    Good { revision: 0, scene: Arc::new(scene), source: Arc::new(source), pictures: Arc::default() }
}

/// The files of the pictures that a scene shows: of an IDF image the description, which is written last.
fn pictures(scene: &Scene) -> Vec<PathBuf> {
    scene.images.iter().map(|image| idf::description_path(Path::new(&image.path))).collect()
}

fn problem(diagnostic: &Diagnostic, sources: &SourceMap) -> Problem {
    let location = diagnostic.span.and_then(|span| sources.locate(span));
    Problem {
        is_error: diagnostic.severity == Severity::Error,
        file: location.map(|location| location.path.display().to_string()),
        line: location.map_or(0, |location| location.line),
        column: location.map_or(0, |location| location.column),
        text: diagnostic.human(sources),
    }
}

/// The text of a scene; empty for one that was compiled before.
struct Text {
    sources: SourceMap,
    objects: Vec<Span>,
}

/// The most of a line that is shown, in characters.
const LINE: usize = 120;

impl Source for Text {
    fn place(&self, object: usize) -> Option<Place> {
        let span = *self.objects.get(object)?;
        let location = self.sources.locate(span)?;
        let (_, text, range) = self.sources.within(span)?;
        let start = text.get(..range.start)?.rfind('\n').map_or(0, |end| end + 1);
        let line = text.get(start..)?.lines().next().unwrap_or_default();
        Some(Place {
            file: location.path.display().to_string(),
            line: location.line,
            column: location.column,
            text: line.chars().take(LINE).collect(),
        })
    }

    fn explain(&self, error: &LoadError) -> Problem {
        match (pointed_at(error, &self.sources), error) {
            (Some(text), LoadError::Image(failure)) => Problem {
                file: Some(failure.file.source.clone()),
                line: failure.file.line,
                column: failure.file.column,
                text,
                ..nowhere("")
            },
            _ => nowhere(&error.to_string()),
        }
    }

    fn statement(&self, camera: &Camera, lens: Option<&Lens>) -> String {
        compile::camera::statement(camera, lens)
    }
}
