//! Arguments of `ilut`, and the order of reading, working and writing.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Parser, ValueEnum};
use idf::command::{
    ArgumentError, Color, Job, Storage, Talk, Threads, UsageError, check_output, is_stream, open,
    print, save,
};
use idf::exchange::Format;
use idf::plane::Role;
use idf::transfer::rounded_8;
use idf::{Ask, Depth, Image, Kind, Lut, Plane, Samples, Transfer, add};

use crate::{Method, Metric, Options, Pixels, Table, TableError, quality, quantize, rms_rgb};

type Failure = Box<dyn Error + Send + Sync>;

/// Finds the colours that images get by with
///
/// Several images get one table together. An IDF image gets the channel `lut`, and loses an `enc` of
/// another table; `photo.png` gets a file `photo.lut`. With -o there is one new file instead: .lut is bare, three rows of bytes;
/// another ending is a picture of one row of these colours, indexed in .png and .gif. `-` is
/// standard input or, as PNG, standard output.
///
/// Where coverage is below 1 it is kept as alpha in the table, unless --matte is given or the table
/// is bare, which is opaque.
#[derive(Parser, Debug)]
#[command(
    name = "ilut",
    version,
    after_help = "Example:\n  ilut wine.idf label.png -n 64 --keep '#000000,#ffffff' -o both.lut"
)]
pub struct Arguments {
    /// Images that get one table
    #[arg(value_name = "IMAGE", required = true)]
    images: Vec<PathBuf>,
    #[command(flatten)]
    table: TableArguments,
    /// As few colours as leave at most this root mean square error, in display steps: of a channel
    /// for rgb, of 255 times the distance for oklab
    #[arg(long, value_name = "E", value_parser = error_bound, allow_hyphen_values = true)]
    max_error: Option<f64>,
    /// Make the table for a dither: up to 32 colours reach out to the ends of those of the images,
    /// so that mixes show them (fast and best)
    #[arg(long)]
    spread: bool,
    /// What to put behind where coverage is below 1: #rrggbb, #rgb or R,G,B [default for bare tables: the
    /// image's background]
    #[arg(long, value_name = "COLOUR")]
    matte: Option<Color>,
    /// Table to write
    #[arg(short, long, value_name = "LUT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

/// What table to make: options that `iencode` has, too.
#[derive(Args, Clone, Debug)]
pub struct TableArguments {
    /// Most colours of a table that is made [default: 256]
    #[arg(short = 'n', long, value_name = "COLOURS", value_parser = color_count, allow_hyphen_values = true)]
    colors: Option<usize>,
    /// How a table is made [default: best]
    #[arg(long, value_name = "METHOD")]
    method: Option<MethodWord>,
    /// What is near: the numbers of a colour, or how it looks
    #[arg(long, value_name = "METRIC", default_value = "rgb")]
    metric: MetricWord,
    /// Colours to begin a table with: #rgb, #rgba, #rrggbb or #rrggbbaa, with commas
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    keep: Option<Kept>,
}

/// Colours to keep.
#[derive(Clone, Debug)]
struct Kept(Vec<[u8; 4]>);

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodWord {
    /// Median cut of 15-bit colours, as in 1982
    Heckbert,
    /// Variance cut, one round of k-means
    Fast,
    /// Variance cut, ten rounds of k-means
    Best,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MetricWord {
    Rgb,
    Oklab,
}

/// Where a table goes.
enum Target<'a> {
    /// Into an IDF image that is there.
    Channel(&'a Path),
    /// Into a file of three rows.
    Bare(PathBuf),
    /// Into a picture of one row.
    Picture(&'a Path),
}

/// Does what `ilut` was asked for.
///
/// # Errors
///
/// If an image cannot be read, no table be made as is wanted, or it cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { images: names, storage, talk, .. } = arguments;
    let job = Job::start("ilut", env!("CARGO_PKG_VERSION"));
    let method = arguments.table.options().method;
    if arguments.spread && method == Method::Heckbert {
        let message = "--spread is for --method fast and best, found heckbert";
        return Err(UsageError(message.into()).into());
    }
    let targets = targets(arguments)?;
    if let Some(output) = &arguments.output {
        check_output(output, &["gif", "lut"])?;
    }
    let is_bare = targets.iter().any(|target| matches!(target, Target::Bare(_)));
    for target in &targets {
        if let Target::Channel(name) = target {
            check_light(name)?;
        }
    }
    // Each picture is read and compared, all are counted, and the table is written.
    let progress = talk.progress(2 * names.len() as u64 + 2);
    let mut pictures = Vec::new();
    for name in names {
        progress.stage(format!("reads {}", name.display()));
        let image = open(name, &storage.read_options(Ask::Picture))?;
        let own = is_bare.then(|| image.properties.background.unwrap_or_default());
        let matte = arguments.matte.map(|Color(matte)| matte).or(own);
        let error = |error| format!("{}: {error}", name.display());
        let pixels = Pixels::of(&image, matte).map_err(error)?;
        talk.note(format_args!(
            "read {}: {} x {}",
            name.display(),
            pixels.columns(),
            pixels.rows()
        ));
        pictures.push((pixels, image.transfer(Depth::U8)));
        progress.advance(1);
    }
    let options = Options {
        max_error: arguments.max_error,
        spread: arguments.spread,
        ..arguments.table.options()
    };
    let pixels: Vec<&Pixels> = pictures.iter().map(|(pixels, _)| pixels).collect();
    progress.stage("chooses colours");
    let quantized = quantize(&pixels, &options).map_err(|error| match error {
        TableError::Keep { .. } => Failure::from(UsageError(error.to_string())),
        error => error.into(),
    })?;
    progress.advance(1);
    let table = quantized.table;
    let colors = table.colors().len();
    let mut worst: f64 = 0.0;
    for ((name, pixels), indices) in names.iter().zip(pixels).zip(&quantized.indices) {
        progress.stage(format!("compares {}", name.display()));
        worst = worst.max(if talk.is_quiet() {
            rms_rgb(pixels, &table, indices)
        } else {
            let figures = quality(pixels, &table, indices);
            print(&format!("{}: {}\n", name.display(), figures.words(colors)));
            figures.rms_rgb
        });
        progress.advance(1);
    }
    let job = job.with_figure("colors", colors).with_figure("rms", format_args!("{worst:.3}"));
    progress.stage("writes");
    // There is one target, which is no image, or one for each picture.
    let transfers = pictures.iter().map(|(_, transfer)| *transfer);
    for (target, transfer) in targets.iter().zip(transfers) {
        put(target, &table, transfer, arguments, &job)?;
    }
    Ok(())
}

/// An image that is nothing but indices into its table must keep that table.
fn check_light(name: &Path) -> Result<(), Failure> {
    let channels = idf::read_description(name)?.channels;
    if channels.iter().any(|channel| channel.kind.role() == Role::Light) {
        return Ok(());
    }
    let name = name.display();
    Err(format!("{name}: its colours are in its table alone, which stays; give a name with -o")
        .into())
}

/// One target with -o, else one for each image.
fn targets(arguments: &Arguments) -> Result<Vec<Target<'_>>, UsageError> {
    match &arguments.output {
        Some(output) if is_bare(output) => Ok(vec![Target::Bare(output.clone())]),
        Some(output) => Ok(vec![Target::Picture(output)]),
        None if arguments.images.iter().any(|name| is_stream(name)) => {
            let message = "standard input has no name for a table; give one with -o";
            Err(UsageError(message.into()))
        }
        None => Ok(arguments.images.iter().map(|name| own_target(name)).collect()),
    }
}

fn own_target(name: &Path) -> Target<'_> {
    if Format::of(name) == Some(Format::Idf) {
        Target::Channel(name)
    } else {
        Target::Bare(name.with_extension("lut"))
    }
}

