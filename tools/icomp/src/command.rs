//! Arguments of `icomp`, and the order of reading, working and writing.

use std::borrow::Cow;
use std::error::Error;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::builder::PossibleValuesParser;
use idf::command::{
    Job, Parts, Progress, Storage, Talk, Threads, UsageError, assembled, check_output, is_stream,
    open_layered, open_rows, parts, save, save_layered,
};
use idf::exchange::{self, AnymapWriter, Format, Layers};
use idf::rows::{Reader, Writer};
use idf::{
    Ask, Depth, Image, ImageError, Kind, Matte, Plane, Properties, ReadError, Samples, Window,
};
use rayon::prelude::*;

use crate::{OPERATORS, Operator, Options, Plan, Rule, Source};

/// Composites images by the operators of Porter and Duff
///
/// Work is in linear light. The canvas is the union of the images' windows; an image without
/// coverage covers its window. More than two images are folded from the left: (A over B) over C.
/// Parts of one picture, as portray --part and --window write them, `over` each other are put together: they have
/// to cover it, each pixel once. Images in IDF, PPM, PGM and PAM are read and written in bands of rows, so they may be
/// larger than memory.
#[derive(Parser, Debug)]
#[command(
    name = "icomp",
    version,
    override_usage = "icomp [OPTIONS] OPERATOR A B...\n       icomp [OPTIONS] OPERATOR F A",
    after_help = after_help()
)]
pub struct Arguments {
    /// Operator, from the list below
    #[arg(
        value_name = "OPERATOR",
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(OPERATORS.iter().map(|row| row.name))
    )]
    operator: String,
    /// Images; a factor and an image for darken, dissolve and opaque. `-` is standard input
    #[arg(value_name = "A B", required = true, num_args = 1.., allow_negative_numbers = true)]
    operands: Vec<OsString>,
    /// Image to write [default: A-OPERATOR-B beside A; standard output where an image is standard input]; `-` is standard output, as PNG
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Where the top left of A is on the canvas, instead of its window
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    at: Option<[i32; 2]>,
    /// Combine stored values, as programs without linear light do
    #[arg(long)]
    stored: bool,
    #[command(flatten)]
    storage: Storage,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

/// Pixels in a band: with its layers and result, some megabytes.
const BAND: usize = 1 << 20;

/// Does what `icomp` was asked for.
///
/// # Errors
///
/// If the operands do not fit the operator, or an image cannot be read or written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { storage, talk, .. } = arguments;
    let job = Job::start("icomp", env!("CARGO_PKG_VERSION"));
    let operator = Operator::from_name(&arguments.operator)
        .ok_or_else(|| UsageError(format!("no operator is called `{}`", arguments.operator)))?;
    let (factor, names) = operands(operator, &arguments.operands)?;
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None => usual_output(operator, &names)?,
    };
    check_output(&output, &[])?;
    // Tiles of different pictures are nothing together: what is wrong with them is said.
    let is_whole = |parts| matches!(parts, Parts::OfOne | Parts::OfSeveral { tiles: true });
    if operator.name == "over" && arguments.at.is_none() && is_whole(parts(&names)?) {
        let progress = talk.progress(names.len() as u64 + 1);
        let image = assembled(&names, &storage.read_options(Ask::All), &progress)?;
        return Ok(save(&output, image, &storage.write_options(), &job)?);
    }
    let open = |(position, name): (usize, &PathBuf)| {
        Layer::open(name, arguments.at.filter(|_| position == 0), storage)
    };
    let layers: Vec<Result<Layer, _>> = names.par_iter().enumerate().map(open).collect();
    let mut layers = layers.into_iter().collect::<Result<Vec<_>, _>>()?;
    let sources: Vec<Source<'_>> = layers.iter().map(Layer::source).collect();
    let format = Format::of(&output);
    let matte = match format {
        _ if is_stream(&output) => Some(Matte::Straight),
        Some(Format::Png | Format::Pam) => Some(Matte::Straight),
        Some(Format::Exr) => Some(Matte::Premultiplied),
        _ => None,
    };
    let options = Options { factor, stored: arguments.stored, matte };
    let plan = Plan::new(operator, &sources, &options)
        .map_err(|error| ReadError::Image { path: names[0].clone(), error })?;
    let [columns, rows] = plan.size();
    talk.note(format_args!("write {}: {columns} x {rows}", output.display()));
    let history = layers.iter().flat_map(|layer| layer.rows.properties().history.clone());
    let mut history: Vec<String> = history.collect();
    let others = others(operator, arguments, &mut layers, &names);
    let mut bands = Bands::new(&plan, layers);
    let progress = talk.progress(rows.into());
    progress.stage(format!("writes {}", output.display()));
    if !is_stream(&output) && format == Some(Format::Idf) {
        talk.left_out(&others.words(), "as IDF has no place for it");
        let channels: Vec<(Kind, Depth)> =
            plan.kinds().iter().map(|&kind| (kind, plan.depth())).collect();
        let properties = plan.properties().clone();
        let options = storage.write_options();
        let mut writer = Writer::create(&output, [columns, rows], &channels, properties, &options)?;
        while let Some(band) = bands.next()? {
            writer.write(&band)?;
            progress.advance(band.rows().into());
        }
        history.push(job.entry().to_string());
        return Ok(writer.finish(history)?);
    }
    if !is_stream(&output) && matches!(format, Some(Format::Pnm | Format::Pam)) {
        let mut writer = AnymapWriter::create(&output, [columns, rows])?;
        while let Some(band) = bands.next()? {
            writer.write(&band)?;
            progress.advance(band.rows().into());
        }
        return Ok(writer.finish()?);
    }
    let image = bands.whole(&progress)?;
    Ok(save_layered(&output, image, &others, &storage.write_options(), &job, *talk)?)
}

