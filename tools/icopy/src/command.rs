//! Arguments of `icopy`, and the order of reading, working and writing.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Parser, ValueEnum};
use idf::command::{
    ArgumentError, Channels, Color, Job, Storage, Talk, Threads, UsageError, check_output,
    is_stream, open, save, summary,
};
use idf::exchange::Format;
use idf::plane::Role;
use idf::{Ask, Depth, Kind, Matte, ReadError, Window};

use crate::resize::FILTERS;
use crate::{
    Axis, Behind, Border, Extent, Filter, Options, Pick, Region, Source, Turn, copied, joined,
    levels,
};

/// Copies an image from any format to any other
///
/// Formats follow the endings of the names: none or .idf, .png, .exr, .ppm, .pam, .gif; only read:
/// .jpg, .tif, .webp. `-` is standard input or, as PNG, standard output. Several images are put
/// together in their windows first; where they overlap, the last is seen. What is done on the way is
/// done in the order of the options below.
#[derive(Parser, Debug)]
#[command(
    name = "icopy",
    version,
    after_help = "Example:\n  icopy wine.idf label.png --crop 120,40,64,64 --flatten '#ffffff'"
)]
pub struct Arguments {
    /// Image to read; several are put together
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    /// Image to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Channels to keep, as rgb,cvg; NEW=OLD renames, NEW=NUMBER fills, grg=luma is the luminance
    #[arg(long, value_name = "LIST")]
    channels: Option<Picks>,
    /// The part to keep, in pixels from the top left
    #[arg(long, value_name = "X,Y,W,H", value_parser = region, allow_hyphen_values = true)]
    crop: Option<Region>,
    /// Pixels more on the left, top, right and bottom
    #[arg(long, value_name = "L,T,R,B", value_parser = border_widths, conflicts_with = "extend_to", allow_hyphen_values = true)]
    extend: Option<[u32; 4]>,
    /// The window of the canvas to have, larger or not
    #[arg(long, value_name = "X,Y,W,H", value_parser = window, allow_hyphen_values = true)]
    extend_to: Option<Window>,
    /// What is beyond the edges: clear (coverage 0), edge, wrap, or a colour [default: clear]
    #[arg(long, value_name = "BORDER", allow_hyphen_values = true)]
    border: Option<BorderWord>,
    /// Move to the right and down; what leaves comes in at the other side
    #[arg(long, value_name = "X,Y", value_parser = offset, allow_hyphen_values = true)]
    shift: Option<[i32; 2]>,
    /// Make opposite edges meet: towards them, blend into the picture shifted by half its size
    #[arg(long)]
    tileable: bool,
    /// Resample, in linear light
    #[arg(long, value_name = "WxH", value_parser = pair, allow_hyphen_values = true)]
    resize: Option<[u32; 2]>,
    /// How to resample: linear (area average down, bilinear up), box, bicubic (Catmull-Rom), lanczos
    #[arg(long, value_name = "FILTER", default_value = "linear", value_parser = filter)]
    filter: Filter,
    /// Reverse left and right, or top and bottom
    #[arg(long, value_name = "AXIS")]
    flip: Option<AxisWord>,
    /// Turn clockwise
    #[arg(long, value_name = "DEGREES")]
    rotate: Option<TurnWord>,
    /// Repeat across and down
    #[arg(long, value_name = "NxM", value_parser = pair, allow_hyphen_values = true)]
    tile: Option<[u32; 2]>,
    /// Give what has no coverage the colours about it; light becomes straight
    #[arg(long)]
    fill: bool,
    /// Paint a colour in where coverage is below 1: #rrggbb or R,G,B [default: the image's]
    #[arg(long, value_name = "COLOUR", num_args = 0..=1, value_parser = flat_color)]
    #[expect(clippy::option_option, reason = "absent, without a colour, with a colour")]
    flatten: Option<Option<Color>>,
    /// Store light multiplied by coverage, or straight [default for IDF: as in an IDF, else premultiplied]
    #[arg(long)]
    matte: Option<MatteWord>,
    /// Bits of a sample
    #[arg(long, value_name = "BITS")]
    depth: Option<DepthWord>,
    /// Write levels of detail too, each half as large: of x.png, x.1.png, x.2.png ... to one pixel
    #[arg(long)]
    mips: bool,
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

#[derive(Clone, Copy, Debug)]
struct BorderWord(Border);

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
    let Arguments { inputs, output, storage, talk, .. } = arguments;
    check(arguments)?;
    // Of each image, and of the copy.
    let progress = talk.progress(2 * (inputs.len() as u64 + 1));
    let job = Job::start("icopy", env!("CARGO_PKG_VERSION"));
    let mut options = options(arguments);
    let to = Format::of(output);
    let ask = ask(options.channels.as_deref(), to);
    let mut images = Vec::new();
    for input in inputs {
        progress.stage(format!("reads {}", input.display()));
        let image =
            open(input, &storage.read_options(ask.clone())).map_err(|error| match &error {
                ReadError::Missing { kind, present, .. } => match hint(*kind, present, to) {
                    Some(hint) => Box::<dyn Error + Send + Sync>::from(format!("{error}; {hint}")),
                    None => error.into(),
                },
                _ => error.into(),
            })?;
        talk.note(format_args!("read {}: {}", input.display(), summary(&image)));
        images.push(image);
        progress.advance(2);
    }
    progress.stage("copies");
    let is_own = |input: &PathBuf| Format::of(input) == Some(Format::Idf) && !is_stream(input);
    if to == Some(Format::Idf) && !inputs.iter().all(is_own) && !options.fill {
        options.matte = options.matte.or(Some(Matte::Premultiplied));
    }
    let image = joined(&images)?;
    drop(images);
    let copies =
        if arguments.mips { levels(&image, &options)? } else { vec![copied(&image, &options)?] };
    progress.advance(1);
    for (level, copy) in copies.into_iter().enumerate() {
        let name = level_name(output, level);
        progress.stage(format!("writes {}", name.display()));
        if to == Some(Format::Pnm) && copy.plane(Kind::Cvg).is_some() && level == 0 {
            talk.warn("this format is opaque; the background is painted in");
        }
        talk.note(format_args!("write {}: {}", name.display(), summary(&copy)));
        save(&name, copy, &storage.write_options(), &job)?;
    }
    Ok(())
}

