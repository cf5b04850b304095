//! What is wrong with a scene or a file is said with its place; nothing panics, and no output is touched.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use compile::compile_path;
use render::World;
use tempfile::TempDir;

use crate::support::{LISTING, files, portray, prcomp, shown, square};

const GOOD: &str = "object is red sphere camera at (0, 0, 5) ambient\n";

/// What stood where the programs are asked to write.
const BEFORE: &[u8] = b"before";
const OUTPUTS: [&str; 4] = ["out.png", "out.idf", "out.red", "out.prc"];

/// A folder with `bad.sdl` and outputs that are there already.
fn folder(bad: &[u8]) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("bad.sdl"), bad).unwrap();
    for output in OUTPUTS {
        fs::write(folder.path().join(output), BEFORE).unwrap();
    }
    folder
}

/// Neither program makes anything of `scene`, a name in `folder`, and all files stay as they were.
fn refused(folder: &Path, scene: &str) -> String {
    let before = listed(folder);
    let mut message = String::new();
    for output in ["out.idf", "new.png"] {
        let words = format!("@{scene} -q --size 8x8 -o @{output}");
        message = portray(folder, &words).expect_err(&format!("{scene} to {output}")).to_string();
    }
    if !scene.ends_with(".prc") {
        let status = prcomp(folder, &format!("@{scene} -q -o @out.prc"));
        assert_eq!(status, ExitCode::from(1), "prcomp {scene}");
    }
    assert!(listed(folder) == before, "{scene}: files changed");
    message
}

/// Files with what is in them; of large ones the length.
fn listed(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = files(folder);
    for (_, bytes) in files.iter_mut().filter(|(_, bytes)| bytes.len() > 1 << 20) {
        *bytes = bytes.len().to_string().into_bytes();
    }
    files
}

/// What the compiler says of `bad.sdl`, with the names of files alone.
fn report(folder: &Path) -> String {
    let report = compile_path(&folder.join("bad.sdl")).report();
    report.replace(&format!("{}/", folder.display()), "")
}

/// `text` is refused, and the report begins with this place and message.
fn wrong(text: impl AsRef<[u8]>, expected: &str) {
    let folder = folder(text.as_ref());
    let report = report(folder.path());
    assert!(report.starts_with(expected), "expected {expected}, found:\n{report}");
    assert!(report.len() < 10_000, "short");
    let message = refused(folder.path(), "bad.sdl");
    assert!(message.contains("bad.sdl"), "{message}");
}

#[test]
fn what_cannot_be_meant_is_refused_with_its_place() {
    for (text, expected) in [
        (format!("{GOOD}object is sphere scale 0"), "bad.sdl:2:24: error: a scale of 0"),
        (format!("{GOOD}object is cone scale (1, 0, 1)"), "bad.sdl:2:22: error: a scale of 0"),
        (
            "object is sphere\ncamera at (1, 2, 3) target at (1, 2, 3)".into(),
            "bad.sdl:2:21: error: the camera stands at its target",
        ),
        (format!("\n\n{GOOD})"), "bad.sdl:4:1: error: "),
        (format!("{GOOD}object is glas"), "bad.sdl:2:11: error: unknown class `glas`"),
        (format!("{GOOD}include \"none.sdl\""), "bad.sdl:2:9: error: cannot read `none.sdl`: "),
        (format!("{GOOD}include \".\""), "bad.sdl:2:9: error: cannot read `.`: "),
        (
            format!("{GOOD}  include \"bad.sdl\""),
            "bad.sdl:2:11: error: a file cannot include itself",
        ),
        (format!("{GOOD}fog 1e999"), "bad.sdl:2:5: error: number too large"),
        (format!("{GOOD}/* no end"), "bad.sdl:2:1: error: "),
    ] {
        wrong(text, expected);
    }
    wrong(b"object is sphere\n  \xff\xfe", "bad.sdl:2:3: error: the file is not UTF-8");
}

#[test]
fn a_cycle_over_files_names_them() {
    let folder = folder(b"object is sphere\ninclude \"a.sdl\"");
    fs::write(folder.path().join("a.sdl"), "include \"b.sdl\"").unwrap();
    fs::write(folder.path().join("b.sdl"), "\ninclude \"bad.sdl\"").unwrap();
    let report = report(folder.path());
    let first = report.lines().next().unwrap();
    assert!(first.starts_with("b.sdl:2:9: error: a file cannot include itself"), "{first}");
    assert!(["`bad.sdl`", "`a.sdl`", "`b.sdl`"].iter().all(|name| first.contains(name)), "{first}");
    refused(folder.path(), "bad.sdl");
}

