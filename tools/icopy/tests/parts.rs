//! Parts of a picture, put together by the real program.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use idf::part::{Part, Share, Tiles};
use idf::{
    Ask, Image, Kind, Plane, ReadOptions, Samples, Transfer, Window, WriteOptions, read, write,
};

const CANVAS: [u32; 2] = [20, 12];

fn icopy(folder: &Path, words: &str) -> Output {
    let words = words.split_whitespace();
    Command::new(env!("CARGO_BIN_EXE_icopy")).args(words).current_dir(folder).output().unwrap()
}

fn says(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A pixel of the picture.
fn value(at: u32) -> u16 {
    u16::try_from(at * 37 % 65_521).unwrap()
}

/// Samples of a window of the picture.
fn samples(window: Window) -> Vec<u16> {
    let pixel = |at: u32| {
        let column = window.column.unsigned_abs() + at % window.columns;
        value((window.row.unsigned_abs() + at / window.columns) * CANVAS[0] + column)
    };
    (0..window.columns * window.rows).map(pixel).collect()
}

/// An image of colour and measured values at `window`.
fn image(window: Window) -> Image {
    let values = samples(window);
    let bytes = values.iter().map(|v| v.to_le_bytes()[0]).collect::<Vec<u8>>();
    let floats = values.iter().map(|&v| f32::from(v) / 3.0).collect();
    let mut planes: Vec<Plane> = [Kind::Red, Kind::Grn, Kind::Blu]
        .map(|kind| Plane { kind, samples: Samples::U8(bytes.clone()) })
        .into();
    planes.push(Plane { kind: Kind::Dep, samples: Samples::F32(floats) });
    planes.push(Plane { kind: Kind::Obj, samples: Samples::U16(values) });
    let mut image = Image::new(window.columns, window.rows, planes).unwrap();
    image.properties.transfer = Some(Transfer::Srgb);
    image.properties.origin = [window.column, window.row];
    image
}

/// Writes a part of the picture of a number.
fn put(folder: &Path, name: &str, share: Share, picture: u128) {
    let mut image = image(share.frame(CANVAS));
    Part { share, canvas: CANVAS, picture }.mark(&mut image);
    write(&folder.join(name), &image, &WriteOptions::default()).unwrap();
}

fn tiles(number: u32, count: u32) -> Share {
    Share::Tiles(Tiles { number, count, side: 4 })
}

fn window(column: i32, row: i32, columns: u32, rows: u32) -> Share {
    Share::Window(Window { column, row, columns, rows })
}

/// A folder with the picture as `whole`, in four parts `t0` to `t3`, and in two windows `a` and `b`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let all = Window { column: 0, row: 0, columns: CANVAS[0], rows: CANVAS[1] };
    write(&folder.path().join("whole"), &image(all), &WriteOptions::default()).unwrap();
    for number in 0..4 {
        put(folder.path(), &format!("t{number}"), tiles(number, 4), 9);
    }
    put(folder.path(), "a", window(0, 0, 20, 5), 9);
    put(folder.path(), "b", window(0, 5, 20, 7), 9);
    folder
}

#[test]
fn parts_make_the_files_of_the_whole() {
    for parts in ["t0 t1 t2 t3", "t3 t1 t0.idf t2", "b a"] {
        let folder = folder();
        let output = icopy(folder.path(), &format!("{parts} out"));
        assert!(output.status.success(), "{parts}: {}", says(&output));
        for ending in ["red", "grn", "blu", "dep", "obj"] {
            let file = |name: &str| fs::read(folder.path().join(format!("{name}.{ending}")));
            assert!(file("out").unwrap() == file("whole").unwrap(), "{parts}: {ending}");
        }
        let options = ReadOptions { ask: Ask::All, ..ReadOptions::default() };
        let [out, whole] = ["out", "whole"].map(|name| read(&folder.path().join(name), &options));
        assert_eq!(out.unwrap(), whole.unwrap(), "and no part of anything");
    }
}

#[test]
fn parts_are_changed_on_the_way_as_any_image() {
    let folder = folder();
    let output = icopy(folder.path(), "t0 t1 t2 t3 out.png --crop 3,2,9,9");
    assert!(output.status.success(), "{}", says(&output));
    icopy(folder.path(), "whole expected.png --crop 3,2,9,9");
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(file("out.png") == file("expected.png"));
    // One part alone is an image like any other.
    for (words, is_part) in
        [("t1 one", true), ("t1 one --channels rgb", false), ("t1 one --flip x", false)]
    {
        let output = icopy(folder.path(), words);
        assert!(output.status.success(), "{}", says(&output));
        let part = Part::at(&folder.path().join("one")).unwrap();
        assert_eq!(part.is_some(), is_part, "{words}");
    }
}

#[test]
fn what_does_not_cover_the_picture_once_is_named() {
    let folder = folder();
    put(folder.path(), "other", tiles(1, 4), 10);
    put(folder.path(), "half", tiles(1, 2), 9);
    for (words, message) in [
        ("t0 t2", "parts 1, 3 are missing: "),
        ("t0 t2 t3", "part 1 is missing: 64 pixels are not covered, the first at column 4, row 0"),
        ("t0 t1 t1 t2 t3", "t1: column 4, row 0 is in part 1 of 4, too"),
        ("t0 t1 half", "half: column 4, row 0 is in part 1 of 4, too"),
        ("a t0", "t0: column 0, row 0 is in window 0,0,20,5, too"),
        ("t0 other", "other: a part of another picture than the first"),
        ("t0 whole", "found images among them that are no parts"),
    ] {
        let output = icopy(folder.path(), &format!("{words} out"));
        assert_eq!(output.status.code(), Some(1), "{words}: {}", says(&output));
        assert!(says(&output).contains(message), "{words}: {}", says(&output));
        assert!(!folder.path().join("out.idf").exists(), "{words}: nothing is written");
    }
    let mut bytes = fs::read(folder.path().join("t2.obj")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(folder.path().join("t2.obj"), bytes).unwrap();
    let output = icopy(folder.path(), "t0 t1 t2 t3 out");
    assert!(says(&output).contains("t2: the checksum of this part is wrong"), "{}", says(&output));
    fs::write(folder.path().join("t3.idf"), "idf 1\nsize 20 12\npart 3\n").unwrap();
    let output = icopy(folder.path(), "t0 t3 out");
    assert!(says(&output).contains("found `part 3`"), "{}", says(&output));
}

#[test]
fn windows_are_pasted_into_pictures_that_are_no_parts() {
    let folder = folder();
    let output = icopy(folder.path(), "whole a out");
    assert!(output.status.success(), "{}", says(&output));
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(file("out.dep") == file("whole.dep"));
}
