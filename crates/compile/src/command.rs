//! The command line of `prcomp`, and the order of reading, working and writing.

use std::ffi::OsString;
use std::fmt;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, ValueEnum};
use clap_complete::Shell;
use scene::Scene;

use crate::image;
use crate::paper::{self, PaperError};
use crate::{Compiled, Diagnostic, Options, Severity, SourceMap};
use crate::{layout, omit};

/// The name that stands for standard input or output.
const STREAM: &str = "-";

/// What it is called in messages.
const STANDARD_INPUT: &str = "standard input";

/// Compiles a scene description.
#[derive(Debug, Parser)]
#[command(
    name = "prcomp",
    version,
    about = "Compiles a scene description",
    after_help = "Example: prcomp wine-glass.sdl\n         writes wine-glass.prc, which portray renders"
)]
struct Arguments {
    /// Scene description; - is standard input
    #[arg(value_name = "SCENE.sdl", required_unless_present_any = ["completions", "man"])]
    scene: Option<PathBuf>,
    /// Where to write; - is standard output [default: SCENE.prc beside the scene description]
    #[arg(short, long, value_name = "SCENE.prc")]
    output: Option<PathBuf>,
    /// Report what is wrong and write nothing; with --format, fail if the layout would change
    #[arg(long, conflicts_with_all = ["output", "paper"])]
    check: bool,
    /// Lay the description out and write it back, or where --output says; files that it includes are left alone
    #[arg(long, conflicts_with = "paper")]
    format: bool,
    /// Write the form of the paper instead: primitives under balanced trees of binary operators
    /// [default: to standard output]
    #[arg(long)]
    paper: bool,
    /// Give the number that a `let` names another value; `frame` is the number of the picture in a sequence
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = crate::definition,
          allow_hyphen_values = true)]
    definitions: Vec<(String, f64)>,
    /// Largest number of solids that repeats and classes with parameters make, and of primitives that --paper writes
    #[arg(long, value_name = "N", default_value_t = paper::LIMIT)]
    max_primitives: u64,
    /// Say what is left out of the compiled scene because no object comes to it
    #[arg(long, conflicts_with = "format")]
    explain: bool,
    /// Leave nothing out; the picture is the same
    #[arg(long, conflicts_with = "format")]
    keep_all: bool,
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Say what is done
    #[arg(short, long)]
    verbose: bool,
    /// How errors and warnings are written to standard error
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    message_format: MessageFormat,
    /// Write the completions of a shell
    #[arg(long, value_name = "SHELL", exclusive = true)]
    completions: Option<Shell>,
    /// Write the manual page
    #[arg(long, exclusive = true)]
    man: bool,
}

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MessageFormat {
    /// Lines to read, with the source
    Human,
    /// One JSON object a line
    Json,
}

/// Why there is no output.
#[derive(Debug)]
enum Failure {
    /// The command line is wrong.
    Usage(String),
    /// The work failed.
    Work(String),
    /// Diagnostics have said why.
    Reported { path: PathBuf, errors: usize },
}

/// Does what the command line says; exit status 1 where the work fails, 2 where the command line is wrong.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    if let Err(message) = processor::check() {
        writeln!(io::stderr(), "prcomp: error: {message}").ok();
        return ExitCode::FAILURE;
    }
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    match work(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => fail(&failure, arguments.message_format),
    }
}

fn work(arguments: &Arguments) -> Result<(), Failure> {
    let Some(path) = &arguments.scene else { return write_packaging(arguments) };
    let sources = if is_stream(path) {
        SourceMap::from_reader(Path::new(STANDARD_INPUT), io::stdin().lock())
    } else {
        SourceMap::from_path(path)
    };
    let sources = sources.map_err(|error| Failure::Work(error.to_string()))?;
    if arguments.format {
        return format(arguments, path, sources);
    }
    let options = Options {
        definitions: arguments.definitions.clone(),
        max_primitives: arguments.max_primitives,
        look: Some(look),
    };
    let mut compiled = Compiled::of(Ok(sources), &options);
    print(&compiled, arguments);
    let output = output(arguments, path);
    if let Some(scene) = &mut compiled.scene {
        let folder = output.parent().filter(|folder| *folder != Path::new(""));
        image::rebase(scene, folder.unwrap_or(Path::new(".")));
    }
    if !arguments.check {
        check_output(&output, &compiled)?;
    }
    if let Some(scene) = &mut compiled.scene {
        leave_out(scene, arguments);
    }
    let Some(scene) = &compiled.scene else {
        let errors = compiled.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        return Err(Failure::Reported { path: path.clone(), errors });
    };
    if !arguments.check {
        let print = |mut out: &mut dyn Write| {
            if arguments.paper {
                return paper::print(scene, arguments.max_primitives, &mut out);
            }
            Ok(scene::format::write(scene, &mut out)?)
        };
        write(&output, print).map_err(|error| cannot_write(&output, error))?;
    }
    if arguments.verbose {
        say(summary(path, scene, &compiled));
    }
    Ok(())
}

