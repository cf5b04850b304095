//! Pictures with proofs beside 16 samples everywhere: time, and how far off they are.
//!
//! `cargo bench -p render --bench certify -- [SCENE.sdl …] [--flat | --full]` prints a line for each scene: first as what is
//! seen first alone, matte, in light without shadows and without rays from surface to surface, then as it is. Without
//! scenes it takes the wine glass, some of the gallery, a sphereflake of 820 and of 7381 spheres, and 10⁴ spheres of 0.01 to
//! 1 pixel. Times are the least of three alternating runs of one thread for 512 × 512 pixels; errors are in display
//! steps, against two references as in the bench `error`.

use std::error::Error;
use std::io::Write;
use std::time::Instant;

use glam::DVec3;
use idf::Transfer;
use render::{Film, Options, Picture, Rate, Sampling, World, render};
use scene::{Attributes, Camera, Light, LightKind, Placement, Primitive, Rgb, Scene, Solid};

const SIDE: u32 = 512;
const SCENES: [&str; 6] = [
    "wine-glass/wine-glass",
    "gallery/cheese",
    "gallery/gears",
    "gallery/planet",
    "gallery/rings",
    "gallery/section",
];
/// Samples of each of two references.
const REFERENCE: u32 = 128;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let has = |word: &str| words.iter().any(|w| w == word);
    let named: Vec<&String> = words.iter().filter(|word| !word.starts_with("--")).collect();
    let mut scenes = Vec::new();
    if named.is_empty() {
        for name in SCENES {
            let path = format!("{}/../../scenes/{name}.sdl", env!("CARGO_MANIFEST_DIR"));
            scenes.push((name.to_owned(), compiled(&path)?));
        }
        scenes.push(("sphereflake, 820".into(), flake(3)));
        scenes.push(("sphereflake, 7381".into(), flake(4)));
        scenes.push(("10000 spheres".into(), spheres()));
    }
    for path in named {
        scenes.push((path.clone(), compiled(path)?));
    }
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "scene | certain | undecided | bound | proofs | seconds: 16 on a grid · drawn · certified | error | 16 drawn by certified: time, error"
    )?;
    for (name, scene) in &scenes {
        if !has("--full") {
            measure(&mut out, &format!("{name}, seen first"), &seen_first(scene))?;
        }
        if !has("--flat") {
            measure(&mut out, name, scene)?;
        }
    }
    Ok(())
}

fn compiled(path: &str) -> Result<Scene, Box<dyn Error>> {
    let compiled = compile::compile_path(path.as_ref());
    let report = compiled.report();
    compiled.scene.ok_or_else(|| report.into())
}

/// The scene in colours alone.
fn seen_first(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for attributes in &mut scene.attributes {
        *attributes = Attributes { color: attributes.color, ..Attributes::default() };
    }
    let beam = LightKind::Beam { at: DVec3::new(0.5, 0.8, 0.6), toward: DVec3::ZERO };
    scene.lights = vec![Light { kind: beam, color: Rgb::splat(0.7), shadows: false, radius: 0.0 }];
    scene.ambient = Rgb::splat(0.3);
    scene.fog_half_distance = None;
    scene.images.clear();
    scene
}

fn seen_from(scene: &mut Scene, position: DVec3) {
    scene.camera =
        Some(Camera { parallel: false, position, target: DVec3::ZERO, focal_length_mm: 50.0 });
}

fn ball(scene: &mut Scene, place: DVec3, radius: f64) {
    let placement = Placement { place, scale: DVec3::splat(radius), ..Placement::default() };
    scene.add_object(None, Solid::primitive(Primitive::Sphere, placement));
}

