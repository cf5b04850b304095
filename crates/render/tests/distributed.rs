//! Lights and lenses that have an extent, against what geometry says by hand.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use glam::DVec3;
use render::{Film, Options, Rate, Sampling, World, render};
use scene::Scene;

fn scene(text: &str) -> Scene {
    let compiled = compile::compile_text(text);
    let report = compiled.report();
    compiled.scene.unwrap_or_else(|| panic!("{report}"))
}

fn film(scene: &Scene, sampling: Sampling) -> Film {
    let options = Options { columns: 64, rows: 64, sampling, ..Options::default() };
    render(&World::load(scene).unwrap(), &options, &|_| ()).unwrap().film
}

fn light(film: &Film) -> Vec<f32> {
    film.pixels().map(|pixel| pixel.color[1]).collect()
}

/// A straight edge half way between a light and a floor, seen from above in parallel rays: 4 units wide.
const EDGE: &str = "object is block at (0, -1, 0) scale (9, 1, 9)\n\
    object is dullest black block at (-10, 5, 0) scale (10, 0.001, 10)\n\
    camera parallel at (0, 4, 0) target at (0, 0, 0) focal length 24\n\
    light at (0, 10, 0)";

#[test]
fn a_shadow_is_as_wide_as_its_light() {
    // Half way, the penumbra is as wide as the light: 2 units of the 4 that are seen.
    let shadow = |text: &str| light(&film(&scene(text), Sampling::Stochastic(Rate::Samples(256))));
    let (soft, hard) = (shadow(&format!("{EDGE} radius 1")), shadow(EDGE));
    let hidden = shadow("object is black block camera at (0, 0, 9) light at (0, 9, 9) radius 1");
    assert!(hidden.iter().all(|&light| light.abs() < 1e-6), "black stays black");
    let open = shadow(
        &EDGE
            .replace("(-10, 5, 0)", "(-40, 5, 0)")
            .replace("at (0, 10, 0)", "at (0, 10, 0) radius 1"),
    );
    for column in 0..64_u16 {
        let x = (f32::from(column) + 0.5) / 16.0 - 2.0;
        let at = 32 * 64 + usize::from(column);
        // The light is to be seen beyond −x: the part of a disc that a chord cuts off.
        let c = (-x).clamp(-1.0, 1.0);
        let share = (c.acos() - c * (1.0 - c * c).sqrt()) / std::f32::consts::PI;
        let found = soft[at] / open[at];
        assert!((found - share).abs() < 0.02, "{x}: {found}, not {share}");
        if x.abs() > 0.1 {
            let sharp = f32::from(u8::from(x > 0.0));
            assert!((hard[at] / open[at] - sharp).abs() < 0.02, "{x}: a point's shadow is sharp");
        }
    }
}

#[test]
fn one_sample_takes_the_middle_of_everything() {
    let middle = light(&film(&scene(&format!("{EDGE} radius 1")), Sampling::Grid(1)));
    assert!(middle == light(&film(&scene(EDGE), Sampling::Grid(1))), "of the light");
    let view =
        "object is sphere at (0, 0, -9) object is red sphere at (1.5, 0, 0) light at (0, 9, 9) ";
    let lens = scene(&format!("{view} camera at (0, 0, 9) aperture 50 focus at (0, 0, 0)"));
    let pinhole = scene(&format!("{view} camera at (0, 0, 9)"));
    let centre = |scene: &Scene| light(&film(scene, Sampling::Grid(1)));
    let differing =
        centre(&lens).iter().zip(centre(&pinhole)).filter(|(a, b)| (*a - b).abs() > 1e-4).count();
    assert!(differing <= 4, "of the lens, but for rounding at edges: {differing}");
    let grids = [2, 3].map(|side| light(&film(&lens, Sampling::Grid(side))));
    assert!(grids.iter().flatten().all(|light| light.is_finite()), "numbers");
}

