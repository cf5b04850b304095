//! What `scripts/compare-quantisers.sh` needs besides programs: our quantisers and those of two
//! libraries in memory, and two measures of what is seen.
//!
//! ```text
//! quantiser-peers methods                            words of the methods, one a line
//! quantiser-peers quantise METHOD RUNS IN OUT.png    milliseconds on one thread and on two
//! quantiser-peers compare A B                        SSIMULACRA2, and DSSIM in millionths
//! ```

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use idf::exchange::{read_image, write_image};
use idf::{Image, Kind, Plane, ReadOptions, Samples, WriteOptions};
use iencode::dither;
use ilut::{Method, Metric, Pixels, Quantized, Table};
use quantette::deps::palette::Srgb;
use quantette::dither::FloydSteinberg;
use quantette::{ImageRef, PaletteSize, Pipeline, QuantizeMethod};

type Failure = Box<dyn Error>;

/// A quantiser: its word, and how it works.
type Row = (&'static str, fn(&Source) -> Result<Quantized, Failure>);

/// All quantisers to 256 colours. `-fs` is with Floyd and Steinberg's dither.
const METHODS: &[Row] = &[
    ("heckbert", |source| ours(source, Method::Heckbert, Metric::Rgb, &dither::NONE)),
    ("fast", |source| ours(source, Method::Fast, Metric::Rgb, &dither::NONE)),
    ("best", |source| ours(source, Method::Best, Metric::Rgb, &dither::NONE)),
    ("oklab", |source| ours(source, Method::Best, Metric::Oklab, &dither::NONE)),
    ("oklab-fs", |source| ours(source, Method::Best, Metric::Oklab, &dither::FLOYD_STEINBERG)),
    ("oklab-noise", |source| ours(source, Method::Best, Metric::Oklab, &dither::BLUE_NOISE)),
    ("imagequant-1", |source| imagequant(source, 1, 0.0)),
    ("imagequant-4", |source| imagequant(source, 4, 0.0)),
    ("imagequant-10", |source| imagequant(source, 10, 0.0)),
    ("imagequant-1-fs", |source| imagequant(source, 1, 1.0)),
    ("imagequant-4-fs", |source| imagequant(source, 4, 1.0)),
    ("imagequant-10-fs", |source| imagequant(source, 10, 1.0)),
    ("quantette-wu", |source| quantette(source, QuantizeMethod::Wu, None)),
    ("quantette-kmeans", |source| quantette(source, QuantizeMethod::kmeans(), None)),
    ("quantette-wu-fs", |source| {
        quantette(source, QuantizeMethod::Wu, Some(FloydSteinberg::new()))
    }),
    ("quantette-kmeans-fs", |source| {
        quantette(source, QuantizeMethod::kmeans(), Some(FloydSteinberg::new()))
    }),
];

/// A picture as each library wants it.
struct Source {
    pixels: Pixels,
    rgba: Vec<imagequant::RGBA>,
    srgb: Vec<Srgb<u8>>,
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["methods"] => METHODS.iter().for_each(|(word, _)| println!("{word}")),
        ["quantise", method, runs, from, to] => {
            let row = METHODS.iter().find(|(word, _)| *word == method);
            let &row = row.ok_or_else(|| format!("no method is called `{method}`"))?;
            quantise(row, runs.parse()?, Path::new(from), Path::new(to))?;
        }
        ["compare", a, b] => compare(&read(Path::new(a))?, &read(Path::new(b))?)?,
        _ => return Err("expected methods, quantise METHOD RUNS IN OUT.png, or compare A B".into()),
    }
    Ok(())
}

fn read(path: &Path) -> Result<Pixels, Failure> {
    Ok(Pixels::of(&read_image(path, &ReadOptions::default())?, None)?)
}

