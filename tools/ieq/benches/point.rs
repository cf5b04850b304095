//! Pixels per second of the operations, in memory, on pictures of 3840 x 2160 pixels.
//!
//! `cargo bench -p ieq` prints the best of several runs of each, on one thread; `cargo bench -p ieq --
//! a.png b.jpg` adds these pictures, for what depends on how many colours there are.

use std::hint::black_box;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use idf::exchange::read_image;
use idf::plane::COLOR;
use idf::{Image, Kind, Matte, Plane, ReadOptions, Samples};
use ieq::{Operation, toned};

const COLUMNS: u32 = 3840;
const ROWS: u32 = 2160;

type Outcome = Result<(), Box<dyn std::error::Error + Send + Sync>>;

fn main() -> Outcome {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work)
}

fn work() -> Outcome {
    let mut rgba = Image::new(
        COLUMNS,
        ROWS,
        [COLOR.as_slice(), &[Kind::Cvg]].concat().into_iter().map(plane).collect(),
    )?;
    rgba.properties.matte = Matte::Straight;
    let mut multiplied = rgba.clone();
    multiplied.properties.matte = Matte::Premultiplied;
    let rgb = Image::new(COLUMNS, ROWS, COLOR.map(plane).into())?;
    let grey = Image::new(COLUMNS, ROWS, vec![plane(Kind::Grg)])?;
    for (name, image, word, numbers) in [
        ("gamma, RGBA straight", &rgba, "gamma", &[2.2][..]),
        ("gamma, RGBA multiplied", &multiplied, "gamma", &[2.2]),
        ("gamma, grey", &grey, "gamma", &[2.2]),
        ("equalize, RGB by luma", &rgb, "equalize", &[]),
        ("equalize, grey", &grey, "equalize", &[]),
        ("clahe, grey", &grey, "clahe", &[]),
        ("clahe, RGB by luma", &rgb, "clahe", &[]),
    ] {
        let operation = Operation::new(word, numbers)?;
        report(name, image, &operation)?;
    }
    let deep = grey.at_depth(idf::Depth::U16)?;
    let gamma = Operation::new("gamma", &[2.2])?;
    report("gamma, grey of 16 bits", &deep, &gamma)?;
    // A tenth of the picture: these take as long for each pixel.
    let part = Image::new(COLUMNS / 10, ROWS, COLOR.map(|kind| part(&rgb, kind)).into())?;
    for word in ["saturation", "hue"] {
        let operation = Operation::new(word, &[1.5])?;
        report(&format!("{word}, a tenth"), &part, &operation)?;
    }
    let glass =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/wine-glass/wine-glass.png");
    let named = std::env::args_os().skip(1).map(PathBuf::from);
    let named = named.filter(|name| !name.to_string_lossy().starts_with("--"));
    for name in std::iter::once(glass).chain(named) {
        let picture = read_image(&name, &ReadOptions::default())?;
        let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for word in ["saturation", "hue"] {
            report(&format!("{word}, {name}"), &picture, &Operation::new(word, &[1.5])?)?;
        }
    }
    Ok(())
}

/// Waves with noise: neighbours are alike, as in photographs.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
fn plane(kind: Kind) -> Plane {
    let mut seed = kind.word().bytes().map(u32::from).sum::<u32>();
    let pixel = |at: u32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = (f64::from(at % COLUMNS), f64::from(at / COLUMNS));
        let wave = 60.0 * libm::sin(x / 150.0) + 50.0 * libm::cos(y / 90.0);
        (128.0 + wave + f64::from(seed >> 28)) as u8
    };
    Plane { kind, samples: Samples::U8((0..COLUMNS * ROWS).map(pixel).collect()) }
}

fn part(image: &Image, kind: Kind) -> Plane {
    let samples = image.plane(kind).map(|samples| {
        let pixels = (COLUMNS / 10 * ROWS) as usize;
        samples.gathered(0..pixels)
    });
    Plane { kind, samples: samples.unwrap_or(Samples::U8(Vec::new())) }
}

/// Prints the million pixels per second that `operation` does on a copy of `image`.
fn report(name: &str, image: &Image, operation: &Operation) -> Outcome {
    let mut best = f64::INFINITY;
    for _ in 0..25 {
        let copy = black_box(image.clone());
        let start = Instant::now();
        black_box(toned(copy, operation)?);
        let seconds = start.elapsed().as_secs_f64();
        if seconds < best {
            best = seconds;
        }
    }
    let pixels = f64::from(image.columns()) * f64::from(image.rows());
    let (milliseconds, rate) = (best * 1e3, pixels / best / 1e6);
    writeln!(std::io::stdout(), "{name:24} {milliseconds:9.2} ms {rate:9.1} million per second")?;
    Ok(())
}
