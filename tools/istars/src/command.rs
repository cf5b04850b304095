//! Arguments of `istars`, and the order of counting, drawing and writing.

use std::error::Error;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Parser;
use idf::command::{Coding, Job, Talk, Threads, UsageError, save, summary};
use idf::plane::COLOR;
use idf::{Depth, Image, Plane, Properties, Samples, Transfer, checked_size};

use crate::{Band, Catalogue, Options, Profile, light};

/// Draws a starry sky
///
/// There are as many stars as in a field of the sky of that size: 3.2 times as many for each magnitude fainter. A star
/// five magnitudes fainter has a hundredth of the light. Colours are those of black bodies as hot as the spectral
/// classes, as frequent as among the stars that the eye sees. The same arguments give the same bytes.
#[derive(Parser, Clone, Debug)]
#[command(
    name = "istars",
    version,
    after_help = "Examples:\n  istars stars --size 960x640\n  istars sky.png --size 1920x1080 \
                  --faintest 12 --band 12 --tilt 40 --seed 7\n  istars light.exr --field 90 --white 2"
)]
pub struct Arguments {
    /// Image to write, its format by its ending; `-` is standard output, as PNG
    #[arg(value_name = "OUT")]
    out: PathBuf,
    /// Columns and rows of the picture
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: Size,
    /// Another number, another sky
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    seed: u64,
    /// Magnitude of the faintest stars, -1 to 25
    #[arg(long, value_name = "M", default_value_t = Options::default().faintest,
          value_parser = from_to::<-1, 25>, allow_negative_numbers = true)]
    faintest: f64,
    /// Degrees of the sky from left to right, 0.01 to 180
    #[arg(long, value_name = "DEGREES", default_value_t = Options::default().field_degrees, value_parser = field)]
    field: f64,
    /// Stars in the midst of the band for one far away from it, 1 to 1000; 1 is no band
    #[arg(long, value_name = "TIMES", default_value_t = Options::default().band.strength, value_parser = from_to::<1, 1000>)]
    band: f64,
    /// Degrees by which the band rises to the right
    #[arg(long, value_name = "DEGREES", default_value_t = Options::default().band.tilt_degrees,
          value_parser = from_to::<-360, 360>, allow_negative_numbers = true)]
    tilt: f64,
    /// Share of the stars that dust in the band hides, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Options::default().band.dust, value_parser = from_to::<0, 1>)]
    dust: f64,
    /// Magnitude of a star that would be white were all its light in one pixel, -30 to 30
    #[arg(long, value_name = "M", default_value_t = Options::default().white,
          value_parser = from_to::<-30, 30>, allow_negative_numbers = true)]
    white: f64,
    /// Standard deviation of the light of a star in pixels, 0.05 to 100
    #[arg(long, value_name = "PIXELS", default_value_t = Options::default().profile.core, value_parser = spread)]
    spread: f64,
    /// Share of it that is in a halo five times as wide, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Options::default().profile.halo, value_parser = from_to::<0, 1>)]
    halo: f64,
    /// Bits of a sample: 8, 16 or 32f, which is not clamped [default: 8; for .exr 32f]
    #[arg(long, value_name = "BITS", value_parser = depth)]
    depth: Option<Depth>,
    #[command(flatten)]
    coding: Coding,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

#[derive(Clone, Copy, Debug)]
struct Size([u32; 2]);

/// Does what `istars` was asked for.
///
/// # Errors
///
/// [`UsageError`] if there would be too many pixels or stars; else if the picture cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let job = Job::start("istars", env!("CARGO_PKG_VERSION"));
    let Size([columns, rows]) = arguments.size;
    checked_size(columns, rows)
        .map_err(|error| UsageError(format!("--size {columns}x{rows}: {error}")))?;
    let options = options(arguments);
    let wrong = |error| UsageError(format!("--faintest {}: {error}", options.faintest));
    let count = Catalogue::new(&options).map_err(wrong)?.len();
    arguments.talk.note(format_args!("{count} stars to magnitude {}", options.faintest));
    let planes = light(&options).map_err(wrong)?;
    let is_exr = arguments.out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    let depth = arguments.depth.unwrap_or(if is_exr { Depth::F32 } else { Depth::U8 });
    let transfer = if depth == Depth::F32 { Transfer::Linear } else { Transfer::Srgb };
    let plane = |(kind, values): (_, Vec<f32>)| {
        let samples = Samples::encoded(&values, depth, transfer);
        samples.map(|samples| Plane { kind, samples })
    };
    let planes: Result<Vec<Plane>, usize> = COLOR.into_iter().zip(planes).map(plane).collect();
    let planes = planes.map_err(|at| format!("pixel {at} has more light than can be stored"))?;
    let mut image = Image::new(columns, rows, planes)?;
    image.properties = Properties { transfer: Some(transfer), ..Properties::default() };
    arguments.talk.note(summary(&image));
    let job = job.with_figure("stars", count);
    save(&arguments.out, image, &arguments.coding.write_options(), &job)?;
    Ok(())
}

fn options(arguments: &Arguments) -> Options {
    let Size([columns, rows]) = arguments.size;
    let Arguments { seed, faintest, field, white, .. } = *arguments;
    let Band { width, .. } = Options::default().band;
    let band = Band {
        strength: arguments.band,
        width,
        tilt_degrees: arguments.tilt,
        dust: arguments.dust,
    };
    let profile = Profile { core: arguments.spread, halo: arguments.halo };
    Options { columns, rows, seed, faintest, field_degrees: field, band, profile, white }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |word: &str| word.parse().ok().filter(|side: &u32| *side > 0);
        let sides =
            text.split_once('x').and_then(|(columns, rows)| Some([side(columns)?, side(rows)?]));
        sides.map(Self).ok_or_else(|| "expected columns and rows as in 640x480".into())
    }
}

/// A number from `LOW` to `HIGH`.
fn from_to<const LOW: i32, const HIGH: i32>(text: &str) -> Result<f64, String> {
    number(text, [f64::from(LOW), f64::from(HIGH)])
}

fn field(text: &str) -> Result<f64, String> {
    number(text, [0.01, 180.0])
}

fn spread(text: &str) -> Result<f64, String> {
    number(text, [0.05, 100.0])
}

fn number(text: &str, [low, high]: [f64; 2]) -> Result<f64, String> {
    let number = text.parse().ok().filter(|value| (low..=high).contains(value));
    number.ok_or_else(|| format!("expected a number from {low} to {high}"))
}

fn depth(text: &str) -> Result<Depth, String> {
    let words = Depth::ALL.map(Depth::word).join(", ");
    Depth::from_word(text).ok_or_else(|| format!("expected one of {words}"))
}
