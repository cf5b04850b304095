//! The real program: sweeps end to end, stopped and resumed, and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::read_image;
use idf::{Kind, ReadOptions, Samples};

const SCENE: &str = "\
    camera at (0, 2, 9) target at (0, 0, 0)  background rgb (0.2, 0.3, 0.5)\n\
    light at (5, 9, 7) intensity 0.8  ambient intensity 0.2\n\
    object is shiny red sphere - block at (1, 1, 1)\n\
    object is blue cylinder at (-2, 0, 0)\n\
    object is trans (100, 1.5) sphere scale 0.5 at (-1, 0, 3)\n\
    object is red sphere at (900, 0, 0)\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.sdl"), SCENE).unwrap();
    folder
}

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_prreport"));
    command.args(arguments.split_whitespace()).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &str) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Standard output where all went well.
fn text(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Exit status and standard error.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = run(folder, arguments);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Fields of each line of CSV, quoted ones too.
fn csv(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let (mut lines, mut fields, mut field, mut quoted) = (vec![], vec![], String::new(), false);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(std::mem::take(&mut field)),
            '\n' if !quoted => {
                fields.push(std::mem::take(&mut field));
                lines.push(std::mem::take(&mut fields));
            }
            c => field.push(c),
        }
    }
    assert!(field.is_empty() && fields.is_empty() && !quoted, "{}: whole", path.display());
    let columns = lines[0].len();
    assert!(lines.iter().all(|line| line.len() == columns), "{}: as wide", path.display());
    lines
}

/// The rows of a table by their first fields, those of figures of time left out.
fn rows(report: &Path, table: &str, keys: &[usize]) -> Vec<String> {
    let lines = csv(&report.join(table));
    lines
        .iter()
        .map(|line| keys.iter().map(|&at| line[at].as_str()).collect::<Vec<_>>().join(" | "))
        .collect()
}

/// Everything in a report that does not depend on how long things took.
fn timeless(report: &Path) -> BTreeMap<&'static str, Vec<String>> {
    // Scene, options, samples, error, deviation, seeds; depth, weight, rays, change, bound; and so on.
    let tables: [(&str, &[usize]); 7] = [
        ("sampling.csv", &[0, 1, 3, 4, 5, 6]),
        ("references.csv", &[0, 1, 2, 3, 4, 5, 6]),
        ("cut-offs.csv", &[0, 1, 2, 4, 5, 6]),
        ("tracing.csv", &[0, 1, 4]),
        ("left-out.csv", &[0, 1, 2, 3, 4, 5]),
        ("colours.csv", &[0, 1, 3, 4, 5]),
        ("reported.csv", &[0, 1, 2, 3, 4, 5, 6]),
    ];
    tables.into_iter().map(|(table, keys)| (table, rows(report, table, keys))).collect()
}

fn is_well_formed(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    let text = text.strip_prefix("<!DOCTYPE html>\n").unwrap_or(&text);
    let parsed = roxmltree::Document::parse(text);
    assert!(parsed.is_ok(), "{}: {parsed:?}", path.display());
}

#[test]
fn a_sweep_writes_a_whole_report() {
    let folder = folder();
    let folder = folder.path();
    let said = text(folder, "ball.sdl -o out --size 32x32 --reference 16 --threads 2");
    assert!(said.contains("| ball | an error below 1 |"), "{said}");
    assert!(said.contains("| adaptive |"), "the table that decides: {said}");
    let out = folder.join("out");
    let sampling = csv(&out.join("sampling.csv"));
    assert_eq!(sampling.len(), 1 + 23 + 4, "a row for each way");
    for line in &sampling[1..] {
        let [seconds, samples, error]: [f64; 3] = [2, 3, 4].map(|at| line[at].parse().unwrap());
        assert!(seconds > 0.0 && samples >= 1.0 && error > 0.0 && error < 60.0, "{line:?}");
    }
    let error = |words: &str| -> f64 {
        let line = sampling.iter().find(|line| line[1] == words).unwrap();
        line[4].parse().unwrap()
    };
    assert!(error("--aa none --samples 64") < 0.5 * error("--aa none --samples 1"));
    assert!(error("--error 1") < 2.0 && error("--error 0.3") < 0.7);
    for (table, same) in [("tracing.csv", 4), ("saved.csv", 6)] {
        let lines = csv(&out.join(table));
        assert!(lines[1..].iter().all(|line| line[same] == "yes"), "{table}: {lines:?}");
    }
    // The far sphere is out of view.
    let omitted = csv(&out.join("left-out.csv"));
    let seen = omitted.iter().any(|line| line[3] != line[4] && line[1] == "unreached");
    assert!(seen || omitted.len() > 1, "{omitted:?}");
    let html = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(!html.replace("http://www.w3.org/2000/svg", "").contains("http"), "no address");
    assert!(!html.contains("<script") && !html.contains("<link"), "nothing to fetch");
    for (at, _) in html.match_indices("src=\"") {
        let name = html[at + 5..].split('"').next().unwrap();
        assert!(out.join(name).is_file(), "{name}");
    }
    assert!(html.matches("<img").count() > 5, "pictures and differences");
    is_well_formed(&out.join("report.html"));
    is_well_formed(&out.join("plots/ball.svg"));
    // Black where nothing is off: most of the background.
    let off = out.join("pictures/ball/aa-none-samples-1-off.png");
    let off = read_image(&off, &ReadOptions::default()).unwrap();
    let Some(Samples::U8(red)) = off.plane(Kind::Red) else { panic!("8 bits") };
    assert!(red[0] == 0 && red.iter().any(|&byte| byte > 40), "edges are off");
}

