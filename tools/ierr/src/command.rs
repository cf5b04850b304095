//! Arguments of `ierr`, and the order of reading, measuring and writing.

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Parser;
use idf::command::{
    ArgumentError, Job, Storage, Talk, Threads, UsageError, open_layered, save, write_text,
};
use idf::{Ask, Depth, Image, Kind, ReadError};

use crate::{Figure, Measured, Pair, Report, Row, TABLE, Viewing, difference, map};

/// Measures how far one image is from another
///
/// Integer images are compared as display values (sRGB, 0 to 1, and in steps of 255); where either
/// is floating point, both are compared as linear light. Light is multiplied by coverage, and
/// coverage is compared as a channel. The exit status is 0 where the images could be compared, and
/// 1 where a limit is passed.
#[derive(Parser, Clone, Debug)]
#[command(name = "ierr", version, after_help = after_help())]
pub struct Arguments {
    /// The image that is right; `-` is standard input
    #[arg(value_name = "A")]
    reference: PathBuf,
    /// The image that is compared with it
    #[arg(value_name = "B")]
    test: PathBuf,
    /// Metrics to print, as rmse,flip [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = row)]
    metrics: Vec<&'static Row>,
    /// End with status 1 where a metric is worse: rmse=0.01, max=2/255, psnr=40; of one channel max.red=2/255; several with
    /// commas
    #[arg(long, value_name = "METRIC=VALUE", value_delimiter = ',')]
    limit: Vec<Limit>,
    /// Write a picture of the difference: that of each channel
    #[arg(long, value_name = "OUT")]
    diff: Option<PathBuf>,
    /// Show the values of a metric in the picture instead: flip, ssim
    #[arg(long, value_name = "METRIC", requires = "diff", value_parser = mapped_row)]
    diff_by: Option<&'static Row>,
    /// Brighten the picture so many times
    #[arg(long, value_name = "TIMES", requires = "diff", default_value = "1", value_parser = positive, allow_hyphen_values = true)]
    gain: f64,
    /// Pixels in a degree of the visual field, for flip
    #[arg(long, value_name = "N", default_value = "67", value_parser = pixels_per_degree, allow_hyphen_values = true)]
    ppd: f64,
    /// Print one object of JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

/// A metric and what it has to reach.
#[derive(Clone, Copy, Debug)]
struct Limit {
    row: &'static Row,
    /// The channel it is of, if not of all.
    channel: Option<Kind>,
    value: f64,
}

/// A limit was passed.
#[derive(Clone, Debug, PartialEq)]
struct Beyond(String);

/// Does what `ierr` was asked for.
///
/// # Errors
///
/// If an image cannot be read, they cannot be compared, a picture cannot be written, or a limit is
/// passed.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { reference, test, storage, talk, limit: limits, .. } = arguments;
    let job = Job::start("ierr", env!("CARGO_PKG_VERSION"));
    if [reference, test].iter().all(|name| idf::command::is_stream(name)) {
        return Err(UsageError("expected one image on standard input, found two".into()).into());
    }
    if let Some(diff) = &arguments.diff {
        idf::command::check_output(diff, &[])?;
    }
    let wanted = rows(arguments);
    let progress = talk.progress(2 + wanted.len() as u64);
    let read = |name: &Path| {
        progress.stage(format!("reads {}", name.display()));
        let (image, layers) = open_layered(name, &storage.read_options(Ask::Picture))?;
        talk.left_out(&layers.words(), &format!("of the comparison, of {}", name.display()));
        progress.advance(1);
        Ok::<Image, ReadError>(image)
    };
    let images = [read(reference)?, read(test)?];
    let depth = images.iter().map(Image::depth).max().unwrap_or(Depth::U8);
    let places = images.each_ref().map(|image| image.properties.origin);
    let pair = Pair::of(images)?;
    if places[0] != places[1] {
        talk.warn("the images lie in different places of their canvas; their pixels are compared");
    }
    let mut report =
        Report::new([reference, test].map(|name| name.to_string_lossy().into_owned()), &pair);
    let viewing = Viewing { pixels_per_degree: arguments.ppd };
    for row in wanted {
        progress.stage(row.word);
        talk.note(format_args!("{row}: {}", row.about));
        let mut measured = (row.measure)(&pair, &viewing);
        // Only the one that is shown takes memory.
        if arguments.diff_by.is_none_or(|shown| shown.word != row.word) {
            measured.iter_mut().for_each(|measured| measured.map = None);
        }
        report.figures.push(Figure { row, measured });
        progress.advance(1);
    }
    if let Some(diff) = &arguments.diff {
        let picture = picture(arguments, &pair, &report, depth)?;
        save(diff, picture, &storage.write_options(), &job)?;
    }
    if report.incomparable > 0 {
        talk.warn(format_args!(
            "{} samples are infinite or not a number in one image alone; no figure has them",
            report.incomparable
        ));
    }
    report.figures.retain(|figure| is_printed(arguments, figure.row));
    let text = if arguments.json { format!("{}\n", report.to_json()) } else { report.to_string() };
    if !arguments.diff.as_deref().is_some_and(idf::command::is_stream) {
        write_text(Path::new("-"), &text)?;
    }
    check(limits, &report)
}

