//! Random expressions of all primitives, opaque, with shadows: the tracer against the oracle.

use glam::DVec3;
use render::Accel;
use scene::form::Row;
use scene::{Attributes, Form, LightKind, Placement, Primitive, Rgb, Scene};

use crate::oracle::author::{Author, Chance, Shape, Site, block, clear, opaque};
use crate::oracle::compare::{Tally, compare};

/// Where the parts of a random solid may stand.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Places {
    /// On a lattice of half units, turned by right angles: many faces coincide.
    Lattice,
    /// Anywhere, turned by any angles, stretched and mirrored.
    Free,
}

impl Places {
    fn placement(self, chance: &mut Chance, kind: Primitive) -> Placement {
        match self {
            Self::Lattice => {
                let mut half = |n: u32| f64::from(chance.below(n) + 1) * 0.5;
                let (a, b, c) = (half(3), half(3), half(3));
                let scale = match kind {
                    Primitive::Sphere => DVec3::splat(a),
                    Primitive::Block => DVec3::new(a, b, c),
                    Primitive::Cylinder | Primitive::Cone | Primitive::Paraboloid => {
                        DVec3::new(2.0 * a, b, b)
                    }
                };
                let place = DVec3::from_array([(); 3].map(|()| half(7) - 2.0));
                Placement { scale, rotation_degrees: right_angles(chance), place }
            }
            Self::Free => {
                let mut three = |low, high| {
                    DVec3::new(
                        chance.between(low, high),
                        chance.between(low, high),
                        chance.between(low, high),
                    )
                };
                let signs = three(-0.3, 1.0);
                Placement {
                    scale: three(0.4, 1.6) * signs.signum(),
                    rotation_degrees: three(-360.0, 360.0),
                    place: three(-1.5, 1.5),
                }
            }
        }
    }
}

fn right_angles(chance: &mut Chance) -> DVec3 {
    let mut angle = || f64::from(chance.below(4)) * 90.0;
    DVec3::new(angle(), angle(), angle())
}

