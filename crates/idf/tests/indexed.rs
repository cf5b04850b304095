//! Indices with their table in other formats: PNG and GIF, in and out, and animations.
#![cfg(feature = "exchange")]
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::{Path, PathBuf};

use idf::exchange::{read_image, read_stream, write_frames, write_image};
use idf::plane::COLOR;
use idf::{Ask, Image, Kind, Lut, Matte, Plane, ReadOptions, Samples, WriteOptions};

/// An image of indices into `entries`, all of which it uses but the last.
fn indexed(columns: u32, rows: u32, entries: &[[u8; 4]]) -> Image {
    let used = entries.len().max(2) - 1;
    let indices = (0..(columns * rows) as usize).map(|at| u8::try_from(at % used).unwrap());
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(indices.collect()) };
    let mut image = Image::new(columns, rows, vec![plane]).unwrap();
    image.lut = Lut::with_coverage(entries.to_vec());
    image
}

/// Colours that are all different, with coverage by `coverage`.
fn entries(count: u8, coverage: impl Fn(u8) -> u8) -> Vec<[u8; 4]> {
    (0..count).map(|at| [255 - at, at, at.wrapping_mul(7), coverage(at)]).collect()
}

fn options(ask: Ask) -> ReadOptions {
    ReadOptions { ask, ..ReadOptions::default() }
}

/// Writes `image`, and reads indices and table.
fn there_and_back(folder: &Path, image: &Image, ending: &str) -> (Image, PathBuf) {
    let path = folder.join(format!("x.{ending}"));
    write_image(&path, image, &WriteOptions::default()).unwrap();
    let back = read_image(&path, &options(Ask::Only(vec![Kind::Enc, Kind::Lut]))).unwrap();
    (back, path)
}

fn indices(image: &Image) -> &[u8] {
    match image.plane(Kind::Enc) {
        Some(Samples::U8(indices)) => indices,
        other => panic!("{other:?}"),
    }
}

#[test]
fn png_keeps_the_table_in_its_order_and_has_the_fewest_bits() {
    let folder = tempfile::tempdir().unwrap();
    for (count, bits) in [(1, 1), (2, 1), (3, 2), (4, 2), (5, 4), (16, 4), (17, 8), (255, 8)] {
        for coverage in [|_| 255, |at: u8| at.wrapping_mul(3)] {
            let image = indexed(13, 7, &entries(count, coverage));
            let (back, path) = there_and_back(folder.path(), &image, "png");
            assert_eq!(back.planes(), image.planes(), "{count}");
            assert_eq!(back.lut, image.lut, "{count}");
            // Depth and kind of colour, 3 for indices, in the header.
            assert_eq!(fs::read(&path).unwrap()[24..26], [bits, 3], "{count}");
            let colors = read_image(&path, &options(Ask::Picture)).unwrap();
            assert_eq!(colors.planes(), image.resolved().unwrap().planes(), "{count}");
        }
    }
}

#[test]
fn indices_come_with_colors_where_both_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let image = indexed(4, 1, &[[1, 2, 3, 255], [4, 5, 6, 128], [7, 8, 9, 0]]);
    let (_, path) = there_and_back(folder.path(), &image, "png");
    let ask = Ask::Only(vec![Kind::Enc, Kind::Cvg, Kind::Blu]);
    let both = read_image(&path, &options(ask)).unwrap();
    assert_eq!(both.kinds(), [Kind::Blu, Kind::Cvg, Kind::Enc]);
    assert_eq!(both.plane(Kind::Cvg), Some(&Samples::U8(vec![255, 128, 255, 128])));
    assert_eq!(both.properties.matte, Matte::Straight);
}

#[test]
fn light_and_coverage_planes_go_before_indices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let mut planes = indexed(2, 1, &[[1, 2, 3, 255]; 2]).planes().to_vec();
    planes.push(Plane { kind: Kind::Cvg, samples: Samples::U8(vec![255, 0]) });
    let mut image = Image::new(2, 1, planes).unwrap();
    image.lut = Lut::new(vec![[1, 2, 3]]);
    image.properties.matte = Matte::Straight;
    write_image(&path, &image, &WriteOptions::default()).unwrap();
    assert_eq!(fs::read(&path).unwrap()[25], 6, "colour and coverage");
    let back = read_image(&path, &ReadOptions::default()).unwrap();
    assert_eq!(back.plane(Kind::Cvg), image.plane(Kind::Cvg));
}

#[test]
fn gif_keeps_the_table_and_its_holes() {
    let folder = tempfile::tempdir().unwrap();
    // A file's table has 2, 4, 8 ... colours; black fills it up.
    for (count, stored) in [(1, 2), (3, 4), (16, 16), (200, 256)] {
        let image = indexed(13, 7, &entries(count, |_| 255));
        let (back, path) = there_and_back(folder.path(), &image, "gif");
        assert_eq!(indices(&back), indices(&image), "{count}");
        let table = back.lut.unwrap();
        let colors = image.lut.as_ref().unwrap().colors();
        assert_eq!(table.colors().len(), stored);
        assert_eq!(table.colors()[..colors.len()], *colors);
        assert_eq!(table.coverage(), None);
        let colors = read_image(&path, &options(Ask::Picture)).unwrap();
        assert_eq!(colors.planes(), image.resolved().unwrap().planes(), "{count}");
    }
    // Below a half is a hole, and all holes are the first of them.
    let holed = indexed(5, 1, &[[1; 4], [2, 2, 2, 200], [3, 3, 3, 127], [4, 4, 4, 128], [9; 4]]);
    let (back, path) = there_and_back(folder.path(), &holed, "gif");
    assert_eq!(indices(&back), [0, 1, 0, 3, 0]);
    let coverage: Vec<u8> = back.lut.unwrap().entries().map(|entry| entry[3]).collect();
    assert_eq!(coverage, [0, 255, 255, 255, 255, 255, 255, 255]);
    let read = read_image(&path, &options(Ask::Picture)).unwrap();
    assert_eq!(read.plane(Kind::Cvg), Some(&Samples::U8(vec![0, 255, 0, 255, 0])));
}

