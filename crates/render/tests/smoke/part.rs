//! Parts and sequences: the pixels of the whole picture, whatever the split.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use idf::exchange::read_image;
use idf::part::{Assembly, Part};
use idf::{Ask, Image, ReadOptions, read};

use super::{folder, names, portray, says};

fn image(folder: &Path, name: &str) -> Image {
    let options = ReadOptions { ask: Ask::All, ..ReadOptions::default() };
    read(&folder.join(name), &options).unwrap()
}

fn done(folder: &Path, words: &str) {
    let output = portray(folder, words, "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{words}");
}

/// The picture that parts make, without their histories.
fn assembled(folder: &Path, parts: &[String]) -> Image {
    let mut assembly = Assembly::new(&image(folder, &parts[0])).unwrap();
    for part in &parts[1..] {
        assembly.add(&image(folder, part)).unwrap();
    }
    assembly.finish().unwrap()
}

/// Options that change what a pixel is made of, and how it is stored.
const OPTIONS: [&str; 7] = [
    "",
    "--aa adaptive --channels rgb,cvg,depth,normal,object",
    "--aa stochastic --samples 3 --seed 5 --filter mitchell",
    "--aa adaptive --filter tent",
    "--samples 4 --dither-output --filter tent",
    "--samples 4 --accel none --dither-output",
    "--channels cvg,object",
];

#[test]
fn parts_of_any_split_make_the_whole_picture() {
    for options in OPTIONS {
        let folder = folder();
        let words = format!("good.sdl --size 70x37 {options}");
        done(folder.path(), &format!("{words} -o whole"));
        let whole = image(folder.path(), "whole");
        for (count, tile) in [(1, ""), (3, ""), (7, "--tile 5"), (16, "--tile 33")] {
            let mut parts = Vec::new();
            for number in 0..count {
                let name = format!("part{number}");
                done(folder.path(), &format!("{words} -o {name} --part {number}/{count} {tile}"));
                parts.push(name);
            }
            // Of 16 parts some have no tiles of 33, and are not needed.
            assert!(assembled(folder.path(), &parts) == whole, "{count} {tile} {options}");
        }
    }
}

#[test]
fn windows_are_cut_out_of_the_whole_picture() {
    for options in OPTIONS {
        let folder = folder();
        let words = format!("good.sdl --size 70x37 {options}");
        done(folder.path(), &format!("{words} -o whole"));
        let windows = ["0,0,70,5", "0,5,33,32", "33,5,37,31", "33,36,37,1"];
        let mut parts = Vec::new();
        for (number, window) in windows.iter().enumerate() {
            let name = format!("window{number}");
            done(folder.path(), &format!("{words} -o {name} --window {window}"));
            parts.push(name);
        }
        assert_eq!(image(folder.path(), "window2").size(), [37, 31]);
        assert_eq!(image(folder.path(), "window2").properties.origin, [33, 5]);
        let whole = image(folder.path(), "whole");
        assert!(assembled(folder.path(), &parts) == whole, "{options}");
    }
}

#[test]
fn parts_of_pictures_in_other_formats_hold_what_those_need() {
    for options in ["", "--channels rgb,cvg"] {
        for ending in ["png", "exr"] {
            let folder = folder();
            let words = format!("good.sdl --size 40x30 --samples 4 {options}");
            done(folder.path(), &format!("{words} -o whole.{ending}"));
            let mut parts = Vec::new();
            for number in 0..3 {
                let part = format!("--part {number}/3 --part-of whole.{ending}");
                done(folder.path(), &format!("{words} -o part{number} {part}"));
                parts.push(format!("part{number}"));
            }
            let image = assembled(folder.path(), &parts);
            let path = folder.path().join(format!("parts.{ending}"));
            idf::exchange::write_image(&path, &image, &idf::WriteOptions::default()).unwrap();
            let whole = fs::read(folder.path().join(format!("whole.{ending}"))).unwrap();
            assert!(fs::read(path).unwrap() == whole, "{ending} {options}");
        }
    }
    let folder = folder();
    done(folder.path(), "good.sdl --size 40x30 -o whole.png");
    done(folder.path(), "good.sdl --size 40x30 -o window.png --window 3,4,20,10");
    let cut = |name: &str, [left, top]: [usize; 2]| -> Vec<u8> {
        let image = read_image(&folder.path().join(name), &ReadOptions::default()).unwrap();
        let columns = image.columns() as usize;
        let Some(idf::Samples::U8(red)) = image.plane(idf::Kind::Red) else { panic!() };
        let row = |row| red[(top + row) * columns + left..][..20].to_vec();
        (0..10).flat_map(row).collect()
    };
    assert_eq!(cut("whole.png", [3, 4]), cut("window.png", [0, 0]));
}

