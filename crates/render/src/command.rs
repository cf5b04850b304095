//! The command line of `portray`: read or compile, render, write.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use clap::{Parser, ValueEnum};
use compile::SourceMap;
use idf::command::{Channels, Coding, Job, Talk, UsageError, check_output, is_stream, save};
use idf::exchange::Format;
use idf::part::{Part, Share};
use idf::{Image, Kind};
use scene::Scene;

use crate::figures::{Done, Figures};
use crate::identity::Identities;
use crate::part::command::PartArguments;
use crate::part::{PartPicture, render_part, sampled_pixels};
use crate::picture::Form;
use crate::progress::with_progress;
use crate::reading::command::{has_errors, pointed_at};
use crate::sampling::command::SamplingArguments;
use crate::sequence::Frames;
use crate::watch::command::WatchArguments;
use crate::world::omit::command::OmitArguments;
use crate::{
    Accel, Audit, Ending, LoadOptions, Options, Picture, Rate, Sampling, World, audit, measured,
    measured_kinds, render,
};

/// Renders a scene by ray tracing
#[derive(Parser, Clone, Debug)]
#[command(
    name = "portray",
    version,
    after_help = "Example:\n  portray scenes/wine-glass/wine-glass.sdl -o wine-glass.png --samples 16"
)]
pub struct Arguments {
    /// A scene description (.sdl) or a compiled scene (.prc); `-` reads either from standard input
    pub(crate) scene: PathBuf,
    /// The picture, its format by its ending: none or .idf, .png, .exr, .ppm; `-` writes PNG to standard output
    /// [default: an IDF image named after the scene, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Give the number that a `let` names another value; `frame` is the number of the picture in a sequence
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = compile::definition, allow_hyphen_values = true)]
    pub(crate) definitions: Vec<(String, f64)>,
    /// Largest number of solids that repeats and classes with parameters make
    #[arg(long, value_name = "N", default_value_t = compile::Options::default().max_primitives)]
    pub(crate) max_primitives: u64,
    /// Columns and rows of the picture
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: Size,
    #[command(flatten)]
    pub(crate) sampling: SamplingArguments,
    /// Rays of the tree deeper than this return the background
    #[arg(long, value_name = "N", default_value_t = Options::default().depth,
          value_parser = clap::value_parser!(u32).range(0..=i64::from(Options::DEPTH_LIMIT)))]
    depth: u32,
    /// Rays that can add less than this to a channel are left out
    #[arg(long, value_name = "W", default_value_t = Options::default().min_weight)]
    min_weight: f64,
    /// How surfaces are found along a ray; the picture is the same
    #[arg(long, value_enum, default_value_t = AccelWord::Bvh)]
    accel: AccelWord,
    #[command(flatten)]
    pub(crate) omit: OmitArguments,
    /// Channels to write: rgb, cvg, and in IDF and EXR depth, normal, object [default: rgb, and in IDF and EXR cvg if a
    /// pixel is not covered; elsewhere the background is painted in]. Where there is nothing depth is 3.4028235e38,
    /// the largest number of its kind, and the others are 0
    #[arg(long, value_name = "LIST")]
    channels: Option<Channels>,
    /// Spread the rounding to 8 bits in a fine pattern: gradients show no bands
    #[arg(long)]
    pub(crate) dither_output: bool,
    #[command(flatten)]
    pub(crate) part: PartArguments,
    /// Render a sequence: one picture for each number from A to B, both included, which `frame` is in the scene. Each gets
    /// its number at the end of its name, as x-0007.png. Finished pictures are listed in x.frames, and are not rendered again
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<Frames>,
    #[command(flatten)]
    pub(crate) watch: WatchArguments,
    /// Write figures of the render as JSON
    #[arg(long, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) threads: idf::command::Threads,
    #[command(flatten)]
    pub(crate) coding: Coding,
    #[command(flatten)]
    pub(crate) talk: Talk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AccelWord {
    /// Span lists of every object for every ray: the paper's plainest way
    None,
    /// Span lists, with bounding boxes
    Boxes,
    /// The same, with rectangles in the picture, and without a test of boxes that the ray before was in
    Coherence,
    /// Lazy evaluation through hierarchies of boxes
    Bvh,
}

#[derive(Clone, Copy, Debug)]
struct Size {
    columns: u32,
    rows: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side =
            |word: &str| word.parse().ok().filter(|n: &u32| (1..=Options::SIDE_LIMIT).contains(n));
        let (columns, rows) =
            text.split_once('x').ok_or("expected columns and rows as in 640x480")?;
        match (side(columns), side(rows)) {
            (Some(columns), Some(rows)) => Ok(Self { columns, rows }),
            _ => Err(format!("each side is a whole number from 1 to {}", Options::SIDE_LIMIT)),
        }
    }
}

