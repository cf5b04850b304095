//! Parts of one picture, put together by the real program; windows of several pictures are composited.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::path::Path;
use std::process::{Command, Output};

use idf::part::{Part, Share, Tiles};
use idf::{Ask, Image, Kind, Plane, ReadOptions, Samples, Window, WriteOptions, read, write};

const CANVAS: [u32; 2] = [8, 4];

fn icomp(folder: &Path, words: &str) -> Output {
    let words = words.split_whitespace();
    Command::new(env!("CARGO_BIN_EXE_icomp")).args(words).current_dir(folder).output().unwrap()
}

fn says(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Writes a part whose grey is `value` and whose depth is a third of that.
fn put(folder: &Path, name: &str, share: Share, picture: u128, value: u8) {
    let Window { column, row, columns, rows } = share.frame(CANVAS);
    let pixels = (columns * rows) as usize;
    let planes = vec![
        Plane { kind: Kind::Grg, samples: Samples::U8(vec![value; pixels]) },
        Plane { kind: Kind::Dep, samples: Samples::F32(vec![f32::from(value) / 3.0; pixels]) },
    ];
    let mut image = Image::new(columns, rows, planes).unwrap();
    image.properties.origin = [column, row];
    Part { share, canvas: CANVAS, picture }.mark(&mut image);
    write(&folder.join(name), &image, &WriteOptions::default()).unwrap();
}

fn out(folder: &Path) -> Image {
    read(&folder.join("out"), &ReadOptions { ask: Ask::All, ..ReadOptions::default() }).unwrap()
}

#[test]
fn parts_over_each_other_are_the_picture_with_all_its_channels() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let tiles = |number| Share::Tiles(Tiles { number, count: 2, side: 2 });
    put(folder, "a", tiles(0), 5, 10);
    put(folder, "b", tiles(1), 5, 200);
    let output = icomp(folder, "over a b -o out");
    assert!(output.status.success(), "{}", says(&output));
    // A board of squares of 2 x 2.
    let expected: Vec<u8> =
        (0..32).map(|at| if (at % 8 / 2 + at / 8 / 2) % 2 == 0 { 10 } else { 200 }).collect();
    let image = out(folder);
    let depths = expected.iter().map(|&value| f32::from(value) / 3.0).collect();
    assert_eq!(image.plane(Kind::Grg), Some(&Samples::U8(expected)));
    assert_eq!(image.plane(Kind::Dep), Some(&Samples::F32(depths)));
    assert!(image.plane(Kind::Cvg).is_none() && image.properties.unknown.is_empty());
    for (words, message) in [
        ("over a a -o out", "a: column 0, row 0 is in part 0 of 2, too"),
        ("over b b a -o out", "b: column 2, row 0 is in part 1 of 2, too"),
    ] {
        let output = icomp(folder, words);
        assert_eq!(output.status.code(), Some(1), "{words}");
        assert!(says(&output).contains(message), "{words}: {}", says(&output));
    }
    put(folder, "other", tiles(1), 6, 200);
    let output = icomp(folder, "over a other -o out");
    assert_eq!(output.status.code(), Some(1), "tiles of two pictures");
    assert!(says(&output).contains("other: "), "{}", says(&output));
    put(folder, "c", Share::Tiles(Tiles { number: 2, count: 3, side: 2 }), 5, 1);
    put(folder, "d", Share::Tiles(Tiles { number: 1, count: 3, side: 2 }), 5, 1);
    let output = icomp(folder, "over c d -o out");
    assert!(says(&output).contains("part 0 is missing: "), "{}", says(&output));
}

#[test]
fn windows_of_two_pictures_are_composited() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let window = Share::Window(Window { column: 0, row: 0, columns: 8, rows: 4 });
    put(folder, "front", window, 5, 10);
    put(folder, "back", window, 6, 200);
    let output = icomp(folder, "over front back -o out");
    assert!(output.status.success(), "{}", says(&output));
    let image = out(folder);
    assert_eq!(image.plane(Kind::Grg), Some(&Samples::U8(vec![10; 32])));
    assert!(image.properties.unknown.is_empty(), "no part: {:?}", image.properties);
}
