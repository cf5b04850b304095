//! Random rays on random extreme scenes against the oracle.

use render::{Options, World, measured, measured_kinds};

use super::case::{Case, Found, Promise};
use super::extreme::{self, Kind};
use super::fresh::{self, Fresh};
use crate::oracle::compare::{Tally, compare_with};

const RANDOM: &str = "Random extreme scenes";

/// Scenes of each kind; the variable `PORTRAY_STABILITY` multiplies them.
const SCENES: u64 = 40;
/// The same of each of the other kinds.
const FRESH: u64 = 12;
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

/// The scenes of a section of kinds, by name.
type Scenes = Box<dyn Iterator<Item = (String, scene::Scene)>>;

fn extremes(kind: Kind) -> Scenes {
    Box::new(seeds(kind).map(move |seed| (format!("{kind:?} {seed}"), extreme::scene(seed).1)))
}

fn freshes(kind: Fresh) -> Scenes {
    let seeds = 0..FRESH * times();
    Box::new(seeds.map(move |seed| (format!("{kind:?} {seed}"), fresh::scene(kind, seed))))
}

/// All scenes of a kind.
fn compared(scenes: Scenes) -> Tally {
    let mut sum = Tally::default();
    for (name, scene) in scenes {
        let tally = compare_with(&scene, &options());
        if !tally.wrong.is_empty() {
            tally.report(&name);
        }
        sum.add(tally);
    }
    sum
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    let mut right = |words, scenes: Box<dyn Fn() -> Scenes>| {
        cases.push(Case::new(RANDOM, words, Promise::Right, move || {
            let tally = compared(scenes());
            Found::Pixels { wrong: tally.wrong.len() as u64, of: tally.pixels, edges: tally.edges }
        }));
    };
    Kind::ALL.into_iter().for_each(|kind| right(kind.words(), Box::new(move || extremes(kind))));
    Fresh::ALL.into_iter().for_each(|kind| right(kind.words(), Box::new(move || freshes(kind))));
    let finite = Case::new(RANDOM, "numbers in all of them", Promise::Right, || {
        let all = Kind::ALL.into_iter().flat_map(extremes);
        let all = all.chain(Fresh::ALL.into_iter().flat_map(freshes));
        all.fold(Found::NONE, |sum, (_, scene)| sum.and(unfinite(&scene, &options())))
    });
    cases.push(finite);
    cases
}

/// Samples that are no numbers.
pub(super) fn unfinite(scene: &scene::Scene, options: &Options) -> Found {
    let world = World::load(scene).expect("it loads");
    let picture = render::render(&world, options, &|_| ()).expect("threads");
    let colors = picture.film.pixels().filter(|pixel| !pixel.color.iter().all(|c| c.is_finite()));
    let mut wrong = colors.count();
    for plane in measured(&world, options, &measured_kinds()).expect("threads") {
        if let idf::Samples::F32(values) = &plane.samples {
            wrong += values.iter().filter(|value| !value.is_finite()).count();
        }
    }
    Found::differing(wrong, (options.columns * options.rows) as usize)
}