fn is_bare(name: &Path) -> bool {
    name.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("lut"))
}

impl TableArguments {
    /// Whether a table of a kind is asked for, besides its metric.
    pub fn is_given(&self) -> bool {
        self.colors.is_some() || self.method.is_some() || self.keep.is_some()
    }

    /// What table to make.
    pub fn options(&self) -> Options {
        let default = Options::default();
        Options {
            colors: self.colors.unwrap_or(default.colors),
            method: match self.method {
                Some(MethodWord::Heckbert) => Method::Heckbert,
                Some(MethodWord::Fast) => Method::Fast,
                Some(MethodWord::Best) => Method::Best,
                None => default.method,
            },
            metric: match self.metric {
                MetricWord::Rgb => Metric::Rgb,
                MetricWord::Oklab => Metric::Oklab,
            },
            keep: self.keep.as_ref().map(|Kept(colors)| colors.clone()).unwrap_or_default(),
            ..default
        }
    }
}

/// Writes the table. `transfer` is that of the image that it goes into.
fn put(
    target: &Target<'_>,
    table: &Table,
    transfer: Transfer,
    arguments: &Arguments,
    job: &Job,
) -> Result<(), Failure> {
    let Arguments { storage, talk, .. } = arguments;
    match target {
        Target::Bare(path) => {
            if table.colors().iter().any(|color| color[3] < u8::MAX) {
                talk.warn("a bare table is opaque; the alpha of kept colours is left out");
            }
            talk.note(format_args!("write {}", path.display()));
            Ok(Lut::from(table).write(path)?)
        }
        Target::Channel(path) => {
            talk.note(format_args!("write the channel `lut` of {}", path.display()));
            let stored = table.colors().iter().map(|&color| stored(color, transfer)).collect();
            let size = idf::read_description(&idf::description_path(path))?.size;
            let mut image = Image::new(size[0], size[1], Vec::new())?;
            image.lut = Lut::with_coverage(stored);
            image.properties.history.push(job.entry().to_string());
            for kind in add(path, &image, &storage.write_options())? {
                talk.warn(format_args!(
                    "{}: its channel `{kind}` is gone, as its indices were into the older table; \
                     iencode makes another",
                    path.display()
                ));
            }
            Ok(())
        }
        Target::Picture(path) => {
            talk.note(format_args!("write {}", path.display()));
            let indices: Vec<u8> = (0..=u8::MAX).take(table.colors().len()).collect();
            let plane = Plane { kind: Kind::Enc, samples: Samples::U8(indices) };
            let columns = u32::try_from(table.colors().len())?;
            let mut image = Image::new(columns, 1, vec![plane])?;
            image.lut = Some(table.into());
            Ok(save(path, image, &storage.write_options(), job)?)
        }
    }
}