#[test]
fn a_million_parentheses_and_a_line_of_a_hundred_megabytes() {
    let nested = format!("object is\n{}sphere{}", "(".repeat(1_000_000), ")".repeat(1_000_000));
    wrong(nested, "bad.sdl:2:50001: error: parentheses nest deeper than 50000");
    wrong("(".repeat(1_000_000), "bad.sdl:1:1: error: ");
    wrong(
        format!("{GOOD}fog {}", "7".repeat(100_000_000)),
        "bad.sdl:2:5: error: number too large: `7777",
    );
}

#[test]
fn what_nests_as_deep_as_it_may_is_rendered() {
    let folder = TempDir::new().unwrap();
    // A block without what is left of a block without …: every other one cancels, and the ball is left.
    let (open, close) = ("(block scale 1.5 - ".repeat(50_000), ")".repeat(50_000));
    let text = format!("camera at (0, 0, 9) ambient object is {open}sphere{close}");
    fs::write(folder.path().join("deep.sdl"), text).unwrap();
    for accel in ["none", "boxes", "bvh"] {
        let words = format!("@deep.sdl -q --size 8x8 --accel {accel} -o @{accel}.ppm");
        portray(folder.path(), &words).unwrap();
    }
    let mut pictures = files(folder.path());
    pictures.retain(|(name, _)| name.extension().is_some_and(|ending| ending == "ppm"));
    assert_eq!(pictures.len(), 3, "pictures");
    assert!(pictures.iter().all(|(_, bytes)| *bytes == pictures[0].1), "the same three times");
    fs::write(folder.path().join("ball.sdl"), "camera at (0, 0, 9) ambient object is sphere")
        .unwrap();
    portray(folder.path(), "@ball.sdl -q --size 8x8 -o @ball.ppm").unwrap();
    assert!(fs::read(folder.path().join("ball.ppm")).unwrap() == pictures[0].1, "the ball");
}

#[test]
fn every_prefix_of_the_listing_is_a_picture_or_a_message() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("prefix.sdl");
    let (mut pictures, mut refused) = (0, 0);
    for end in (0..LISTING.len()).step_by(7).chain(LISTING.len() - 60..=LISTING.len()) {
        fs::write(&path, &LISTING[..end]).unwrap();
        let compiled = compile_path(&path);
        match compiled.scene {
            Some(scene) if scene.camera.is_some() => {
                assert_eq!(shown(&scene, &square(4, 1)).pixels.len(), 16, "picture of {end} bytes");
                pictures += 1;
            }
            Some(scene) => {
                let error = World::load(&scene).expect_err("no camera").to_string();
                assert!(error.contains("no camera"), "{end} bytes: {error}");
            }
            None => {
                let report = compiled.error_report();
                let place = report.split("prefix.sdl:").nth(1).unwrap();
                let numbers: Vec<_> = place.splitn(3, ':').take(2).map(str::parse::<u32>).collect();
                assert!(numbers.iter().all(Result::is_ok), "{end} bytes: {report}");
                refused += 1;
            }
        }
    }
    assert!(pictures > 2 && refused > 50, "{pictures} pictures, {refused} refused");
}

#[test]
fn scenes_without_a_camera_are_told_what_to_add() {
    for text in ["", "\n // nothing\n", "object is sphere"] {
        let folder = folder(text.as_bytes());
        let before = files(folder.path());
        let error = portray(folder.path(), "@bad.sdl -q -o @out.png").unwrap_err().to_string();
        assert!(error.contains("camera at"), "{error}");
        assert!(files(folder.path()) == before, "untouched");
        // A scene all the same: the camera may come from a file that includes this one.
        assert_eq!(prcomp(folder.path(), "@bad.sdl -q --check"), ExitCode::SUCCESS, "checked");
    }
}

#[test]
fn a_scene_without_objects_is_background() {
    let folder = folder(b"camera at (0, 0, 5) background red");
    portray(folder.path(), "@bad.sdl -q --size 2x2 -o @new.ppm").unwrap();
    let picture = fs::read(folder.path().join("new.ppm")).unwrap();
    assert!(picture.ends_with(&[255, 0, 0].repeat(4)), "{picture:?}");
}

