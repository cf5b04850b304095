//! Seconds to compile, write and read scenes of 100 000 objects of three primitives, and of ten times as many.
//!
//! `cargo bench -p compile` prints the best of several alternating runs on one thread.

use std::fmt::Write as _;
use std::io::Write;
use std::time::Instant;

use compile::compile_text;
use scene::format;

const RUNS: usize = 7;

/// Every object as a statement of its own.
fn statements(objects: u32) -> String {
    let mut text = "camera at (0, 0, 100)\n".to_owned();
    for i in 0..objects {
        let (x, y, z, turn) = (i % 317, i / 317 % 317, i / 100_489, i % 90);
        writeln!(
            text,
            "object is shiny red sphere at ({x}, {y}, {z}) scale .4 - blue block rotate (0, {turn}, 0) \
             + cone at (0, 0, {})",
            i % 50
        )
        .expect("a text takes what is written");
    }
    text
}

/// The same objects from one statement.
fn repeated(objects: u32) -> String {
    format!(
        "camera at (0, 0, 100) repeat i from 0 to {} {{ object is shiny red \
         sphere at (mod(i, 317), mod(floor(i / 317), 317), floor(i / 100489)) scale .4 \
         - blue block rotate (0, mod(i, 90), 0) + cone at (0, 0, mod(i, 50)) }}",
        objects - 1
    )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout().lock();
    for (objects, runs) in [(100_000, RUNS), (1_000_000, RUNS.div_ceil(2))] {
        let texts = [statements(objects), repeated(objects)];
        let mut compiled = Vec::new();
        let mut best = [f64::INFINITY; 4];
        for _ in 0..runs {
            for (text, best) in texts.iter().zip(&mut best) {
                let start = Instant::now();
                let scene = compile_text(text).scene.ok_or("a scene without errors")?;
                *best = best.min(start.elapsed().as_secs_f64());
                if compiled.is_empty() {
                    format::write(&scene, &mut compiled)?;
                }
            }
            let start = Instant::now();
            let scene = format::read(&compiled)?;
            best[2] = best[2].min(start.elapsed().as_secs_f64());
            let mut written = Vec::with_capacity(compiled.len());
            let start = Instant::now();
            format::write(&scene, &mut written)?;
            best[3] = best[3].min(start.elapsed().as_secs_f64());
        }
        let [statements, repeated, read, write] = best;
        writeln!(
            out,
            "{objects} objects: compile {statements:.3} s from statements, {repeated:.3} s from a repeat; \
             {} MB compiled: read {read:.3} s, write {write:.3} s",
            compiled.len() / 1_000_000
        )?;
    }
    Ok(())
}