#[test]
fn a_sweep_that_is_killed_goes_on_where_it_was() {
    let folder = folder();
    let folder = folder.path();
    let options = "--size 24x24 --reference 8 --quick --seconds 3600 --threads 1";
    text(folder, &format!("ball.sdl -o whole {options}"));
    let expected = timeless(&folder.join("whole"));
    let lines = fs::read_to_string(folder.join("whole/measurements.tsv")).unwrap().lines().count();
    // After so many measurements; how far it gets in writing the next is up to chance.
    for kills in [vec![0], vec![3, 9], vec![lines - 4]] {
        let name = format!("killed-{}", kills.len() + kills[0]);
        for after in kills {
            let mut child = command(folder, &format!("ball.sdl -o {name} {options} -v"))
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let mut stages = child.stderr.take().unwrap();
            let (mut told, mut byte) = (0, [0]);
            while told <= after && stages.read(&mut byte).unwrap() == 1 {
                told += usize::from(byte[0] == b'\n');
            }
            child.kill().unwrap();
            child.wait().unwrap();
        }
        text(folder, &format!("ball.sdl -o {name} {options}"));
        assert_eq!(timeless(&folder.join(&name)), expected, "{name}");
        let journal = fs::read_to_string(folder.join(&name).join("measurements.tsv")).unwrap();
        let mut keys: Vec<&str> =
            journal.lines().filter_map(|line| line.split('\t').next()).collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!((keys.len(), count), (lines, lines), "every measurement once");
    }
    // Nothing is measured twice: the second run says the same, times too.
    let first = text(folder, &format!("ball.sdl -o whole {options}"));
    assert_eq!(text(folder, &format!("ball.sdl -o whole {options}")), first);
    // Measured anew.
    text(folder, &format!("ball.sdl -o whole {options} --fresh -q"));
    assert_eq!(timeless(&folder.join("whole")), expected);
}

#[test]
fn time_that_is_over_leaves_a_report_and_says_so() {
    let folder = folder();
    let output = run(folder.path(), "ball.sdl -o out --size 16x16 --seconds 0.000001");
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("measurements are missing"), "{said}");
    let missing = csv(&folder.path().join("out/missing.csv"));
    assert!(missing.iter().any(|line| line[1].contains("no time")), "{missing:?}");
    is_well_formed(&folder.path().join("out/report.html"));
}

#[test]
fn seeds_definitions_and_several_scenes_are_told_apart() {
    let folder = folder();
    let folder = folder.path();
    let scene = SCENE.replace("scale 0.5", "scale size");
    fs::create_dir(folder.join("sub")).unwrap();
    fs::write(folder.join("sub/ball.sdl"), format!("let size = 0.5\n{scene}")).unwrap();
    let options = "--size 16x16 --reference 4 --quick --seconds 3600 -q";
    text(folder, &format!("ball.sdl sub/ball.sdl -o out --seeds 2 {options}"));
    let out = folder.join("out");
    let error = |scene: &str| -> Vec<String> {
        let lines = csv(&out.join("sampling.csv"));
        let row = lines.iter().find(|l| l[0] == scene && l[1] == "--aa stochastic --samples 4");
        row.unwrap()[4..].to_vec()
    };
    assert_eq!(error("ball"), error("ball-2"), "the same scene in other words");
    assert_eq!(error("ball")[2], "2", "seeds");
    text(folder, &format!("sub/ball.sdl -D size=1.5 -o out --seeds 2 {options}"));
    assert_ne!(error("ball"), Vec::<String>::new());
    let html = fs::read_to_string(out.join("report.html")).unwrap();
    assert_eq!(html.matches("<section id=").count(), 1, "the report of the last run");
}