pub use crate::part::command::fitting_side;
pub use crate::reading::command::read_scene;

/// What is to be made of a scene, as the command line says.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The file to write.
    pub output: PathBuf,
    /// The channels that were asked for, if any were.
    pub kinds: Option<Vec<Kind>>,
    /// How to render.
    pub options: Options,
    /// What planes hold.
    pub form: Form,
    /// How to load the scene.
    pub load: LoadOptions,
    /// Which part of the picture, if not all of it.
    pub share: Option<Share>,
}

impl Plan {
    /// Stands for all that the picture is made of; of a part, for the whole picture.
    #[must_use]
    pub fn identity(&self, scene: &Scene, identities: &mut Identities) -> u128 {
        identities.of(scene, &self.options, &self.load, self.form, self.kinds.as_deref())
    }
}

/// Does what the command line says.
///
/// # Errors
///
/// [`UsageError`] for arguments that make no sense together; else what kept the picture from being made.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if arguments.watch.is_wanted() {
        return crate::watch::command::run(arguments);
    }
    arguments.part.check()?;
    if let Some(frames) = arguments.frames {
        return crate::sequence::command::run(arguments, frames);
    }
    let begun = Instant::now();
    let job = Job::start("portray", env!("CARGO_PKG_VERSION"));
    let plan = plan(arguments)?;
    let scene = read_scene(arguments, true)?;
    make(arguments, plan, scene, job, begun)
}

impl Arguments {
    /// The file of the scene.
    #[must_use]
    pub fn scene(&self) -> &Path {
        &self.scene
    }

    /// How much is said.
    #[must_use]
    pub fn talk(&self) -> Talk {
        self.talk
    }

    /// How files of IDF are written.
    #[must_use]
    pub fn coding(&self) -> Coding {
        self.coding
    }
}

/// What the arguments ask for, if it makes sense.
///
/// # Errors
///
/// As [`run`], as far as it can be seen without the scene.
pub fn plan(arguments: &Arguments) -> Result<Plan, Box<dyn Error>> {
    crate::sequence::command::check(arguments)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    let written = if is_stream(&output) { Some(Format::Png) } else { Format::of(&output) };
    let format = arguments.part.format(&output, written)?;
    let kinds = channels(arguments, format)?;
    if arguments.dither_output && format == Some(Format::Exr) {
        let message = "--dither-output: EXR holds floating point, which shows no bands";
        return Err(UsageError(message.into()).into());
    }
    check_outputs(arguments, &output)?;
    let options = options(arguments, format)?;
    let share = arguments.part.share(&options, arguments.sampling.audit)?;
    let plain = format.is_some_and(Format::is_plain);
    let covered = kinds.as_ref().map_or(!plain, |kinds| kinds.contains(&Kind::Cvg));
    let form = Form {
        float: format == Some(Format::Exr),
        opaque: !covered,
        coverage: covered && kinds.is_some(),
        straight: plain,
        dither: arguments.dither_output,
    };
    let load =
        arguments.omit.load_options((options.columns, options.rows), arguments.sampling.glossy);
    Ok(Plan { output, kinds, options, form, load, share })
}

/// Renders a scene, and writes the picture or a part of it.
pub(crate) fn make(
    arguments: &Arguments,
    plan: Plan,
    (scene, sources): (Scene, SourceMap),
    job: Job,
    begun: Instant,
) -> Result<(), Box<dyn Error>> {
    let part = plan.share.map(|share| {
        let canvas = [plan.options.columns, plan.options.rows];
        Part { share, canvas, picture: plan.identity(&scene, &mut Identities::default()) }
    });
    let Plan { output, kinds, mut options, form, .. } = plan;
    let kinds = kinds.as_deref();
    if scene.objects.is_empty() {
        arguments.talk.warn("the scene has no objects; the picture shows the background");
    }
    let world = load(arguments, &output, &options, &scene, sources)?;
    drop(scene);
    let start = Instant::now();
    if let Sampling::Stochastic(Rate::Time(time)) = &mut options.sampling {
        let pixels = options.columns * options.rows;
        *time = time.saturating_sub(begun.elapsed() + pixels * WRITING);
    }
    let (image, figures) = match part {
        Some(part) => part_image(arguments, &world, &options, form, kinds, part, start)?,
        None => image(arguments, &world, &options, form, kinds, start)?,
    };
    let job = figures.iter().fold(job, |job, (name, value)| job.with_figure(name, value));
    if let Some(path) = &arguments.stats {
        let lines: Vec<String> =
            figures.iter().map(|(name, value)| format!("  \"{name}\": {value}")).collect();
        idf::command::write_text(path, &format!("{{\n{}\n}}\n", lines.join(",\n")))?;
    }
    save(&output, image, &arguments.coding.write_options(), &job)?;
    for (name, value) in &figures {
        arguments.talk.note(format_args!("{name} {value}"));
    }
    Ok(())
}

