//! Arguments of `iencode`, and the order of reading, working and writing.

use std::error::Error;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::builder::PossibleValuesParser;
use clap::builder::TypedValueParser as _;
use idf::command::{
    Color, Job, Storage, Talk, Threads, UsageError, check_output, is_stream, open, print, save,
    write_text,
};
use idf::exchange::{Format, write_frames};
use idf::plane::Role;
use idf::{
    Ask, Depth, Form, Image, ImageError, Kind, Lut, Matte, Plane, ReadError, Samples, Transfer,
    description_path, read_description,
};
use ilut::command::TableArguments;
use ilut::{Pixels, Table, TableError, quality, rms_rgb};

use crate::dither::{self, Dither};
use crate::{Options, encoded, sixel};

type Failure = Box<dyn Error + Send + Sync>;

/// Encodes images in the colours of a table
///
/// Without a table (--lut, or the one that a single IDF image has) one is made, one for all images.
/// An IDF image gets the channel `enc`, and `lut` where the table is new; `photo.png` becomes the
/// IDF image `photo`. With -o there is one new file instead: IDF, indexed .png or .gif, .six or
/// .sixel for terminals; several images make an animated .gif. `-` is standard input or, as PNG,
/// standard output.
///
/// Where coverage is below 1 it is kept as alpha in the table, unless --matte is given; .gif and
/// sixel keep a half or more as whole and less as none.
#[derive(Parser, Debug)]
#[command(
    name = "iencode",
    version,
    after_help = "Example:\n  iencode photo.png --metric oklab --dither floyd-steinberg -o small.png"
)]
pub struct Arguments {
    /// Images to encode
    #[arg(value_name = "IMAGE", required = true)]
    images: Vec<PathBuf>,
    /// Take this table as it is: a .lut, an image with a table, or one of at most 256 colours
    #[arg(long, value_name = "IMAGE|LUT", conflicts_with_all = ["colors", "method", "keep"])]
    lut: Option<PathBuf>,
    #[command(flatten)]
    table: TableArguments,
    /// How errors of neighbours cancel
    #[arg(long, value_name = "DITHER", default_value = dither::NONE.name, value_parser = dither_row())]
    dither: &'static Dither,
    /// Share of the error to make up for, 0 to 1 [default: 1 up to 31 colours, less with more; at 256, 0.75 for floyd-steinberg, 0.5 for blue-noise]
    #[arg(long, value_name = "SHARE", value_parser = strength, allow_hyphen_values = true)]
    strength: Option<f32>,
    /// Put a colour behind: #rrggbb, #rgb or R,G,B
    #[arg(long, value_name = "COLOUR")]
    matte: Option<Color>,
    /// File to write
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Write sixel, to standard output unless -o is given
    #[arg(long)]
    sixel: bool,
    /// Time of each picture of an animation, in hundredths of a second [default: 10]
    #[arg(long, value_name = "HUNDREDTHS", value_parser = small_number, allow_hyphen_values = true)]
    delay: Option<u16>,
    /// How often an animation is shown; 0 is for ever [default: 0]
    #[arg(long, value_name = "TIMES", value_parser = small_number, allow_hyphen_values = true)]
    loops: Option<u16>,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

/// Where the result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Target {
    /// Into an IDF image that is there.
    Added(PathBuf),
    /// To a file of its own.
    Saved(PathBuf),
    /// As text for a terminal.
    Sixel(PathBuf),
    /// To one file with the other pictures.
    Frame(PathBuf),
}

/// An image on its way.
struct Picture {
    name: PathBuf,
    image: Image,
    pixels: Pixels,
    target: Target,
}

