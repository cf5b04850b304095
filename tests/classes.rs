//! Classes of classes: what they stand for is never written out.

use std::fmt::Write;

use render::{World, render};
use scene::Scene;

use crate::support::{Shown, scene, shown, square};

/// A class of ten of the class before it, `levels` deep: balls at the points of a lattice, in lines, squares and cubes
/// in turn. After three levels of ten it is ten times as wide each way.
fn lattice(levels: u32) -> String {
    let mut text = String::from("class ball0 is shiny red sphere scale 0.4\n");
    let mut step = 1_u64;
    for level in 1..=levels {
        let axis = (level - 1) % 3;
        let terms: Vec<String> = (0..10)
            .map(|i| {
                let mut place = [0; 3];
                place[axis as usize] = i * step;
                let [x, y, z] = place;
                format!("ball{} at ({x}, {y}, -{z})", level - 1)
            })
            .collect();
        writeln!(text, "class ball{level} is {}", terms.join(" + ")).expect("a string");
        if axis == 2 {
            step *= 10;
        }
    }
    text
}

/// Past the upper left edge of ten by ten by ten balls.
const CORNER: &str = "camera at (-4, 13, 12) target at (1, 8, 0)";

fn seen(objects: &str, camera: &str) -> Scene {
    scene(&format!(
        "{objects} {camera}
         light beam at (2, 3, 4) intensity 0.8 ambient intensity 0.2 background light blue"
    ))
}

fn shares(picture: &Shown) -> (usize, usize) {
    let covered = picture.coverage.iter().filter(|&&coverage| coverage > 0.5).count();
    (covered, picture.coverage.len() - covered)
}

#[test]
fn a_million_million_spheres_are_few_in_memory() {
    let scene = seen(
        &(lattice(12) + "object is ball12"),
        // Along the left side of a cube ten thousand balls wide.
        "camera at (-6, 50, 12) target at (-2, 50, -10)",
    );
    let world = World::load(&scene).expect("it loads");
    assert!(world.leaf_count() <= 16, "{} primitives in memory", world.leaf_count());
    let picture = render(&world, &square(64, 1), &|_| ()).expect("threads");
    let picture = Shown::new(&picture.film, scene.background);
    let (covered, open) = shares(&picture);
    assert!(covered > 500 && open > 500, "{covered} pixels covered, {open} open");
    // Many balls one behind the other, each with a bright and a dark side.
    let tones: std::collections::BTreeSet<u8> =
        picture.pixels.iter().filter(|pixel| pixel[1] < 100).map(|pixel| pixel[0]).collect();
    assert!(tones.len() > 20, "{} tones of red", tones.len());
}

/// Every ball of `lattice(3)` in a text of its own.
fn written_out() -> String {
    let mut text = String::new();
    for i in 0..1000 {
        let (x, y, z) = (i % 10, i / 10 % 10, i / 100);
        writeln!(text, "object is shiny red sphere scale 0.4 at ({x}, {y}, -{z})")
            .expect("a string");
    }
    text
}

#[test]
fn classes_look_like_what_they_stand_for() {
    let options = square(64, 2);
    let full = shown(&seen(&written_out(), CORNER), &options);
    let (covered, open) = shares(&full);
    assert!(covered > 500 && open > 500, "{covered} pixels covered, {open} open");
    let classes = seen(&(lattice(3) + "object is ball3"), CORNER);
    assert_eq!(World::load(&classes).expect("it loads").leaf_count(), 1000, "small: written out");
    assert!(shown(&classes, &options) == full, "as classes");

    // Beside a million balls that the camera does not see, the classes stay shared.
    let many = lattice(6) + "object is ball3 object is ball6 at (0, 0, 9000)";
    let many = seen(&many, CORNER);
    let world = World::load(&many).expect("it loads");
    assert!(world.leaf_count() <= 16, "shared: {} primitives in memory", world.leaf_count());
    let differing = shown(&many, &options).differing(&full, 0);
    assert!(differing.is_empty(), "shared: {} pixels differ", differing.len());
}

#[test]
fn the_number_of_spheres_has_a_named_limit() {
    let scene = seen(&(lattice(18) + "object is ball18"), CORNER);
    assert!(World::load(&scene).is_ok(), "10^18");
    let scene = seen(&(lattice(19) + "object is ball19"), CORNER);
    let error = World::load(&scene).expect_err("10^19").to_string();
    assert!(error.contains("more primitives"), "{error}");
}