#[test]
fn speed_measures_growing_scenes() {
    let folder = folder();
    let folder = folder.path();
    let options = "--max-n 100 --cases drilled,chain --size 64x64 --seconds 3600";
    let station = "camera at (0, 0, 9) object is sphere";
    fs::create_dir_all(folder.join("scenes/station")).unwrap();
    fs::write(folder.join("scenes/station/station.sdl"), station).unwrap();
    let said = text(folder, &format!("speed ball.sdl -o out {options}"));
    assert!(said.contains("| drilled | 100 |") && said.contains("wine-glass"), "{said}");
    let out = folder.join("out");
    let growth = rows(&out, "speed.csv", &[0, 1, 2, 6]);
    assert_eq!(growth[1..3], ["drilled | 10 | 11 | 4096", "drilled | 100 | 101 | 4096"]);
    assert_eq!(growth.len(), 1 + 4 + 3, "{growth:?}");
    assert!(growth.contains(&"scenes/station/station.sdl |  | 1 | 4096".into()), "{growth:?}");
    let tracing = csv(&out.join("tracing.csv"));
    assert!(tracing.len() == 6 && tracing[1..].iter().all(|line| line[9] == "yes"), "{tracing:?}");
    let claims = csv(&out.join("claims.csv"));
    assert!(claims[1..].iter().all(|line| line[2].parse::<f64>().unwrap() > 0.0), "{claims:?}");
    let threads = csv(&out.join("threads.csv"));
    assert_eq!(threads.len(), 1 + 5, "two cases and three scenes");
    assert_eq!(csv(&out.join("missing.csv")).len(), 1, "all was measured");
    assert_eq!(csv(&out.join("trees.csv")).len(), 1, "one size alone says nothing of growth");
    for plot in ["trace", "build", "memory"] {
        is_well_formed(&out.join(format!("plots/{plot}.svg")));
    }
    is_well_formed(&out.join("report.html"));
    assert_eq!(text(folder, &format!("speed ball.sdl -o out {options} -q")), said, "resumed");
}

#[test]
fn a_measurement_ends_with_whoever_waits_for_it() {
    let folder = folder();
    let words = "measure tracing scattered 100000 4096x4096 --while-input";
    let mut child =
        command(folder.path(), words).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdin.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stdout), (Some(1), vec![]), "no figures");
    // With an input that is left open there are some.
    let words = "measure growth heap 10 8x8 --while-input";
    let mut child =
        command(folder.path(), words).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let input = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(input);
    assert!(output.status.success() && !output.stdout.is_empty(), "{output:?}");
}

#[test]
fn passes_are_measured_on_all_scenes() {
    let folder = folder();
    let folder = folder.path();
    fs::write(
        folder.join("empty.sdl"),
        "camera at (0, 0, 9) object is sphere * sphere at (7, 0, 0)",
    )
    .unwrap();
    let said = text(folder, "passes ball.sdl empty.sdl -o out --size 24x24");
    assert!(said.contains("| geometric mean |") && said.contains("| unreached |"), "{said}");
    let out = folder.join("out");
    // The far sphere of four objects is out of view, but its neighbours mirror; the other scene has nothing left.
    let saved = csv(&out.join("saved.csv"));
    assert_eq!(saved[1][..3], ["ball", "5", "5"], "{saved:?}");
    assert_eq!(saved[2][..3], ["empty", "2", "0"], "{saved:?}");
    assert!(saved[1..3].iter().all(|line| line[8] == "yes"), "{saved:?}");
    let passes = csv(&out.join("passes.csv"));
    let empty = passes.iter().find(|line| line[0] == "empty" && line[1] == "empty").unwrap();
    assert_eq!(empty[3..5], ["1", "0"], "{passes:?}");
    assert!(empty[7].parse::<f64>().unwrap() > 0.0, "{passes:?}");
    is_well_formed(&out.join("report.html"));
    assert_eq!(text(folder, "passes ball.sdl empty.sdl -o out --size 24x24 -q"), said, "resumed");
}

/// Lines of blocks of commands in a page.
fn commands(page: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(page);
    let text = fs::read_to_string(path).unwrap();
    let mut lines = Vec::new();
    let mut is_inside = false;
    for line in text.lines() {
        if line.starts_with("```") {
            is_inside = line == "```sh";
        } else if is_inside && line.starts_with("prreport") {
            lines.push(line.to_owned());
        }
    }
    lines
}