/// Does what `iencode` was asked for.
///
/// # Errors
///
/// If an image or a table cannot be read, or a result not be written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { images, storage, talk, .. } = arguments;
    let job = Job::start("iencode", env!("CARGO_PKG_VERSION"));
    let targets = targets(arguments)?;
    let table = table(arguments)?;
    let is_own = table.is_some() && arguments.lut.is_none();
    if !is_own {
        for (name, target) in images.iter().zip(&targets) {
            check_light(name, target)?;
        }
    }
    // Each picture is read and written; all of them are encoded at once.
    let progress = talk.progress(2 * images.len() as u64 + 1);
    let mut pictures = Vec::new();
    for (name, target) in images.iter().zip(targets) {
        progress.stage(format!("reads {}", name.display()));
        let image = open(name, &storage.read_options(Ask::Picture))?;
        let (pixels, partly) = pixels(&image, arguments.matte, &target)
            .map_err(|error| format!("{}: {error}", name.display()))?;
        if partly > 0 {
            talk.warn(format_args!(
                "{}: pixels covered in part, {partly} of them, become covered or not; --matte puts \
                 a colour behind",
                name.display()
            ));
        }
        talk.note(format_args!("read {}: {} x {}", name.display(), image.columns(), image.rows()));
        pictures.push(Picture { name: name.clone(), image, pixels, target });
        progress.advance(1);
    }
    let all: Vec<&Pixels> = pictures.iter().map(|picture| &picture.pixels).collect();
    progress.stage("encodes");
    let result = encoded(&all, table, &options(arguments)).map_err(|error| match error {
        TableError::Keep { .. } => Failure::from(UsageError(error.to_string())),
        error => error.into(),
    })?;
    progress.advance(1);
    let table = &result.table;
    let mut frames = Vec::new();
    for (picture, indices) in pictures.into_iter().zip(result.indices) {
        progress.stage(format!("writes {}", picture.name.display()));
        let colors = table.colors().len();
        let rms = if talk.is_quiet() {
            rms_rgb(&picture.pixels, table, &indices)
        } else {
            let figures = quality(&picture.pixels, table, &indices);
            print(&format!("{}: {}\n", picture.name.display(), figures.words(colors)));
            figures.rms_rgb
        };
        let job = job.clone().with_figure("colors", colors).with_figure("rms", rms);
        frames.extend(put(picture, indices, (table, is_own), arguments, &job)?);
        progress.advance(1);
    }
    match &arguments.output {
        Some(path) if !frames.is_empty() => {
            let (delay, loops) = (arguments.delay.unwrap_or(10), arguments.loops.unwrap_or(0));
            Ok(write_frames(path, &frames, delay, loops)?)
        }
        _ => Ok(()),
    }
}

/// Writes a picture, or gives it back as a frame of an animation. `is_own` says whether the table
/// is that of the image.
fn put(
    picture: Picture,
    indices: Vec<u8>,
    (table, is_own): (&Table, bool),
    arguments: &Arguments,
    job: &Job,
) -> Result<Option<Image>, Failure> {
    let Arguments { storage, matte, .. } = arguments;
    let Picture { image, target, .. } = picture;
    let write_options = storage.write_options();
    match target {
        Target::Added(path) => {
            let mut added = added(&image, indices, Some(table).filter(|_| !is_own))?;
            added.properties.history = vec![job.entry().to_string()];
            idf::add(&path, &added, &write_options)?;
        }
        Target::Saved(path) => {
            save(&path, indexed(&image, indices, table, *matte)?, &write_options, job)?;
        }
        Target::Sixel(path) => {
            let columns = image.columns() as usize;
            write_text(&path, &sixel::encode(columns, &indices, table.colors()))?;
        }
        Target::Frame(_) => return Ok(Some(indexed(&image, indices, table, *matte)?)),
    }
    Ok(None)
}

fn options(arguments: &Arguments) -> Options {
    Options {
        table: arguments.table.options(),
        dither: arguments.dither,
        strength: arguments.strength,
    }
}

