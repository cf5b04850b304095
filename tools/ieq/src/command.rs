//! Arguments of `ieq`, made from the table of operations, and the order of reading, working and
//! writing.

use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, CommandFactory, FromArgMatches, Parser};
use idf::command::{
    Job, Storage, Talk, Threads, UsageError, check_output, is_stream, open, open_layered, save,
    save_layered, summary, write_text,
};
use idf::exchange::Format;
use idf::{Ask, Image};

use crate::{Operation, Parameter, Row, TABLE, Work, histogram, toned};

const ABOUT: &str = "Changes the tones of an image, or counts them";

const LONG_ABOUT: &str = "Changes the tones of an image, or counts them\n\n\
    Operations work on display values (sRGB, 0 to 1) of the covered part of each pixel; what is \
    not covered does not count. Names are those of IDF images, or of files of any other format by \
    their ending; `-` is standard input or, as PNG, standard output.";

const EXAMPLE: &str = "Examples:\n  ieq gamma 2.2 wine -o brighter.png\n  \
    ieq clahe --tiles 8 --clip 0.02 wine\n  ieq histogram wine -o histogram.png > tones.tsv";

/// What `ieq` is asked for.
#[derive(Clone, Debug)]
pub struct Arguments {
    operation: Operation,
    source: Source,
    files: Files,
}

/// What follows every operation.
#[derive(Args, Clone, Debug)]
struct Source {
    /// Image to read
    #[arg(value_name = "IMAGE")]
    image: PathBuf,
}

/// What may stand before an operation or behind it.
#[derive(Args, Clone, Debug)]
struct Files {
    /// Image to write [default: an IDF image beside the one that is read, as wine-gamma; standard output for standard input]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

impl Parser for Arguments {}

impl CommandFactory for Arguments {
    fn command() -> Command {
        let either_side = Files::augment_args(Command::new("ieq")).mut_args(|arg| arg.global(true));
        either_side
            .version(env!("CARGO_PKG_VERSION"))
            .about(ABOUT)
            .long_about(LONG_ABOUT)
            .after_help(EXAMPLE)
            .disable_help_subcommand(true)
            .subcommands(TABLE.iter().map(subcommand))
    }

    fn command_for_update() -> Command {
        Self::command()
    }
}

fn subcommand(row: &'static Row) -> Command {
    let mut command = Command::new(row.word).args(row.parameters.iter().map(argument));
    if row.looks_at_luma() {
        let about = "Take each channel by itself, not luma";
        command = command.arg(
            Arg::new("per-channel").long("per-channel").action(ArgAction::SetTrue).help(about),
        );
    }
    Source::augment_args(command).about(row.about)
}

fn argument(parameter: &'static Parameter) -> Arg {
    let [least, most] = parameter.range;
    let argument = Arg::new(parameter.name)
        .allow_hyphen_values(parameter.default.is_some())
        .allow_negative_numbers(true)
        .value_parser(|text: &str| number(parameter, text));
    let about = parameter.about;
    match parameter.default {
        None => argument
            .required(true)
            .value_name(parameter.name)
            .help(format!("{about}, {least} to {most}")),
        Some(default) => argument
            .long(parameter.name)
            .value_name("N")
            .help(format!("{about}, {least} to {most} [default: {default}]")),
    }
}

fn number(parameter: &Parameter, text: &str) -> Result<f64, String> {
    let number = text.parse().map_err(|_| format!("expected a number, found `{text}`"))?;
    parameter.checked(number).map_err(|error| error.to_string())
}

impl FromArgMatches for Arguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let error = |kind, message: &str| Self::command().error(kind, message);
        let Some((word, matches)) = matches.subcommand() else {
            let words: Vec<&str> = TABLE.iter().map(|row| row.word).collect();
            let message = format!("expected an operation, one of {}", words.join(" "));
            return Err(error(ErrorKind::MissingSubcommand, &message));
        };
        let row = TABLE.iter().find(|row| row.word == word);
        let parameters = row.map_or(&[][..], |row| row.parameters).iter();
        let numbers: Vec<f64> =
            parameters.filter_map(|p| matches.get_one(p.name).copied().or(p.default)).collect();
        let mut operation = Operation::new(word, &numbers)
            .map_err(|found| error(ErrorKind::ValueValidation, &found.to_string()))?;
        operation.per_channel = operation.row().looks_at_luma() && matches.get_flag("per-channel");
        Ok(Self {
            operation,
            source: Source::from_arg_matches(matches)?,
            files: Files::from_arg_matches(matches)?,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Does what `ieq` was asked for.
///
/// # Errors
///
/// If the image cannot be read, has no light, or the result cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.files.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { operation, source: Source { image: input }, files } = arguments;
    let Files { output, storage, talk, .. } = files;
    if let Some(output) = output {
        check_output(output, &[])?;
    }
    let progress = talk.progress(3);
    progress.stage(format!("reads {}", input.display()));
    let job = Job::start("ieq", env!("CARGO_PKG_VERSION"));
    if let Work::Histogram = operation.row().work {
        let image = open(input, &storage.read_options(Ask::Picture))?;
        return count(image, arguments, &job);
    }
    let output = match output {
        Some(output) => output.clone(),
        None => beside(input, operation.row().word)?,
    };
    // Measured values have a place there.
    let keeps_all = matches!(Format::of(&output), Some(Format::Idf | Format::Exr));
    let ask = if keeps_all && !is_stream(&output) { Ask::All } else { Ask::Picture };
    let (image, layers) = open_layered(input, &storage.read_options(ask))?;
    talk.note(format_args!("read {}: {}", input.display(), summary(&image)));
    progress.advance(1);
    progress.stage(operation.row().word);
    let new = toned(image, operation)?;
    talk.note(format_args!("write {}: {}", output.display(), summary(&new)));
    progress.advance(1);
    progress.stage(format!("writes {}", output.display()));
    Ok(save_layered(&output, new, &layers, &storage.write_options(), &job, *talk)?)
}

/// The table on standard output, and the picture where one is asked for; a picture on standard
/// output comes without the table.
fn count(
    image: Image,
    arguments: &Arguments,
    job: &Job,
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { operation, files: Files { output, storage, .. }, .. } = arguments;
    let histogram = histogram(image, crate::whole(operation.parameters()[0]))?;
    if let Some(output) = output {
        save(output, histogram.drawn(), &storage.write_options(), job)?;
        if is_stream(output) {
            return Ok(());
        }
    }
    Ok(write_text(Path::new("-"), &histogram.to_string())?)
}

/// `wine-gamma.idf` beside `wine` or `wine.png`; standard output for standard input.
fn beside(input: &Path, word: &str) -> Result<PathBuf, UsageError> {
    if is_stream(input) {
        return Ok(input.into());
    }
    let stem = input
        .file_stem()
        .ok_or_else(|| UsageError("expected a name to write to, as -o OUT".into()))?;
    let mut name = OsString::from(stem);
    name.push(format!("-{word}.idf"));
    Ok(input.with_file_name(name))
}
