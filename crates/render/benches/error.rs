//! Error against time: how far off pictures are by each way of sampling, and how far off they say they are.
//!
//! `cargo bench -p render --bench error -- [SCENE.sdl …] [--fast] [--errors]` prints a line for each way: seconds of one thread, samples
//! a pixel, true error and reported error in display steps, as geometric means over eight seeds; `--fast` takes two, and
//! worse references; `--errors` tries `--error` 10 to 0.3 alone. Without scenes it takes the wine glass, some of the gallery,
//! and 3000 spheres smaller than a pixel.
//!
//! The true mean square error of P is the mean of (P − R₁)(P − R₂): what two independent references are off by has
//! nothing to do with each other.

use std::error::Error;
use std::io::Write;
use std::time::{Duration, Instant};

use glam::DVec3;
use idf::Transfer;
use render::{Film, Options, Rate, Sampling, World, render};
use scene::{Camera, Light, LightKind, Placement, Primitive, Rgb, Scene, Solid};

const SIDE: u32 = 256;
const SCENES: [&str; 5] =
    ["wine-glass/wine-glass", "gallery/cheese", "gallery/flake", "gallery/planet", "gallery/gears"];
const REFERENCE: u32 = 512;
/// Seeds of the references; those of pictures are less.
const REFERENCE_SEEDS: [u32; 2] = [900_001, 900_002];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let said = |wanted: &str| words.iter().any(|word| word == wanted);
    let (fast, errors) = (said("--fast"), said("--errors"));
    let named: Vec<&String> = words.iter().filter(|word| !word.starts_with("--")).collect();
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "scene | way | seconds | samples | true | reported | reported/true, least … most"
    )?;
    if named.is_empty() {
        for name in SCENES {
            let path = format!("{}/../../scenes/{name}.sdl", env!("CARGO_MANIFEST_DIR"));
            measure(&mut out, name, &compiled(&path)?, fast, errors)?;
        }
        measure(&mut out, "3000 spheres", &World::load(&spheres())?, fast, errors)?;
    }
    for path in named {
        measure(&mut out, path, &compiled(path)?, fast, errors)?;
    }
    Ok(())
}

fn compiled(path: &str) -> Result<World, Box<dyn Error>> {
    let compiled = compile::compile_path(path.as_ref());
    let scene = compiled.scene.as_ref().ok_or_else(|| compiled.report())?;
    Ok(World::load(scene)?)
}

/// Spheres of 0.03 to 0.5 pixel, all over the picture.
fn spheres() -> Scene {
    // Numbers by a linear congruence (Knuth's MMIX).
    let mut state = 4243_u64;
    let mut chance = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut scene = Scene { ambient: Rgb::splat(0.2), ..Scene::default() };
    let pixel = 480.0 / f64::from(SIDE);
    for _ in 0..3000 {
        let radius = libm::exp10(-1.523 + 1.222 * chance()) * pixel;
        let at = DVec3::new((chance() - 0.5) * 480.0, (chance() - 0.5) * 480.0, 0.0);
        let placement =
            Placement { place: at, scale: DVec3::splat(radius), ..Placement::default() };
        scene.add_object(None, Solid::primitive(Primitive::Sphere, placement));
    }
    let kind = LightKind::Beam { at: DVec3::new(0.5, 0.9, 0.3), toward: DVec3::ZERO };
    scene.lights.push(Light { kind, color: Rgb::splat(0.8), shadows: true, radius: 0.0 });
    scene.camera = Some(Camera {
        parallel: false,
        position: DVec3::new(0.0, 0.0, 1000.0),
        target: DVec3::ZERO,
        focal_length_mm: 50.0,
    });
    scene
}

/// A picture over its background in display steps.
fn shown(film: &Film, world: &World) -> Vec<f64> {
    let background = world.background();
    film.pixels()
        .flat_map(|pixel| {
            let open = 1.0 - f64::from(pixel.coverage);
            let channels = pixel.color.into_iter().zip(background.to_array());
            channels.map(move |(color, behind)| {
                let linear = (f64::from(color) + open * behind).clamp(0.0, 1.0);
                255.0 * Transfer::Srgb.encode(linear)
            })
        })
        .collect()
}