/// Where each image goes.
fn targets(arguments: &Arguments) -> Result<Vec<Target>, UsageError> {
    let Arguments { images, output, sixel, .. } = arguments;
    let usage = |message: &str| Err(UsageError(message.into()));
    let animated = images.len() > 1 && output.is_some();
    if arguments.strength.is_some() && arguments.dither.name == dither::NONE.name {
        return usage("--strength belongs to a --dither");
    }
    if !animated && (arguments.delay.is_some() || arguments.loops.is_some()) {
        return usage("--delay and --loops belong to several images with -o OUT.gif");
    }
    if let Some(path) = output {
        check_output(path, &["gif", "six", "sixel"])?;
    }
    let sixel = *sixel || output.as_ref().is_some_and(|path| is_sixel(path));
    let one = |path: PathBuf| if sixel { Target::Sixel(path) } else { Target::Saved(path) };
    match output {
        None if sixel => Ok(images.iter().map(|_| Target::Sixel("-".into())).collect()),
        Some(path) if sixel && is_stream(path) => {
            Ok(images.iter().map(|_| Target::Sixel(path.clone())).collect())
        }
        Some(path) if !animated => Ok(vec![one(path.clone())]),
        Some(path) if !sixel && Format::of(path) == Some(Format::Gif) => {
            Ok(images.iter().map(|_| Target::Frame(path.clone())).collect())
        }
        Some(_) => usage("several images make one file only as an animation, -o OUT.gif"),
        None => {
            let targets: Vec<Target> = images.iter().map(|name| beside(name)).collect();
            let is_twice = |(at, target): (usize, &Target)| targets[..at].contains(target);
            if targets.iter().enumerate().any(is_twice) {
                return usage("two of the images would become one");
            }
            Ok(targets)
        }
    }
}

/// An image that is nothing but indices into its table must keep both.
fn check_light(name: &Path, target: &Target) -> Result<(), Failure> {
    let is_itself = Format::of(name) == Some(Format::Idf);
    if !is_itself || !matches!(target, Target::Added(_)) {
        return Ok(());
    }
    let channels = read_description(name)?.channels;
    if channels.iter().any(|channel| channel.kind.role() == Role::Light) {
        return Ok(());
    }
    let name = name.display();
    let message = "its colours are in its table alone, which stays; give a name with -o";
    Err(format!("{name}: {message}").into())
}

/// Where an image goes without -o: into itself, or beside it under its name without ending.
fn beside(name: &Path) -> Target {
    if is_stream(name) {
        return Target::Saved(name.into());
    }
    let path = if Format::of(name) == Some(Format::Idf) { name } else { &name.with_extension("") };
    if description_path(path).exists() {
        Target::Added(description_path(path))
    } else {
        Target::Saved(path.into())
    }
}

fn is_sixel(path: &Path) -> bool {
    let is = |ending: &OsStr| ["six", "sixel"].iter().any(|six| ending.eq_ignore_ascii_case(six));
    path.extension().is_some_and(is)
}

/// The table from outside: that of --lut, or the one that a single IDF image has, unless another
/// is asked for.
fn table(arguments: &Arguments) -> Result<Option<Table>, Failure> {
    let read_options = |ask| arguments.storage.read_options(ask);
    if let Some(path) = &arguments.lut {
        if path.extension().is_some_and(|ending| ending == "lut") {
            return Ok(Some(Table::from(&Lut::read(path)?)));
        }
        return match open(path, &read_options(Ask::Only(vec![Kind::Lut]))) {
            Ok(image) => own_table(&image),
            Err(ReadError::Missing { .. }) => {
                let image = open(path, &read_options(Ask::Picture))?;
                Ok(Some(distinct(path, &Pixels::of(&image, None)?)?))
            }
            Err(error) => Err(error.into()),
        };
    }
    let [name] = &arguments.images[..] else { return Ok(None) };
    if arguments.table.is_given() || is_stream(name) || Format::of(name) != Some(Format::Idf) {
        return Ok(None);
    }
    let description = read_description(name)?;
    if description.channels.iter().all(|channel| channel.kind != Kind::Lut) {
        return Ok(None);
    }
    own_table(&open(name, &read_options(Ask::Only(vec![Kind::Lut])))?)
}

