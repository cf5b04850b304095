//! Random rays on random extreme scenes against the oracle.

use render::{Options, World, measured, measured_kinds};

use super::case::{Case, Found, Promise};
use super::extreme::{self, Kind};
use crate::oracle::compare::{Tally, compare_with};

const RANDOM: &str = "Random extreme scenes";

/// Scenes of each kind; the variable `PORTRAY_STABILITY` multiplies them.
const SCENES: u64 = 40;
/// Side of their pictures.
const SIDE: u32 = 16;

/// How many times the scenes.
pub(crate) fn times() -> u64 {
    std::env::var("PORTRAY_STABILITY").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// The first scenes of a kind, by their numbers.
fn seeds(kind: Kind) -> impl Iterator<Item = u64> {
    let count = usize::try_from(SCENES * times()).expect("not that many");
    (0..).filter(move |&seed| extreme::kind(seed) == kind).take(count)
}

/// Rays are followed to a depth where errors have not grown yet, and none is left out for being faint.
fn options() -> Options {
    Options { columns: SIDE, rows: SIDE, depth: 5, min_weight: 1e-6, ..Options::default() }
}

/// All scenes of a kind.
pub(crate) fn compared(kind: Kind) -> Tally {
    let mut sum = Tally::default();
    for seed in seeds(kind) {
        let (_, scene) = extreme::scene(seed);
        let tally = compare_with(&scene, &options());
        if !tally.wrong.is_empty() {
            tally.report(&format!("{kind:?} {seed}"));
        }
        sum.add(tally);
    }
    sum
}

pub(crate) fn cases() -> Vec<Case> {
    let compared = Kind::ALL.into_iter().map(|kind| {
        Case::new(RANDOM, kind.words(), Promise::Right, move || {
            let tally = compared(kind);
            Found::Pixels { wrong: tally.wrong.len() as u64, of: tally.pixels, edges: tally.edges }
        })
    });
    let finite = Case::new(RANDOM, "numbers in all of them", Promise::Right, || {
        let all = Kind::ALL.into_iter().flat_map(seeds);
        all.fold(Found::NONE, |sum, seed| sum.and(unfinite(&extreme::scene(seed).1)))
    });
    compared.chain([finite]).collect()
}

/// Samples that are no numbers.
fn unfinite(scene: &scene::Scene) -> Found {
    let world = World::load(scene).expect("it loads");
    let picture = render::render(&world, &options(), &|_| ()).expect("threads");
    let colors = picture.film.pixels().filter(|pixel| !pixel.color.iter().all(|c| c.is_finite()));
    let mut wrong = colors.count();
    for plane in measured(&world, &options(), &measured_kinds()).expect("threads") {
        if let idf::Samples::F32(values) = &plane.samples {
            wrong += values.iter().filter(|value| !value.is_finite()).count();
        }
    }
    Found::differing(wrong, (SIDE * SIDE) as usize)
}