/// The layers of an image that is alone and stays where it is; those of others have no place in a
/// composite, and are named.
fn others(
    operator: &Operator,
    arguments: &Arguments,
    layers: &mut [Layer],
    names: &[PathBuf],
) -> Layers {
    if let ([layer], Rule::One { .. }, None) = (&mut *layers, operator.rule, arguments.at) {
        return std::mem::take(&mut layer.others);
    }
    for (layer, name) in layers.iter().zip(names) {
        let why = format!("of the composite, of {}", name.display());
        arguments.talk.left_out(&layer.others.words(), &why);
    }
    Layers::default()
}

/// The factor of an operator that has one, and the images.
fn operands(operator: &Operator, operands: &[OsString]) -> Result<(f64, Vec<PathBuf>), UsageError> {
    let name = operator.name;
    let images =
        |operands: &[OsString]| -> Vec<PathBuf> { operands.iter().map(PathBuf::from).collect() };
    let (factor, images) = match operator.rule {
        Rule::Two { .. } if operands.len() < 2 => {
            return Err(UsageError(format!("`{name}` needs two images or more, found one")));
        }
        Rule::Two { .. } => (1.0, images(operands)),
        Rule::One { .. } => {
            let [factor, image] = operands else {
                let found = operands.len();
                let message =
                    format!("`{name}` needs a factor and one image, found {found} operands");
                return Err(UsageError(message));
            };
            let number = factor.to_str().and_then(|text| text.parse::<f64>().ok());
            let factor = number.filter(|f| (0.0..f64::INFINITY).contains(f)).ok_or_else(|| {
                let found = factor.to_string_lossy();
                UsageError(format!("`{name}` needs a factor from 0 on, found `{found}`"))
            })?;
            (factor, images(std::slice::from_ref(image)))
        }
    };
    if images.iter().filter(|name| is_stream(name)).count() > 1 {
        return Err(UsageError("standard input can be one of the images, found it twice".into()));
    }
    Ok((factor, images))
}

/// `a-over-b` for `over a b`, beside the first; `a-darken` for an operator of one; standard output
/// where one of them is standard input.
fn usual_output(operator: &Operator, names: &[PathBuf]) -> Result<PathBuf, UsageError> {
    if let Some(stream) = names.iter().find(|name| is_stream(name)) {
        return Ok(stream.clone());
    }
    let mut output = OsString::new();
    for (position, name) in names.iter().enumerate() {
        let error = || UsageError(format!("`{}` has no name; say -o OUT", name.display()));
        let stem = name.file_stem().ok_or_else(error)?;
        if position > 0 || names.len() == 1 {
            let words = if names.len() == 1 {
                [stem, "-".as_ref(), operator.name.as_ref()]
            } else {
                ["-".as_ref(), operator.name.as_ref(), "-".as_ref()]
            };
            words.into_iter().for_each(|word| output.push(word));
        }
        if names.len() > 1 {
            output.push(stem);
        }
    }
    Ok(names[0].with_file_name(output))
}

/// One image, and where it lies.
struct Layer {
    rows: Rows,
    window: Window,
    /// One row of it, without indices.
    sample: Image,
    /// What an `.exr` holds besides.
    others: Layers,
}

/// Where the rows of an image are.
enum Rows {
    /// In files that give some of them.
    Banded(Box<Reader>),
    /// In memory, with colours in place of indices.
    Whole(Box<Image>),
}

impl Layer {
    fn open(
        name: &Path,
        at: Option<[i32; 2]>,
        storage: &Storage,
    ) -> Result<Self, Box<dyn Error + Send + Sync>> {
        let options = storage.read_options(Ask::Picture);
        let error = |error| ReadError::Image { path: name.into(), error };
        let reader = match Format::of(name) {
            _ if is_stream(name) => None,
            Some(Format::Idf) => Some(open_rows(name, &options)?),
            _ => exchange::open_rows(name)?,
        };
        let mut others = Layers::default();
        let (rows, mut window, sample) = if let Some(mut reader) = reader {
            let (window, sample) = (reader.window(), reader.band(0..1)?);
            (Rows::Banded(Box::new(reader)), window, sample.resolved().map_err(error)?)
        } else {
            let (image, besides) = open_layered(name, &options)?;
            others = besides;
            let sample = first_row(&image).map_err(error)?;
            let window = image.window();
            (Rows::Whole(Box::new(image)), window, sample)
        };
        if let Some([column, row]) = at {
            window = Window { column, row, ..window };
        }
        sample.light_kinds().map_err(error)?;
        Ok(Self { rows, window, sample, others })
    }