/// Takes away what the scene does not need, and tells of it, as far as that is wanted.
fn leave_out(scene: &mut Scene, arguments: &Arguments) {
    if arguments.keep_all && !arguments.explain {
        return;
    }
    let mut kept = arguments.keep_all.then(|| scene.clone());
    let omissions = omit::leave_out(kept.as_mut().unwrap_or(scene));
    if arguments.explain {
        let end = if arguments.keep_all { "all of it is kept: --keep-all\n" } else { "" };
        write!(io::stderr(), "{}{end}", omit::table(&omissions)).ok();
    }
}

/// Whether a renderer could show the picture of a file.
fn look(path: &Path) -> Result<(), String> {
    idf::exchange::read_picture(path).map(drop).map_err(|error| error.to_string())
}

/// Lays the main file out and writes it where it has to be.
fn format(arguments: &Arguments, path: &Path, mut sources: SourceMap) -> Result<(), Failure> {
    let mistakes = layout::mistakes(&mut sources);
    let laid = if mistakes.is_empty() { layout::laid_out(&sources) } else { Err(mistakes) };
    let text = match laid {
        Ok(text) => text,
        Err(diagnostics) => {
            let errors = diagnostics.len();
            print(&Compiled { scene: None, diagnostics, sources, objects: Vec::new() }, arguments);
            return Err(Failure::Reported { path: path.to_owned(), errors });
        }
    };
    let same = sources.main().is_some_and(|main| *sources.text(main).0.text == *text);
    if arguments.check {
        let message = format!("the layout of `{}` would change", path.display());
        return if same { Ok(()) } else { Err(Failure::Work(message)) };
    }
    let in_place = arguments.output.is_none() && !is_stream(path);
    // What is laid out already keeps its time of change.
    if in_place && same {
        return Ok(());
    }
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None if is_stream(path) => path.to_owned(),
        // A link stays one.
        None => path.canonicalize().unwrap_or_else(|_| path.to_owned()),
    };
    write(&output, |out| Ok(out.write_all(text.as_bytes())?))
        .map_err(|error| cannot_write(&output, error))
}

fn is_stream(path: &Path) -> bool {
    path == Path::new(STREAM)
}

fn output(arguments: &Arguments, scene: &Path) -> PathBuf {
    match &arguments.output {
        Some(output) => output.clone(),
        None if arguments.paper || is_stream(scene) => PathBuf::from(STREAM),
        None => scene.with_extension("prc"),
    }
}

/// The output must not be a source.
fn check_output(output: &Path, compiled: &Compiled) -> Result<(), Failure> {
    let Ok(identity) = output.canonicalize() else { return Ok(()) };
    let same = |path: &Path| path.canonicalize().is_ok_and(|source| source == identity);
    let folder = output.parent().unwrap_or(Path::new(""));
    let images = compiled.scene.iter().flat_map(|scene| &scene.images);
    let mut pictures = images.map(|image| folder.join(&image.path));
    let source = compiled.sources.paths().any(same) || pictures.any(|picture| same(&picture));
    if source && !is_stream(output) {
        let message = format!("`{}` would be overwritten, a source; use -o", output.display());
        return Err(Failure::Usage(message));
    }
    Ok(())
}

