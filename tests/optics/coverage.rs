//! A picture over its background is the picture without coverage.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::path::{Path, PathBuf};

use idf::{Image, Kind, Samples};
use render::{Form, Options, World, render};
use scene::{Rgb, Scene};

use crate::oracle::author::Site;
use crate::radiance::look;
use crate::random_csg::Places;
use crate::support::{root, scene, square};

const COLOR: [Kind; 3] = [Kind::Red, Kind::Grn, Kind::Blu];

/// What a comparison saw of pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    pixels: usize,
    /// Neither wholly covered nor wholly open.
    part: usize,
    /// Largest difference in steps of 255.
    steps: u8,
}

fn bytes(image: &Image, kind: Kind) -> Vec<u8> {
    match image.plane(kind) {
        Some(Samples::U8(bytes)) => bytes.clone(),
        other => panic!("{kind}: {other:?}"),
    }
}

fn compare(name: &str, scene: &Scene, side: u32, grid: u32) -> Seen {
    let options = square(side, grid);
    let world = World::load(scene).unwrap();
    let film = render(&world, &options, &|_| ()).unwrap().film;
    let image = |opaque, float| {
        film.image(Form { float, opaque, coverage: true, dither: false }, scene.background).unwrap()
    };
    let (whole, open) = (image(true, false), image(false, false));
    let flat = open.flattened(None).unwrap();
    let mut seen = Seen { pixels: (side * side) as usize, ..Seen::default() };
    seen.part = bytes(&open, Kind::Cvg).iter().filter(|c| (1..255).contains(*c)).count();
    for kind in COLOR {
        let pairs = bytes(&whole, kind).into_iter().zip(bytes(&flat, kind));
        let off = pairs.map(|(a, b)| a.abs_diff(b)).enumerate().max_by_key(|pair| pair.1).unwrap();
        assert!(off.1 <= 1, "{name}: {kind} of pixel {} is {} steps off", off.0, off.1);
        seen.steps = seen.steps.max(off.1);
    }
    // In floating point nothing is rounded but the numbers themselves.
    let (whole, open) = (image(true, true), image(false, true));
    let coverage = open.decoded(Kind::Cvg).unwrap();
    for (kind, background) in COLOR.into_iter().zip(scene.background.to_array()) {
        let pairs = whole.decoded(kind).unwrap().into_iter().zip(open.decoded(kind).unwrap());
        for ((whole, color), coverage) in pairs.zip(&coverage) {
            let over = f64::from(color) + (1.0 - f64::from(*coverage)) * background;
            let off = (over - f64::from(whole)).abs();
            assert!(off <= 1e-6 * f64::from(whole).max(1.0), "{name}: {over} is not {whole}");
        }
    }
    seen
}

#[expect(clippy::print_stderr, reason = "the counts are the report")]
fn check(name: &str, seen: impl Iterator<Item = Seen>) {
    let all = seen.fold(Seen::default(), |all, one| Seen {
        pixels: all.pixels + one.pixels,
        part: all.part + one.part,
        steps: all.steps.max(one.steps),
    });
    eprintln!("{name}: {all:?}");
    assert!(all.part > 0, "{name}: some pixels are covered in part");
}

fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "sdl"))
        .collect();
    found.sort();
    found
}

#[test]
fn scenes_of_the_repository() {
    let folders =
        ["scenes/wine-glass", "scenes/gallery", "scenes/optics", "docs/sdl", "docs/textures"];
    let paths = folders.iter().flat_map(|folder| scenes_in(&root().join(folder)));
    let seen = paths.filter_map(|path| {
        let compiled = compile::compile_path(&path);
        let report = compiled.report();
        let scene = compiled.scene.unwrap_or_else(|| panic!("{report}"));
        scene.camera?;
        Some(compare(&path.display().to_string(), &scene, 48, 2))
    });
    check("scenes of the repository", seen);
}

#[test]
fn random_scenes() {
    let seen = (0_u32..150).map(|seed| {
        let places = if seed % 2 == 0 { Places::Free } else { Places::Lattice };
        let scene = look::scene(30_000 + u64::from(seed), places, Site::UNIT);
        compare(&format!("random {seed}"), &scene, 24, 1 + seed % 3)
    });
    check("random scenes", seen);
}

/// Coverage and colour of the middle of a picture that looks along −z.
fn middle(text: &str) -> ([f64; 3], f64) {
    let scene = scene(&format!("{text} camera at (0, 0, 10)"));
    let world = World::load(&scene).unwrap();
    let options = Options { columns: 1, rows: 1, ..Options::default() };
    let seen = render::radiance(&world, &options, &[(0.5, 0.5)]).unwrap()[0];
    let over = seen.color + (1.0 - seen.coverage) * scene.background;
    let shown = |c: Rgb| c.to_array();
    (shown(over), seen.coverage)
}

#[test]
fn what_covers_and_what_does_not() {
    let half = 0.5_f64.sqrt();
    for (text, coverage) in [
        ("", 0.0),
        ("object is block", 1.0),
        // Two units of a pane that halves in two, once and behind each other; the tint of one is in the mean.
        ("object is trans (2, fake) block", 0.5),
        ("object is trans (2, fake) block object is trans (2, fake) block at (0, 0, -5)", 0.75),
        ("object is trans (2, fake) red block", 1.0 - (0.5 + 2.0 / 512.0) / 3.0),
        // Half of its surface is matte.
        ("object is shininess 0.5 trans (1e9, fake) block scale (1, 1, 1e-9)", 0.75),
        // Fog hides its share of what covers: to the block it is 4 units, or 4 to the pane and as much behind it.
        ("fog 4 object is block at (0, 0, 5)", 0.5),
        ("fog 4 object is trans (4, fake) block at (0, 0, 5)", 0.5 * (1.0 - half)),
        (
            "fog 4 object is trans (1e9, fake) block at (0, 0, 5) object is block at (0, 0, -1)",
            0.25,
        ),
        // Reflection and refraction cover, whatever is seen by them.
        ("object is smoothest shiniest block", 1.0),
        ("object is smoothest trans (1e9, 1.5) block", 1.0),
        ("object is smoothest trans (1e9, 1) block", 1.0),
        (
            "object is smoothest trans (1e9, 1.5) block object is trans (1e9, fake) block at (0, 0, 4)",
            1.0,
        ),
    ] {
        for background in ["black", "white", "rgb (0.2, 0.9, 0.5)"] {
            let text = format!("ambient {text} background {background}");
            let (_, found) = middle(&text);
            assert!((found - coverage).abs() < 1e-8, "{text}: {found}, expected {coverage}");
        }
    }
}

#[test]
fn what_is_seen_by_glass_is_the_background_in_full() {
    // Index 1 neither bends nor reflects: the background itself, but covered.
    let (color, coverage) = middle("background white object is trans (1e12, 1) block");
    assert!((coverage - 1.0).abs() < 1e-12, "{coverage}");
    assert!(color.iter().all(|c| (c - 1.0).abs() < 1e-9), "{color:?}");
}
