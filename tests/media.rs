//! Clear bodies of several media, in random trees and in scenes of the kind people make: the tracer against the oracle.

use glam::DVec3;
use scene::{Attributes, LightKind, Placement, Primitive, Rgb, Scene};

use crate::oracle::author::{
    Author, Chance, Shape, Site, block, clear, opaque, sphere, stands, upright,
};
use crate::random_csg::{LATER, Places, check, floor, random, random_of, stage};

const WHITE: [f64; 3] = [1.0; 3];
const WINE: [f64; 3] = [1.0, 0.1, 0.1];

/// Opaque, glass, coloured and `fake` bodies, some of them with a priority.
pub(crate) fn any_medium(chance: &mut Chance, hue: [f64; 3]) -> Attributes {
    let attributes = match chance.below(7) {
        0 | 1 => opaque(hue),
        2 | 3 => clear(WHITE, 10.0, Some(1.5)),
        4 => clear(hue, 10.0, Some(1.33)),
        5 => clear(hue, 5.0, Some(1.0)),
        _ => clear(hue, 7.0, None),
    };
    let ranks = [-1, 0, 1, 2];
    let priority = (chance.below(4) == 0).then(|| ranks[chance.below(4) as usize]);
    Attributes { priority, ..attributes }
}

fn mixed_tree(seed: u64, places: Places, site: Site) -> Scene {
    let mut author = stage(site, [3.1, 4.3, 7.7]);
    let mut chance = Chance::new(seed);
    for _ in 0..2 {
        let shape = random(&mut chance, 3, places, &mut 0, &mut any_medium);
        author.object(&shape);
    }
    author.object(&floor());
    author.finish()
}

#[test]
fn mixed_media_on_a_lattice() {
    check("mixed lattice", &Site::ALL, 32, |site| {
        (100..120).map(|seed| mixed_tree(seed, Places::Lattice, site)).collect()
    });
}

#[test]
fn mixed_media_anywhere() {
    check("mixed free", &Site::ALL, 32, |site| {
        (120..140).chain([2226, 2299]).map(|seed| mixed_tree(seed, Places::Free, site)).collect()
    });
}

#[test]
fn mixed_media_of_later_solids() {
    let scene = |site, seed, places| {
        let mut author = stage(site, [3.1, 4.3, 7.7]);
        let mut chance = Chance::new(seed);
        for _ in 0..2 {
            let shape = random_of(LATER, &mut chance, 2, places, &mut 0, &mut any_medium);
            author.object(&shape);
        }
        author.object(&floor());
        author.finish()
    };
    check("mixed later", &Site::ALL, 32, |site| {
        let lattice = (180..184).map(|seed| scene(site, seed, Places::Lattice));
        lattice.chain((184..188).map(|seed| scene(site, seed, Places::Free))).collect()
    });
}

#[test]
fn mixed_media_behind_instances() {
    check("mixed instances", &Site::INSTANCES, 32, |site| {
        let free = (145..150).chain([2413]).map(|seed| mixed_tree(seed, Places::Free, site));
        (140..145).map(|seed| mixed_tree(seed, Places::Lattice, site)).chain(free).collect()
    });
}

/// The wine glass of the paper: its bowl and the wine share a surface, and its stem stands in the wine.
fn wine_glass(unit: f64, [x, y, z]: [f64; 3], half_distance: f64) -> [Shape; 2] {
    let glass = clear(WHITE, half_distance, Some(1.65));
    let wine = clear(WINE, half_distance, Some(1.36));
    let part = |kind, height: f64, (length, radius): (f64, f64), degrees, look: &Attributes| {
        upright(kind, [x, y + height * unit, z], (length * unit, radius * unit), degrees, look)
    };
    let bowl = part(Primitive::Cone, 300.0, (400.0, 300.0), 90.0, &glass);
    let hollow = part(Primitive::Cone, 320.0, (400.0, 300.0), 90.0, &glass);
    let body = Shape::Union(vec![
        part(Primitive::Cone, 100.0, (60.5, 200.0), -90.0, &glass),
        part(Primitive::Cylinder, 0.0, (40.5, 200.0), 90.0, &glass),
        part(Primitive::Cylinder, 350.0, (300.0, 20.0), -90.0, &glass),
        bowl.minus(hollow),
    ]);
    [body, part(Primitive::Cone, 320.0, (280.0, 210.0), 90.0, &wine)]
}

#[test]
fn the_papers_wine_glass() {
    check("wine glass", &Site::ALL, 96, |site| {
        let eye = DVec3::new(0.0, 1500.0, 4000.0);
        let mut author = Author::new(site, eye, DVec3::new(0.0, 400.0, 0.0));
        wine_glass(1.0, [0.0; 3], 1000.0).iter().for_each(|shape| author.object(shape));
        author.object(&block([-2000.0, -40.0, -2000.0], [2000.0, 0.0, 2000.0], &opaque(WHITE)));
        author.object(&block([-2000.0, 0.0, -2020.0], [2000.0, 4000.0, -1980.0], &opaque(WHITE)));
        let (at, toward) = (DVec3::new(0.0, 1000.0, -100.0), DVec3::new(0.0, 0.0, -2000.0));
        let spot = LightKind::Spot { at, toward, concentration: 1.0, half_angle_degrees: 62.0 };
        author.light(spot, Rgb::splat(0.8));
        vec![author.finish()]
    });
}