/// The table of an image, in display values.
fn own_table(image: &Image) -> Result<Option<Table>, Failure> {
    let image = restored(image.clone(), Transfer::Srgb)?;
    Ok(image.lut.as_ref().map(Table::from))
}

/// The colours of a picture that serves as a table, in the order in which they come.
fn distinct(path: &Path, pixels: &Pixels) -> Result<Table, TooMany> {
    let mut colors: Vec<[u8; 4]> = Vec::new();
    for color in pixels.colors() {
        if !colors.contains(color) {
            colors.push(*color);
        }
        if colors.len() > Lut::MOST {
            return Err(TooMany { path: path.into() });
        }
    }
    Table::new(colors).ok_or_else(|| TooMany { path: path.into() })
}

/// What is seen of an image, its coverage as the target can hold it, and of how many pixels it
/// cannot.
fn pixels(
    image: &Image,
    matte: Option<Color>,
    target: &Target,
) -> Result<(Pixels, usize), ImageError> {
    let pixels = Pixels::of(image, matte.map(|Color(color)| color))?;
    let whole = match target {
        Target::Sixel(_) | Target::Frame(_) => true,
        Target::Saved(path) => Format::of(path) == Some(Format::Gif),
        Target::Added(_) => false,
    };
    if !whole || pixels.is_opaque() {
        return Ok((pixels, 0));
    }
    let partly = pixels.colors().iter().filter(|color| (1..u8::MAX).contains(&color[3])).count();
    let whole = |&[r, g, b, alpha]: &[u8; 4]| if alpha < 128 { [0; 4] } else { [r, g, b, 255] };
    let colors = pixels.colors().iter().map(whole).collect();
    Ok((Pixels::new(pixels.columns(), pixels.rows(), colors)?, partly))
}

/// Indices and table alone, with what the image says besides its samples.
fn indexed(
    image: &Image,
    indices: Vec<u8>,
    table: &Table,
    matte: Option<Color>,
) -> Result<Image, ImageError> {
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(indices) };
    let mut indexed = image.with_planes(image.columns(), image.rows(), vec![plane])?;
    indexed.lut = Some(Lut::from(table));
    indexed.properties.transfer = None;
    indexed.properties.matte = Matte::default();
    if matte.is_some() {
        indexed.properties.background = None;
    }
    Ok(indexed)
}

/// The channels that an image gets: indices, and the table where it is new, stored as the image
/// stores light.
fn added(image: &Image, indices: Vec<u8>, table: Option<&Table>) -> Result<Image, ImageError> {
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(indices) };
    let mut added = Image::new(image.columns(), image.rows(), vec![plane])?;
    added.lut = table.map(Lut::from);
    restored(added, image.transfer(Depth::U8))
}

/// The image with its table stored by another transfer.
fn restored(image: Image, transfer: Transfer) -> Result<Image, ImageError> {
    let matte = image.properties.matte;
    image.converted(Form { depth: Depth::U8, transfer, matte })
}

fn dither_row() -> impl clap::builder::TypedValueParser<Value = &'static Dither> {
    let names = dither::TABLE.iter().map(|dither| dither.name);
    PossibleValuesParser::new(names)
        .map(|name| Dither::by_name(&name).expect("only names of the table are possible"))
}

fn strength(text: &str) -> Result<f32, String> {
    let strength = text.parse().ok().filter(|strength| (0.0..=1.0).contains(strength));
    strength.ok_or_else(|| {
        "expected a number from 0 to 1: 0 takes the nearest colours, 1 makes up for all of the error"
            .into()
    })
}

fn small_number(text: &str) -> Result<u16, String> {
    text.parse().map_err(|_| format!("expected a whole number from 0 to {}, as 10", u16::MAX))
}

/// A picture that serves as a table has more colours than one may have.
#[derive(Debug)]
struct TooMany {
    path: PathBuf,
}

impl fmt::Display for TooMany {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: expected a table or at most {} colours; ilut makes a table of a picture",
            self.path.display(),
            Lut::MOST
        )
    }
}

impl Error for TooMany {}
