//! One scene, loaded and traced with all passes, without any, and without one of them.

use std::error::Error;
use std::time::{Duration, Instant};

use render::{LoadOptions, Omission, Options, World, render};
use scene::Scene;

use crate::clock::Stopwatch;
use crate::journal::Figures;
use crate::sweep::film_digest;

/// Rounds are gone on with until they took so long together, but no more than the most and no fewer than the least.
const ENOUGH: Duration = Duration::from_secs(6);
const MOST_ROUNDS: u32 = 25;
const LEAST_ROUNDS: u32 = 3;

/// What is known of a scene before anything is timed.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Primitives that it stands for.
    pub primitives: u64,
    /// Those that are left of them.
    pub left: u64,
    /// What each pass did.
    pub omissions: Vec<Omission>,
}

/// A way of loading a scene; its words stand in the figures.
struct Way {
    load: LoadOptions,
    word: String,
    seconds: [f64; 2],
}

/// How a figure of a pass is named: `load_all` is without any pass, `trace_fog` without that for fog.
#[must_use]
pub fn name_of(figure: &str, pass: &str) -> String {
    format!("{figure}_{}", pass.replace(' ', "_"))
}

/// What the passes do with a scene in a picture of this size.
///
/// # Errors
///
/// If it cannot be loaded.
pub fn seen(scene: &Scene, size: (u32, u32)) -> Result<Seen, Box<dyn Error>> {
    let load = LoadOptions { picture: Some(size), ..LoadOptions::default() };
    let world = World::load_with(scene, &load)?;
    Ok(Seen {
        primitives: world.stands_for(),
        left: world.primitives_left(),
        omissions: world.omissions().to_vec(),
    })
}

/// Seconds of one core, the least of alternating runs: `load` and `trace` with all passes, `load_all` and `trace_all` with
/// none, [`name_of`] each pass that takes something without that one. `same` is 1 if all give the same bytes.
///
/// # Errors
///
/// If the scene cannot be loaded or rendered.
pub fn measured(
    scene: &Scene,
    seen: &Seen,
    (columns, rows): (u32, u32),
) -> Result<Figures, Box<dyn Error>> {
    let usual = LoadOptions { picture: Some((columns, rows)), ..LoadOptions::default() };
    let way = |load: LoadOptions, word: String| Way { load, word, seconds: [f64::INFINITY; 2] };
    let mut ways = vec![
        way(usual, String::new()),
        way(LoadOptions { keep_all: true, ..usual }, name_of("", "all")),
    ];
    for omission in seen.omissions.iter().filter(|omission| omission.after < omission.before) {
        let load = LoadOptions { keep_pass: Some(omission.name), ..usual };
        ways.push(way(load, name_of("", omission.name)));
    }
    let options = Options { columns, rows, threads: 1, ..Options::default() };
    let (begun, mut round, mut digests) = (Instant::now(), 0, Vec::new());
    while round < LEAST_ROUNDS || (round < MOST_ROUNDS && begun.elapsed() < ENOUGH) {
        for way in &mut ways {
            let watch = Stopwatch::start();
            let world = World::load_with(scene, &way.load)?;
            way.seconds[0] = way.seconds[0].min(watch.seconds());
            let watch = Stopwatch::start();
            let picture = render(&world, &options, &|_| ())?;
            way.seconds[1] = way.seconds[1].min(watch.seconds());
            if round == 0 {
                digests.push(film_digest(&picture));
            }
        }
        round += 1;
    }
    digests.dedup();
    let same = if digests.len() == 1 { 1.0 } else { 0.0 };
    let figures = Figures::default().with("same", same);
    Ok(ways.iter().fold(figures, |figures, way| {
        let [load, trace] = way.seconds;
        figures.with(&format!("load{}", way.word), load).with(&format!("trace{}", way.word), trace)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pass_that_takes_something_is_switched_off_by_itself() {
        let text = "camera at (0, 0, 9) light at (5, 9, 7) intensity 0.8
            object is sphere * (block at (9, 0, 0)) object is sphere - block at (90, 0, 0)";
        let scene = compile::compile_text(text).scene.unwrap();
        let seen = seen(&scene, (8, 8)).unwrap();
        assert_eq!((seen.primitives, seen.left), (4, 1));
        let figures = measured(&scene, &seen, (8, 8)).unwrap();
        assert_eq!(figures.get("same"), Some(1.0), "{figures:?}");
        for name in ["load", "trace", "trace_all", "trace_empty", "load_apart", "trace_fog"] {
            assert!(figures.number(name) > 0.0, "{name}: {figures:?}");
        }
        assert_eq!(figures.get("trace_dark"), None, "the light shines");
        assert_eq!(name_of("trace", "hidden paint"), "trace_hidden_paint");
    }
}
