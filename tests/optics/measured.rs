//! Distance, normal and object of the first surface, worked out by hand; in files with the names that others know.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;

use idf::{Image, Kind, Samples};
use render::{Options, World, measured, measured_kinds};
use tempfile::TempDir;

use crate::support::{portray, scene};

/// All channels of a picture of one pixel that looks along −z from (0, 0, 10).
fn middle(text: &str) -> Vec<f64> {
    let scene = scene(&format!("{text} camera at (0, 0, 10)"));
    let world = World::load(&scene).unwrap();
    let options = Options { columns: 1, rows: 1, ..Options::default() };
    let planes = measured(&world, &options, &measured_kinds()).unwrap();
    let kinds: Vec<Kind> = planes.iter().map(|plane| plane.kind).collect();
    assert_eq!(kinds, measured_kinds(), "{text}");
    let value = |samples: &Samples| match samples {
        Samples::F32(values) => f64::from(values[0]),
        Samples::U16(values) => f64::from(values[0]),
        Samples::U8(_) => panic!("8 bits"),
    };
    planes.iter().map(|plane| value(&plane.samples)).collect()
}

#[test]
fn the_first_surface_is_measured() {
    let nothing = [f64::from(f32::MAX), 0.0, 0.0, 0.0, 0.0];
    let (half, far) = (0.5_f64.sqrt(), "object is block at (9, 0, 0)");
    for (text, expected) in [
        ("", nothing),
        (far, nothing),
        ("object is sphere", [9.0, 0.0, 0.0, 1.0, 1.0]),
        ("object is block scale (1, 1, 2)", [8.0, 0.0, 0.0, 1.0, 1.0]),
        // A face at 45°, its edge 1.414 before the middle.
        (
            "object is block rotate (45, 0, 0) at (0, 0.1, 0)",
            [10.0 - 2.0 * half + 0.1, 0.0, -half, half, 1.0],
        ),
        // From the inside normals turn to the eye.
        ("object is sphere scale 20", [30.0, 0.0, 0.0, 1.0, 1.0]),
        // Panes and glass are surfaces, too.
        ("object is trans (1, fake) block at (0, 0, 3) object is block", [6.0, 0.0, 0.0, 1.0, 1.0]),
        ("object is block object is trans (1, 1.5) block at (0, 0, 3)", [6.0, 0.0, 0.0, 1.0, 2.0]),
        // A body around both the eye and what is seen, and an object that is nothing.
        (
            "object is block at (5, 5, 0) object is block - block object is sphere object is block at (7, 0, 0)",
            [9.0, 0.0, 0.0, 1.0, 3.0],
        ),
        (
            "class two is sphere at (0, 3, 0) + sphere object is two at (9, 0, 0) object is two at (0, 0, 1)",
            [8.0, 0.0, 0.0, 1.0, 2.0],
        ),
        // What a subtraction leaves belongs to the object that was cut.
        (
            "object is block object is block scale (3, 3, 3) - block scale (2, 2, 9)",
            [9.0, 0.0, 0.0, 1.0, 1.0],
        ),
    ] {
        let found = middle(text);
        let near =
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs().max(1.0));
        assert!(near, "{text}: {found:?}, expected {expected:?}");
    }
}

#[test]
fn shared_classes_have_their_objects_numbers() {
    // 2¹⁷ spheres: classes stay shared.
    let mut text = "class c0 is sphere ".to_owned();
    for level in 0..17 {
        text += &format!(
            "class c{} is c{level} scale 0.5 + c{level} scale 0.5 at (0.2, 0, 0) ",
            level + 1
        );
    }
    let found = middle(&format!(
        "{text} object is c17 at (9, 0, 0) object is c17 scale 1e5 at (0, 0, -1e5)"
    ));
    assert!((found[4] - 2.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn files_hold_them_by_their_names() {
    let folder = TempDir::new().unwrap();
    fs::write(
        folder.path().join("a.sdl"),
        "object is sphere camera at (0, 0, 10) background white",
    )
    .unwrap();
    for output in ["@a.exr", "@a"] {
        let words = "--size 9x9 -q --channels rgb,cvg,depth,normal,object";
        portray(folder.path(), &format!("@a.sdl -o {output} {words}")).unwrap();
    }
    let read = |name: &str| -> Image {
        idf::command::open(&folder.path().join(name), &idf::ReadOptions::default()).unwrap()
    };
    let (exr, own) = (read("a.exr"), read("a.idf"));
    for kind in measured_kinds() {
        assert!(exr.plane(kind).is_some() && exr.plane(kind) == own.plane(kind), "{kind}");
    }
    let bytes = fs::read(folder.path().join("a.exr")).unwrap();
    for name in ["A", "B", "G", "R", "Z", "N.X", "N.Y", "N.Z", "id"] {
        // Names of channels end with a zero byte, before the number of their type.
        let entry = [name.as_bytes(), &[0]].concat();
        assert!(bytes.windows(entry.len()).any(|window| window == entry), "{name}");
    }
}
