//! Random scenes of more kinds at the limits of numbers: long chains, classes in classes, solids with arguments, gaps of
//! about a bound of rounding, lattices of glass, parallel rays, fog.

use glam::DVec3;
use scene::form::Row;
use scene::{Attributes, Form, LightKind, Placement, Primitive, Rgb, Scene};

use super::extreme::{self, decade, direction, look, turn, vector};
use crate::oracle::author::{Author, Chance, Shape, Site, Writing, clear, opaque};

/// What is extreme about a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fresh {
    /// Twenty to sixty operators in turn, of all media, on faces that coincide.
    Chains,
    /// Classes in classes, each turned, stretched and moved.
    Nested,
    /// Tori, prisms and terrain: shells, copies a gap apart, and on each other.
    Forms,
    /// Copies a quarter to eight bounds of rounding apart.
    Bounds,
    /// Glass and water on a lattice, a billionth and a billion times as large.
    Glass,
    /// Rays are parallel.
    Parallel,
    /// Fog that halves light within a thousandth of the scene, or a thousand of them.
    Fog,
}

impl Fresh {
    pub(crate) const ALL: [Self; 7] = [
        Self::Chains,
        Self::Nested,
        Self::Forms,
        Self::Bounds,
        Self::Glass,
        Self::Parallel,
        Self::Fog,
    ];

    /// What the page says.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Chains => "chains of 20 … 60 operators of several media",
            Self::Nested => "classes in classes, turned and stretched",
            Self::Forms => "tori, prisms and terrain: shells, copies, contact",
            Self::Bounds => "faces a quarter to eight rounding bounds apart",
            Self::Glass => "lattices of glass × 1e-9 and 1e9",
            Self::Parallel => "parallel rays, in and along faces",
            Self::Fog => "fog of 1e-3 … 1e3 scenes",
        }
    }
}

type Bodies = Vec<(Primitive, Placement)>;

fn bodies(kind: extreme::Kind, chance: &mut Chance, count: u32) -> Bodies {
    let mut bodies = Bodies::new();
    for _ in 0..count {
        let next = extreme::place(kind, chance, &bodies);
        bodies.push(next);
    }
    bodies
}

/// Kinds of bodies that touch.
fn touching(chance: &mut Chance) -> extreme::Kind {
    [extreme::Kind::Lattice, extreme::Kind::Contact][chance.below(2) as usize]
}

/// Few looks, so that neighbours often have the same.
fn looks(chance: &mut Chance, clear_share: u32) -> Vec<Attributes> {
    (0..3).map(|_| look(chance, clear_share)).collect()
}

fn one<'a, T>(chance: &mut Chance, of: &'a [T]) -> &'a T {
    &of[chance.below(u32::try_from(of.len()).expect("a few")) as usize]
}

fn chain(chance: &mut Chance) -> (Shape, Bodies) {
    let kind = touching(chance);
    let bodies = bodies(kind, chance, 6);
    let looks = looks(chance, 60);
    let leaf = |chance: &mut Chance| {
        let (solid, placement) = *one(chance, &bodies);
        Shape::Primitive(solid, placement, one(chance, &looks).clone())
    };
    let mut all = leaf(chance);
    for _ in 0..20 + chance.below(41) {
        let next = leaf(chance);
        all = match chance.below(9) {
            0..4 => all.plus(next),
            4..8 => all.minus(next),
            _ => Shape::Intersection(vec![all, next.plus(leaf(chance))]),
        };
    }
    (all, bodies)
}

/// One of the solids with arguments, about as large as a ball.
fn form(chance: &mut Chance) -> Form {
    let (word, arguments): (&str, &[f64]) = *one(
        chance,
        &[
            ("torus", &[0.5][..]),
            ("torus", &[0.05]),
            ("torus", &[1.0]),
            ("prism", &[-1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.5, 0.0, 0.5, 1.0, -1.0, 1.0]),
            ("prism", &[0.0, 1.0, -0.9, -0.8, 0.1, -0.3, 0.8, -1.0]),
            ("terrain", &[3.0, 0.6, 2.0]),
        ],
    );
    Form::new(Row::named(word).expect("a row"), arguments).expect("arguments that fit")
}