#[test]
fn a_glass_on_a_planet() {
    // Far from the origin the planet's own rounding is larger than the glass is near the ground.
    check("planet", &Site::SIZES, 96, |site| {
        let mut author = Author::new(site, DVec3::new(0.0, 1.7, 5.0), DVec3::new(0.0, 0.7, 0.0));
        wine_glass(1.0 / 400.0, [0.0; 3], 10.0).iter().for_each(|shape| author.object(shape));
        author.object(&sphere([0.0, -6.4e6, 0.0], 6.4e6, &opaque([0.5, 0.7, 0.3])));
        author.object(&block([1.0, 0.0, -1.0], [1.5, 0.5, -0.5], &opaque([0.8, 0.3, 0.2])));
        author.light(LightKind::Point { at: DVec3::new(3.0, 4.0, 2.0) }, Rgb::splat(0.6));
        vec![author.finish()]
    });
}

fn aquarium(site: Site) -> Scene {
    let mut author = Author::new(site, DVec3::new(1.0, 3.0, 12.0), DVec3::new(0.0, 1.4, 0.0));
    wine_glass(1.0 / 400.0, [-1.25, 0.0, 0.5], 10.0).iter().for_each(|s| author.object(s));
    let glass = clear(WHITE, 20.0, Some(1.5));
    author.object(&Shape::Union(vec![
        block([-3.25, 0.0, -2.0], [-3.0, 3.5, 2.0], &glass),
        block([3.0, 0.0, -2.0], [3.25, 3.5, 2.0], &glass),
        block([-3.25, 0.0, 2.0], [3.25, 3.5, 2.25], &glass),
        block([-3.25, 0.0, -2.25], [3.25, 3.5, -2.0], &glass),
        block([-3.25, -0.25, -2.25], [3.25, 0.0, 2.25], &glass),
    ]));
    author.object(&sphere([1.5, 3.0, 0.0], 0.75, &opaque([0.6, 0.5, 0.4])));
    author.object(&sphere([0.5, 1.5, 0.5], 0.5, &clear(WHITE, 1e3, Some(1.0))));
    let water = clear([0.8, 0.9, 1.0], 20.0, Some(1.33));
    author.object(&block([-3.0, 0.0, -2.0], [3.0, 3.0, 2.0], &water));
    author.object(&block([-20.0, -1.0, -20.0], [20.0, -0.25, 20.0], &opaque([0.9, 0.8, 0.6])));
    author.object(&block([-20.0, -0.25, -6.0], [20.0, 10.0, -5.0], &opaque([0.6, 0.8, 0.9])));
    author.light(LightKind::Point { at: DVec3::new(4.0, 9.0, 6.0) }, Rgb::splat(0.6));
    author.finish()
}

#[test]
fn an_aquarium() {
    check("aquarium", &Site::ALL, 96, |site| vec![aquarium(site)]);
}

#[test]
fn an_aquarium_behind_instances() {
    check("aquarium instances", &Site::INSTANCES, 64, |site| vec![aquarium(site)]);
}

/// Shells a millionth thick, one of glass and one cut open, and perhaps a dome about everything.
fn shells(site: Site, dome: bool) -> Scene {
    let mut author = Author::new(site, DVec3::new(1.0, 2.0, 7.0), DVec3::new(1.0, 0.0, 0.0));
    let glass = clear(WHITE, 10.0, Some(1.5));
    let within = 1.0 - 1e-6;
    author.object(&sphere([0.0; 3], 1.0, &glass).minus(sphere([0.0; 3], within, &glass)));
    author.object(&Shape::Difference(vec![
        sphere([2.0, 0.0, 0.0], 1.0, &opaque([0.9, 0.2, 0.2])),
        sphere([2.0, 0.0, 0.0], within, &opaque([0.2, 0.9, 0.2])),
        block([1.0, 0.0, -1.0], [3.0, 2.0, 2.0], &opaque([0.2, 0.2, 0.9])),
    ]));
    author.object(&block([-6.0, -2.0, -6.0], [8.0, -1.0, 4.0], &opaque([0.8; 3])));
    if dome {
        let sky = opaque([0.4, 0.6, 0.9]);
        author.object(&sphere([0.0; 3], 1.1e9, &sky).minus(sphere([0.0; 3], 1e9, &sky)));
    }
    author.light(LightKind::Point { at: DVec3::new(4.0, 6.0, 4.0) }, Rgb::splat(0.6));
    author.finish()
}

#[test]
fn a_thin_shell() {
    check("shell", &Site::SIZES, 96, |site| vec![shells(site, false)]);
}