/// The metrics that have to be measured, in the order of the list.
fn rows(arguments: &Arguments) -> Vec<&'static Row> {
    let mut rows: Vec<&'static Row> = Vec::new();
    let listed: Vec<&'static Row> = if arguments.metrics.is_empty() {
        TABLE.iter().collect()
    } else {
        arguments.metrics.clone()
    };
    let limited = arguments.limit.iter().map(|limit| limit.row);
    for row in listed.into_iter().chain(limited).chain(arguments.diff_by) {
        if rows.iter().all(|other| other.word != row.word) {
            rows.push(row);
        }
    }
    rows
}

/// Whether a metric was asked for, and not only for the picture.
fn is_printed(arguments: &Arguments, row: &Row) -> bool {
    let wanted = |other: &&Row| other.word == row.word;
    arguments.metrics.is_empty()
        || arguments.metrics.iter().any(wanted)
        || arguments.limit.iter().any(|limit| limit.row.word == row.word)
}

fn picture(
    arguments: &Arguments,
    pair: &Pair,
    report: &Report,
    depth: Depth,
) -> Result<Image, Box<dyn Error + Send + Sync>> {
    let Some(row) = arguments.diff_by else { return Ok(difference(pair, arguments.gain, depth)?) };
    let figure = report.figures.iter().find(|figure| figure.row.word == row.word);
    let values = figure.and_then(|figure| figure.measured.as_ref()?.map.as_ref());
    let values = values.ok_or_else(|| format!("{row}: the images are too small"))?;
    Ok(map(pair, values, arguments.gain, depth)?)
}

fn check(limits: &[Limit], report: &Report) -> Result<(), Box<dyn Error + Send + Sync>> {
    if !limits.is_empty() && report.incomparable > 0 {
        let message = format!("{} samples cannot be compared", report.incomparable);
        return Err(Beyond(message).into());
    }
    for Limit { row, channel, value: limit } in limits {
        let figure = report.figures.iter().find(|figure| figure.row.word == row.word);
        let found = figure.and_then(|figure| figure.measured.as_ref());
        let found = found.ok_or_else(|| format!("{row}: the images are too small"))?;
        let (name, value) = match channel {
            None => (row.word.to_owned(), found.value),
            Some(channel) => (format!("{row}.{channel}"), of_channel(row, found, *channel)?),
        };
        if row.is_beyond(value, *limit) {
            let side = if row.more_is_nearer { "at least" } else { "at most" };
            return Err(Beyond(format!("{name} is {value}, expected {side} {limit}")).into());
        }
    }
    Ok(())
}

/// What a metric found of one channel.
fn of_channel(row: &Row, found: &Measured, channel: Kind) -> Result<f64, String> {
    let value = found.channels.iter().find(|(kind, _)| *kind == channel).map(|&(_, value)| value);
    value.ok_or_else(|| {
        let words: Vec<&str> = found.channels.iter().map(|(kind, _)| kind.word()).collect();
        match &words[..] {
            [] => format!("--limit: {row} looks at all channels together, found `{row}.{channel}`"),
            _ => format!("--limit: no channel `{channel}`, found {}", words.join(" ")),
        }
    })
}

impl FromStr for Limit {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let error = || {
            let message = format!("expected METRIC=VALUE, as max=2/255, found `{text}`");
            ArgumentError::new(message)
        };
        let (word, value) = text.split_once('=').ok_or_else(error)?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = match value.split_once('/') {
            None => number(value),
            Some((above, below)) => number(above)
                .zip(number(below).filter(|below| *below > 0.0))
                .map(|(above, below)| above / below),
        };
        let (word, channel) = match word.split_once('.') {
            None => (word, None),
            Some((word, channel)) => (word, Some(self::channel(channel)?)),
        };
        Ok(Self { row: row(word)?, channel, value: value.ok_or_else(error)? })
    }
}

fn row(word: &str) -> Result<&'static Row, ArgumentError> {
    Row::from_word(word).ok_or_else(|| {
        let words: Vec<&str> = TABLE.iter().map(|row| row.word).collect();
        let message = format!("no metric is called `{word}`, expected {}", words.join(" "));
        ArgumentError::new(message)
    })
}

fn channel(word: &str) -> Result<Kind, ArgumentError> {
    Kind::from_word(word).ok_or_else(|| {
        ArgumentError::new(format!("no channel is called `{word}`, expected red, grn, blu …"))
    })
}

fn mapped_row(word: &str) -> Result<&'static Row, ArgumentError> {
    let row = row(word)?;
    let error = || ArgumentError::new(format!("`{row}` has no value for each pixel"));
    Some(row).filter(|row| row.has_map).ok_or_else(error)
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|value| (1e-6..=1e6).contains(value));
    number.ok_or_else(|| "expected a number from 0.000001 to 1000000".into())
}

fn pixels_per_degree(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|value| (1.0..=1000.0).contains(value));
    number.ok_or_else(|| "expected a number from 1 to 1000".into())
}

fn after_help() -> String {
    let rows = TABLE.iter().map(|row| format!("  {:5} {}\n", row.word, row.about));
    let rows: String = rows.collect();
    format!(
        "Metrics:\n{rows}\nExamples:\n  ierr right.png left.png\n  \
         ierr wine wine-small --diff d.png --diff-by flip\n  \
         ierr a.png b.png --json --limit max=1/255"
    )
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for Beyond {}