/// A hue by its number, the golden angle apart.
fn hue(number: u32) -> [f64; 3] {
    let h = f64::from(number) * 0.381_966 % 1.0 * 6.0;
    [5.0, 3.0, 1.0].map(|n| {
        let k = (n + h) % 6.0;
        1.0 - 0.8 * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

/// A solid that random ones are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Choice {
    Convex(Primitive),
    Form(&'static str, &'static [f64]),
}

const BLOCK: Choice = Choice::Convex(Primitive::Block);
const PARABOLOID: Choice = Choice::Convex(Primitive::Paraboloid);
/// With faces on a lattice of half units.
const BRACKET: Choice = Choice::Form(
    "prism",
    &[-1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.5, 0.0, 0.5, -0.5, -0.5, -0.5, -0.5, 1.0, -1.0, 1.0],
);
const ARROW: Choice = Choice::Form("prism", &[0.0, 1.0, -0.9, -0.8, 0.1, -0.3, 0.8, -1.0]);

/// The solids of the paper, the block a little more often.
pub(crate) const CLASSIC: &[Choice] = &[
    BLOCK,
    Choice::Convex(Primitive::Sphere),
    Choice::Convex(Primitive::Cylinder),
    Choice::Convex(Primitive::Cone),
];

/// Most of them later ones.
pub(crate) const LATER: &[Choice] = &[
    Choice::Form("torus", &[0.5]),
    BRACKET,
    PARABOLOID,
    Choice::Form("torus", &[0.25]),
    BLOCK,
    ARROW,
    Choice::Convex(Primitive::Sphere),
    Choice::Form("torus", &[1.0]),
    Choice::Form("terrain", &[3.0, 0.6, 2.0]),
];

/// A random solid `depth` operators deep; `look` gives the looks of each primitive from its hue.
pub(crate) fn random(
    chance: &mut Chance,
    depth: u32,
    places: Places,
    number: &mut u32,
    look: &mut impl FnMut(&mut Chance, [f64; 3]) -> Attributes,
) -> Shape {
    random_of(CLASSIC, chance, depth, places, number, look)
}

/// The same of some solids, the first a little more often than the others.
pub(crate) fn random_of(
    kinds: &[Choice],
    chance: &mut Chance,
    depth: u32,
    places: Places,
    number: &mut u32,
    look: &mut impl FnMut(&mut Chance, [f64; 3]) -> Attributes,
) -> Shape {
    if depth == 0 || depth < 3 && chance.below(100) < 15 {
        let count = u32::try_from(kinds.len()).expect("a few");
        let kind = kinds[(chance.below(count + 1) % count) as usize];
        let shape = match kind {
            Choice::Convex(kind) => kind,
            // Reaches as far as a block.
            Choice::Form(..) => Primitive::Block,
        };
        let placement = places.placement(chance, shape);
        *number += 1;
        let attributes = look(chance, hue(*number));
        return match kind {
            Choice::Convex(kind) => Shape::Primitive(kind, placement, attributes),
            Choice::Form(word, arguments) => {
                let row = Row::named(word).expect("a row of the table");
                let form = Form::new(row, arguments).expect("arguments that fit");
                Shape::Form(form, placement, attributes)
            }
        };
    }
    // Wide operators are evaluated in other ways than narrow ones.
    let count = if depth <= 2 && chance.below(5) == 0 { 5 } else { 2 };
    let mut part = || random_of(kinds, chance, depth - 1, places, number, look);
    let parts = (0..count).map(|_| part()).collect();
    let joined = match chance.below(10) {
        0..5 => Shape::Union(parts),
        5..8 => Shape::Difference(parts),
        _ => Shape::Intersection(parts.into_iter().take(2).collect()),
    };
    if chance.below(5) > 0 {
        return joined;
    }
    let place = DVec3::from_array([(); 3].map(|()| f64::from(chance.below(3)) * 0.5 - 0.5));
    let rotation_degrees = match places {
        Places::Lattice => right_angles(chance),
        Places::Free => DVec3::new(33.0, -71.0, 12.5),
    };
    let scale = DVec3::new(1.0, 1.0, if chance.below(2) == 0 { 1.0 } else { -1.0 });
    let placement = Placement { scale, rotation_degrees, place };
    Shape::Group(Box::new(joined), placement, Attributes::default())
}

/// A stage with a floor and three kinds of light.
pub(crate) fn stage(site: Site, eye: [f64; 3]) -> Author {
    let mut author = Author::new(site, DVec3::from_array(eye), DVec3::ZERO);
    author.light(LightKind::Point { at: DVec3::new(2.0, 9.0, 4.0) }, Rgb::splat(0.6));
    let (at, toward) = (DVec3::new(-6.0, 5.0, 7.0), DVec3::new(0.0, 0.5, 0.0));
    author.light(LightKind::Beam { at, toward }, Rgb::new(0.2, 0.2, 0.1));
    let (at, toward) = (DVec3::new(5.0, 3.0, 6.0), DVec3::ZERO);
    let spot = LightKind::Spot { at, toward, concentration: 3.0, half_angle_degrees: 20.0 };
    author.light(spot, Rgb::new(0.1, 0.2, 0.3));
    author
}

pub(crate) fn floor() -> Shape {
    block([-8.0, -4.0, -8.0], [8.0, -3.0, 8.0], &opaque([0.8; 3]))
}

const OBLIQUE: [f64; 3] = [3.1, 4.3, 7.7];
/// Along an axis: in a picture of odd sides, rays lie in lattice planes but for the distance the eye is moved.
const AXIS: [f64; 3] = [0.0, 0.0, 9.0];

fn opaque_tree(kinds: &[Choice], seed: u64, places: Places, eye: [f64; 3], site: Site) -> Scene {
    let mut author = stage(site, eye);
    let mut look = |_: &mut Chance, color| opaque(color);
    let shape = random_of(kinds, &mut Chance::new(seed), 4, places, &mut 0, &mut look);
    author.object(&shape);
    author.object(&floor());
    author.finish()
}

/// Compares the pictures of many scenes at many sites.
pub(crate) fn check(name: &str, sites: &[Site], side: u32, scenes: impl Fn(Site) -> Vec<Scene>) {
    let mut all = Tally::default();
    for &site in sites {
        let mut tally = Tally::default();
        for (number, scene) in scenes(site).iter().enumerate() {
            let found = compare(scene, (side, side), Accel::Bvh);
            if !found.wrong.is_empty() {
                found.report(&format!("  {name} number {number} {site:?}"));
            }
            tally.add(found);
        }
        tally.report(&format!("{name} {site:?}"));
        all.add(tally);
    }
    assert!(all.wrong.is_empty(), "{name}: {} wrong of {}", all.wrong.len(), all.pixels);
}

fn trees(
    seeds: impl Iterator<Item = u64> + Clone,
    places: Places,
    eye: [f64; 3],
) -> impl Fn(Site) -> Vec<Scene> {
    trees_of(CLASSIC, seeds, places, eye)
}

fn trees_of(
    kinds: &'static [Choice],
    seeds: impl Iterator<Item = u64> + Clone,
    places: Places,
    eye: [f64; 3],
) -> impl Fn(Site) -> Vec<Scene> {
    move |site| seeds.clone().map(|seed| opaque_tree(kinds, seed, places, eye, site)).collect()
}

#[test]
fn later_solids_on_a_lattice() {
    check("later lattice", &Site::ALL, 32, trees_of(LATER, 70..80, Places::Lattice, OBLIQUE));
}

#[test]
fn later_solids_anywhere() {
    check("later free", &Site::ALL, 32, trees_of(LATER, 80..90, Places::Free, OBLIQUE));
}

#[test]
fn later_solids_behind_instances() {
    check("later instances", &Site::INSTANCES, 32, trees_of(LATER, 90..93, Places::Free, OBLIQUE));
}

#[test]
fn opaque_on_a_lattice() {
    check("lattice", &Site::ALL, 40, trees(0..20, Places::Lattice, OBLIQUE));
}

#[test]
fn opaque_on_a_lattice_seen_along_an_axis() {
    check("axis", &Site::ALL, 41, trees((20..30).chain([1287, 1214]), Places::Lattice, AXIS));
}

#[test]
fn opaque_anywhere() {
    check("free", &Site::ALL, 40, trees(30..50, Places::Free, OBLIQUE));
}

#[test]
fn opaque_behind_instances() {
    check("instances", &Site::INSTANCES, 40, trees(50..60, Places::Lattice, OBLIQUE));
}

/// The wall at x = 0 is left by a cut that is written before the factor whose face lies there, too. One of the pits is
/// cut twice: by something clear, which leaves a mirror, and later by something opaque.
fn many_cuts(site: Site) -> Scene {
    let mut author = stage(site, OBLIQUE);
    let cut = |x: f64, look: &Attributes| block([x, -0.25, 0.5], [x + 0.25, 0.25, 2.0], look);
    let side = block([-2.0; 3], [0.0, 2.0, 2.0], &opaque(hue(1)));
    let (glass, green) = (clear([1.0; 3], 1.0, Some(1.5)), opaque(hue(2)));
    author.object(&Shape::Intersection(vec![
        Shape::Difference(vec![
            block([-1.5; 3], [1.5; 3], &opaque(hue(0))),
            side,
            cut(0.25, &green),
            cut(0.625, &glass),
            cut(0.625, &green),
            cut(1.0, &green),
        ]),
        block([0.0, -1.0, -1.0], [2.0, 1.0, 1.0], &opaque(hue(3))),
    ]));
    author.object(&floor());
    author.finish()
}

#[test]
fn the_earlier_surface_shows_however_many_cuts_there_are() {
    // From the side of the wall, and into the pits.
    let seen = |site| {
        let from_the_right = many_cuts(site);
        let mut scene = from_the_right.clone();
        if let Some(camera) = &mut scene.camera {
            camera.position.x = 2.0 * camera.target.x - camera.position.x;
        }
        vec![scene, from_the_right]
    };
    check("many cuts", &Site::SIZES, 40, seen);
}
