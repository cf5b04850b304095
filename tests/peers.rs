//! The comparison with POV-Ray, as far as it does not need it: the scenes that it generates. Instructions that are
//! counted, with figures made up.

use std::fs;

use crate::shell::Shell;
use crate::support::root;

#[test]
fn the_comparison_makes_scenes_and_a_table() {
    let shell = Shell::new();
    let cases = "scattered drilled heap flake chain chess";
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

/// A folder like the repository's, with programs that say what they are told to: what `valgrind` counts stands in the file
/// `counted`, the version of `rustc` in `version`.
fn counting_house(shell: &Shell) {
    let write = |name: &str, text: &str| {
        let path = shell.file("house").join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    let script = root().join("scripts/count-instructions.sh");
    write("scripts/count-instructions.sh", &fs::read_to_string(script).expect("the script"));
    write("target/release/portray", "#!/bin/sh\n");
    write("bin/rustc", "#!/bin/sh\necho rustc $(cat version)\n");
    let valgrind = "#!/bin/sh\nfor word; do case $word in --callgrind-out-file=*) out=${word#*=};; esac; done\n\
        echo summary: $(cat counted)000000 >\"$out\"\n";
    write("bin/valgrind", valgrind);
    write("crates/render/benches/instructions.txt", "// Figures.\n1.95.0 PROCESSOR 1000\n");
    write("CHANGELOG.md", "# Changelog\n");
    write("version", "1.95.0 (1234 2026-01-01)");
    shell.run("cd house && chmod +x bin/* target/release/portray && sed -i s/PROCESSOR/$(uname -m)/ crates/render/benches/instructions.txt");
}

#[test]
fn more_instructions_than_are_known_fail() {
    let shell = Shell::new();
    counting_house(&shell);
    let count = |before: &str, options: &str| {
        let line = format!(
            "cd house && {before} && CARGO_TARGET_DIR= PATH=$PWD/bin:$PATH bash scripts/count-instructions.sh {options}"
        );
        let output = shell.output(&line);
        let text =
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.code(), text.concat())
    };
    for (before, status, said) in [
        ("echo 1000 >counted", 0, "1000 million instructions; 1000 are kept"),
        ("echo 1050 >counted", 0, "1050 million instructions; 1000 are kept"),
        ("echo 1051 >counted", 1, "say in CHANGELOG.md \"wine glass: 1051 million instructions\""),
        ("echo 500 >counted", 0, "500 million"),
        // What is written down counts to the same 5 %.
        (
            "echo 1200 >counted; echo 'wine glass: 1142 million instructions' >>CHANGELOG.md",
            1,
            "5 % more",
        ),
        (
            "echo '- Boxes; wine glass: 1143 million instructions.' >>CHANGELOG.md",
            0,
            "1200 million",
        ),
        // Of another compiler nothing is known.
        ("echo '1.99.0 (x)' >version; echo 5000 >counted", 0, "no figure is kept for 1.99.0"),
    ] {
        let (found, text) = count(before, "");
        assert_eq!(found, Some(status), "{before}: {text}");
        assert!(text.contains(said), "{before}: {text}");
    }
    let (status, text) = count("true", "--keep");
    assert_eq!(status, Some(0), "{text}");
    let kept = fs::read_to_string(shell.file("house/crates/render/benches/instructions.txt"));
    let kept = kept.expect("figures");
    assert!(kept.contains("1.95.0 ") && kept.contains(" 1000\n"), "the other stays: {kept}");
    assert!(
        kept.lines().any(|line| line.starts_with("1.99.0 ") && line.ends_with(" 5000")),
        "{kept}"
    );
    let (status, text) = count("echo 5251 >counted", "");
    assert_eq!(status, Some(1), "its own figure counts now: {text}");
    assert_eq!(count("true", "--most").0, Some(2), "no such option");
}
