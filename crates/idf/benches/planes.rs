//! Megabytes per second and ratio of run-length coding, beside PNG and EXR, and samples per second
//! through the table of a transfer.
//!
//! `cargo bench -p idf` prints the best of several runs of each, on one thread.

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::transfer::rounded_8;
use idf::{Image, Kind, Plane, ReadOptions, Samples, Transfer, WriteOptions, rle, srgb8};

type Fault = Box<dyn Error + Send + Sync>;
type Outcome = Result<(), Fault>;
type Pictures = Vec<(&'static str, [Vec<u8>; 3])>;

const SIDE: u32 = 2048;

fn main() -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        for (name, planes) in pictures()? {
            in_memory(name, &planes)?;
            in_files(name, &planes)?;
        }
        let light: Vec<f64> = (0..1_u32 << 20).map(|i| f64::from(i) / f64::from(1 << 20)).collect();
        let sum =
            |byte: fn(f64) -> u8| light.iter().map(|&l| u64::from(byte(black_box(l)))).sum::<u64>();
        report("bytes by table", light.len(), || Ok(sum(srgb8)))?;
        report("bytes by formula", light.len(), || Ok(sum(|l| rounded_8(Transfer::Srgb, l))))
    })
}

/// Three planes each: the picture of the wine glass, side by side to the size of the others, a
/// gradient in two directions, and noise.
fn pictures() -> Result<Pictures, Fault> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let glass = scenes.join("wine-glass/wine-glass.png");
    let glass = read_image(&glass, &ReadOptions::default())?;
    let [columns, rows] = glass.size();
    let places = || (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| [column, row]));
    let render = |kind| -> Result<Vec<u8>, Fault> {
        let Samples::U8(plane) = glass.needed(kind)? else { return Err("expected bytes".into()) };
        Ok(places().map(|[x, y]| plane[(y % rows * columns + x % columns) as usize]).collect())
    };
    let gradient = |turn: u32| -> Vec<u8> {
        places().map(|[x, y]| ((x * (turn + 1) + y * (3 - turn)) / 32).to_le_bytes()[0]).collect()
    };
    let mut seed = 1_u32;
    let mut noise = || -> Vec<u8> {
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed.to_le_bytes()[3]
        };
        places().map(|_| next()).collect()
    };
    Ok(vec![
        ("render", [render(Kind::Red)?, render(Kind::Grn)?, render(Kind::Blu)?]),
        ("gradient", [gradient(0), gradient(1), gradient(2)]),
        ("noise", [noise(), noise(), noise()]),
    ])
}

/// Coding and decoding of one plane.
fn in_memory(name: &str, planes: &[Vec<u8>; 3]) -> Outcome {
    let (plane, side) = (&planes[1], SIDE as usize);
    let file = rle::encode(plane, side);
    let ratio = share(file.len(), plane.len());
    report(&format!("rle encode {name} ({ratio})"), plane.len(), || {
        Ok(rle::encode(black_box(plane), side))
    })?;
    report(&format!("rle decode {name}"), plane.len(), || {
        Ok(rle::decode(black_box(&file), side, side)?)
    })?;
    report(&format!("copy {name}"), plane.len(), || Ok(black_box(plane).clone()))
}

/// Writing and reading of three planes in each format.
fn in_files(name: &str, planes: &[Vec<u8>; 3]) -> Outcome {
    let folder = tempfile::tempdir()?;
    let plane =
        |(kind, samples): (Kind, &Vec<u8>)| Plane { kind, samples: Samples::U8(samples.clone()) };
    let image = Image::new(SIDE, SIDE, COLOR.into_iter().zip(planes).map(plane).collect())?;
    let count = 3 * planes[0].len();
    for ending in ["idf", "png", "exr"] {
        let folder = folder.path().join(ending);
        fs::create_dir(&folder)?;
        let path = folder.join(format!("x.{ending}"));
        write_image(&path, &image, &WriteOptions::default())?;
        let mut bytes = 0;
        for entry in fs::read_dir(&folder)? {
            bytes += usize::try_from(entry?.metadata()?.len())?;
        }
        report(&format!("write {ending} {name} ({})", share(bytes, count)), count, || {
            Ok(write_image(&path, black_box(&image), &WriteOptions::default())?)
        })?;
        report(&format!("read {ending} {name}"), count, || {
            Ok(read_image(black_box(&path), &ReadOptions::default())?)
        })?;
    }
    Ok(())
}

/// Percent of the bytes that are left.
fn share(bytes: usize, of: usize) -> String {
    format!("{} %", bytes * 100 / of)
}

/// Prints the millions per second of `count` things that `work` does.
fn report<T>(name: &str, count: usize, work: impl Fn() -> Result<T, Fault>) -> Outcome {
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        black_box(work()?);
        best = best.min(start.elapsed().as_secs_f64());
    }
    let rate = f64::from(u32::try_from(count)?) / best / 1e6;
    writeln!(std::io::stdout(), "{name:30} {rate:8.0} million per second")?;
    Ok(())
}
