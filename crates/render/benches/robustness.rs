//! What it costs that every boundary is asked what lies on its sides: ordinary scenes with that, and without.
//!
//! `cargo bench -p render --bench robustness` prints the least seconds of alternating runs on one thread, what the
//! questions add to those without them, and in how many pixels the pictures differ: solids of the fields stand apart, so
//! hardly any. Scenes of the gallery have solids that touch or overlap, and look wrong without the questions; what
//! counts there is the time of one ray.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use render::{Film, Options, World, render};

const RUNS: usize = 9;
/// Solids of a row, and rows.
const SIDE: u32 = 6;
/// What is promised at most.
const OPAQUE: f64 = 0.12;
const FILTERED: f64 = 0.25;

/// Solids of all kinds that stand apart above a floor; of every `clear` of them one is of glass.
fn field(clear: Option<u32>) -> String {
    let solids = ["sphere", "block", "cylinder", "cone", "paraboloid"];
    let colors = ["strong red", "strong green", "strong blue", "light yellow", "light gray"];
    let mut text =
        String::from("object is very light gray block scale (20, 0.5, 20) at (0, -2, 0)\n");
    for k in 0..SIDE * SIDE {
        let (x, z) = (f64::from(k % SIDE) * 1.7 - 4.2, f64::from(k / SIDE) * 1.7 - 6.0);
        let look = match clear {
            Some(every) if k % every == 0 => "smoothest trans (8, 1.5) white".to_owned(),
            _ => colors[k as usize % colors.len()].to_owned(),
        };
        let solid = solids[(k / 2) as usize % solids.len()];
        let turn = 17 * k;
        let line = format!(
            "object is {look} {solid} scale (0.6, 0.5, 0.6) rotate (0, {turn}, 0) at ({x}, 0, {z})\n"
        );
        text += &line;
    }
    let _ = write!(
        text,
        "light point at (5, 9, 6) intensity 0.6\nlight beam toward (1, -2, -1) intensity 0.3\n\
         ambient intensity 0.2\ncamera at (1, 5, 9) target at (0, -0.5, -1.5)\n"
    );
    text
}

fn differing(a: &Film, b: &Film) -> usize {
    let apart = |(a, b): &(render::Pixel, render::Pixel)| {
        a.color.iter().zip(b.color).any(|(a, b)| (a - b).abs() > 1.0 / 255.0)
    };
    a.pixels().zip(b.pixels()).filter(apart).count()
}

/// Scenes of the gallery, and whether shadows go through glass in them.
const GALLERY: [(&str, bool); 6] = [
    ("spindles/spindles", false),
    ("gallery/cheese", false),
    ("gallery/gears", false),
    ("gallery/flake", false),
    ("wine-glass/wine-glass", true),
    ("gallery/aquarium", true),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, clear, most) in [
        ("opaque solids", None, OPAQUE),
        ("one solid of five is glass, shadows go through it", Some(5), FILTERED),
        ("one solid of two is glass, shadows go through it", Some(2), FILTERED),
    ] {
        measure(name, &compile::compile_text(field(clear)), most)?;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for (name, filtered) in GALLERY {
        let compiled = compile::compile_path(&folder.join(name).with_extension("sdl"));
        measure(name, &compiled, if filtered { FILTERED } else { OPAQUE })?;
    }
    Ok(())
}

fn measure(
    name: &str,
    compiled: &compile::Compiled,
    most: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout().lock();
    let scene = compiled.scene.as_ref().ok_or_else(|| compiled.report())?;
    let worlds = [World::load(scene)?, World::load(scene)?.trusting_boundaries()];
    let options = Options { threads: 1, ..Options::default() };
    let mut best = [f64::INFINITY; 2];
    let mut pictures = Vec::new();
    for _ in 0..RUNS {
        pictures.clear();
        for (world, best) in worlds.iter().zip(&mut best) {
            let start = Instant::now();
            let picture = render(world, &options, &|_| ())?;
            *best = best.min(start.elapsed().as_secs_f64());
            pictures.push(picture);
        }
    }
    let [asked, trusted] = best;
    let [rays, rays_trusted] = [0, 1].map(|k| pictures[k].stats.rays());
    let of_a_ray = (asked / rays as f64) / (trusted / rays_trusted as f64);
    writeln!(
        out,
        "{name}: {asked:.3} s, without {trusted:.3} s: {:+.1} % a ray (at most {:.0} %); {rays} rays and {rays_trusted}, {} pixels differ",
        100.0 * (of_a_ray - 1.0),
        100.0 * most,
        differing(&pictures[0].film, &pictures[1].film),
    )?;
    Ok(())
}