#[test]
fn damaged_compiled_scenes_are_refused_with_their_place() {
    let folder = folder(LISTING.as_bytes());
    assert_eq!(prcomp(folder.path(), "@bad.sdl -q -o @good.prc"), ExitCode::SUCCESS, "compiled");
    let good = fs::read_to_string(folder.path().join("good.prc")).unwrap();
    portray(folder.path(), "@good.prc -q --size 2x2 -o @good.png").unwrap();
    let lines = good.lines().count();
    let half = good.len() / 2;
    let cut = &good[..half];
    for (damaged, line) in [
        (String::new(), 1),
        ("nonsense".into(), 1),
        (good.replacen("portray scene 2", "portray scene 999", 1), 1),
        (cut.into(), cut.lines().count()),
        (good.replacen("cylinder", "cylindre", 1), line_of(&good, "cylinder")),
        (good.replacen("camera", "camera camera", 1), line_of(&good, "camera")),
        (format!("{good}more\n"), lines + 1),
        (good.replacen("1.65", "1.65x", 1), line_of(&good, "1.65")),
        (good.replacen("1.65", "-1.65", 1), line_of(&good, "1.65")),
        (good.replacen("1.65", "inf", 1), line_of(&good, "1.65")),
    ] {
        fs::write(folder.path().join("damaged.prc"), &damaged).unwrap();
        let message = refused(folder.path(), "damaged.prc");
        let place = format!("damaged.prc: line {line}, column ");
        assert!(message.contains(&place), "expected {place}, found {message}");
    }
    fs::write(folder.path().join("damaged.prc"), b"portray scene 2\n\xff\xff").unwrap();
    assert!(refused(folder.path(), "damaged.prc").contains("line 2"), "not UTF-8");
}

fn line_of(text: &str, word: &str) -> usize {
    text.lines().position(|line| line.contains(word)).unwrap() + 1
}

#[test]
fn each_byte_of_a_compiled_scene_may_be_damaged() {
    let good = {
        let mut text = Vec::new();
        scene::format::write(&crate::support::scene(LISTING), &mut text).unwrap();
        text
    };
    let (mut read, mut refused) = (0, 0);
    for at in (0..good.len()).step_by(5) {
        for byte in [b'9', b' ', 0xff] {
            let mut damaged = good.clone();
            damaged[at] = byte;
            match scene::format::read(&damaged) {
                Ok(scene) => {
                    World::load(&scene).ok();
                    read += 1;
                }
                Err(error) => {
                    assert!(error.line >= 1 && error.column >= 1, "byte {at}: {error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 10 * read / 3, "{read} read, {refused} refused");
}

#[test]
fn folders_and_missing_files_are_named() {
    let folder = folder(GOOD.as_bytes());
    for name in ["dir.sdl", "dir.prc", "dir"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        let message = refused(folder.path(), name);
        assert!(message.contains(name), "a folder: {message}");
    }
    for name in ["none.sdl", "none.prc", "none/none.sdl"] {
        let message = refused(folder.path(), name);
        assert!(message.contains(name), "missing: {message}");
    }
    fs::create_dir(folder.path().join("dir.png")).unwrap();
    let before = files(folder.path());
    for output in ["none/out.png", "none/out", "none/out.exr", "dir.png", "out.xyz"] {
        let error = portray(folder.path(), &format!("@bad.sdl -q --size 8x8 -o @{output}"));
        let message = idf::command::chain(error.unwrap_err().as_ref());
        assert!(message.contains(output.split('.').next().unwrap()), "{output}: {message}");
    }
    assert_eq!(prcomp(folder.path(), "@bad.sdl -q -o @none/out.prc"), ExitCode::from(1), "prcomp");
    assert_eq!(prcomp(folder.path(), "@bad.sdl -q -o @dir"), ExitCode::from(1), "prcomp");
    assert!(files(folder.path()) == before, "untouched");
}

#[test]
fn a_source_is_not_overwritten() {
    let folder = folder(GOOD.as_bytes());
    let before = files(folder.path());
    assert_eq!(prcomp(folder.path(), "@bad.sdl -q -o @bad.sdl"), ExitCode::from(2), "prcomp");
    assert!(portray(folder.path(), "@bad.sdl -q --size 8x8 -o @bad.sdl").is_err(), "portray");
    assert!(files(folder.path()) == before, "untouched");
}
