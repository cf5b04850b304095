//! Laws of sets: what is written in two ways is the same solid, and the same picture where surfaces look alike.

use glam::DVec3;
use scene::{Attributes, Placement, Primitive, Scene};

use super::case::{Case, Found, Peer, Promise};
use super::extreme;
use super::place::differing;
use crate::oracle::author::{Author, Chance, Shape, Site, opaque, stands};
use crate::random_csg::stage;
use crate::support::{shown, square};

const LAWS: &str = "Laws of sets, on random solids of one colour";
const MEMBERS: &str = "Laws of sets, the distance of the first surface";
const GREAT: &str = "Great expressions";
/// Random operands of a law.
const RANDOM: u64 = 120;

/// Operands of a law.
type Three = [Shape; 3];
/// One side of a law.
type Side = fn(Three) -> Shape;

fn and(a: Shape, b: Shape) -> Shape {
    Shape::Intersection(vec![a, b])
}

/// Space, as far as it matters: what is taken from it opens its faces.
fn space() -> Shape {
    Shape::Primitive(Primitive::Block, stands([0.0; 3], [0.9; 3]), look())
}

fn look() -> Attributes {
    opaque([0.8, 0.6, 0.4])
}

const ALL: [(&str, Side, Side); 10] = [
    ("A + B = B + A", |[a, b, _]| a.plus(b), |[a, b, _]| b.plus(a)),
    ("A * B = B * A", |[a, b, _]| and(a, b), |[a, b, _]| and(b, a)),
    ("A * A = A", |[a, ..]| and(a.clone(), a), |[a, ..]| a),
    ("A + A = A", |[a, ..]| a.clone().plus(a), |[a, ..]| a),
    ("(A - B) - C = A - (B + C)", |[a, b, c]| a.minus(b).minus(c), |[a, b, c]| a.minus(b.plus(c))),
    ("(A - B) + B = A + B", |[a, b, _]| a.minus(b.clone()).plus(b), |[a, b, _]| a.plus(b)),
    ("A - (A - B) = A * B", |[a, b, _]| a.clone().minus(a.minus(b)), |[a, b, _]| and(a, b)),
    (
        "A * (B + C) = A * B + A * C",
        |[a, b, c]| and(a, b.plus(c)),
        |[a, b, c]| and(a.clone(), b).plus(and(a, c)),
    ),
    (
        "space - (A + B) = (space - A) * (space - B)",
        |[a, b, _]| space().minus(a.plus(b)),
        |[a, b, _]| and(space().minus(a), space().minus(b)),
    ),
    (
        "space - A * B = (space - A) + (space - B)",
        |[a, b, _]| space().minus(and(a, b)),
        |[a, b, _]| space().minus(a).plus(space().minus(b)),
    ),
];

/// Three random bodies of which faces often coincide.
fn operands(seed: u64) -> Three {
    let mut chance = Chance::new(seed);
    let kind = [extreme::Kind::Lattice, extreme::Kind::Contact][chance.below(2) as usize];
    of_kind(kind, chance)
}

fn of_kind(kind: extreme::Kind, mut chance: Chance) -> Three {
    let mut bodies: Vec<(Primitive, Placement)> = Vec::new();
    for _ in 0..3 {
        let next = extreme::place(kind, &mut chance, &bodies);
        bodies.push(next);
    }
    let shape = |k: usize| Shape::Primitive(bodies[k].0, bodies[k].1, look());
    [shape(0), shape(1), shape(2)]
}

/// Three random bodies on a lattice, under operators, on a stage.
pub(super) fn joined(seed: u64) -> Scene {
    let [a, b, c] = of_kind(extreme::Kind::Lattice, Chance::new(seed));
    seen(&if seed.is_multiple_of(2) { a.plus(b).minus(c) } else { a.minus(b).plus(c) })
}

fn seen(shape: &Shape) -> Scene {
    let mut author: Author = stage(Site::UNIT, [3.1, 4.3, 7.7]);
    author.object(shape);
    author.finish()
}

pub(crate) fn cases() -> Vec<Case> {
    let laws = ALL.into_iter().map(|(name, left, right)| {
        Case::new(LAWS, name, Promise::Alike, move || {
            (0..RANDOM).fold(Found::NONE, |sum, seed| {
                let picture = |side: Side| shown(&seen(&side(operands(seed))), &square(24, 1));
                sum.and(differing(&picture(left), &picture(right), 1))
            })
        })
    });
    let members = ALL.into_iter().map(|(name, left, right)| {
        Case::new(MEMBERS, name, Promise::Right, move || {
            (0..RANDOM).fold(Found::NONE, |sum, seed| {
                let way = |side: Side| distances(&seen(&side(operands(seed))));
                let (a, b) = (way(left), way(right));
                let apart = |(a, b): &(&f32, &f32)| (*a - *b).abs() > 1e-6 * a.abs();
                sum.and(Found::differing(a.iter().zip(&b).filter(apart).count(), a.len()))
            })
        })
    });
    laws.chain(members).chain(great()).collect()
}