#[test]
fn a_thin_shell_under_a_dome() {
    check("dome", &Site::SIZES, 96, |site| vec![shells(site, true)]);
}

/// A drop of oil in water as one object, once as it is and once as instances of a class, with the outer attributes
/// given at the instance.
fn drops(site: Site) -> Scene {
    let mut author = stage(site, [3.1, 4.3, 7.7]);
    let water = clear([0.7, 0.9, 1.0], 5.0, Some(1.33));
    let oil = Attributes { priority: Some(1), ..clear([1.0, 0.9, 0.4], 3.0, Some(1.47)) };
    let bead = || sphere([0.0; 3], 0.4, &opaque([0.9, 0.2, 0.1]));
    let drop = |look: &Attributes| {
        Shape::Union(vec![
            block([-0.5, -1.0, -0.5], [0.5, 0.0, 0.5], look),
            sphere([0.0; 3], 0.75, &oil),
            bead(),
        ])
    };
    let class = author.class(&drop(&Attributes::default()));
    author.object(&Shape::Group(
        Box::new(drop(&water)),
        stands([-1.5, 0.0, 0.0], [1.0; 3]),
        Attributes::default(),
    ));
    let turned = Placement {
        rotation_degrees: DVec3::new(0.0, 90.0, 180.0),
        ..stands([0.5, 0.0, 0.0], [1.0, 1.5, 1.0])
    };
    author.object(&Shape::Instance(class, turned, water.clone()));
    let cut = Shape::Instance(class, stands([2.0, 0.0, 0.0], [1.0, 1.0, -1.0]), water);
    author.object(&cut.minus(block([2.0, -2.0, 0.0], [3.0, 2.0, 1.0], &opaque([0.2, 0.5, 0.2]))));
    author.object(&floor());
    author.finish()
}

#[test]
fn two_media_in_one_class() {
    check("drops", &Site::ALL, 96, |site| vec![drops(site)]);
    check("drops instances", &Site::INSTANCES, 64, |site| vec![drops(site)]);
}

/// Glass, water and the same glass again, overlapping, within one factor: where the first glass ends inside both others
/// there is water, though glass of the same kind reaches on.
fn sandwich(site: Site) -> Scene {
    let mut author = stage(site, [3.1, 4.3, 7.7]);
    let glass = clear([0.5, 0.9, 0.7], 4.0, Some(1.5));
    let water = clear([0.9, 0.6, 0.5], 4.0, Some(1.33));
    let [first, second, third] = [(-0.75, &glass), (0.0, &water), (0.75, &glass)]
        .map(|(x, look)| sphere([x, 0.0, 0.0], 1.25, look));
    let union = Shape::Union(vec![first, second, third]);
    author.object(&Shape::Intersection(vec![union, block([-2.5, -1.0, -0.75], [2.5; 3], &glass)]));
    author.object(&floor());
    author.finish()
}

#[test]
fn one_medium_twice_with_another_between() {
    check("sandwich", &Site::SIZES, 64, |site| vec![sandwich(site)]);
    check("sandwich instances", &Site::INSTANCES, 48, |site| vec![sandwich(site)]);
}

/// In the water with a lamp under water, murky glass and fog above: what fills the eye's and the lamp's place counts.
fn diver(site: Site) -> Scene {
    let mut author = Author::new(site, DVec3::new(2.1, 1.3, 3.7), DVec3::new(-0.5, 1.2, 0.0));
    let water = clear([0.8, 0.9, 1.0], 10.0, Some(1.33));
    author.object(&block([-4.0, 0.0, -4.0], [4.0, 2.0, 4.0], &water));
    let murky = Attributes { shininess: Some(0.6), ..clear([0.9, 0.5, 0.3], 2.0, Some(1.5)) };
    author.object(&sphere([0.0, 1.0, 0.0], 1.0, &murky).minus(block([0.0; 3], [1.0; 3], &murky)));
    let stone = opaque([0.6, 0.5, 0.4]);
    let hollow = sphere([-2.0, 0.75, 1.0], 0.75, &stone).minus(sphere(
        [-2.0, 1.25, 1.25],
        0.5,
        &clear(WHITE, 1.0, Some(1.5)),
    ));
    author.object(&hollow);
    author.object(&block([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0], &opaque([0.9, 0.8, 0.6])));
    author.object(&block([-9.0, 0.0, -9.0], [9.0, 6.0, -8.0], &opaque([0.4, 0.8, 0.5])));
    author.light(LightKind::Point { at: DVec3::new(1.1, 0.7, 1.9) }, Rgb::splat(0.5));
    author.light(LightKind::Point { at: DVec3::new(4.0, 9.0, 6.0) }, Rgb::splat(0.5));
    let mut scene = author.finish();
    scene.fog_half_distance = Some(20.0 * site.scale);
    scene
}

#[test]
fn from_under_water() {
    check("diver", &Site::ALL, 64, |site| vec![diver(site)]);
    check("diver instances", &Site::INSTANCES, 48, |site| vec![diver(site)]);
}