#[test]
fn the_identity_of_a_picture_is_that_of_what_it_is_made_of() {
    let folder = folder();
    let picture = |words: &str| {
        let words = format!("{words} -o part --part 0/2 --size 16x16");
        done(folder.path(), &words);
        Part::of(&image(folder.path(), "part")).unwrap().unwrap().picture
    };
    let usual = picture("good.sdl");
    for same in ["--threads 1", "--accel none", "--keep-all", "--raw", "--tile 4"] {
        assert_eq!(picture(&format!("good.sdl {same}")), usual, "{same}");
    }
    let compiled =
        compile::compile_path_with(&folder.path().join("good.sdl"), &compile::Options::default());
    let mut text = Vec::new();
    scene::format::write(&compiled.scene.unwrap(), &mut text).unwrap();
    fs::write(folder.path().join("good.prc"), text).unwrap();
    assert_eq!(picture("good.prc"), usual, "compiled before");
    for other in [
        "--samples 4",
        "--seed 1",
        "--depth 3",
        "--filter tent",
        "--channels rgb",
        "--dither-output",
    ] {
        assert!(picture(&format!("good.sdl {other}")) != usual, "{other}");
    }
    fs::write(folder.path().join("good.sdl"), super::GOOD.replace("blue", "green")).unwrap();
    assert!(picture("good.sdl") != usual, "another scene");
}

#[test]
fn pictures_that_a_scene_shows_are_in_its_identity() {
    let folder = folder();
    let star = |value: u8| {
        let plane = idf::Plane { kind: idf::Kind::Grg, samples: idf::Samples::U8(vec![value; 4]) };
        let image = Image::new(2, 2, vec![plane]).unwrap();
        idf::write(&folder.path().join("star"), &image, &idf::WriteOptions::default()).unwrap();
    };
    let text = "object is paint image (\"star\") sphere camera at (0, 0, 9)";
    fs::write(folder.path().join("good.sdl"), text).unwrap();
    let picture = || {
        done(folder.path(), "good.sdl -o part --part 0/2 --size 16x16");
        Part::of(&image(folder.path(), "part")).unwrap().unwrap().picture
    };
    star(7);
    let usual = picture();
    assert_eq!(picture(), usual);
    star(8);
    assert!(picture() != usual, "another picture of the same name");
}

#[test]
fn parts_that_make_no_sense_are_refused() {
    let folder = folder();
    let before = names(folder.path());
    for (words, message) in [
        ("--part 0/2 -o x.png", "a part is an IDF image, found `x.png`"),
        ("--part 2/2", "parts are numbered from 0 to 1"),
        ("--part 0/0", "expected a count from 1"),
        ("--part 1", "expected number and count of the parts, as 0/8"),
        ("--part 0/2 --window 0,0,8,8", "cannot be used with"),
        ("--part 0/2 --error 1", "--part and --error: it looks at the whole picture"),
        ("--part 0/2 --seconds 1", "--part and --seconds"),
        ("--part 0/2 --audit", "--part and --audit"),
        ("--window 0,0,8,8 --error 1", "--window and --error"),
        ("--part 0/2 --certify", "--part and --certify"),
        ("--window 0,0,513,8", "expected a window in a picture of 512x512"),
        ("--window 0,0,0,8", "a window has at least one column and row"),
        ("--window 0,0,8", "expected column, row, columns and rows"),
        ("--window -1,0,8,8", "expected column, row, columns and rows"),
        ("--tile 8", "--tile is for --part"),
        ("--tile 0 --part 0/2", "--tile"),
        ("--part-of x.png", "--part-of is for --part and --window"),
        ("--part-of x.png --window 0,0,8,8 -o y.png", "--part-of is for --part and --window"),
        ("--part-of x.gif --part 0/2", "cannot write `x.gif`"),
        ("--frames 5..3", "the first not above the last"),
        ("--frames 5", "expected the first and the last number, as 0..47"),
        ("--frames 0..3 -D frame=1", "leave -D frame out"),
        ("--frames 0..3 --stats x.json", "--stats tells of one picture"),
        ("--frames 0..3 -o -", "--frames writes several files"),
    ] {
        let output = portray(folder.path(), &format!("good.sdl {words}"), "");
        assert_eq!(output.status.code(), Some(2), "{words}: {}", says(&output));
        assert!(says(&output).contains(message), "{words}: {}", says(&output));
        assert_eq!(names(folder.path()), before, "{words}");
    }
    let output = portray(folder.path(), "- --frames 0..1", "");
    assert!(says(&output).contains("expected a scene description in a file"));
}