/// How far the first surface is behind each pixel.
fn distances(scene: &Scene) -> Vec<f32> {
    let world = render::World::load(scene).expect("it loads");
    let planes = render::measured(&world, &square(24, 1), &[idf::Kind::Dep]).expect("threads");
    match &planes[0].samples {
        idf::Samples::F32(ways) => ways.clone(),
        other => panic!("{other:?}"),
    }
}

/// Where the k-th small ball on a block's surface stands.
pub(crate) fn stud(k: u32, of: u32) -> DVec3 {
    let at = f64::from(k);
    let z = 1.67 * at / f64::from(of) - 0.9;
    DVec3::new(0.9 * libm::cos(at), 0.9 * libm::sin(2.0 * at), z)
}

/// A block from which balls are taken, and put back.
fn chain<const OPERATORS: u32>() -> String {
    let count = OPERATORS / 2;
    let step = |k: u32| {
        let at = stud(k, count);
        let ball = format!("sphere scale 0.01 at ({:.6}, {:.6}, {:.6})", at.x, at.y, at.z);
        format!(" - {ball} + {ball}")
    };
    let steps: String = (0..count).map(step).collect();
    format!("(block{steps}) rotate (0, 30, 20)")
}

/// Balls of glass whose radii differ by a rounding.
fn pile() -> Found {
    let look = crate::oracle::author::clear([0.9; 3], 9.0, Some(1.5));
    let ball = |k: u32| crate::oracle::author::sphere([0.0; 3], 1.0 + 1e-15 * f64::from(k), &look);
    let picture = |shape: &Shape| {
        let mut author: Author = stage(Site::UNIT, [1.1, 2.3, 6.0]);
        author.object(shape);
        author.object(&crate::random_csg::floor());
        shown(&author.finish(), &square(24, 1))
    };
    let all = Shape::Union((0..1000).map(ball).collect());
    differing(&picture(&all), &picture(&ball(999)), 1)
}

fn great() -> Vec<Case> {
    let block = "block rotate (0, 30, 20)";
    let view = "\ncamera at (1, 3, 6)\nlight beam toward (-1, -2, -3)";
    let row = "class row is union of i from 1 to 1000 (sphere scale 0.01 at (0.9 * cos(i), 0, 0.9 * sin(i)))";
    let scene = move |solid: &str| format!("{row}\nobject is {solid}{view}");
    let same = move |name: &'static str, side: u32, text: fn() -> String| {
        Case::new(GREAT, name, Promise::Same, move || {
            let picture = |text: &str| {
                let options = compile::Options { max_primitives: 10_000_000, ..Default::default() };
                let compiled = compile::compile_text_with(scene(text), &options);
                let report = compiled.error_report();
                let scene = compiled.scene.unwrap_or_else(|| panic!("{name}: {report}"));
                shown(&scene, &square(side, 1))
            };
            differing(&picture(&text()), &picture(block), 0)
        })
    };
    vec![
        same("a chain of 1 000 operators", 5, chain::<1000>).beside(Peer::Chain(1000)),
        same("a chain of 100 000 operators", 5, chain::<100_000>).beside(Peer::Chain(100_000)),
        same("a tree 10 000 deep", 12, || {
            let open = "sphere scale 0.5 + block * (".repeat(5000);
            format!("({open} block {}) rotate (0, 30, 20)", ")".repeat(5000))
        }),
        same("1 000 000 terms, in classes", 12, || {
            "(block + union of i from 1 to 1000 (row at (0, i / 2000, 0))) rotate (0, 30, 20)"
                .to_owned()
        }),
        same("1 000 000 terms, in one list", 6, || {
            "(block + union of i from 1 to 1000000 (sphere scale 0.01 at (0.9 * cos(i), \
             0.9 * sin(i), 1.8 * i / 1000000 - 0.9))) rotate (0, 30, 20)"
                .to_owned()
        }),
        // All of them coincide: a sphere is taken off, and what stands in its place is of glass, and gone again.
        same("a chain of 100 000 operators that coincide", 5, || {
            let ball = "sphere scale 0.5 at (0.3, 0.2, 0.1)";
            let steps = format!(" - {ball} + smoothest trans (5, 1.5) {ball} - {ball} + {ball}");
            format!("(block{}) rotate (0, 30, 20)", steps.repeat(25_000))
        }),
        Case::new(GREAT, "1 000 balls of glass whose radii differ by 1e-15", Promise::Alike, pile),
        same("30 000 terms", 12, || {
            "(block + union of i from 1 to 30000 (sphere scale 0.01 at (0.9 * cos(i), \
             0.9 * sin(i), 1.8 * i / 30000 - 0.9))) rotate (0, 30, 20)"
                .to_owned()
        }),
    ]
}
