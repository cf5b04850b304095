//! Sizes and places: one scene written with other numbers, all scenes changed as data.

use std::fs;

use glam::DVec3;
use render::{Options, Rate, Sampling};
use scene::{Lens, Scene};

use super::algebra::joined;
use crate::oracle::compare::evaluated;

use super::case::{Case, Found, Peer, Promise, Written};
use super::extreme;
use super::long::unfinite;
use super::place::{against, differing, mirrored, moved, options, scaled, turned_over};
use crate::support::{Shown, root, shown};

const SIZE: &str = "Everything larger or smaller";
const PLACE: &str = "Everything far from the origin";
const MIRROR: &str = "Mirrored";
const SOFT: &str = "Lenses and lights of extreme width";
/// Random scenes of a row.
const RANDOM: u64 = 200;

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = numbers();
    cases.extend(sizes());
    cases.extend(places());
    cases.extend(mirrors());
    cases.extend(widths());
    cases
}

/// A file with other numbers in it.
fn numbers() -> Vec<Case> {
    let mut cases = Vec::new();
    for decade in [-12, -10, -8, -6, -4, -2, 2, 4, 6, 8, 10, 12] {
        let unit = libm::exp10(f64::from(decade));
        let written = Written::new("anywhere.sdl", &[("unit", unit)]);
        cases.push(rewritten(SIZE, format!("anywhere × 1e{decade}"), Promise::Alike, written));
    }
    for decade in 0..=9 {
        let away = libm::exp10(f64::from(decade));
        let written = Written::new("anywhere.sdl", &[("away", away)]);
        let promise = if decade < 9 { Promise::Alike } else { Promise::Nearly };
        cases.push(rewritten(PLACE, format!("anywhere + 1e{decade}"), promise, written));
    }
    cases.push(Case::new(PLACE, "anywhere + 1e9, the evaluator's", Promise::Nearly, || {
        let seen =
            |away| evaluated(&Written::new("anywhere.sdl", &[("away", away)]).scene(), &options());
        let step = |light: f64| 255.0 * idf::Transfer::Srgb.encode(light.clamp(0.0, 1.0));
        let apart =
            |(a, b): &([f64; 3], [f64; 3])| (0..3).any(|k| (step(a[k]) - step(b[k])).abs() > 1.0);
        let (base, moved) = (seen(0.0), seen(1e9));
        let wrong = base.iter().copied().zip(moved.iter().copied()).filter(apart).count();
        Found::differing(wrong, base.len())
    }));
    for (unit, away) in [(1e-12, 1e-3), (1e-6, 1e3), (1e6, 1e15), (1e12, 1e21)] {
        let written = Written::new("anywhere.sdl", &[("unit", unit), ("away", away)]);
        let name = format!("anywhere × {unit:e} + {away:e}");
        cases.push(rewritten(PLACE, name, Promise::Nearly, written));
    }
    cases
}

/// How a scene differs from itself in another size.
fn resized(factor: f64, steps: u8) -> impl Fn(Scene, &Shown, &Options) -> Found {
    move |scene, base, options| against(&scaled(scene, factor), base, options, steps)
}

fn sizes() -> Vec<Case> {
    let mut cases = Vec::new();
    // The last two are beyond single precision, in which boxes are.
    for power in [-40, -7, 1, 23, 40, -140, 140] {
        let factor = libm::exp2(f64::from(power));
        let name = |what: &str| format!("{what} × 2^{power}");
        // Down there a detail of a millionth reaches the end of single precision.
        let (promise, steps) = if power > -140 { (Promise::Same, 0) } else { (Promise::Alike, 1) };
        cases.push(Case::new(SIZE, name("every scene"), promise, move || {
            every_scene(resized(factor, steps))
        }));
        cases.push(Case::new(SIZE, name("random scenes"), Promise::Same, move || {
            random_scenes(resized(factor, 0))
        }));
    }
    for power in [-40, 40] {
        let factor = libm::exp2(f64::from(power));
        let name = format!("soft lights and a lens × 2^{power}");
        cases.push(Case::new(SIZE, name, Promise::Same, move || {
            let base = shown(&soft(2.0, 0.5), &lots());
            against(&scaled(soft(2.0, 0.5), factor), &base, &lots(), 0)
        }));
    }
    for decade in [-12, -5, 5, 12] {
        let factor = libm::exp10(f64::from(decade));
        let name = |what: &str| format!("{what} × 1e{decade}");
        cases.push(Case::new(SIZE, name("every scene"), Promise::Alike, move || {
            every_scene(resized(factor, 1))
        }));
        cases.push(Case::new(SIZE, name("random solids"), Promise::Alike, move || {
            random_solids(resized(factor, 1))
        }));
    }
    cases
}

/// How a scene differs from itself in another place.
fn displaced(away: f64) -> impl Fn(Scene, &Shown, &Options) -> Found {
    let by = away * DVec3::new(1.0, -0.7, 0.9);
    move |scene, base, options| against(&moved(scene, by), base, options, 1)
}