/// A colour as bytes of another transfer.
fn stored([red, green, blue, alpha]: [u8; 4], transfer: Transfer) -> [u8; 4] {
    let byte = |display: u8| rounded_8(transfer, Transfer::Srgb.decode(f64::from(display) / 255.0));
    [byte(red), byte(green), byte(blue), alpha]
}

fn error_bound(text: &str) -> Result<f64, String> {
    let bound = text.parse().ok().filter(|bound: &f64| bound.is_finite() && *bound >= 0.0);
    bound.ok_or_else(|| "expected a number of 0 or more, as 1.5".into())
}

fn color_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=Lut::MOST).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {}, as 64", Lut::MOST))
}

impl FromStr for Kept {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let color = |word: &str| {
            let digits = word.strip_prefix('#').filter(|d| matches!(d.len(), 3 | 4 | 6 | 8));
            let digits = digits.filter(|digits| digits.chars().all(|d| d.is_ascii_hexdigit()));
            // One digit of a channel stands for two of the same.
            let digits = digits.map(|digits| match digits.len() {
                3 | 4 => digits.chars().flat_map(|digit| [digit; 2]).collect(),
                _ => digits.to_owned(),
            });
            let number = digits.and_then(|d| u32::from_str_radix(&format!("{d:f<8}"), 16).ok());
            number.map(u32::to_be_bytes).ok_or_else(|| {
                let message = format!(
                    "expected #rgb, #rgba, #rrggbb or #rrggbbaa, found `{word}`, as #ffcc00"
                );
                ArgumentError::new(message)
            })
        };
        text.split(',').map(color).collect::<Result<_, _>>().map(Self)
    }
}