#[test]
fn gif_needs_indices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.gif");
    let plane = |kind| Plane { kind, samples: Samples::U8(vec![1]) };
    let image = Image::new(1, 1, COLOR.map(plane).into()).unwrap();
    let error = write_image(&path, &image, &WriteOptions::default()).unwrap_err();
    let source = std::error::Error::source(&error).unwrap().to_string();
    assert_eq!(
        source,
        "expected channels enc and lut alone, found red grn blu; make them with iencode"
    );
    assert!(!path.exists());
}

#[test]
fn an_index_beyond_the_table_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut image = indexed(4, 1, &entries(5, |_| 255));
    image.lut = Lut::new(vec![[0; 3]; 3]);
    for ending in ["png", "gif"] {
        let path = folder.path().join(format!("x.{ending}"));
        let error = write_image(&path, &image, &WriteOptions::default()).unwrap_err().to_string();
        assert!(error.ends_with("index 3, expected one of 3 colours"), "{error}");
        assert!(!path.exists());
    }
}

#[test]
fn a_table_of_other_light_is_written_as_srgb() {
    let folder = tempfile::tempdir().unwrap();
    let mut image = indexed(2, 1, &[[55, 128, 255, 255]; 2]);
    image.properties.transfer = Some(idf::Transfer::Linear);
    let (back, _) = there_and_back(folder.path(), &image, "png");
    // 55/255 of light is stored as 0.5017 of sRGB, 128/255 as 0.7370.
    assert_eq!(back.lut.unwrap().colors()[0], [128, 188, 255]);
}

/// Delay, transparent index, and left, top, columns and rows of a frame.
type FrameHead = (u16, Option<u8>, [u16; 4]);

/// Walks the blocks of a GIF: its frames, and how often they are repeated, if that is said.
fn frames(file: &[u8]) -> (Vec<FrameHead>, Option<u16>) {
    let word = |at: usize| u16::from_le_bytes([file[at], file[at + 1]]);
    let table = |flags: u8| if flags & 0x80 != 0 { 3 << ((flags & 7) + 1) } else { 0 };
    let skip = |mut at: usize| {
        while file[at] != 0 {
            at += 1 + usize::from(file[at]);
        }
        at + 1
    };
    let (mut at, mut found, mut repeats, mut control) = (13 + table(file[10]), vec![], None, None);
    loop {
        match file[at] {
            0x21 if file[at + 1] == 0xf9 => {
                control = Some((word(at + 4), (file[at + 3] & 1 == 1).then_some(file[at + 6])));
                at = skip(at + 2);
            }
            0x21 => {
                if &file[at + 3..at + 14] == b"NETSCAPE2.0" {
                    repeats = Some(word(at + 16));
                }
                at = skip(at + 2);
            }
            0x2c => {
                let (delay, hole) = control.take().unwrap();
                found.push((delay, hole, [1, 3, 5, 7].map(|offset| word(at + offset))));
                at = skip(at + 10 + table(file[at + 9]) + 1);
            }
            0x3b => return (found, repeats),
            other => panic!("block {other:#x}"),
        }
    }
}

#[test]
fn frames_make_an_animation_on_a_screen_that_holds_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.gif");
    let mut first = indexed(3, 2, &entries(4, |_| 255));
    first.properties.origin = [-1, 5];
    let mut second = indexed(2, 2, &entries(4, |at| if at == 1 { 0 } else { 255 }));
    second.properties.origin = [2, 4];
    let images = [first, second];
    for (times, repeats) in [(0, Some(0)), (1, None), (3, Some(2))] {
        write_frames(&path, &images, 25, times).unwrap();
        let file = fs::read(&path).unwrap();
        assert_eq!(file[6..10], [5, 0, 3, 0], "a screen of 5 x 3");
        let expected = vec![(25, None, [0, 1, 3, 2]), (25, Some(1), [3, 0, 2, 2])];
        assert_eq!(frames(&file), (expected, repeats));
    }
    // The first frame is what is read, on the screen, with nothing beside it.
    let read = read_image(&path, &ReadOptions::default()).unwrap();
    assert_eq!(read.size(), [5, 3]);
    let Some(Samples::U8(coverage)) = read.plane(Kind::Cvg) else { panic!("no coverage") };
    assert_eq!(coverage[..], [0, 0, 0, 0, 0, 255, 255, 255, 0, 0, 255, 255, 255, 0, 0]);
    let Some(Samples::U8(red)) = read.plane(Kind::Red) else { panic!("no red") };
    assert_eq!(red[5..8], [255, 254, 253]);
    let error = write_frames(&path, &[], 1, 1).unwrap_err();
    let source = std::error::Error::source(&error).unwrap().to_string();
    assert_eq!(source, "expected a picture, found none");
}

#[test]
fn indices_are_read_from_streams() {
    let folder = tempfile::tempdir().unwrap();
    let image = indexed(3, 2, &entries(4, |_| 255));
    for ending in ["png", "gif"] {
        let (_, path) = there_and_back(folder.path(), &image, ending);
        let file = fs::read(path).unwrap();
        let ask = Ask::Only(vec![Kind::Enc]);
        let read = read_stream(Path::new("x"), file.as_slice(), &options(ask)).unwrap();
        assert_eq!(read.kinds(), [Kind::Enc], "{ending}");
        assert_eq!(indices(&read), indices(&image), "{ending}");
    }
}
