//! What the program says, and its exit status.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use crate::{done, farm, files, folder, says};

#[test]
fn what_makes_no_sense_is_said_at_once() {
    let folder = folder();
    fs::write(folder.path().join("bad.sdl"), "object is glas").unwrap();
    // A picture this large takes long: that the answer comes at all says that it came first.
    for (words, status, message) in [
        ("", 2, "--engine"),
        ("--engine local --window 0,0,8,8", 2, "--window: a farm renders whole pictures"),
        ("--engine local --part 0/2", 2, "--part: a farm renders whole pictures"),
        ("--engine local --stats x.json", 2, "--stats: a farm"),
        ("--engine local --audit", 2, "--audit: a farm"),
        ("--engine local --error 1", 2, "--error: samples are given"),
        ("--engine local --seconds 1", 2, "--seconds: samples are given"),
        ("--engine local -o -", 2, "expected a name"),
        ("--engine local --parts 0", 2, "--parts"),
        ("--engine local --sbatch -n1", 2, "--sbatch is for --engine slurm"),
        ("--engine slurm --jobs 2", 2, "--jobs is for --engine local"),
        ("--engine local --frames 3..1", 2, "the first not above the last"),
        ("--engine local --frames 0..3 -D frame=2", 2, "leave -D frame out"),
        ("--engine local -o none/x.png", 1, "none/x.png: No such file"),
        ("--engine local -o x.gif", 2, "cannot write `x.gif`"),
    ] {
        let output = done(folder.path(), &format!("--size 8000x8000 {words}"));
        assert_eq!(output.status.code(), Some(status), "{words}: {}", says(&output));
        assert!(says(&output).contains(message), "{words}: {}", says(&output));
    }
    let output = Command::new(env!("CARGO_BIN_EXE_prfarm"))
        .current_dir(folder.path())
        .args(["render", "bad.sdl", "--engine", "local"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(says(&output).contains("bad.sdl:1:11: error: unknown class `glas`"));
    assert!(files(folder.path(), "x").is_empty(), "nothing was written");
}

#[test]
fn a_cluster_that_is_not_there_is_said() {
    let folder = folder();
    let output = farm(folder.path(), "--engine slurm --size 64x64 -o x")
        .env("PATH", folder.path())
        .output()
        .unwrap();
    let text = says(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("is Slurm installed here?"), "{text}");
    assert!(text.contains("0 of 16 parts are finished, the same command goes on"), "{text}");
}

#[test]
fn a_worker_that_fails_is_heard() {
    let folder = folder();
    // The picture is there when the scene is compiled, and no picture.
    fs::write(folder.path().join("star.png"), "no picture").unwrap();
    fs::write(
        folder.path().join("scene.sdl"),
        "object is paint image (\"star.png\") sphere camera at (0, 0, 9)",
    )
    .unwrap();
    let output = done(folder.path(), "--engine local --parts 2 --size 16x16 -o x");
    let text = says(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("has failed 3 times: "), "{text}");
    assert!(text.contains("star.png"), "{text}");
}

#[test]
fn workers_say_what_is_wrong_with_their_folder() {
    let folder = folder();
    for (words, message) in [
        (["part", "none", "0"], "none/job.json: No such file"),
        (["part", ".", "x"], "invalid value 'x'"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_prfarm"))
            .current_dir(folder.path())
            .args(words)
            .output()
            .unwrap();
        assert!(!output.status.success());
        assert!(says(&output).contains(message), "{}", says(&output));
    }
}

#[test]
fn every_option_is_in_a_test() {
    let help = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_prfarm")).args(words).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let options = |text: &str| -> BTreeSet<String> {
        let words = text.split(|c: char| c.is_whitespace() || ",[]=<>`".contains(c));
        words.filter(|word| word.starts_with("--")).map(str::to_owned).collect()
    };
    let all = options(&help(&["render", "--help"]));
    for own in ["--engine", "--parts", "--jobs", "--retries", "--sbatch", "--keep-parts"] {
        assert!(all.contains(own), "{own} of {all:?}");
    }
    // Options of a picture are those of portray, and tested there.
    for option in ["--frames", "--samples", "--size", "--tile", "--channels"] {
        assert!(all.contains(option), "{option} of {all:?}");
    }
    assert!(help(&["--help"]).contains("Examples:"));
}

#[test]
fn tiles_are_as_large_as_is_asked_for() {
    let folder = folder();
    let small = "--engine local --size 40x30 --parts 3 --threads 2";
    let output = done(folder.path(), &format!("{small} --tile 5 -o x --keep-parts"));
    assert_eq!(output.status.code(), Some(0), "{}", says(&output));
    let text = fs::read_to_string(folder.path().join("x.farm/scene-0001.idf")).unwrap();
    assert!(text.contains("\npart 1 of 3 tiles 5 canvas 40 30 "), "{text}");
    let output = done(folder.path(), &format!("{small} -q -o v1.2.png"));
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
}