#[test]
fn points_blur_to_the_circle_of_confusion() {
    // A small bright ball in front of black: seen through a lens of radius 1, sharp at 10, from 20 away, it is a disc
    // of radius 1 · |20 − 10| / 10 where it is, at its own distance.
    let text = "object is sphere scale 0.05 ambient intensity 1\n\
        camera at (0, 0, 20) aperture 25 focus at (0, 0, 10)";
    let scene = scene(text);
    let lens = scene.lens.unwrap();
    assert!((lens.radius(50.0) - 1.0).abs() < 1e-12, "50 mm at f/25");
    let options = Options {
        columns: 64,
        rows: 64,
        sampling: Sampling::Stochastic(Rate::Samples(1024)),
        ..Options::default()
    };
    let picture = render(&World::load(&scene).unwrap(), &options, &|_| ()).unwrap();
    // 24 mm of film behind 50 mm: at 20 it shows 9.6 units in 64 pixels.
    let pixel = 9.6 / 64.0;
    let (mut area, mut moment, mut sum) = (0.0, 0.0, 0.0);
    for (number, found) in picture.film.pixels().enumerate() {
        let at = |n: usize| (f64::from(u32::try_from(n).unwrap()) + 0.5) * pixel - 4.8;
        let place = DVec3::new(at(number % 64), at(number / 64), 0.0);
        let coverage = f64::from(found.coverage);
        sum += coverage;
        moment += coverage * place.length_squared();
        area += f64::from(u8::from(coverage > 0.0));
    }
    // The mean square distance in a disc is half the square of its radius.
    let radius = (2.0 * moment / sum).sqrt();
    assert!((radius - 1.0).abs() < 0.03, "{radius}");
    assert!(area * pixel * pixel < 4.2, "nothing is outside of the disc: {area}");
    // Nothing is lost: as much as the ball covers, π · 0.05².
    let covered = sum * pixel * pixel;
    assert!((covered / (std::f64::consts::PI * 0.0025) - 1.0).abs() < 0.1, "{covered}");
}

#[test]
fn pictures_are_the_same_on_any_number_of_threads() {
    let text = format!("{EDGE} radius 1 object is smoothest trans (9, 1.5) sphere at (0, 1, 0)");
    let scene = scene(&text);
    let world = World::load(&scene).unwrap();
    for sampling in [
        Sampling::Grid(2),
        Sampling::Subdivided { levels: 2 },
        Sampling::Stochastic(Rate::Samples(5)),
        Sampling::Stochastic(Rate::Error(3.0)),
    ] {
        let picture = |threads| {
            let options =
                Options { columns: 48, rows: 40, sampling, threads, ..Options::default() };
            let film = render(&world, &options, &|_| ()).unwrap().film;
            film.pixels().collect::<Vec<_>>()
        };
        assert!(picture(1) == picture(3), "{sampling:?}");
    }
}

#[test]
fn what_makes_no_sense_is_said() {
    for (text, message) in [
        ("camera parallel at (0, 0, 9) aperture 2", "parallel rays pass through no lens"),
        ("camera at (0, 0, 9) aperture 0", "the aperture has to be above 0"),
        ("camera at (0, 0, 9) aperture 2 focus at (0, 0, 10)", "not in front of the camera"),
        (
            "light at (0, 1, 0) radius -1 camera at (0, 0, 9)",
            "the radius of a light has to be 0 or more",
        ),
        ("light at (0, 1, 0) radius 1 radius 2 camera at (0, 0, 9)", "`radius`"),
    ] {
        let compiled = compile::compile_text(text);
        assert!(compiled.scene.is_none(), "{text}");
        assert!(compiled.report().contains(message), "{text}: {}", compiled.report());
    }
    // The words stay free for names.
    let named = "let radius = 2 let focus = 1 class aperture is sphere object is aperture scale radius camera at (0, 0, 9)";
    assert!(compile::compile_text(named).scene.is_some());
}
