//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use idf::exchange::read_image;
use idf::plane::COLOR;
use idf::{Depth, Image, ReadOptions};

fn istars(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_istars");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// Standard output where all went well; nothing else was said.
fn text(folder: &Path, arguments: &str) -> String {
    let output = istars(folder, arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn open(folder: &Path, name: &str) -> Image {
    let options = ReadOptions { history: true, ..ReadOptions::default() };
    read_image(&folder.join(name), &options).unwrap()
}

/// The light of all pixels, by channel.
fn sums(folder: &Path, name: &str) -> [f64; 3] {
    let image = open(folder, name);
    COLOR.map(|kind| image.decoded(kind).unwrap().iter().map(|&value| f64::from(value)).sum())
}

#[test]
fn a_sky_is_an_image() {
    let folder = tempfile::tempdir().unwrap();
    text(folder.path(), "sky --size 90x60");
    let image = open(folder.path(), "sky");
    assert_eq!((image.size(), image.kinds(), image.depth()), ([90, 60], COLOR.into(), Depth::U8));
    let history = &image.properties.history;
    assert!(history.len() == 1 && history[0].contains("\tistars\t"), "{history:?}");
    // 60 x 40 degrees of 41 253, with 9096 · 10^(0.51 · 3.5) stars.
    assert!(history[0].contains("stars=32256"), "{history:?}");
    let some = sums(folder.path(), "sky");
    assert!(some.iter().all(|sum| (5.0..2000.0).contains(sum)), "{some:?}");
}

#[test]
fn every_option_has_its_effect() {
    let folder = tempfile::tempdir().unwrap();
    let usual = "--size 64x48 --faintest 9";
    text(folder.path(), &format!("usual {usual}"));
    let bytes = |name: &str| {
        ["red", "grn", "blu"]
            .map(|end| fs::read(folder.path().join(format!("{name}.{end}"))).unwrap())
    };
    for option in [
        "--seed 2",
        "--faintest 8",
        "--field 50",
        "--band 1",
        "--tilt -30",
        "--dust 0",
        "--white 5",
        "--spread 1.5",
        "--halo 0.5",
        "--depth 16",
    ] {
        let rest = if option.starts_with("--faintest") { "--size 64x48" } else { usual };
        text(folder.path(), &format!("other {rest} {option}"));
        assert_ne!(bytes("other"), bytes("usual"), "{option}");
    }
    for option in ["--threads 1", "--threads 3", "--seed 1", "-q", "--rle"] {
        text(folder.path(), &format!("same {usual} {option}"));
        assert_eq!(bytes("same"), bytes("usual"), "{option}");
    }
    text(folder.path(), &format!("raw {usual} --raw"));
    assert!(bytes("raw").iter().all(|plane| plane.len() == 64 * 48), "as they are");
    let output = istars(folder.path(), &format!("same {usual} -v"));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("stars to magnitude 9\n64 x 48, depth 8, red grn blu"), "{said}");
}

#[test]
fn light_in_floating_point_is_not_clamped() {
    let folder = tempfile::tempdir().unwrap();
    let usual = "--size 64x48 --faintest 6 --white 8";
    text(folder.path(), &format!("light.exr {usual}"));
    assert_eq!(open(folder.path(), "light.exr").depth(), Depth::F32);
    text(folder.path(), &format!("light {usual} --depth 32f"));
    let values = open(folder.path(), "light").decoded(COLOR[1]).unwrap();
    assert!(values.iter().any(|&value| value > 2.0), "a bright star is brighter than white");
    // Two magnitudes are a factor of 6.31.
    text(folder.path(), &format!("less.exr {usual}0 --depth 32f").replace("80", "6"));
    let [more, less] = [sums(folder.path(), "light"), sums(folder.path(), "less.exr")];
    for channel in 0..3 {
        let ratio = more[channel] / less[channel];
        assert!((ratio - 6.3096).abs() < 0.05, "{ratio}");
    }
}

#[test]
fn standard_output_gets_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let output = istars(folder.path(), "- --size 8x8");
    assert!(output.status.success() && output.stdout.starts_with(b"\x89PNG"), "{output:?}");
}

#[test]
fn help_has_examples() {
    let folder = tempfile::tempdir().unwrap();
    assert!(text(folder.path(), "--help").contains("istars stars --size 960x640"));
    assert!(text(folder.path(), "--version").starts_with("istars "));
    assert!(text(folder.path(), "--man").contains(".TH istars"));
    assert!(text(folder.path(), "--completions bash").contains("--faintest"));
}

#[test]
fn bad_invocations_fail_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, status, reason) in [
        ("", 2, "<OUT>"),
        ("a --size 8", 2, "columns and rows"),
        ("a --size 0x8", 2, "columns and rows"),
        ("a --size 4000000000x4", 2, "--size 4000000000x4"),
        ("a --faintest 26", 2, "from -1 to 25"),
        ("a --faintest 20", 2, "stars, at most 50000000"),
        ("a --faintest nan", 2, "from -1 to 25"),
        ("a --field 0", 2, "from 0.01 to 180"),
        ("a --band 0.5", 2, "from 1 to 1000"),
        ("a --spread 0", 2, "from 0.05 to 100"),
        ("a --halo 2", 2, "from 0 to 1"),
        ("a --depth 12", 2, "8, 16, 32f"),
        ("a --threads 0", 2, "--threads"),
        ("none/a --size 8x8", 1, "none"),
        ("a.jpg --size 8x8", 1, "a.jpg"),
    ] {
        let output = istars(folder.path(), arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments}: {message}");
        assert!(message.starts_with("istars: ") && message.contains(reason), "{message}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
}