/// Prints the least milliseconds of several runs on one thread and on two, in turn, and writes
/// the picture.
fn quantise((_, work): Row, runs: usize, from: &Path, to: &Path) -> Result<(), Failure> {
    let pixels = read(from)?;
    let source = Source {
        rgba: pixels.colors().iter().map(|&[r, g, b, a]| imagequant::RGBA { r, g, b, a }).collect(),
        srgb: pixels.colors().iter().map(|&[r, g, b, _]| Srgb::new(r, g, b)).collect(),
        pixels,
    };
    let mut least = [f64::INFINITY; 2];
    let mut result = None;
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let pools = pools.into_iter().collect::<Result<Vec<_>, _>>()?;
    for _ in 0..runs.max(1) {
        for (pool, least) in pools.iter().zip(&mut least) {
            let (quantized, seconds) = pool.install(|| {
                let start = Instant::now();
                let quantized = work(&source).map_err(|error| error.to_string());
                (quantized, start.elapsed().as_secs_f64())
            });
            result = Some(quantized?);
            *least = least.min(1e3 * seconds);
        }
    }
    let result = result.ok_or("no run")?;
    let samples = Samples::U8(result.indices.into_iter().next().ok_or("no picture")?);
    let planes = vec![Plane { kind: Kind::Enc, samples }];
    let mut image = Image::new(source.pixels.columns(), source.pixels.rows(), planes)?;
    image.lut = Some((&result.table).into());
    write_image(to, &image, &WriteOptions::default())?;
    println!("{:.2} {:.2}", least[0], least[1]);
    Ok(())
}

fn ours(
    source: &Source,
    method: Method,
    metric: Metric,
    dither: &'static iencode::Dither,
) -> Result<Quantized, Failure> {
    let table = ilut::Options { method, metric, ..ilut::Options::default() };
    let options = iencode::Options { table, dither, ..iencode::Options::default() };
    Ok(iencode::encoded(&[&source.pixels], None, &options)?)
}

/// libimagequant at a speed of 1 to 10, where 1 is best.
fn imagequant(source: &Source, speed: i32, dither: f32) -> Result<Quantized, Failure> {
    let mut attributes = imagequant::new();
    attributes.set_speed(speed)?;
    let [columns, rows] = [source.pixels.columns() as usize, source.pixels.rows() as usize];
    let mut image = attributes.new_image_borrowed(&source.rgba, columns, rows, 0.0)?;
    let mut result = attributes.quantize(&mut image)?;
    result.set_dithering_level(dither)?;
    let (palette, indices) = result.remapped(&mut image)?;
    quantized(palette.iter().map(|c| [c.r, c.g, c.b, c.a]).collect(), indices)
}

fn quantette(
    source: &Source,
    method: QuantizeMethod,
    dither: Option<FloydSteinberg>,
) -> Result<Quantized, Failure> {
    let [columns, rows] = [source.pixels.columns(), source.pixels.rows()];
    let image = ImageRef::new(columns, rows, &source.srgb).map_err(|error| error.to_string())?;
    let is_parallel = rayon::current_num_threads() > 1;
    let result = Pipeline::new()
        .palette_size(PaletteSize::from_u16_clamped(256))
        .quantize_method(method)
        .ditherer(dither)
        .parallel(is_parallel)
        .input_image(image)
        .output_srgb8_indexed_image();
    let palette = result.palette().iter().map(|c| [c.red, c.green, c.blue, u8::MAX]).collect();
    quantized(palette, result.indices().to_vec())
}

fn quantized(colors: Vec<[u8; 4]>, indices: Vec<u8>) -> Result<Quantized, Failure> {
    let table = Table::new(colors).ok_or("expected 1 to 256 colours")?;
    Ok(Quantized { table, indices: vec![indices] })
}

fn compare(a: &Pixels, b: &Pixels) -> Result<(), Failure> {
    let size = |pixels: &Pixels| (pixels.columns() as usize, pixels.rows() as usize);
    if size(a) != size(b) {
        return Err("the pictures are of different sizes".into());
    }
    let (columns, rows) = size(a);
    let frame = |pixels: &Pixels| {
        let color = |&[r, g, b, _]: &[u8; 4]| [r, g, b].map(|byte| f32::from(byte) / 255.0);
        let colors = pixels.colors().iter().map(color).collect();
        let (transfer, primaries) =
            (ssimulacra2::TransferCharacteristic::SRGB, ssimulacra2::ColorPrimaries::BT709);
        ssimulacra2::Rgb::new(colors, columns, rows, transfer, primaries)
    };
    let score = ssimulacra2::compute_frame_ssimulacra2(frame(a)?, frame(b)?)?;
    let dssim = dssim_core::Dssim::new();
    let image = |pixels: &Pixels| {
        let color = |&[r, g, b, a]: &[u8; 4]| imagequant::RGBA { r, g, b, a };
        let colors: Vec<_> = pixels.colors().iter().map(color).collect();
        dssim.create_image_rgba(&colors, columns, rows).ok_or("DSSIM takes no such picture")
    };
    let (distance, _) = dssim.compare(&image(a)?, image(b)?);
    println!("{score:.3} {:.1}", 1e6 * f64::from(distance));
    Ok(())
}
