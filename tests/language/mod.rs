//! What the language says, as pictures: seen along z from far away, so that a pixel's centre has an x and a y.

mod light;
mod look;
mod picture;
mod shape;

use render::{Options, Pixel, World, render};
use scene::Scene;

use crate::support::{Shown, scene, shown, square};

/// Columns and rows of a drawing.
const SIDE: u32 = 16;
/// Half the width of a drawing: pixel centres are at ±0.1, ±0.3 … ±1.5.
const HALF: f64 = 1.6;

/// `text` with a camera that sees x and y from −`half` to `half` as if in parallel: 10 000 units away.
fn from_afar(text: &str, half: f64) -> Scene {
    let focal_length = 12.0 * 10_000.0 / half;
    scene(&format!("{text} camera at (0, 0, 10000) focal length {focal_length}"))
}

fn drawn(text: &str) -> Shown {
    shown(&from_afar(text, HALF), &square(SIDE, 1))
}

/// `#` where `text` is covered.
fn silhouette(text: &str) -> String {
    drawn(text).silhouette()
}

/// A drawing with the blanks of the source taken off.
fn trimmed(drawing: &str) -> String {
    drawing.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

fn assert_drawn(found: &str, expected: &str, what: &str) {
    assert!(found == trimmed(expected), "{what}:\n{found}\nexpected:\n{}", trimmed(expected));
}

/// The one pixel of a picture that looks along the axis of the camera.
fn middle(scene: &Scene) -> Pixel {
    let world = World::load(scene).expect("it loads");
    let options = Options { columns: 1, rows: 1, clamp: false, ..Options::default() };
    let picture = render(&world, &options, &|_| ()).expect("threads");
    picture.film.pixels().next().expect("a pixel")
}

fn assert_near(found: [f32; 3], expected: [f64; 3], what: &str) {
    let near = |(f, e): (&f32, &f64)| (f64::from(*f) - e).abs() < 2e-6;
    assert!(found.iter().zip(&expected).all(near), "{what}: {found:?}, expected {expected:?}");
}
