//! What a scene does not need is left out, and nothing of that can be seen.

use render::{Accel, LoadOptions, Options, World, render};
use scene::{Attributes, Placement, Primitive, Scene};

use crate::media;
use crate::oracle::author::{Chance, Shape, Site};
use crate::radiance::look;
use crate::random_csg::{self, LATER, Places};
use crate::support::{Shown, root, scene};

const SIDE: u32 = 24;

/// A picture, and how many are left of what each pass looks at.
fn pictured(scene: &Scene, keep_all: bool, accel: Accel) -> (Vec<[u32; 4]>, World) {
    pictured_with(scene, LoadOptions { keep_all, ..LoadOptions::default() }, accel)
}

fn pictured_with(scene: &Scene, load: LoadOptions, accel: Accel) -> (Vec<[u32; 4]>, World) {
    let options = Options { columns: SIDE, rows: SIDE, accel, ..Options::default() };
    let load = LoadOptions { picture: Some((SIDE, SIDE)), ..load };
    let world = World::load_with(scene, &load).expect("it loads");
    let picture = render(&world, &options, &|_| ()).expect("threads");
    let bits = |pixel: render::Pixel| {
        let [red, green, blue] = pixel.color.map(f32::to_bits);
        [red, green, blue, pixel.coverage.to_bits()]
    };
    (picture.film.pixels().map(bits).collect(), world)
}

/// Small solids here and there, added to a ball, cut out of it and clipped to, in turn.
fn chain(chance: &mut Chance, length: u32) -> Shape {
    let mut chain = ball(chance, 2.0);
    for _ in 0..length {
        let next = ball(chance, 0.7);
        chain = match chance.below(7) {
            0..4 => chain.plus(next),
            4..6 => chain.minus(next),
            _ => Shape::Intersection(vec![chain, ball(chance, 3.5)]),
        };
    }
    chain
}

#[test]
fn long_chains_are_what_the_oracle_says() {
    let scenes = |site| {
        let scene = |seed: u64| {
            let chance = &mut Chance::new(7000 + seed);
            let mut author = random_csg::stage(site, [3.1, 4.3, 7.7]);
            let length = 30 + chance.below(60);
            author.object(&chain(chance, length));
            author.object(&random_csg::floor());
            author.finish()
        };
        (0..4).map(scene).collect()
    };
    random_csg::check("chains", &[Site::ALL[0], Site::ALL[4], Site::INSTANCES[3]], 32, scenes);
}

/// Scenes of every kind, one for each number.
fn random_scene(number: u64) -> Scene {
    let chance = &mut Chance::new(9000 + number);
    let site = Site::ALL[(number % 6) as usize];
    let places = if number.is_multiple_of(2) { Places::Lattice } else { Places::Free };
    if number.is_multiple_of(3) {
        // All attributes, paint and lights.
        return look::scene(number, places, Site::UNIT);
    }
    let mut author = random_csg::stage(site, [3.1, 4.3, 7.7]);
    let kinds = if number.is_multiple_of(5) { LATER } else { random_csg::CLASSIC };
    let depth = 2 + chance.below(4);
    let mut look = media::any_medium;
    let solid = random_csg::random_of(kinds, chance, depth, places, &mut 0, &mut look);
    author.object(&solid);
    if chance.below(2) == 0 {
        let length = chance.below(40);
        author.object(&chain(chance, length));
    }
    author.object(&random_csg::floor());
    author.finish()
}

fn ball(chance: &mut Chance, size: f64) -> Shape {
    let mut within = |reach: f64| chance.between(-reach, reach);
    let placement = Placement {
        scale: glam::DVec3::splat(size),
        place: glam::DVec3::new(within(2.0), within(2.0), within(2.0)),
        ..Placement::default()
    };
    Shape::Primitive(Primitive::Sphere, placement, Attributes::default())
}

#[test]
fn five_hundred_scenes_are_the_same_with_all_of_them() {
    let mut taken = 0;
    for number in 0..500 {
        let scene = random_scene(number);
        let (found, world) = pictured(&scene, false, Accel::Bvh);
        assert!(found == pictured(&scene, true, Accel::Bvh).0, "{number}");
        if number.is_multiple_of(10) {
            for accel in [
                Accel::None,
                Accel::Boxes,
                Accel::Flat,
                Accel::Slanted,
                Accel::Coherence,
                Accel::Remembered,
            ] {
                assert!(found == pictured(&scene, false, accel).0, "{number} by {accel:?}");
            }
        }
        // Without one of the passes, each in its turn.
        let passes = world.omissions();
        let turn = usize::try_from(number).expect("a few hundred") % passes.len();
        let keep_pass = Some(passes[turn].name);
        let only = LoadOptions { keep_pass, ..LoadOptions::default() };
        assert!(found == pictured_with(&scene, only, Accel::Bvh).0, "{number}: {keep_pass:?}");
        if number.is_multiple_of(3) {
            let glossy =
                |keep_all| LoadOptions { keep_all, glossy: true, ..LoadOptions::default() };
            let [left, kept] =
                [false, true].map(|keep_all| pictured_with(&scene, glossy(keep_all), Accel::Bvh).0);
            assert!(left == kept, "{number}, glossy");
        }
        let stages = ["fog", "paint"];
        let passes = world.omissions().iter().filter(|pass| !stages.contains(&pass.name));
        taken += u64::from(passes.map(|pass| pass.before - pass.after).sum::<u64>() > 0);
    }
    assert!(taken > 100, "{taken} scenes have something to leave out");
}

