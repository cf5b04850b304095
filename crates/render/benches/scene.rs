//! Seconds for the scenes of the repository, by each way of finding boundaries.
//!
//! `cargo bench -p render` prints the best of several alternating runs on one thread, and the rays traced.

use std::io::Write;
use std::time::Instant;

use render::{Accel, Options, World, render};

const SCENES: [&str; 3] =
    ["wine-glass/wine-glass.sdl", "gallery/planet.sdl", "gallery/aquarium.sdl"];
const WAYS: [(&str, Accel); 4] = [
    ("bvh", Accel::Bvh),
    ("coherence", Accel::Coherence),
    ("boxes", Accel::Boxes),
    ("none", Accel::None),
];
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout().lock();
    for name in SCENES {
        let path = format!("{}/../../scenes/{name}", env!("CARGO_MANIFEST_DIR"));
        let compiled = compile::compile_path(path.as_ref());
        let scene = compiled.scene.as_ref().ok_or_else(|| compiled.report())?;
        let world = World::load(scene)?;
        let mut best = [f64::INFINITY; WAYS.len()];
        let mut rays = 0;
        for _ in 0..RUNS {
            for ((_, accel), best) in WAYS.iter().zip(&mut best) {
                let options = Options { accel: *accel, threads: 1, ..Options::default() };
                let start = Instant::now();
                rays = render(&world, &options, &|_| ())?.stats.rays();
                *best = best.min(start.elapsed().as_secs_f64());
            }
        }
        for ((way, _), seconds) in WAYS.iter().zip(best) {
            writeln!(out, "{name} {way}: {seconds:.3} s, {rays} rays")?;
        }
    }
    Ok(())
}