/// What the parser cannot see.
fn check(arguments: &Arguments) -> Result<(), UsageError> {
    let error = |message: &str| Err(UsageError(message.into()));
    check_output(&arguments.output, &["gif"])?;
    if arguments.mips && is_stream(&arguments.output) {
        return error("--mips writes several files, expected a name for them, found `-`");
    }
    let has_extent = arguments.extend.is_some() || arguments.extend_to.is_some();
    if arguments.border.is_some() && !has_extent {
        return error("--border is for --extend or --extend-to");
    }
    if arguments.inputs.iter().filter(|input| is_stream(input)).count() > 1 {
        return error("standard input is one image, found `-` twice");
    }
    let premultiplied = matches!(arguments.matte, Some(MatteWord::Premultiplied));
    let multiplies = matches!(Format::of(&arguments.output), Some(Format::Exr | Format::Pnm));
    if arguments.fill && (premultiplied || multiplies) {
        return error(
            "--fill gives straight light; multiplied by coverage, as --matte premultiplied, .exr \
             and .ppm have it, nothing of it would be left",
        );
    }
    Ok(())
}

/// What to ask for instead of a channel that is not there.
fn hint(missing: Kind, present: &[Kind], to: Option<Format>) -> Option<&'static str> {
    let has = |kind: Kind| present.contains(&kind);
    match missing {
        Kind::Enc | Kind::Lut if to == Some(Format::Gif) => Some("make them with iencode"),
        Kind::Red | Kind::Grn | Kind::Blu if has(Kind::Grg) => {
            Some("grey as a colour is --channels rgb=grg")
        }
        Kind::Grg if has(Kind::Red) => Some("the grey of a colour is --channels grg=luma"),
        Kind::Cvg => Some("a picture that is covered everywhere is --channels with cvg=1"),
        _ => None,
    }
}

/// The channels to read.
fn ask(picks: Option<&[Pick]>, to: Option<Format>) -> Ask {
    let Some(picks) = picks else {
        return match to {
            // Measured values have a place there.
            Some(Format::Idf | Format::Exr) => Ask::All,
            Some(Format::Gif) => Ask::Only(vec![Kind::Enc, Kind::Lut]),
            _ => Ask::Picture,
        };
    };
    let mut kinds = Vec::new();
    for pick in picks {
        match pick.from {
            Source::Kind(kind) => kinds.push(kind),
            Source::Constant(_) => {}
            // Of colour, indices or grey.
            Source::Luminance => return Ask::All,
        }
    }
    Ask::Only(kinds)
}

/// The name of a level: with its number before the ending, from 1 on.
fn level_name(output: &Path, level: usize) -> PathBuf {
    if level == 0 {
        return output.into();
    }
    let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or("idf");
    output.with_extension(format!("{level}.{ending}"))
}

