//! The comparison with POV-Ray, as far as it does not need it: the scenes that it generates.

use crate::shell::Shell;

#[test]
fn the_comparison_makes_scenes_and_a_table() {
    let shell = Shell::new();
    let cases = "scattered drilled heap chain chess";
    let run =
        format!("CARGO_TARGET_DIR=none scripts/compare-povray.sh -r 1 -s 16 -t 20 -n 10 {cases}");
    let table = shell.run(&run);
    for case in cases.split(' ') {
        let row = table.lines().find(|line| line.starts_with(&format!("| {case} | 10 | ")));
        let cells: Vec<&str> =
            row.map_or(Vec::new(), |row| row.split('|').map(str::trim).collect());
        let megabytes = cells.get(5).and_then(|cell| cell.parse::<f64>().ok());
        assert!(megabytes.is_some_and(|found| found >= 0.0), "{case}: {table}");
    }
    let refused = shell.output("CARGO_TARGET_DIR=none scripts/compare-povray.sh -r 1 -n 10 tower");
    assert_eq!(refused.status.code(), Some(2), "no such case");
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("no case tower; expected some of scattered"), "{said}");
}
