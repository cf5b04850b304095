//! Arguments of `icopy`, and the order of reading, working and writing.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Parser, ValueEnum};
use idf::command::{
    ArgumentError, Color, Job, Parts, Progress, Storage, Talk, Threads, UsageError, assembled,
    check_output, is_stream, open, open_layer, open_rows, parts, save, summary,
};
use idf::exchange::{Format, Layers, write_layered};
use idf::part::{Part, settle};
use idf::{Ask, Depth, Image, Kind, Matte, ReadError, ReadOptions, Window};

use crate::resize::FILTERS;
use crate::stream::Bands;
use crate::words::Words;
use crate::{
    Axis, Behind, Border, Extent, Filter, Options, Pick, Region, Source, Turn, copied, joined,
    levels,
};

/// Copies an image from any format to any other
///
/// Formats follow the endings of the names: none or .idf, .png, .exr, .ppm, .pam, .gif; only read:
/// .jpg, .tif, .webp. `-` is standard input or, as PNG, standard output. Several images are put
/// together in their windows first; where they overlap, the last is seen. Parts of a picture, as portray
/// --part and --window write them, have to cover it, each pixel once. What is done on the way is
/// done in the order of the options below.
#[derive(Parser, Debug)]
#[command(
    name = "icopy",
    version,
    override_usage = "icopy [OPTIONS] IN... OUT",
    after_help = "Example:\n  icopy wine.idf label.png --crop 120,40,64,64 --flatten '#ffffff'"
)]
pub struct Arguments {
    /// Images to read, several of which are put together, and last the image to write
    #[arg(value_name = "IN OUT", required = true, num_args = 1..)]
    names: Vec<PathBuf>,
    /// Channels to keep, as rgb,cvg; NEW=OLD renames, NEW=NUMBER fills, grg=luma is the luminance; of
    /// an .exr also layers by name, as diffuse or rgb=diffuse
    #[arg(long, value_name = "LIST")]
    channels: Option<Words>,
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
    /// Paint a colour in where coverage is below 1: #rrggbb, #rgb or R,G,B [default: the image's]
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

impl Arguments {
    /// Images to read, and the one to write: options may stand between them, which a list with a
    /// name of its own behind it does not allow.
    fn names(&self) -> Result<(&[PathBuf], &PathBuf), UsageError> {
        match self.names.split_last() {
            Some((output, inputs)) if !inputs.is_empty() => Ok((inputs, output)),
            _ => Err(UsageError("expected an image to read and one to write, found one".into())),
        }
    }
}

type Failure = Box<dyn Error + Send + Sync>;

fn work(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { storage, talk, .. } = arguments;
    let (inputs, output) = arguments.names()?;
    check(arguments, inputs, output)?;
    let job = Job::start("icopy", env!("CARGO_PKG_VERSION"));
    let mut options = options(arguments);
    let is_own = |name: &PathBuf| Format::of(name) == Some(Format::Idf) && !is_stream(name);
    let ask = match options.channels.as_deref() {
        Some(_) if options.hides_coverage() => Ask::All,
        picks => ask(picks, Format::of(output)),
    };
    if let [input] = inputs
        && is_own(input)
        && is_own(output)
        && options.is_by_rows()
        && !arguments.mips
        // Of a part it has to be seen whether the copy is one still.
        && Part::at(input)?.is_none()
    {
        let reader = open_rows(input, &storage.read_options(ask));
        let reader = reader.map_err(|error| hinted(error, output))?;
        let [columns, rows] = reader.size();
        talk.note(format_args!("read {}: {columns} x {rows}", input.display()));
        talk.note(format_args!("write {}", output.display()));
        let progress = talk.progress(options.crop.map_or(rows, |part| part.rows).into());
        let bands = Bands::new(reader, &options)?;
        return bands.write(output, &storage.write_options(), &job, &progress);
    }
    // Of each image, and of the copy.
    let progress = talk.progress(inputs.len() as u64 + 2);
    match parts(inputs)? {
        Parts::OfOne | Parts::OfSeveral { .. } => {
            let image = assembled(inputs, &storage.read_options(Ask::All), &progress)?;
            progress.stage("copies");
            return put(
                &image,
                Layers::default(),
                &options,
                (arguments, output),
                (&job, &progress),
            );
        }
        Parts::Mixed => {
            return Err("tiles of a picture are put together with all its other parts, found \
                        images among them that are no parts"
                .into());
        }
        Parts::Windows => {}
    }
    let mut images = Vec::new();
    let mut layers = Layers::default();
    for input in inputs {
        progress.stage(format!("reads {}", input.display()));
        let read = storage.read_options(ask.clone());
        let image = if Format::of(input) == Some(Format::Exr) || is_stream(input) {
            let (image, others) = layered(input, (arguments, output), &mut options, &read)?;
            if inputs.len() == 1 {
                layers = others;
            } else {
                talk.left_out(&others.words(), "in several images put together");
            }
            image
        } else {
            open(input, &read).map_err(|error| hinted(error, output))?
        };
        talk.note(format_args!("read {}: {}", input.display(), summary(&image)));
        images.push(image);
        progress.advance(1);
    }
    let to = Format::of(output);
    if to == Some(Format::Idf) && !inputs.iter().all(is_own) && !options.fill {
        options.matte = options.matte.or(Some(Matte::Premultiplied));
    }
    let image = match <[Image; 1]>::try_from(images) {
        Ok([image]) => image,
        Err(images) => joined(&images)?,
    };
    progress.stage("copies");
    put(&image, layers, &options, (arguments, output), (&job, &progress))
}

/// Copies an image that is in memory, and writes it.
fn put(
    image: &Image,
    mut layers: Layers,
    options: &Options,
    (arguments, output): (&Arguments, &Path),
    (job, progress): (&Job, &Progress),
) -> Result<(), Failure> {
    let Arguments { storage, talk, .. } = arguments;
    let to = Format::of(output).filter(|_| !is_stream(output));
    if to == Some(Format::Exr) && !arguments.mips {
        let elsewhere = match options.for_data() {
            Some(data) => layers.change(image, options.mixes(), |layer| copied(layer, &data))?,
            None => Vec::new(),
        };
        talk.left_out(&elsewhere, "as it lies elsewhere or cannot be mixed");
    } else if matches!(to, Some(Format::Idf | Format::Exr)) && arguments.channels.is_none() {
        let why = if arguments.mips { "of levels of detail" } else { "as IDF has no place for it" };
        talk.left_out(&layers.words(), why);
        layers = Layers::default();
    }
    let copies =
        if arguments.mips { levels(image, options)? } else { vec![copied(image, options)?] };
    progress.advance(1);
    for (level, mut copy) in copies.into_iter().enumerate() {
        settle(&mut copy);
        let name = level_name(output, level);
        progress.stage(format!("writes {}", name.display()));
        if to == Some(Format::Pnm) && copy.plane(Kind::Cvg).is_some() && level == 0 {
            talk.warn("this format is opaque; the background is painted in");
        }
        talk.note(format_args!("write {}: {}", name.display(), summary(&copy)));
        if to == Some(Format::Exr) {
            write_layered(&name, &copy, &layers)?;
        } else {
            save(&name, copy, &storage.write_options(), job)?;
        }
    }
    Ok(())
}

/// Reads an `OpenEXR` file, or what may be one: its picture, or the layer that `--channels` names, whose channels go into
/// `options`, and what else is to be copied.
fn layered(
    input: &Path,
    (arguments, output): (&Arguments, &Path),
    options: &mut Options,
    read: &ReadOptions,
) -> Result<(Image, Layers), Failure> {
    let Some(words) = &arguments.channels else {
        return open_layer(input, None, read).map_err(|error| hinted(error, output));
    };
    let picture = words.picture()?;
    let ask = if picture.is_some() { Ask::All } else { read.ask.clone() };
    let read = ReadOptions { ask, ..read.clone() };
    let (image, mut layers) =
        open_layer(input, picture, &read).map_err(|error| hinted(error, output))?;
    let kept = words.kept();
    if let Some(none) = kept.iter().find(|word| !layers.has(word)) {
        return Err(format!("{}: no layer or channel is called `{none}`", input.display()).into());
    }
    layers.retain(&kept);
    if picture.is_none() || !words.keep_names() {
        layers.forget_names();
    }
    if picture.is_some() {
        options.channels = Some(words.picks_of(&image)?);
    }
    Ok((image, layers))
}

/// An error of reading, with what to ask for instead of a channel that is not there.
fn hinted(error: ReadError, output: &Path) -> Failure {
    let hint = match &error {
        ReadError::Missing { kind, present, .. } => hint(*kind, present, Format::of(output)),
        _ => None,
    };
    match hint {
        Some(hint) => format!("{error}; {hint}").into(),
        None => error.into(),
    }
}

/// What the parser cannot see.
fn check(arguments: &Arguments, inputs: &[PathBuf], output: &Path) -> Result<(), UsageError> {
    let error = |message: &str| Err(UsageError(message.into()));
    check_output(output, &["gif"])?;
    if arguments.mips && is_stream(output) {
        return error("--mips writes several files, expected a name for them, found `-`");
    }
    let layer = arguments.channels.as_ref().and_then(Words::layer);
    let has_layers = |input: &PathBuf| is_stream(input) || Format::of(input) == Some(Format::Exr);
    if let Some(name) = layer.filter(|_| inputs.len() != 1) {
        return error(&format!("layers, as `{name}`, are copied of one image, found several"));
    }
    if let Some(name) = layer.filter(|_| !inputs.iter().all(has_layers)) {
        return error(&format!(
            "no channel is called `{name}`, and no image but an .exr has layers"
        ));
    }
    if let Some(words) = arguments.channels.as_ref() {
        words.picture().map_err(|error| UsageError(error.to_string()))?;
        let kept = words.kept();
        if let Some(name) = kept.first().filter(|_| Format::of(output) != Some(Format::Exr)) {
            return error(&format!("only an .exr keeps several layers, found `{name}`, too"));
        }
    }
    let has_extent = arguments.extend.is_some() || arguments.extend_to.is_some();
    if arguments.border.is_some() && !has_extent {
        return error("--border is for --extend or --extend-to");
    }
    if inputs.iter().filter(|input| is_stream(input)).count() > 1 {
        return error("standard input is one image, found `-` twice");
    }
    let premultiplied = matches!(arguments.matte, Some(MatteWord::Premultiplied));
    let multiplies = matches!(Format::of(output), Some(Format::Exr | Format::Pnm));
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
        channels: arguments.channels.as_ref().map(Words::picks),
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

impl FromStr for BorderWord {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        Ok(Self(match text {
            "clear" => Border::Clear,
            "edge" => Border::Edge,
            "wrap" => Border::Wrap,
            _ => {
                let Color(color) = text.parse().map_err(|_| {
                    let colors = Color::EXPECTED;
                    ArgumentError::new(format!(
                        "expected clear, edge, wrap, {colors}, found `{text}`"
                    ))
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
