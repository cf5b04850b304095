//! Arguments of `icopy`, and the order of reading, working and writing.

use std::error::Error;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Parser, ValueEnum};
use idf::command::{ArgumentError, Channels, Color, Job, Storage, Talk, Threads, open, save};
use idf::exchange::Format;
use idf::{Ask, Depth, Kind, Matte};

use crate::{Axis, Behind, Options, Pick, Region, Turn, copied};

/// Copies an image from any format to any other
///
/// Formats follow the endings of the names: none or .idf, .png, .exr, .ppm, .jpg (only read).
/// `-` is standard input or, as PNG, standard output. What is done on the way is done in the
/// order of the options below.
#[derive(Parser, Debug)]
#[command(
    name = "icopy",
    version,
    after_help = "Example:\n  icopy wine.idf label.png --crop 120,40,64,64 --flatten '#ffffff'"
)]
pub struct Arguments {
    /// Image to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Image to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Channels to keep, as rgb,cvg; NEW=OLD renames
    #[arg(long, value_name = "LIST")]
    channels: Option<Picks>,
    /// The part to keep, in pixels from the top left
    #[arg(long, value_name = "X,Y,W,H", value_parser = region)]
    crop: Option<Region>,
    /// Resample, in linear light
    #[arg(long, value_name = "WxH", value_parser = pair)]
    resize: Option<[u32; 2]>,
    /// Reverse left and right, or top and bottom
    #[arg(long, value_name = "AXIS")]
    flip: Option<AxisWord>,
    /// Turn clockwise
    #[arg(long, value_name = "DEGREES")]
    rotate: Option<TurnWord>,
    /// Repeat across and down
    #[arg(long, value_name = "NxM", value_parser = pair)]
    tile: Option<[u32; 2]>,
    /// Paint a colour in where coverage is below 1: #rrggbb or R,G,B [default: the image's]
    #[arg(long, value_name = "COLOUR", num_args = 0..=1)]
    #[expect(clippy::option_option, reason = "absent, without a colour, with a colour")]
    flatten: Option<Option<Color>>,
    /// Store light multiplied by coverage, or straight [default for IDF: as in an IDF, else premultiplied]
    #[arg(long)]
    matte: Option<MatteWord>,
    /// Bits of a sample
    #[arg(long, value_name = "BITS")]
    depth: Option<DepthWord>,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

/// Channels with their new kinds.
#[derive(Clone, Debug)]
struct Picks(Vec<Pick>);

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AxisWord {
    X,
    Y,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TurnWord {
    #[value(name = "90")]
    Quarter,
    #[value(name = "180")]
    Half,
    #[value(name = "270")]
    ThreeQuarters,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MatteWord {
    Premultiplied,
    Straight,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DepthWord {
    #[value(name = "8")]
    U8,
    #[value(name = "16")]
    U16,
    #[value(name = "32f")]
    F32,
}

/// Does what `icopy` was asked for.
///
/// # Errors
///
/// If the image cannot be read, copied so, or written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { input, output, storage, talk, .. } = arguments;
    let job = Job::start("icopy", env!("CARGO_PKG_VERSION"));
    let mut options = options(arguments);
    let to = Format::of(output);
    let ask = match &options.channels {
        Some(picks) => Ask::Only(picks.iter().map(|pick| pick.from).collect()),
        None if to == Some(Format::Idf) => Ask::All,
        None => Ask::Picture,
    };
    let image = open(input, &storage.read_options(ask))?;
    talk.note(format_args!("read {}: {}", input.display(), summary(&image)));
    if to == Some(Format::Idf) && Format::of(input) != to {
        options.matte = options.matte.or(Some(Matte::Premultiplied));
    }
    let copy = copied(&image, &options)?;
    if to == Some(Format::Pnm) && copy.plane(Kind::Cvg).is_some() {
        talk.warn("this format is opaque; the background is painted in");
    }
    talk.note(format_args!("write {}: {}", output.display(), summary(&copy)));
    Ok(save(output, copy, &storage.write_options(), &job)?)
}

fn options(arguments: &Arguments) -> Options {
    Options {
        channels: arguments.channels.as_ref().map(|picks| picks.0.clone()),
        crop: arguments.crop,
        resize: arguments.resize,
        flip: arguments.flip.map(|word| match word {
            AxisWord::X => Axis::X,
            AxisWord::Y => Axis::Y,
        }),
        rotate: arguments.rotate.map(|word| match word {
            TurnWord::Quarter => Turn::Quarter,
            TurnWord::Half => Turn::Half,
            TurnWord::ThreeQuarters => Turn::ThreeQuarters,
        }),
        tile: arguments.tile.unwrap_or([1, 1]),
        flatten: arguments.flatten.map(|color| match color {
            None => Behind::Own,
            Some(Color(color)) => Behind::Color(color),
        }),
        matte: arguments.matte.map(|word| match word {
            MatteWord::Premultiplied => Matte::Premultiplied,
            MatteWord::Straight => Matte::Straight,
        }),
        depth: arguments.depth.map(|word| match word {
            DepthWord::U8 => Depth::U8,
            DepthWord::U16 => Depth::U16,
            DepthWord::F32 => Depth::F32,
        }),
    }
}

fn summary(image: &idf::Image) -> String {
    let words: Vec<&str> = image.kinds().iter().map(|kind| kind.word()).collect();
    let [columns, rows] = image.size();
    format!("{columns} x {rows}, depth {}, {}", image.depth().word(), words.join(" "))
}

impl FromStr for Picks {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let mut picks = Vec::new();
        for word in text.split(',') {
            let (to, from) = word.split_once('=').unwrap_or((word, word));
            let (Channels(to), Channels(from)) = (to.parse()?, from.parse()?);
            let tables = to.contains(&Kind::Lut) != from.contains(&Kind::Lut);
            if to.len() != from.len() && from.len() != 1 || tables {
                let message = format!("expected NEW=OLD of channels of one shape, found `{word}`");
                return Err(ArgumentError::new(message));
            }
            // rgb=grg: grey light as a colour.
            let from = from.iter().cycle();
            picks.extend(to.iter().zip(from).map(|(&to, &from)| Pick { to, from }));
        }
        Ok(Self(picks))
    }
}

fn pair(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x').map(|(a, b)| [a.parse::<u32>(), b.parse::<u32>()]);
    match numbers {
        Some([Ok(across), Ok(down)]) if across > 0 && down > 0 => Ok([across, down]),
        _ => Err("expected two whole numbers above 0, as 4x3".into()),
    }
}

fn region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[column, row, columns, rows]) if columns > 0 && rows > 0 => {
            Ok(Region { column, row, columns, rows })
        }
        _ => Err("expected column, row, columns and rows, as 0,0,64,48".into()),
    }
}