fn options(arguments: &Arguments) -> Options {
    Options {
        channels: arguments.channels.as_ref().map(|picks| picks.0.clone()),
        crop: arguments.crop,
        extend: arguments
            .extend
            .map(Extent::By)
            .or(arguments.extend_to.map(Extent::To))
            .map(|extent| (extent, arguments.border.map_or(Border::Clear, |word| word.0))),
        shift: arguments.shift.unwrap_or_default(),
        tileable: arguments.tileable,
        resize: arguments.resize,
        filter: arguments.filter,
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
        fill: arguments.fill,
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

impl FromStr for Picks {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let mut picks = Vec::new();
        for word in text.split(',') {
            let (to, from) = word.split_once('=').unwrap_or((word, word));
            let Channels(to) = to.parse()?;
            let source = match from.parse::<f64>() {
                Ok(number) => Some(Source::Constant(number)),
                Err(_) => (from == "luma").then_some(Source::Luminance),
            };
            if let Some(source) = source {
                for &kind in &to {
                    check_source(kind, source, word)?;
                    picks.push(Pick { to: kind, from: source });
                }
                continue;
            }
            let Channels(from) = from.parse()?;
            let tables = to.contains(&Kind::Lut) != from.contains(&Kind::Lut);
            if to.len() != from.len() && from.len() != 1 || tables {
                let message = format!("expected NEW=OLD of channels of one shape, found `{word}`");
                return Err(ArgumentError::new(message));
            }
            // rgb=grg: grey light as a colour.
            let from = from.iter().cycle();
            picks.extend(to.iter().zip(from).map(|(&to, &from)| Pick { to, from: from.into() }));
        }
        Ok(Self(picks))
    }
}

/// Refuses a number that a channel cannot hold, and luminance that is no light.
fn check_source(kind: Kind, source: Source, word: &str) -> Result<(), ArgumentError> {
    let (fits, expected) = match (source, kind.role()) {
        (Source::Constant(number), Role::Light | Role::Coverage) => {
            ((0.0..=1.0).contains(&number), "a number from 0 to 1")
        }
        (Source::Constant(number), Role::Index) => {
            let whole = number.fract().abs() <= 0.0;
            (whole && (0.0..=255.0).contains(&number), "a whole number from 0 to 255")
        }
        (Source::Constant(number), Role::Data) => (number.is_finite(), "a number"),
        (Source::Luminance, Role::Light | Role::Coverage) => (true, ""),
        _ => (false, "a channel of the same shape"),
    };
    if fits {
        return Ok(());
    }
    Err(ArgumentError::new(format!("expected {expected} for {kind}, found `{word}`")))
}

impl FromStr for BorderWord {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        Ok(Self(match text {
            "clear" => Border::Clear,
            "edge" => Border::Edge,
            "wrap" => Border::Wrap,
            _ => {
                let Color(color) = text.parse().map_err(|_| {
                    let expected = "clear, edge, wrap, #rrggbb or three numbers from 0 to 1";
                    ArgumentError::new(format!("expected {expected}, found `{text}`"))
                })?;
                Border::Color(color)
            }
        }))
    }
}

fn filter(text: &str) -> Result<Filter, String> {
    let found = FILTERS.iter().find(|row| row.name == text).map(|row| row.filter);
    found.ok_or_else(|| {
        let names: Vec<&str> = FILTERS.iter().map(|row| row.name).collect();
        format!("expected {}", names.join(", "))
    })
}

/// `N` numbers with commas.
fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok()
}

/// A colour; of a word that cannot have been meant as one, what to do about it.
fn flat_color(text: &str) -> Result<Color, String> {
    text.parse::<Color>().map_err(|error| {
        let is_color = text.starts_with('#') || text.contains(',');
        let hint =
            "; the word after --flatten is its colour: say --flatten behind the names of images";
        format!("{error}{}", if is_color { "" } else { hint })
    })
}

fn border_widths(text: &str) -> Result<[u32; 4], String> {
    numbers(text).ok_or_else(|| "expected left, top, right and bottom, each from 0 on, as 8,0,8,0; --extend-to goes inwards, too".into())
}

fn offset(text: &str) -> Result<[i32; 2], String> {
    numbers(text).ok_or_else(|| "expected columns and rows, as 16,-3".into())
}

fn window(text: &str) -> Result<Window, String> {
    let sizes = |number: i64| u32::try_from(number).ok().filter(|&length| length > 0);
    let window = numbers::<i64, 4>(text).and_then(|[column, row, columns, rows]| {
        Some(Window {
            column: column.try_into().ok()?,
            row: row.try_into().ok()?,
            columns: sizes(columns)?,
            rows: sizes(rows)?,
        })
    });
    window.ok_or_else(|| "expected column, row, columns and rows, as -8,0,64,48".into())
}

fn pair(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x').map(|(a, b)| [a.parse::<u32>(), b.parse::<u32>()]);
    match numbers {
        Some([Ok(across), Ok(down)]) if across > 0 && down > 0 => Ok([across, down]),
        _ => Err("expected two whole numbers above 0, as 4x3".into()),
    }
}

fn region(text: &str) -> Result<Region, String> {
    match numbers(text) {
        Some([column, row, columns, rows]) if columns > 0 && rows > 0 => {
            Ok(Region { column, row, columns, rows })
        }
        _ => Err("expected column, row, columns and rows inside the picture, as 0,0,64,48".into()),
    }
}
