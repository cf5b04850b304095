//! Measures every case of the table and writes `docs/stability.md`.
//!
//! ```text
//! cargo run --release -p suite-tests --example stability               measure, and write the page
//! cargo run --release -p suite-tests --example stability -- --povray   also what POV-Ray makes of the same scenes
//! cargo run --release -p suite-tests --example stability -- --only "Media and light"   measure these, no page
//! cargo run --release -p suite-tests --example stability -- --scene FILE.sdl 48 36 6     compare a scene: columns, rows, depth
//! cargo run --release -p suite-tests --example stability -- --run 2000 compare so many random scenes of each kind, no page
//! ```
//!
//! The variable `PORTRAY_STABILITY` multiplies the random scenes. What POV-Ray makes of them is kept in `povray.csv`
//! beside this file, for machines that do not have it.

#![expect(dead_code, reason = "modules are the tests', which use the rest")]

#[path = "../oracle/mod.rs"]
mod oracle;
mod povray;
#[path = "../random_csg.rs"]
mod random_csg;
#[path = "mod.rs"]
mod stability;
#[path = "../support/mod.rs"]
mod support;

use std::fs;
use std::io;

use stability::case::{Case, Found};
use stability::page;

/// Random scenes of every kind, from a number on.
#[expect(clippy::print_stdout, reason = "the counts are the result")]
fn run_long(scenes: u64, from: u64) {
    stability::run_long(from, scenes, 100, &mut |runs| {
        for run in runs {
            println!("{run}");
        }
        println!();
    });
}

/// Cases whose heading or name has these words in it.
#[expect(clippy::print_stdout, reason = "the figures are the result")]
fn measure_only(cases: &[Case], part: &str) {
    for case in
        cases.iter().filter(|case| format!("{}: {}", case.section, case.name).contains(part))
    {
        let found = (case.measure)();
        let verdict = if case.holds(&found) { "" } else { " BROKEN" };
        println!("{}: promised {}, measured {found}{verdict}", case.name, case.promise);
    }
}

/// A scene of a file, without paint, against the evaluator.
#[expect(clippy::print_stdout, reason = "the counts are the result")]
fn compare_scene(file: &str, numbers: &[u32]) -> io::Result<()> {
    let compiled = compile::compile_path(file.as_ref());
    let Some(scene) = compiled.scene else { return Err(io::Error::other(compiled.error_report())) };
    let number = |place: usize, usual: u32| numbers.get(place).copied().unwrap_or(usual);
    let (columns, rows, depth) = (number(0, 48), number(1, 36), number(2, 6));
    println!("{}", stability::compared_with(&stability::unpainted(scene), columns, rows, depth));
    Ok(())
}

fn main() -> io::Result<()> {
    let words: Vec<String> = std::env::args().collect();
    if let [_, run, scenes, from @ ..] = words.as_slice()
        && run == "--run"
    {
        let number = |word: &String| word.parse().map_err(io::Error::other);
        run_long(number(scenes)?, from.first().map_or(Ok(0), number)?);
        return Ok(());
    }
    if let [_, scene, file, rest @ ..] = words.as_slice()
        && scene == "--scene"
    {
        let numbers: Result<Vec<u32>, _> = rest.iter().map(|word| word.parse()).collect();
        return compare_scene(file, &numbers.map_err(io::Error::other)?);
    }
    let folder = support::root();
    let mut cases = stability::table();
    if let [_, only, part] = words.as_slice()
        && only == "--only"
    {
        measure_only(&cases, part);
        return Ok(());
    }
    if std::env::args().any(|word| word == "--povray") {
        let mut rows = String::new();
        for case in &cases {
            if let Some(figure) = povray::measured(case)? {
                rows += &format!("{};{figure}\n", case.name);
            }
        }
        fs::write(folder.join("tests/stability/povray.csv"), rows)?;
    }
    let mut broken = 0;
    let rows: Vec<(Case, Found)> = cases
        .drain(..)
        .map(|case| {
            let found = (case.measure)();
            broken += usize::from(!case.holds(&found));
            (case, found)
        })
        .collect();
    let figures = fs::read_to_string(folder.join("tests/stability/povray.csv"))?;
    fs::write(folder.join("docs/stability.md"), page::page(&rows, &figures))?;
    if broken > 0 { Err(io::Error::other(format!("{broken} promises are broken"))) } else { Ok(()) }
}