fn options(sampling: Sampling, seed: u32) -> Options {
    Options { columns: SIDE, rows: SIDE, sampling, seed, ..Options::default() }
}

/// Measures all ways on one scene.
fn measure(
    out: &mut impl Write,
    name: &str,
    world: &World,
    fast: bool,
    errors: bool,
) -> Result<(), Box<dyn Error>> {
    let rate = if fast { REFERENCE / 4 } else { REFERENCE };
    let reference = |seed| -> Result<Vec<f64>, Box<dyn Error>> {
        let sampling = Sampling::Stochastic(Rate::Samples(rate));
        Ok(shown(&render(world, &options(sampling, seed), &|_| ())?.film, world))
    };
    let references = [reference(REFERENCE_SEEDS[0])?, reference(REFERENCE_SEEDS[1])?];
    let square =
        references[0].iter().zip(&references[1]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let own = (square / references[0].len() as f64).sqrt() / 2.0;
    writeln!(out, "{name} | references, {rate} samples each | | | {own:.4} both together | |")?;
    for (way, sampling, drawn) in ways(fast) {
        if errors && !matches!(sampling, Sampling::Stochastic(Rate::Error(error)) if error > 0.2) {
            continue;
        }
        let seeds = if !drawn {
            1
        } else if fast {
            2
        } else {
            8
        };
        // Logarithms of seconds, samples, true and reported error.
        let (mut sums, mut ratios) = ([0.0; 4], Vec::new());
        for seed in 0..seeds {
            let start = Instant::now();
            let options = Options { threads: 1, ..options(sampling, seed) };
            let picture = render(world, &options, &|_| ())?;
            let seconds = start.elapsed().as_secs_f64();
            let truth = true_error(&shown(&picture.film, world), &references);
            let reported = picture.error.unwrap_or(f64::NAN);
            ratios.push(reported / truth);
            for (sum, x) in sums.iter_mut().zip([seconds, picture.samples, truth, reported]) {
                *sum += libm::log(x) / f64::from(seeds);
            }
        }
        let [seconds, samples, truth, reported] = sums.map(libm::exp);
        let (low, high) = ratios
            .iter()
            .fold((f64::MAX, 0.0_f64), |(low, high), &ratio| (low.min(ratio), high.max(ratio)));
        let ratio = reported / truth;
        if drawn {
            writeln!(
                out,
                "{name} | {way} | {seconds:.3} | {samples:.2} | {truth:.3} | {reported:.3} | {ratio:.3}, {low:.3} … {high:.3}"
            )?;
        } else {
            writeln!(out, "{name} | {way} | {seconds:.3} | {samples:.2} | {truth:.3} | |")?;
        }
        out.flush()?;
    }
    Ok(())
}

/// Words, sampling, and whether another seed is another picture.
fn ways(fast: bool) -> Vec<(String, Sampling, bool)> {
    let mut ways = Vec::new();
    for side in [1, 2, 4, 8] {
        ways.push((format!("none {}", side * side), Sampling::Grid(side), false));
    }
    for levels in 1..=4 {
        let sampling = Sampling::Subdivided { levels };
        ways.push((format!("adaptive {}", 1 << (2 * levels)), sampling, false));
    }
    for samples in [4, 16, 64] {
        let sampling = Sampling::Stochastic(Rate::Samples(samples));
        ways.push((format!("stochastic {samples}"), sampling, true));
    }
    let errors = [10.0, 3.0, 1.0, 0.5, 0.3, 0.1];
    for error in &errors[..if fast { 5 } else { 6 }] {
        ways.push((format!("--error {error}"), Sampling::Stochastic(Rate::Error(*error)), true));
    }
    let second = Sampling::Stochastic(Rate::Time(Duration::from_secs(1)));
    ways.push(("--seconds 1".into(), second, true));
    ways
}

fn true_error(picture: &[f64], references: &[Vec<f64>; 2]) -> f64 {
    let pairs = references[0].iter().zip(&references[1]);
    let product: f64 = picture.iter().zip(pairs).map(|(p, (a, b))| (p - a) * (p - b)).sum();
    let mean = product / picture.len() as f64;
    if mean > 0.0 { mean.sqrt() } else { 1e-9 }
}