fn places() -> Vec<Case> {
    let mut cases = Vec::new();
    for (away, name) in [(1.0 / 3.0, "1/3"), (1e3, "1e3"), (1e6, "1e6")] {
        let name = format!("random solids + {name}");
        cases.push(Case::new(PLACE, name, Promise::Alike, move || random_solids(displaced(away))));
    }
    for (away, name) in [(1.0 / 3.0, "1/3"), (1e3, "1e3"), (1e4, "1e4")] {
        let name = format!("every scene + {name}");
        cases.push(Case::new(PLACE, name, Promise::Alike, move || every_scene(displaced(away))));
    }
    for away in [1e5, 1e6] {
        let name = format!("every scene without detail below 1e-4 + {away:e}");
        cases.push(Case::new(PLACE, name, Promise::Alike, move || {
            let fine = ["detail.sdl", "shells.sdl", "slender.sdl", "flake.sdl"];
            every_scene_but(&fine, displaced(away))
        }));
    }
    cases
}

fn mirrors() -> Vec<Case> {
    let seen = |scene, base: &Shown, options: &Options| {
        differing(&turned_over(&shown(&mirrored(scene), options)), base, 1)
    };
    let painted = |scene: &Scene| scene.attributes.iter().any(|set| !set.paint.is_empty());
    vec![
        Case::new(MIRROR, "every scene without paint", Promise::Alike, move || {
            every_scene(
                |scene, base, options| {
                    if painted(&scene) { Found::NONE } else { seen(scene, base, options) }
                },
            )
        }),
        Case::new(MIRROR, "random solids", Promise::Alike, move || random_solids(seen)),
    ]
}

fn widths() -> Vec<Case> {
    let alike = |name, aperture, radius| {
        Case::new(SOFT, name, Promise::Alike, move || {
            let base = shown(&soft(0.0, 0.0), &lots());
            against(&soft(aperture, radius), &base, &lots(), 1)
        })
    };
    vec![
        alike("a lens of aperture 1e9 against a pinhole", 1e9, 0.0),
        alike("lights of radius 1e-9 against points", 0.0, 1e-9),
        Case::new(SOFT, "numbers at aperture 1e-3 and radius 1e6", Promise::Right, || {
            unfinite(&soft(1e-3, 1e6), &lots())
        }),
    ]
}

fn rewritten(section: &'static str, name: String, promise: Promise, written: Written) -> Case {
    let case = written.clone();
    Case::new(section, name, promise, move || {
        let base = shown(&Written::new(case.file, &[]).scene(), &options());
        against(&case.scene(), &base, &options(), 1)
    })
    .beside(Peer::Itself(written))
}

/// All scenes of `scenes/` that have a camera.
pub(crate) fn scenes() -> Vec<(String, Scene)> {
    let mut found = Vec::new();
    let folders = fs::read_dir(root().join("scenes")).expect("there are scenes");
    for folder in folders.map(|entry| entry.expect("a folder").path()).filter(|path| path.is_dir())
    {
        for file in fs::read_dir(folder).expect("a folder") {
            let path = file.expect("a file").path();
            if path.extension().is_some_and(|ending| ending == "sdl") {
                let scene = compile::compile_path(&path).scene.expect("scenes compile");
                if scene.camera.is_some() {
                    found.push((path.display().to_string(), scene));
                }
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// Sums what is found in all scenes of `scenes/`, at a small size.
fn every_scene(find: impl Fn(Scene, &Shown, &Options) -> Found) -> Found {
    every_scene_but(&[], find)
}

/// [`every_scene`] but those of some names.
fn every_scene_but(left_out: &[&str], find: impl Fn(Scene, &Shown, &Options) -> Found) -> Found {
    let options = Options { columns: 60, rows: 45, ..Options::default() };
    scenes().into_iter().fold(Found::NONE, |sum, (path, scene)| {
        if left_out.iter().any(|name| path.contains(name)) {
            return sum;
        }
        let base = shown(&scene, &options);
        sum.and(find(scene, &base, &options))
    })
}

/// [`random_scenes`] at the origin, of ordinary sizes, on a lattice.
fn random_solids(find: impl Fn(Scene, &Shown, &Options) -> Found) -> Found {
    let options = Options { columns: 16, rows: 16, ..Options::default() };
    (0..RANDOM).fold(Found::NONE, |sum, seed| {
        let scene = joined(seed);
        let base = shown(&scene, &options);
        sum.and(find(scene, &base, &options))
    })
}

/// Rays through all of a lens to all of a light.
fn lots() -> Options {
    let sampling = Sampling::Stochastic(Rate::Samples(4));
    Options { columns: 60, rows: 45, sampling, ..Options::default() }
}

/// Boxes on a floor under a light of this radius, seen through a lens of this aperture; 0 is none.
fn soft(aperture: f64, radius: f64) -> Scene {
    let mut scene = Written::new("contact.sdl", &[]).scene();
    scene.lights.iter_mut().for_each(|light| light.radius = radius);
    scene.lens = (aperture > 0.0).then(|| Lens { aperture, focus: DVec3::new(0.2, 0.6, 0.3) });
    scene
}

fn random_scenes(find: impl Fn(Scene, &Shown, &Options) -> Found) -> Found {
    let options = Options { columns: 16, rows: 16, ..Options::default() };
    (0..RANDOM).fold(Found::NONE, |sum, seed| {
        let scene = extreme::scene(seed).1;
        let base = shown(&scene, &options);
        sum.and(find(scene, &base, &options))
    })
}