/// Nine spheres of a third the size on each, so many times over (Haines, "A Proposal for Standard Graphics
/// Environments", 1987).
fn flake(levels: u32) -> Scene {
    let mut scene = Scene { ambient: Rgb::splat(0.2), ..Scene::default() };
    let mut row = vec![(DVec3::ZERO, 1.0, DVec3::Y)];
    ball(&mut scene, DVec3::ZERO, 1.0);
    for _ in 0..levels {
        let mut next = Vec::new();
        for (center, radius, axis) in row {
            let (u, v) = axis.any_orthonormal_pair();
            for k in 0..9 {
                let (count, first, height): (i32, i32, f64) =
                    if k < 6 { (6, 0, 0.0) } else { (3, 6, 0.8) };
                let turn = std::f64::consts::TAU * f64::from(k - first) / f64::from(count) + height;
                let across = (1.0 - height * height).sqrt();
                let way = height * axis + across * (libm::cos(turn) * u + libm::sin(turn) * v);
                let place = center + 4.0 / 3.0 * radius * way;
                ball(&mut scene, place, radius / 3.0);
                next.push((place, radius / 3.0, way));
            }
        }
        row = next;
    }
    let kind = LightKind::Beam { at: DVec3::new(0.5, 0.9, 0.3), toward: DVec3::ZERO };
    scene.lights.push(Light { kind, color: Rgb::splat(0.8), shadows: true, radius: 0.0 });
    seen_from(&mut scene, DVec3::new(2.0, 4.0, 8.0));
    scene
}

/// Spheres of 0.01 to 1 pixel, each in a square of its own.
fn spheres() -> Scene {
    let mut state = 4243_u64;
    let mut chance = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut scene = Scene { ambient: Rgb::splat(0.2), ..Scene::default() };
    let pixel = 480.0 / f64::from(SIDE);
    for number in 0..10_000 {
        let radius = libm::exp10(-2.0 + 2.0 * chance()) * pixel;
        let [x, y] = [number % 100, number / 100]
            .map(|at| (5.12 * (f64::from(at) + 0.5) - 256.0 + 3.0 * (chance() - 0.5)) * pixel);
        ball(&mut scene, DVec3::new(x, y, 0.0), radius);
    }
    let kind = LightKind::Beam { at: DVec3::new(0.5, 0.9, 0.3), toward: DVec3::ZERO };
    scene.lights.push(Light { kind, color: Rgb::splat(0.8), shadows: true, radius: 0.0 });
    seen_from(&mut scene, DVec3::new(0.0, 0.0, 1000.0));
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

fn measure(out: &mut impl Write, name: &str, scene: &Scene) -> Result<(), Box<dyn Error>> {
    let world = World::load(scene)?;
    let drawn = |samples| Sampling::Stochastic(Rate::Samples(samples));
    let options = |sampling, certify| Options {
        columns: SIDE,
        rows: SIDE,
        sampling,
        certify,
        threads: 1,
        ..Options::default()
    };
    let reference = |seed| -> Result<Vec<f64>, Box<dyn Error>> {
        let options = Options { seed, threads: 0, ..options(drawn(REFERENCE), false) };
        Ok(shown(&render(&world, &options, &|_| ())?.film, &world))
    };
    let references = [reference(900_001)?, reference(900_002)?];
    let ways = [
        options(Sampling::Grid(4), false),
        options(drawn(16), false),
        options(Sampling::Grid(1), true),
    ];
    let mut seconds = [f64::INFINITY; 3];
    let mut pictures: [Option<Picture>; 3] = [None, None, None];
    for _ in 0..3 {
        for (way, options) in ways.iter().enumerate() {
            let start = Instant::now();
            let picture = render(&world, options, &|_| ())?;
            seconds[way] = seconds[way].min(start.elapsed().as_secs_f64());
            pictures[way] = Some(picture);
        }
    }
    let pictures = pictures.into_iter().flatten();
    let pictures: Vec<(Vec<f64>, _)> =
        pictures.map(|picture| (shown(&picture.film, &world), picture.certificates)).collect();
    let error = |way: usize| {
        let pairs = references[0].iter().zip(&references[1]);
        let found = &pictures[way].0;
        let product: f64 = found.iter().zip(pairs).map(|(p, (a, b))| (p - a) * (p - b)).sum();
        let mean = product / found.len() as f64;
        if mean > 0.0 { mean.sqrt() } else { 0.0 }
    };
    let errors = [0, 1, 2].map(error);
    let [a, b, c] = seconds;
    let [d, e, f] = errors;
    let found = pictures[2].1.ok_or("no proofs were asked for")?;
    writeln!(
        out,
        "{name} | {:.4} | {:.4} | {:.2} | {:.3} s | {a:.3} · {b:.3} · {c:.3} | {d:.3} · {e:.3} · {f:.3} | {:.2}, {:.2}",
        found.certain,
        found.undecided,
        found.bound,
        found.seconds,
        b / c,
        e / f
    )?;
    out.flush()?;
    Ok(())
}