const VIEW: &str = "camera at (0, 0, 20) background light blue ambient intensity 0.3 ";

/// Loads a scene: the pass named leaves `after` of `before`, and the picture is the same without it.
fn check(pass: &str, text: &str, before: u64, after: u64) {
    let scene = scene(&format!("{VIEW} {text}"));
    let (found, world) = pictured(&scene, false, Accel::Bvh);
    let row = world.omissions().iter().find(|row| row.name == pass);
    let row = row.unwrap_or_else(|| panic!("no pass {pass}"));
    assert_eq!((row.before, row.after), (before, after), "{pass}: {text}");
    let left = world.primitives_left();
    let only = LoadOptions { keep_pass: Some(row.name), ..LoadOptions::default() };
    let (kept, alone) = pictured_with(&scene, only, Accel::Bvh);
    assert!(found == kept, "{pass} alone: {text}");
    let (kept, world) = pictured(&scene, true, Accel::Bvh);
    assert!(found == kept, "{pass}: {text}");
    assert_eq!(world.primitives_left(), world.stands_for(), "nothing is left out: {text}");
    let between = (left..=world.stands_for()).contains(&alone.primitives_left());
    assert!(between, "{pass} alone: {text}");
    let same = world.omissions().iter().any(|row| row.name == pass && row.before == before);
    assert!(same, "{pass} looks at the same: {text}");
}

#[test]
fn what_is_left_out_is_not_counted() {
    let text = "class pair is sphere + sphere at (2, 0, 0)
        object is pair object is (pair at (0, 3, 0)) - block at (0, 90, 0)
        object is sphere * block at (9, 0, 0)";
    let scene = scene(&format!("{VIEW} {text}"));
    let left = |keep_all| pictured(&scene, keep_all, Accel::Bvh).1.primitives_left();
    // Two pairs, a far block, and an intersection of nothing.
    assert_eq!((left(true), left(false)), (7, 4));
}

/// A pass, a scene, and how many it leaves of how many.
const PASSES: &[(&str, &str, u64, u64)] = &[
    ("empty", "object is sphere * (sphere at (9, 0, 0))", 1, 0),
    ("empty", "object is sphere * (sphere at (2, 0, 0))", 1, 1),
    ("apart", "object is sphere - (block at (9, 0, 0)) - (block at (0.5, 0, 0))", 2, 1),
    // A finger's breadth closer, and their boxes touch.
    ("apart", "object is sphere - (block at (2.001, 0, 0)) - (block at (2, 0, 0))", 2, 1),
    ("outside", "object is (sphere + (block at (9, 0, 0))) * (block scale 2)", 2, 1),
    ("repeated", "object is sphere + block + sphere", 3, 2),
    ("repeated", "object is sphere + block + red sphere", 3, 3),
    ("repeated", "object is sphere + trans (5, 1.5) sphere", 2, 2),
    ("inside", "object is block scale 3 object is sphere object is sphere at (3, 0, 0)", 3, 2),
    // Against a face from within.
    ("inside", "object is block scale 3 object is sphere at (2, 0, 0)", 2, 2),
    ("inside", "object is trans (5, 1.5) block scale 3 object is sphere", 2, 2),
    // The eye is in it, and sees what else is.
    ("inside", "object is block scale 30 object is sphere", 2, 2),
    ("unreached", "object is sphere object is sphere at (0, 0, 40)", 2, 1),
    ("unreached", "object is shiny smoothest sphere object is sphere at (0, 0, 40)", 2, 2),
    ("unreached", "object is trans (5, 1.5) sphere object is sphere at (0, 0, 40)", 2, 2),
    ("unreached", "object is trans (5, fake) sphere object is sphere at (0, 0, 40)", 2, 1),
    // Its shadow falls into view.
    ("unreached", "object is sphere object is sphere at (0, 0, 40) light at (0, 0, 60)", 2, 2),
    (
        "unreached",
        "object is sphere object is sphere at (0, 0, 40) light at (0, 0, 60) no shadows",
        2,
        1,
    ),
    ("dark", "object is sphere light at (5, 5, 5) light at (5, 5, 5) intensity 0", 2, 1),
    (
        "dark",
        "object is sphere light spot (1, 20) at (9, 0, 0) toward (20, 0, 0) \
             light spot (1, 20) at (9, 0, 0) toward (0, 2, 0)",
        2,
        1,
    ),
    ("unstopped", "object is sphere light at (5, 5, 5)", 1, 0),
    ("unstopped", "object is sphere object is sphere at (0, 3, 0) light at (0, 9, 0)", 1, 1),
    ("unstopped", "object is sphere object is sphere at (0, 3, 0) light at (9, 0, 0)", 1, 1),
    ("unstopped", "object is sphere object is sphere at (0, 3, 0) light at (9, 1.5, 0)", 1, 0),
    ("unstopped", "object is sphere - block at (1, 0, 0) light at (9, 0, 0)", 1, 1),
    ("hidden paint", "object is trans (5, 1.5) paint checker red sphere", 1, 0),
    ("hidden paint", "object is trans (5, 1.5) dull paint checker red sphere", 1, 1),
    ("hidden paint", "object is paint checker red sphere", 1, 1),
    // The face of the cut is opaque, and has the paint of what cuts it.
    (
        "hidden paint",
        "object is sphere * (trans (5, 1.5) paint checker red block at (1, 0, 0))",
        1,
        1,
    ),
    ("fog", "object is sphere", 1, 0),
    ("fog", "object is sphere fog 30", 1, 1),
    ("paint", "object is sphere", 1, 0),
    ("paint", "object is paint checker red sphere", 1, 1),
    (
        "unstopped",
        "object is sphere object is sphere at (0, 3, 0) light at (9, 1.5, 0) radius 0.3",
        1,
        0,
    ),
    (
        "unstopped",
        "object is sphere object is sphere at (0, 3, 0) light at (9, 1.5, 0) radius 3",
        1,
        1,
    ),
    ("unstopped", "object is sphere light beam at (9, 9, 9) radius 1", 1, 0),
    (
        "unstopped",
        "object is sphere object is sphere at (0, 9, 0) light beam at (9, 0, 0) radius 1",
        1,
        1,
    ),
    ("dark", "object is sphere light spot (1, 20) at (9, 0, 0) toward (20, 0, 0) radius 1", 1, 1),
    (
        "unreached",
        "object is sphere object is sphere at (9, 0, 20) light at (9, 0, -20) no shadows",
        2,
        1,
    ),
];