#[test]
fn commands_of_the_pages_work_as_written_on_small_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    std::os::unix::fs::symlink(scenes, folder.path().join("scenes")).unwrap();
    let programs = Path::new(env!("CARGO_BIN_EXE_prreport")).parent().unwrap().to_owned();
    let path = std::env::join_paths(
        [programs].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    )
    .unwrap();
    let mut seen = [false; 3];
    for command in ["report.md", "speed.md"].into_iter().flat_map(commands) {
        let (kind, small) = match command.split(' ').nth(1) {
            Some("speed") => (0, "--size 16x16 --max-n 10"),
            Some("passes") => (1, "--size 8x8"),
            _ => (2, "--size 16x16 --reference 4"),
        };
        seen[kind] = true;
        let mut shell = Command::new("bash");
        shell.args(["-c", &format!("{command} {small}")]).env("PATH", &path);
        let output = shell.current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{command}: {output:?}");
        let words: Vec<&str> = command.split(' ').collect();
        let out = words[words.iter().position(|word| *word == "-o").unwrap() + 1];
        is_well_formed(&folder.path().join(out).join("report.html"));
    }
    assert_eq!(seen, [true; 3], "each kind of report is shown");
}

#[test]
fn povray_is_measured_where_it_is_installed() {
    let folder = folder();
    let folder = folder.path();
    let pov = "#version 3.7; camera{location <0,2,9> look_at 0} light_source{<5,9,7> rgb 1} sphere{0,1 pigment{rgb x}}";
    fs::write(folder.join("other.pov"), pov).unwrap();
    let options = "-o out --size 24x24 --reference 4 --quick --seconds 3600 -q";
    text(folder, &format!("ball.sdl --povray other.pov {options}"));
    let rows = csv(&folder.join("out/povray.csv"));
    let missing = csv(&folder.join("out/missing.csv"));
    let is_absent = missing.iter().any(|line| line[1].contains("not installed"));
    assert!(is_absent || rows.len() == 11, "{rows:?} {missing:?}");
    if !is_absent {
        let error = |options: &str| -> f64 {
            rows.iter().find(|line| line[2] == options).unwrap()[4].parse().unwrap()
        };
        assert!(error("+AM2 +A0.03 +R4") < error("-A"), "{rows:?}");
    }
}

#[test]
fn help_says_how() {
    let folder = folder();
    let help = text(folder.path(), "--help");
    assert!(help.contains("prreport speed -o speed") && help.contains("--fresh"), "{help}");
    let named = help.lines().any(|line| line.trim_start().starts_with("measure "));
    assert!(!named, "processes of its own are nobody's business: {help}");
    assert!(text(folder.path(), "speed --help").contains("--max-n"));
    assert!(text(folder.path(), "--version").starts_with("prreport "));
    assert!(text(folder.path(), "--man").contains(".TH prreport"));
    assert!(text(folder.path(), "--completions bash").contains("--reference"));
}

#[test]
fn bad_invocations_fail_with_a_reason() {
    let folder = folder();
    fs::write(folder.path().join("file"), "x").unwrap();
    fs::write(folder.path().join("wine-glass"), SCENE).unwrap();
    fs::write(folder.path().join("wrong.sdl"), "object is glas").unwrap();
    fs::create_dir(folder.path().join("taken")).unwrap();
    fs::write(folder.path().join("taken/measurements.tsv"), "a,b\n").unwrap();
    for (arguments, status, reason) in [
        ("", 2, "SCENE"),
        ("ball.sdl", 2, "--output"),
        ("ball.sdl -o out --size 0x9", 2, "a whole number from 1"),
        ("ball.sdl -o out --seconds 0", 2, "expected a number above 0"),
        ("ball.sdl -o out --seeds 0", 2, "0 is not in"),
        ("ball.sdl -o out --reference 0", 2, "0 is not in"),
        ("ball.sdl ball.sdl -o out --povray a.pov", 2, "one file shows one scene"),
        ("nothing.sdl -o out", 1, "nothing.sdl"),
        ("wrong.sdl -o out", 1, "unknown class `glas`"),
        ("ball.sdl -o out -D x=1", 1, "x"),
        ("ball.sdl -o file", 1, "cannot make the folder file"),
        ("ball.sdl -o taken", 1, "expected `prreport 1`"),
        ("passes ball.sdl", 2, "--output"),
        ("passes -o out", 2, "SCENE"),
        ("passes ball.sdl -o out --threads 2", 2, "one thread"),
        ("passes nothing.sdl -o out", 1, "nothing.sdl"),
        ("speed", 2, "--output"),
        ("speed -o out --cases tower", 2, "expected some of scattered"),
        ("speed -o out --max-n 3", 2, "3 is not in"),
        ("speed -o out --threads 2", 2, "one thread and two"),
        ("speed nothing.sdl -o out", 1, "nothing.sdl"),
        ("speed wine-glass -o out", 2, "a generated scene has this name"),
    ] {
        let (found, message) = failure(folder.path(), arguments);
        assert_eq!(found, Some(status), "{arguments}: {message}");
        assert!(message.contains(reason), "{arguments}: {message}");
        assert!(message.contains("prreport: "), "{message}");
    }
    assert!(!folder.path().join("out").exists(), "nothing is made in vain");
}