/// Writes beside the output and then renames it, so that a crash leaves the old file or the new one.
fn write(
    output: &Path,
    text: impl FnOnce(&mut dyn Write) -> Result<(), PaperError>,
) -> Result<(), PaperError> {
    let print = |out: &mut dyn Write| {
        let mut out = BufWriter::with_capacity(1 << 16, out);
        text(&mut out)?;
        Ok::<(), PaperError>(out.flush()?)
    };
    if is_stream(output) {
        return print(&mut io::stdout().lock());
    }
    let before = std::fs::metadata(output).ok();
    if before.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        return Err(io::Error::other("expected a file").into());
    }
    let folder = match output.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".prcomp.");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(plain)?;
    print(&mut file)?;
    file.as_file().sync_data()?;
    if let Some(before) = before {
        file.as_file().set_permissions(before.permissions())?;
    }
    file.persist(output).map_err(|error| error.error)?;
    Ok(())
}

/// What the system said, without the temporary name that `tempfile` adds to it.
fn plain(error: io::Error) -> io::Error {
    let said = error.to_string();
    let said = said.split_once(" at path ").map(|(said, _)| said.to_owned());
    said.map_or(error, io::Error::other)
}

fn cannot_write(output: &Path, error: PaperError) -> Failure {
    let name = if is_stream(output) { Path::new("standard output") } else { output };
    let reason = match error {
        PaperError::Write(error) => error.to_string(),
        error => error.to_string(),
    };
    Failure::Work(format!("cannot write `{}`: {reason}", name.display()))
}

fn print(compiled: &Compiled, arguments: &Arguments) {
    let text = match (arguments.message_format, arguments.quiet) {
        (MessageFormat::Human, false) => compiled.report(),
        (MessageFormat::Human, true) => compiled.error_report(),
        (MessageFormat::Json, quiet) => {
            let wanted =
                compiled.diagnostics.iter().filter(|d| !quiet || d.severity == Severity::Error);
            wanted.map(|diagnostic| diagnostic.json(&compiled.sources) + "\n").collect()
        }
    };
    write!(io::stderr(), "{text}").ok();
}

fn summary(path: &Path, scene: &Scene, compiled: &Compiled) -> String {
    let solids = scene
        .classes
        .iter()
        .map(|class| &class.solid)
        .chain(scene.objects.iter().map(|object| &object.solid));
    let leaves: usize = solids
        .flat_map(|solid| &solid.nodes)
        .filter(|node| {
            use scene::Node::{Form, Instance, Primitive};
            matches!(node, Primitive { .. } | Form { .. } | Instance { .. })
        })
        .count();
    format!(
        "{}: files {}, classes {}, objects {}, primitives and instances {leaves}, lights {}",
        path.display(),
        compiled.sources.paths().count(),
        scene.classes.len(),
        scene.objects.len(),
        scene.lights.len()
    )
}

fn write_packaging(arguments: &Arguments) -> Result<(), Failure> {
    let mut command = Arguments::command();
    let mut text = Vec::new();
    let rendered = match arguments.completions {
        Some(shell) => {
            clap_complete::generate(shell, &mut command, "prcomp", &mut text);
            Ok(())
        }
        None => clap_mangen::Man::new(command).render(&mut text),
    };
    rendered
        .and_then(|()| io::stdout().write_all(&text))
        .map_err(|error| cannot_write(Path::new(STREAM), error.into()))
}

/// Help on standard output with status 0, or what is wrong on standard error with 2.
fn usage(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let shown = write!(io::stdout(), "{}", error.render());
        return if shown.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    say(format_args!("prcomp: {}", error.render().to_string().trim_end()));
    ExitCode::from(2)
}

fn fail(failure: &Failure, format: MessageFormat) -> ExitCode {
    let (message, status) = match failure {
        Failure::Usage(message) => (message.clone(), 2),
        Failure::Work(message) => (message.clone(), 1),
        // Those who read objects have counted them.
        Failure::Reported { .. } if format == MessageFormat::Json => return ExitCode::from(1),
        Failure::Reported { path, errors } => {
            let name = if is_stream(path) {
                STANDARD_INPUT.to_owned()
            } else {
                format!("`{}`", path.display())
            };
            let count = if *errors == 1 { "an error".into() } else { format!("{errors} errors") };
            (format!("{name} has {count}"), 1)
        }
    };
    match format {
        MessageFormat::Human => say(format_args!("prcomp: error: {message}")),
        MessageFormat::Json => say(Diagnostic::nowhere(message).json(&SourceMap::default())),
    }
    ExitCode::from(status)
}

/// One message on standard error. That it cannot be written there can be told to nobody.
fn say(message: impl fmt::Display) {
    writeln!(io::stderr(), "{message}").ok();
}