fn forms(chance: &mut Chance) -> (Shape, Bodies) {
    let looks = looks(chance, 40);
    let (mut known, mut all): (Vec<(Form, Placement)>, Option<Shape>) = (Vec::new(), None);
    for _ in 0..2 + chance.below(3) {
        let (own, placement) = if known.is_empty() || chance.below(2) == 0 {
            let scale = vector(chance, 0.4, 1.4);
            (
                form(chance),
                Placement {
                    scale,
                    rotation_degrees: turn(chance),
                    place: vector(chance, -0.8, 0.8),
                },
            )
        } else {
            let (form, mut placement) = one(chance, &known).clone();
            let gap = if chance.below(3) == 0 { 0.0 } else { decade(chance, -14.0, 0.0) };
            if chance.below(2) == 0 {
                placement.place[chance.below(3) as usize] += gap;
            } else {
                placement.scale *= 1.0 - 0.5 * gap;
            }
            (form, placement)
        };
        let shape = Shape::Form(own.clone(), placement, one(chance, &looks).clone());
        known.push((own, placement));
        all = Some(match all {
            None => shape,
            Some(all) => match chance.below(5) {
                0..3 => all.plus(shape),
                3 => all.minus(shape),
                _ => Shape::Intersection(vec![all, shape]),
            },
        });
    }
    let seen = known.into_iter().map(|(_, placement)| (Primitive::Block, placement)).collect();
    (all.expect("at least two"), seen)
}

/// Copies of a few bodies `apart` from each other.
fn copies(chance: &mut Chance, apart: f64) -> (Shape, Bodies) {
    let mut bodies = bodies(extreme::Kind::Shells, chance, 2);
    for _ in 0..2 + chance.below(3) {
        let (solid, mut placement) = *one(chance, &bodies);
        let gap = apart * decade(chance, -0.6, 0.9);
        match chance.below(3) {
            0 => placement.place[chance.below(3) as usize] += gap,
            1 => placement.scale *= 1.0 - gap,
            _ => placement.scale[chance.below(3) as usize] *= 1.0 + gap,
        }
        bodies.push((solid, placement));
    }
    let clear_share = 50 * chance.below(3);
    let looks = looks(chance, clear_share);
    let leaf = |chance: &mut Chance, k: usize| {
        let (solid, placement): (_, Placement) = bodies[k];
        Shape::Primitive(solid, placement, one(chance, &looks).clone())
    };
    let mut all = leaf(chance, 0);
    for k in 1..bodies.len() {
        let next = leaf(chance, k);
        all = match chance.below(6) {
            0..3 => all.plus(next),
            3..5 => all.minus(next),
            _ => Shape::Intersection(vec![all, next]),
        };
    }
    (all, bodies)
}

/// Bodies of looks that differ, under operators.
fn under_operators(chance: &mut Chance, bodies: &Bodies, looks: &[Attributes]) -> Shape {
    let leaf = |chance: &mut Chance, k: usize| {
        let (solid, placement) = bodies[k];
        Shape::Primitive(solid, placement, one(chance, looks).clone())
    };
    (1..bodies.len()).fold(leaf(chance, 0), |all, k| {
        let next = leaf(chance, k);
        match chance.below(6) {
            0..4 => all.plus(next),
            4 => all.minus(next),
            _ => Shape::Intersection(vec![all, next]),
        }
    })
}

/// What stands in a scene, and the bodies that it is looked at by.
fn solid(kind: Fresh, chance: &mut Chance, far: f64) -> (Shape, Bodies) {
    match kind {
        Fresh::Chains => chain(chance),
        Fresh::Forms => forms(chance),
        // In numbers as large as those the scene ends up with.
        Fresh::Bounds => copies(chance, 64.0 * 0.5 * f64::EPSILON * far.max(2.0)),
        Fresh::Glass => {
            let bodies = bodies(extreme::Kind::Lattice, chance, 5);
            let looks: Vec<Attributes> = [1.5, 1.33, 1.5]
                .map(|index| clear([0.9, 0.8, 0.95], decade(chance, 0.0, 2.0), Some(index)))
                .into();
            (under_operators(chance, &bodies, &looks), bodies)
        }
        Fresh::Nested | Fresh::Parallel | Fresh::Fog => {
            let own = *one(chance, &extreme::Kind::ALL);
            let bodies = bodies(own, chance, 4);
            let looks = looks(chance, 30);
            (under_operators(chance, &bodies, &looks), bodies)
        }
    }
}

