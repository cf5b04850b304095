//! Light along rays through random scenes of every material and light: the tracer against the oracle, to nine digits.

pub(crate) mod look;

use render::{Options, World, radiance};
use scene::Scene;

use crate::oracle::author::Site;
use crate::oracle::compare::by_rows;
use crate::oracle::trace::{Limits, Oracle};
use crate::random_csg::Places;

/// Side of a picture in pixels.
const SIDE: u32 = 32;
/// The least error of a channel, relative to what it is, that is one.
const NINE_DIGITS: f64 = 1e-9;

type Color = [f64; 3];

/// The largest error of a channel, relative to what it should be, over a background as bright as `background`.
fn error(found: Color, expected: Color, background: f64) -> f64 {
    // What a pane tints is known as a part of the background's mean: a channel that a pane takes away is a difference.
    let rounding = 4.0 * f64::EPSILON * background;
    let channels = found.into_iter().zip(expected);
    channels.fold(0.0, |most, (found, expected)| {
        let off = (found - expected).abs();
        let error = if off <= rounding { 0.0 } else { off / expected.abs() };
        if error > most || error.is_nan() { error } else { most }
    })
}

/// How a number of rays compared.
#[derive(Clone, Debug, Default)]
struct Tally {
    rays: usize,
    /// Rays that see something.
    covered: usize,
    /// Rays that differ, and that see as different a thing when they are moved by a few rounding bounds.
    edges: usize,
    /// Largest error of those that agree.
    most: f64,
    wrong: Vec<String>,
}

impl Tally {
    fn add(&mut self, more: Self) {
        self.rays += more.rays;
        self.covered += more.covered;
        self.edges += more.edges;
        self.most = self.most.max(more.most);
        self.wrong.extend(more.wrong);
    }
}

/// True if what a ray sees hangs on its rounding by as much as `off`, relative to what it is.
fn on_edge(scene: &Scene, limits: Limits, (column, row): (u32, u32), off: f64) -> bool {
    let mut oracle = Oracle::new(scene, (SIDE, SIDE), limits);
    let straight = oracle.pixel(column, row);
    let background = scene.background.max_element();
    let sides = [-1.0, 0.0, 1.0];
    for number in 0..27 {
        oracle.nudge = [number / 9, number / 3 % 3, number % 3].map(|k| 4.0 * sides[k]);
        if error(oracle.pixel(column, row), straight, background) > 0.25 * off {
            return true;
        }
    }
    false
}

/// Looks along a ray through the centre of each pixel, both ways.
fn compare(name: &str, scene: &Scene) -> Tally {
    let options = Options { columns: SIDE, rows: SIDE, ..Options::default() };
    let limits = Limits { depth: options.depth, min_weight: options.min_weight };
    let pixels = (0..SIDE * SIDE).map(|pixel| (pixel % SIDE, pixel / SIDE));
    let centre = |(column, row)| (f64::from(column) + 0.5, f64::from(row) + 0.5);
    let places: Vec<(f64, f64)> = pixels.map(centre).collect();
    let world = World::load(scene).expect("the scene loads");
    let seen = radiance(&world, &options, &places).expect("a thread");
    let oracle = Oracle::new(scene, (SIDE, SIDE), limits);
    let tallies = by_rows(SIDE, |row| {
        let mut tally = Tally::default();
        for column in 0..SIDE {
            let seen = &seen[(row * SIDE + column) as usize];
            let found = (seen.color + (1.0 - seen.coverage) * scene.background).to_array();
            let expected = oracle.pixel(column, row);
            let off = error(found, expected, scene.background.max_element());
            tally.rays += 1;
            tally.covered += usize::from(seen.coverage > 0.0);
            if off <= NINE_DIGITS {
                tally.most = tally.most.max(off);
            } else if off.is_finite() && on_edge(scene, limits, (column, row), off) {
                tally.edges += 1;
            } else {
                tally.wrong.push(format!(
                    "{name} column {column} row {row}: tracer {found:?}, oracle {expected:?}, off {off:.1e}"
                ));
            }
        }
        tally
    });
    let mut all = Tally::default();
    tallies.into_iter().for_each(|tally| all.add(tally));
    all
}

/// Compares the pictures of scenes with these numbers.
#[expect(clippy::print_stderr, reason = "the counts are the report")]
fn check(name: &str, seeds: impl Iterator<Item = u64>, scene: impl Fn(u64) -> Scene) {
    let mut all = Tally::default();
    for seed in seeds {
        all.add(compare(&format!("{name} {seed}"), &scene(seed)));
    }
    let Tally { rays, covered, edges, most, wrong } = &all;
    eprintln!(
        "{name}: {rays} rays, {covered} meet something, {edges} on edges, {} wrong; else within {most:.1e}",
        wrong.len()
    );
    assert!(
        wrong.is_empty(),
        "{} of {rays} wrong:\n{}",
        wrong.len(),
        wrong[..wrong.len().min(8)].join("\n")
    );
    assert!(100 * edges < *rays, "{edges} of {rays} on edges");
    assert!(2 * covered > *rays, "{covered} of {rays} meet something");
}

/// Random scenes to compare: the variable multiplies them.
fn seeds(first: u64, count: u64) -> std::ops::Range<u64> {
    let times = std::env::var("PORTRAY_RADIANCE").ok().and_then(|n| n.parse().ok());
    first..first + count * times.unwrap_or(1)
}

#[test]
fn anywhere() {
    // In the last, rays to a light come from nearly all around it.
    check("free", seeds(0, 50).chain([122]), |seed| look::scene(seed, Places::Free, Site::UNIT));
}

#[test]
fn on_a_lattice() {
    check("lattice", seeds(10_000, 35), |seed| look::scene(seed, Places::Lattice, Site::UNIT));
}

#[test]
fn behind_instances() {
    check("instances", seeds(20_000, 15), |seed| {
        let site = Site::INSTANCES[if seed % 2 == 0 { 0 } else { 3 }];
        look::scene(seed, Places::Free, site)
    });
}

#[test]
fn errors_are_relative() {
    let expected = [1.0, 1e-3, 0.0];
    let error = |found, background| error(found, expected, background);
    assert!((error([1.0, 1.001e-3, 0.0], 0.0) - 1e-3).abs() < 1e-12, "of each channel");
    assert!(error([1.0, 1e-3, 1e-18], 0.0).is_infinite(), "light where there is none");
    assert!(error([1.0, 1e-3, 1e-18], 1.0) <= 0.0, "rounding of the background");
    assert!(error([1.0, 1e-3, 1e-14], 1.0).is_infinite(), "more than that");
    assert!(error([f64::NAN, 1e-3, 0.0], 1.0).is_nan(), "no number");
    assert!(error(expected, 0.0) <= 0.0, "alike");
}