#[test]
fn each_pass_takes_what_it_is_for_and_no_more() {
    for &(pass, text, before, after) in PASSES {
        check(pass, text, before, after);
    }
}

/// A row of balls as a class of two of a class of two of …: all but the ends coincide many times.
fn row(levels: u32) -> String {
    let class = |level: u32| {
        let inner = level - 1;
        format!("class c{level} is c{inner} + c{inner} at (1, 0, 0)\n")
    };
    let classes: String = (1..=levels).map(class).collect();
    format!("class c0 is shiny red sphere scale 0.4\n{classes} object is c{levels} at (-9, 0, 0)")
}

#[test]
fn copies_that_coincide_are_one() {
    let lights = "light at (5, 9, 9)";
    // 2^18 balls, and 2^40, in 19 and 41 places: only the first ones are seen here.
    let pictures = [18, 40].map(|levels| {
        let scene = scene(&format!("{VIEW} {lights} {}", row(levels)));
        let (found, world) = pictured(&scene, false, Accel::Bvh);
        assert!(world.leaf_count() < 100, "{} primitives in memory", world.leaf_count());
        found
    });
    let balls: String = (-9..10)
        .map(|x| format!("object is shiny red sphere scale 0.4 at ({x}, 0, 0)\n"))
        .collect();
    let options = Options { columns: SIDE, rows: SIDE, ..Options::default() };
    let show = |text: &str| {
        let scene = scene(&format!("{VIEW} {lights} {text}"));
        let world = World::load(&scene).expect("it loads");
        let picture = render(&world, &options, &|_| ()).expect("threads");
        Shown::new(&picture.film, scene.background)
    };
    let differing = show(&row(18)).differing(&show(&balls), 0);
    assert!(differing.is_empty(), "{} pixels differ from balls in a row", differing.len());
    let same = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a == b).count();
    assert!(same > 540, "{same} of 576 pixels see the same in a row that goes on beyond the rim");
}

#[test]
fn definitions_that_nothing_comes_to_do_not_show() {
    let mut tried = 0;
    for folder in ["gallery", "wine-glass", "station", "optics"] {
        for file in std::fs::read_dir(root().join("scenes").join(folder)).expect("it is there") {
            let path = file.expect("it can be listed").path();
            if path.extension().is_none_or(|ending| ending != "sdl") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("it can be read");
            let text = format!("class lone_one is rgb (0.1, 0.2, 0.3) cone\n{text}");
            let sources = compile::SourceMap::from_reader(&path, text.as_bytes());
            let mut sources = sources.expect("it is text");
            let (scene, _) = compile::compile(&mut sources, &compile::Options::default());
            let Some(scene) = scene.filter(|scene| scene.camera.is_some()) else { continue };
            let mut left = scene.clone();
            let omissions = compile::omit::leave_out(&mut left);
            let all_have = omissions[..2].iter().all(|pass| pass.before > pass.after);
            assert!(all_have, "{}: {omissions:?}", path.display());
            tried += 1;
            let pictures = [&scene, &left].map(|scene| pictured(scene, false, Accel::Bvh).0);
            assert!(pictures[0] == pictures[1], "{}", path.display());
        }
    }
    assert!(tried > 12, "{tried} scenes");
}
