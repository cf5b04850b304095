//! Random rays on random extreme scenes against the oracle.

use std::fmt;

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

/// Rays are followed to a depth where errors have not grown yet, and none is left out for being faint.
fn options() -> Options {
    Options { columns: SIDE, rows: SIDE, depth: 5, min_weight: 1e-6, ..Options::default() }
}

/// The scenes of a kind, by name.
type Scenes = Box<dyn Iterator<Item = (String, scene::Scene)>>;

fn extremes(kind: Kind, seeds: impl Iterator<Item = u64> + 'static) -> Scenes {
    let seeds = seeds.filter(move |&seed| extreme::kind(seed) == kind);
    Box::new(seeds.map(move |seed| (format!("{kind:?} {seed}"), extreme::scene(seed).1)))
}

fn freshes(kind: Fresh, seeds: impl Iterator<Item = u64> + 'static) -> Scenes {
    Box::new(seeds.map(move |seed| (format!("{kind:?} {seed}"), fresh::scene(kind, seed))))
}

/// The first scenes of all kinds, by what the page says of them.
fn first() -> impl Iterator<Item = (&'static str, Box<dyn Fn() -> Scenes>)> {
    let all = Kind::ALL.into_iter().map(|kind| -> (_, Box<dyn Fn() -> Scenes>) {
        let count = usize::try_from(SCENES * times()).expect("not that many");
        (kind.words(), Box::new(move || Box::new(extremes(kind, 0..).take(count))))
    });
    all.chain(Fresh::ALL.into_iter().map(|kind| -> (_, Box<dyn Fn() -> Scenes>) {
        (kind.words(), Box::new(move || freshes(kind, 0..FRESH * times())))
    }))
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
    for (words, scenes) in first() {
        cases.push(Case::new(RANDOM, words, Promise::Right, move || {
            let tally = compared(scenes());
            Found::Pixels { wrong: tally.wrong.len() as u64, of: tally.pixels, edges: tally.edges }
        }));
    }
    let finite = Case::new(RANDOM, "numbers in all of them", Promise::Right, || {
        let all = first().flat_map(|(_, scenes)| scenes());
        all.fold(Found::NONE, |sum, (_, scene)| sum.and(unfinite(&scene, &options())))
    });
    cases.push(finite);
    cases
}

/// What a long run found in scenes of one kind.
#[derive(Debug, Default)]
pub(crate) struct Run {
    words: &'static str,
    scenes: u64,
    tally: Tally,
    /// Samples that are no numbers.
    unfinite: u64,
}

impl Run {
    fn add(&mut self, name: &str, scene: &scene::Scene) {
        let tally = compare_with(scene, &options());
        if !tally.wrong.is_empty() {
            tally.report(name);
        }
        self.tally.add(tally);
        self.scenes += 1;
        if let Found::Pixels { wrong, .. } = unfinite(scene, &options()) {
            self.unfinite += wrong;
        }
    }
}

impl fmt::Display for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tally { rays, pixels, edges, explained, buried, wrong } = &self.tally;
        let share = 100.0 * *edges as f64 / *pixels as f64;
        write!(f, "{}: {} scenes, {rays} rays, {pixels} pixels: ", self.words, self.scenes)?;
        let (wrong, unfinite) = (wrong.len(), self.unfinite);
        write!(f, "{wrong} wrong, {unfinite} no numbers, {edges} on edges ({share:.3} %), ")?;
        write!(f, "{explained} of them explained, {buried} seen from inside of opaque bodies")
    }
}

/// Compares a scene with the evaluator, at a size and to a depth.
pub(crate) fn compared_with(scene: &scene::Scene, columns: u32, rows: u32, depth: u32) -> Run {
    let options = Options { columns, rows, depth, min_weight: 1e-6, ..Options::default() };
    let mut run = Run { words: "the scene", scenes: 1, ..Run::default() };
    run.tally = compare_with(scene, &options);
    run.tally.report("the scene");
    if let Found::Pixels { wrong, .. } = unfinite(scene, &options) {
        run.unfinite = wrong;
    }
    run
}

/// Compares that many scenes of each kind from a number on, the kinds in turn, and shows how it stands after every `pause`
/// of them.
pub(crate) fn run(from: u64, scenes: u64, pause: u64, show: &mut dyn FnMut(&[Run])) {
    let of_kinds = Kind::ALL.into_iter().map(|kind| (kind.words(), extremes(kind, from..)));
    let of_fresh = Fresh::ALL.into_iter().map(|kind| (kind.words(), freshes(kind, from..)));
    let (mut runs, mut kinds): (Vec<Run>, Vec<Scenes>) = of_kinds
        .chain(of_fresh)
        .map(|(words, scenes)| (Run { words, ..Run::default() }, scenes))
        .unzip();
    for done in 1..=scenes {
        for (run, scenes) in runs.iter_mut().zip(&mut kinds) {
            let (name, scene) = scenes.next().expect("they go on");
            run.add(&name, &scene);
        }
        if done % pause == 0 || done == scenes {
            show(&runs);
        }
    }
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
