//! Measures every case of the table and writes `docs/stability.md`.
//!
//! ```text
//! cargo run --release -p suite-tests --example stability               measure, and write the page
//! cargo run --release -p suite-tests --example stability -- --povray   also what POV-Ray makes of the same scenes
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

fn main() -> io::Result<()> {
    let folder = support::root();
    let mut cases = stability::table();
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