    fn source(&self) -> Source<'_> {
        Source { sample: &self.sample, window: self.window }
    }
}

impl Rows {
    fn properties(&self) -> &Properties {
        match self {
            Self::Banded(reader) => reader.properties(),
            Self::Whole(image) => &image.properties,
        }
    }

    fn into_banded(self) -> Self {
        match self {
            Self::Whole(image) => Self::Banded(Box::new(Reader::from(*image))),
            banded @ Self::Banded(_) => banded,
        }
    }

    /// Some of them, or all where they are in memory.
    fn band(&mut self, rows: Range<u32>) -> Result<Cow<'_, Image>, Box<dyn Error + Send + Sync>> {
        Ok(match self {
            Self::Banded(reader) => Cow::Owned(reader.band(rows)?.resolved()?),
            Self::Whole(image) => Cow::Borrowed(image),
        })
    }
}

/// The first row of an image without indices.
fn first_row(image: &Image) -> Result<Image, ImageError> {
    let first = |plane: &Plane| Plane {
        kind: plane.kind,
        samples: plane.samples.gathered(0..image.columns() as usize),
    };
    image.with_planes(image.columns(), 1, image.planes().iter().map(first).collect())
}

/// The result, band by band.
struct Bands<'a> {
    plan: &'a Plan,
    layers: Vec<Layer>,
    row: u32,
    /// Rows of a band.
    height: u32,
}

impl<'a> Bands<'a> {
    /// One band where all layers are in memory, else such that memory does not grow with the rows.
    fn new(plan: &'a Plan, mut layers: Vec<Layer>) -> Self {
        let [columns, rows] = plan.size();
        let is_whole = |layer: &Layer| matches!(layer.rows, Rows::Whole(_));
        let height = if layers.iter().all(is_whole) {
            rows
        } else {
            let banded = |layer: Layer| Layer { rows: layer.rows.into_banded(), ..layer };
            layers = layers.into_iter().map(banded).collect();
            u32::try_from(BAND / columns as usize).unwrap_or(rows).max(1)
        };
        Self { plan, layers, row: 0, height }
    }

    fn next(&mut self) -> Result<Option<Image>, Box<dyn Error + Send + Sync>> {
        let [_, rows] = self.plan.size();
        if self.row == rows {
            return Ok(None);
        }
        let range = self.row..rows.min(self.row.saturating_add(self.height));
        self.row = range.end;
        let mut images = Vec::new();
        for (position, layer) in self.layers.iter_mut().enumerate() {
            let own = self.plan.rows_of(position, range.clone());
            images.push(if own.is_empty() { None } else { Some(layer.rows.band(own)?) });
        }
        let images: Vec<Option<&Image>> = images.iter().map(Option::as_deref).collect();
        Ok(Some(self.plan.band(&images, range)?))
    }

    /// All bands as one image.
    fn whole(&mut self, progress: &Progress) -> Result<Image, Box<dyn Error + Send + Sync>> {
        let [columns, rows] = self.plan.size();
        if self.height == rows
            && let Some(image) = self.next()?
        {
            return Ok(image);
        }
        let mut planes: Vec<Option<Samples>> = vec![None; self.plan.kinds().len()];
        while let Some(band) = self.next()? {
            progress.advance(band.rows().into());
            for (plane, part) in planes.iter_mut().zip(band.planes()) {
                match (plane, &part.samples) {
                    (Some(Samples::U8(all)), Samples::U8(part)) => all.extend(part),
                    (Some(Samples::U16(all)), Samples::U16(part)) => all.extend(part),
                    (Some(Samples::F32(all)), Samples::F32(part)) => all.extend(part),
                    (plane, part) => *plane = Some(part.clone()),
                }
            }
        }
        let planes = self
            .plan
            .kinds()
            .iter()
            .zip(planes)
            .filter_map(|(&kind, samples)| samples.map(|samples| Plane { kind, samples }));
        let image: Result<Image, ImageError> = Image::new(columns, rows, planes.collect());
        let mut image = image?;
        image.properties = self.plan.properties().clone();
        Ok(image)
    }
}

fn place(text: &str) -> Result<[i32; 2], String> {
    let numbers = text.split_once(',').map(|(x, y)| [x.parse::<i32>(), y.parse::<i32>()]);
    match numbers {
        Some([Ok(column), Ok(row)]) => Ok([column, row]),
        _ => Err("expected column and row, as 40,-8".into()),
    }
}

fn after_help() -> String {
    let row = |operator: &Operator| format!("  {:9} {}\n", operator.name, operator.about);
    let table: String = OPERATORS.iter().map(row).collect();
    format!(
        "Operators:\n{table}\nExamples:\n  icomp over FRONT.png BEHIND.png -o BOTH.png\n  \
         icomp over LABEL.png PICTURE.idf --at 120,40 -o LABELLED.idf"
    )
}