/// A scene whose pictures differ.
const MOVING: &str =
    "object is blue sphere at (frame / 9, 0, 0) light at (5, 9, 5) camera at (0, 1, 9)";

#[test]
fn an_animation_of_48_frames_is_stopped_five_times() {
    let folder = folder();
    fs::write(folder.path().join("moving.sdl"), MOVING).unwrap();
    let words = "moving.sdl --size 48x36 --samples 16 -v --frames 0..47";
    let finished = || {
        let all = names(folder.path());
        all.into_iter().filter(|name| name.starts_with("x-")).collect::<Vec<_>>()
    };
    let mut seen: Vec<(String, Vec<u8>)> = Vec::new();
    for stop in 1..=5 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_portray"))
            .current_dir(folder.path())
            .args(words.split_whitespace())
            .args(["-o", "x.png"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while finished().len() < 4 * stop {
            assert!(child.try_wait().unwrap().is_none(), "ended before it was stopped");
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let bytes = |name: &String| fs::read(folder.path().join(name)).unwrap();
        assert!(seen.iter().all(|(name, old)| bytes(name) == *old), "finished pictures stay");
        seen = finished().iter().map(|name| (name.clone(), bytes(name))).collect();
    }
    assert!(seen.len() < 48, "it was stopped before the end");
    let output = portray(folder.path(), &format!("{words} -o x.png"), "");
    let text = says(&output);
    let line = text.lines().find(|line| line.contains("pictures were finished before"));
    let before: usize = line.unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(before == seen.len() || before + 1 == seen.len(), "{before} of {}", seen.len());
    for number in 0..48 {
        done(
            folder.path(),
            &format!("moving.sdl -o y.png --size 48x36 --samples 16 -D frame={number}"),
        );
        let bytes = |name: String| fs::read(folder.path().join(name)).unwrap();
        assert!(bytes(format!("x-{number:04}.png")) == bytes("y.png".into()), "{number}");
    }
    let stray = names(folder.path()).into_iter().filter(|name| name.starts_with('.'));
    assert_eq!(stray.count(), 0, "what kills left is gone");
}

#[test]
fn pictures_of_other_options_or_scenes_are_not_taken_for_finished() {
    let folder = folder();
    let path = folder.path().join("moving.sdl");
    fs::write(&path, MOVING).unwrap();
    let finished = |options: &str| {
        let words = format!("moving.sdl -v --frames 2..5 -o x --size 16x12 {options}");
        let text = says(&portray(folder.path(), &words, ""));
        let line = text.lines().find(|line| line.contains("pictures were finished before"));
        line.map_or(0, |line| line.split(' ').next().unwrap().parse::<u32>().unwrap())
    };
    assert_eq!(finished(""), 0);
    assert_eq!(finished(""), 4);
    assert_eq!(finished("--threads 1"), 4, "the same pictures");
    assert_eq!(finished("--samples 4"), 0, "other options");
    assert_eq!(finished("--window 0,0,8,8"), 0, "a part of them");
    assert_eq!(finished(""), 0, "the whole again");
    // The picture of 3 alone is another.
    fs::write(&path, MOVING.replace("frame / 9", "min (frame, 4) / 9")).unwrap();
    assert_eq!(finished(""), 3, "one differs");
    fs::remove_file(folder.path().join("x-0004.grn")).unwrap();
    assert_eq!(finished(""), 3, "one has lost a channel");
}