/// Classes in which everything moves with the innermost of them.
fn steps(chance: &mut Chance) -> Vec<Placement> {
    (0..=chance.below(3))
        .map(|_| {
            let scale = vector(chance, 0.5, 2.0);
            let mirror = if chance.below(2) == 0 { 1.0 } else { -1.0 };
            Placement {
                scale: scale * DVec3::new(mirror, 1.0, 1.0),
                rotation_degrees: turn(chance),
                place: vector(chance, -3.0, 3.0),
            }
        })
        .collect()
}

/// A shape as an instance of a class of itself, or two of them.
fn nested(author: &mut Author, chance: &mut Chance, shape: &Shape, step: Placement) -> Shape {
    let class = author.class(shape);
    let copy = Shape::Instance(class, step, Attributes::default());
    if chance.below(2) == 0 {
        // A second copy some way off.
        let aside = Placement { place: step.place + vector(chance, -2.0, 2.0), ..step };
        copy.plus(Shape::Instance(class, aside, Attributes::default()))
    } else {
        copy
    }
}

fn light(author: &mut Author, chance: &mut Chance, at: DVec3, target: DVec3) {
    let light = match chance.below(4) {
        0 => LightKind::Beam { at, toward: target },
        1 => LightKind::Spot {
            at,
            toward: target,
            concentration: decade(chance, -2.0, 3.0),
            half_angle_degrees: decade(chance, -1.0, 1.9),
        },
        _ => LightKind::Point { at },
    };
    author.light(light, Rgb::splat(0.5));
}

/// The scene of a number.
pub(crate) fn scene(kind: Fresh, seed: u64) -> Scene {
    let chance = &mut Chance::new(seed ^ (0xf2e5 + ((kind as u64) << 32)));
    let scale = match kind {
        Fresh::Glass => [1e-9, 1e9][chance.below(2) as usize],
        _ if chance.below(2) == 0 => 1.0,
        _ => decade(chance, -12.0, 12.0),
    };
    let far = if chance.below(3) > 0 { 0.0 } else { decade(chance, 0.0, 9.0) };
    let form = match chance.below(6) {
        0 => Writing::Instances,
        1 if kind != Fresh::Chains => Writing::Shared,
        _ => Writing::Plain,
    };
    let (mut shape, bodies) = solid(kind, chance, far);
    let seen_as = if matches!(kind, Fresh::Chains | Fresh::Glass) {
        extreme::Kind::Lattice
    } else {
        extreme::Kind::Contact
    };
    let (mut eye, mut target, focal) = extreme::view(seen_as, chance, &bodies);
    let steps = if kind == Fresh::Nested { steps(chance) } else { Vec::new() };
    for step in &steps {
        (eye, target) = (step.map().outward(eye), step.map().outward(target));
    }
    let mut author = Author::new(Site { scale, offset: scale * far, form }, eye, target);
    for step in steps {
        shape = nested(&mut author, chance, &shape, step);
    }
    author.object(&shape);
    if chance.below(2) == 0 {
        let size = 10.0 * (eye - target).length().max(1.0);
        let place = target - DVec3::Y * size;
        let floor = Placement { scale: DVec3::splat(0.8 * size), place, ..Placement::default() };
        author.object(&Shape::Primitive(Primitive::Block, floor, opaque([0.7, 0.6, 0.5])));
    }
    let near = (eye - target).length() + bodies[0].1.scale.abs().max_element();
    for _ in 0..=chance.below(2) {
        let at = eye + near * direction(chance);
        light(&mut author, chance, at, target);
    }
    let mut scene = author.finish();
    if let Some(camera) = &mut scene.camera {
        camera.focal_length_mm = focal;
        camera.parallel = kind == Fresh::Parallel;
    }
    if kind == Fresh::Fog {
        scene.fog_half_distance = Some(scale * near * decade(chance, -3.0, 3.0));
    }
    scene
}