/// The whole picture.
fn image(
    arguments: &Arguments,
    world: &World,
    options: &Options,
    form: Form,
    kinds: Option<&[Kind]>,
    start: Instant,
) -> Result<(Image, Figures), Box<dyn Error>> {
    let total = u64::from(options.columns) * u64::from(options.rows);
    let picture =
        with_progress(total, arguments.talk, |progress| render(world, options, progress))?;
    let seconds = start.elapsed().as_secs_f64();
    warn_of_ending(arguments.talk, &picture);
    let mut image = picture.film.image(form, world.background)?;
    if let Some(kinds) = kinds {
        let planes = image.planes().iter().filter(|plane| kinds.contains(&plane.kind)).cloned();
        let planes = planes.chain(measured(world, options, kinds)?).collect();
        image = image.with_planes(image.columns(), image.rows(), planes)?;
    }
    let Picture { stats, samples, error, cut, certificates, .. } = picture;
    let done = Done { stats, samples, error, cut, certificates, seconds };
    let mut figures = done.figures(options, world);
    if arguments.sampling.audit {
        figures.extend(audited(arguments.talk, world, options, &picture)?);
    }
    Ok((image, figures))
}

/// A part of it.
fn part_image(
    arguments: &Arguments,
    world: &World,
    options: &Options,
    form: Form,
    kinds: Option<&[Kind]>,
    part: Part,
    start: Instant,
) -> Result<(Image, Figures), Box<dyn Error>> {
    let total = sampled_pixels(part.share, options);
    let picture = with_progress(total, arguments.talk, |progress| {
        render_part(world, options, part.share, progress)
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let mut image = picture.image(world, options, form, kinds)?;
    part.mark(&mut image);
    let PartPicture { stats, samples, error, .. } = picture;
    let done = Done { stats, samples, error, cut: picture.cut(), certificates: None, seconds };
    Ok((image, done.figures(options, world)))
}

/// The scene as it is traced, if no output takes the place of a picture that it shows.
fn load(
    arguments: &Arguments,
    output: &Path,
    options: &Options,
    scene: &Scene,
    sources: SourceMap,
) -> Result<World, Box<dyn Error>> {
    // Only statements that show pictures are pointed at from here on; the text can be long.
    let sources = if scene.images.is_empty() { SourceMap::default() } else { sources };
    let outputs = [Some(output), arguments.stats.as_deref()];
    check_shown(scene, &outputs.into_iter().flatten().collect::<Vec<_>>())?;
    let omit = arguments.omit;
    let load = omit.load_options((options.columns, options.rows), arguments.sampling.glossy);
    let world = World::load_with(scene, &load).map_err(|error| -> Box<dyn Error> {
        match pointed_at(&error, &sources) {
            Some(report) => {
                idf::command::print(&report);
                has_errors(&arguments.scene).into()
            }
            None => format!("{}: {error}", arguments.scene.display()).into(),
        }
    })?;
    omit.explain(&world);
    Ok(world)
}

/// Refuses outputs that would take the place of a picture that the scene shows.
///
/// # Errors
///
/// For the first of them.
pub fn check_shown(scene: &Scene, outputs: &[&Path]) -> Result<(), Box<dyn Error>> {
    for image in &scene.images {
        if let Some(path) = outputs.iter().find(|path| is_same(path, &image.path)) {
            return Err(
                format!("{}: this is a picture that the scene shows", path.display()).into()
            );
        }
    }
    Ok(())
}

/// Says why a picture is not as good as it was asked for.
fn warn_of_ending(talk: Talk, picture: &Picture) {
    match (picture.ending, picture.error) {
        (Ending::MostSamples, Some(error)) => talk.warn(format!(
            "the error is {error:.3} display steps still, but no pixel can have more samples"
        )),
        (Ending::OneSample, _) => {
            talk.warn("there was time for one sample a pixel only: nothing is known of the error");
        }
        (Ending::Done | Ending::MostSamples, _) => {}
    }
}

/// Lines of the figures: the error as samples tell that the picture is not made of.
fn audited(
    talk: Talk,
    world: &World,
    options: &Options,
    picture: &Picture,
) -> Result<[(&'static str, String); 2], Box<dyn Error>> {
    let Audit { error, deviation, pixels } = audit(world, options, &picture.film)?;
    if !talk.is_quiet() {
        idf::command::print(&format!(
            "off by {error:.3} ± {deviation:.3} display steps, as {pixels} pixels sampled again tell\n"
        ));
    }
    Ok([
        ("audited_error", format!("{error:.4}")),
        ("audited_error_deviation", format!("{deviation:.4}")),
    ])
}

/// Finds out before the work whether the picture can be written.
fn check_outputs(arguments: &Arguments, output: &Path) -> Result<(), Box<dyn Error>> {
    check_output(output, &[])?;
    if is_stream(output) && arguments.stats.as_deref().is_some_and(is_stream) {
        return Err(UsageError("--output and --stats cannot both be standard output".into()).into());
    }
    let files = [Some(output), arguments.stats.as_deref()].into_iter().flatten();
    for path in files.filter(|path| !is_stream(path)) {
        let folder =
            path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        let found = std::fs::metadata(folder).map_err(|error| {
            format!("cannot write {}: {error}; make the folder first", path.display())
        })?;
        if !found.is_dir() {
            let (path, folder) = (path.display(), folder.display());
            return Err(
                format!("cannot write {path}: expected a folder, found file {folder}").into()
            );
        }
        // A folder of the name is no hindrance to an image `name.idf`; a device is.
        let fits = |m: std::fs::Metadata| m.is_file() || m.is_dir() && is_idf(path);
        if std::fs::metadata(path).is_ok_and(|m| !fits(m)) {
            return Err(format!("{}: expected a file", path.display()).into());
        }
        if is_same(path, &arguments.scene) {
            return Err(format!("{}: this is the scene itself", path.display()).into());
        }
    }
    Ok(())
}

/// One file, by whatever name; an IDF image by its description.
fn is_same(a: impl AsRef<Path>, b: impl AsRef<Path>) -> bool {
    let identity = |path: &Path| std::fs::canonicalize(idf::description_path(path));
    identity(a.as_ref()).is_ok_and(|a| identity(b.as_ref()).is_ok_and(|b| a == b))
}

fn is_idf(path: &Path) -> bool {
    path.extension().is_none()
}

/// The scene's name without its ending, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    scene.file_stem().filter(|_| !is_stream(scene)).map_or_else(|| "scene".into(), PathBuf::from)
}

fn channels(
    arguments: &Arguments,
    format: Option<Format>,
) -> Result<Option<Vec<Kind>>, UsageError> {
    let Some(Channels(kinds)) = &arguments.channels else { return Ok(None) };
    let light = [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg];
    for kind in kinds {
        let is_measured = measured_kinds().contains(kind);
        if !light.contains(kind) && !is_measured {
            return Err(UsageError(format!(
                "--channels: a render has no `{kind}`; expected some of red, grn, blu (or rgb), cvg, depth, normal, object"
            )));
        }
        if is_measured && format.is_some_and(Format::is_plain) {
            return Err(UsageError(format!(
                "--channels: `{kind}` holds measured values; write a name without ending, or with .idf or .exr"
            )));
        }
    }
    Ok(Some(kinds.clone()))
}

pub(crate) fn options(
    arguments: &Arguments,
    format: Option<Format>,
) -> Result<Options, UsageError> {
    let sampling = arguments.sampling.sampling()?;
    let Size { columns, rows } = arguments.size;
    idf::checked_size(columns, rows)
        .map_err(|error| UsageError(format!("--size {columns}x{rows}: {error}")))?;
    if !(arguments.min_weight >= 0.0 && arguments.min_weight <= 1.0) {
        return Err(UsageError(format!(
            "--min-weight {}: expected a number from 0 to 1",
            arguments.min_weight
        )));
    }
    Ok(Options {
        columns,
        rows,
        sampling,
        certify: arguments.sampling.certify,
        filter: arguments.sampling.filter(),
        seed: arguments.sampling.seed(),
        depth: arguments.depth,
        min_weight: arguments.min_weight,
        accel: match arguments.accel {
            AccelWord::None => Accel::None,
            AccelWord::Boxes => Accel::Boxes,
            AccelWord::Coherence => Accel::Coherence,
            AccelWord::Bvh => Accel::Bvh,
        },
        clamp: format != Some(Format::Exr),
        threads: arguments.threads.count().map_or(0, std::num::NonZeroUsize::get),
    })
}

/// What a pixel takes to be written, about.
const WRITING: Duration = Duration::from_nanos(60);
