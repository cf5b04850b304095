//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Depth, Image, Kind, Matte, Plane, ReadOptions, Samples, Transfer, WriteOptions, write};

/// A picture of linear bytes, 2 x 2.
fn picture(kinds: &[(Kind, [u8; 4])]) -> Image {
    let plane =
        |&(kind, samples): &(Kind, [u8; 4])| Plane { kind, samples: Samples::U8(samples.into()) };
    let mut image = Image::new(2, 2, kinds.iter().map(plane).collect()).unwrap();
    image.properties.transfer = Some(Transfer::Linear);
    image.properties.history = vec!["drawn".into()];
    image
}

/// A folder with images `a`, with coverage, and `b`, grey and opaque.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let a = picture(&[
        (Kind::Red, [100, 100, 0, 7]),
        (Kind::Grn, [0, 51, 0, 8]),
        (Kind::Blu, [10, 20, 0, 9]),
        (Kind::Cvg, [102, 102, 0, 255]),
    ]);
    let mut b = picture(&[(Kind::Grg, [50, 100, 150, 200])]);
    b.properties.background = Some([0.5; 3]);
    b.properties.unknown = vec!["camera 35".into()];
    for (name, image) in [("a", &a), ("b", &b)] {
        write(&folder.path().join(name), image, &WriteOptions::default()).unwrap();
    }
    folder
}

fn icomp(folder: &Path, arguments: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_icomp");
    let arguments = arguments.split_whitespace();
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs `icomp` with `arguments`, which say nothing, and reads `out`.
fn composed(arguments: &str) -> Image {
    let folder = folder();
    let output = icomp(folder.path(), &format!("{arguments} -o out"));
    assert!(output.status.success(), "{arguments}: {output:?}");
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{arguments}: {output:?}");
    open(folder.path(), "out")
}

fn open(folder: &Path, name: &str) -> Image {
    read_image(&folder.join(name), &ReadOptions { history: true, ..ReadOptions::default() })
        .unwrap()
}

fn bytes(image: &Image, kind: Kind) -> &[u8] {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples,
        other => panic!("{kind}: {other:?}"),
    }
}

/// Exit status and standard error.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = icomp(folder, arguments);
    assert!(output.stdout.is_empty(), "{arguments}: {output:?}");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_result_is_named_after_its_images() {
    let folder = folder();
    assert!(icomp(folder.path(), "over a b.idf").status.success());
    let image = open(folder.path(), "a-over-b");
    assert_eq!(image.kinds(), COLOR);
    // 100 + 50 · 153 / 255, 100 + 100 · 153 / 255, 150, 7.
    assert_eq!(bytes(&image, Kind::Red), [130, 160, 150, 7]);
    assert_eq!(bytes(&image, Kind::Grn), [30, 111, 150, 8]);
    assert_eq!(image.properties.transfer, Some(Transfer::Linear));
    assert_eq!(image.properties.unknown, ["camera 35"]);
    // It is opaque, so nothing is behind.
    assert_eq!(image.properties.background, None);
    let history = image.properties.history;
    assert_eq!(history[..2], ["drawn", "drawn"]);
    let fields: Vec<&str> = history[2].split('\t').collect();
    assert_eq!(fields[1..4], ["icomp", env!("CARGO_PKG_VERSION"), "over a b.idf"]);
    assert!(icomp(folder.path(), "in a b a").status.success());
    assert_eq!(bytes(&open(folder.path(), "a-in-b-in-a"), Kind::Cvg), [41, 41, 0, 255]);
    assert!(icomp(folder.path(), "dissolve 0.5 a").status.success());
    let image = open(folder.path(), "a-dissolve");
    assert_eq!(bytes(&image, Kind::Red), [50, 50, 0, 4]);
    assert_eq!(bytes(&image, Kind::Cvg), [51, 51, 0, 128]);
}

#[test]
fn the_canvas_is_the_union_of_the_windows() {
    let image = composed("plus a b --at -1,1");
    let window = image.window();
    assert_eq!((window.column, window.row, window.columns, window.rows), (-1, 0, 3, 3));
    // Rows of the canvas; B is at 0, 0 and A at -1, 1.
    assert_eq!(bytes(&image, Kind::Red), [0, 50, 100, 100, 250, 200, 0, 7, 0]);
    assert_eq!(bytes(&image, Kind::Cvg), [0, 255, 255, 102, 255, 255, 0, 255, 0]);
    assert_eq!(image.properties.background, Some([0.5; 3]));
    // Far apart: nothing between.
    let image = composed("xor a b --at 5,-4");
    assert_eq!(image.size(), [7, 6]);
    assert_eq!(bytes(&image, Kind::Blu)[5..7], [10, 20]);
    assert_eq!(bytes(&image, Kind::Blu)[28..30], [50, 100]);
    assert_eq!(bytes(&image, Kind::Cvg).iter().filter(|&&cvg| cvg == 0).count(), 42 - 7);
}

#[test]
fn every_option_changes_what_is_done() {
    let folder = folder();
    let mut srgb = picture(&[(Kind::Grg, [188, 0, 0, 0]), (Kind::Cvg, [128, 128, 0, 255])]);
    srgb.properties.transfer = None;
    write(&folder.path().join("half"), &srgb, &WriteOptions::default()).unwrap();
    let white = Plane { kind: Kind::Grg, samples: Samples::U8(vec![0; 4]) };
    let black = Image::new(2, 2, vec![white]).unwrap();
    write(&folder.path().join("black"), &black, &WriteOptions::default()).unwrap();
    // Half of white over black: 188 in linear light, 128 in stored values.
    assert!(icomp(folder.path(), "over half black -o linear").status.success());
    assert!(icomp(folder.path(), "over half black -o stored --stored").status.success());
    assert_eq!(bytes(&open(folder.path(), "linear"), Kind::Grg)[0], 188);
    assert_eq!(bytes(&open(folder.path(), "stored"), Kind::Grg)[0], 128);
    for (option, word) in [("", "rle"), ("--rle", "rle"), ("--raw", "raw")] {
        let flat = Plane { kind: Kind::Grg, samples: Samples::U8(vec![3; 4000]) };
        let flat = Image::new(400, 10, vec![flat]).unwrap();
        write(&folder.path().join("flat"), &flat, &WriteOptions::default()).unwrap();
        assert!(icomp(folder.path(), &format!("b a flat -o x {option}")).status.success());
        let text = fs::read_to_string(folder.path().join("x.idf")).unwrap();
        assert!(text.contains(&format!(" 400 10 8 {word}\n")), "{text}");
    }
    let one = composed("over a b --threads 1");
    assert_eq!(one.planes(), composed("over a b").planes());
    assert_eq!(one.planes(), composed("over a b -q").planes());
    let output = icomp(folder.path(), "over a b -o y -v");
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "write y: 2 x 2\n");
    let elsewhere = tempfile::tempdir().unwrap();
    let name = folder.path().join("a.red");
    let text = format!("idf 1\nsize 2 2\ngrg {} 2 2 8 raw\n", name.display());
    fs::write(elsewhere.path().join("link.idf"), text).unwrap();
    let (status, message) = failure(elsewhere.path(), "darken 1 link");
    assert!(status == Some(1) && message.contains("--outside"), "{message}");
    assert!(icomp(elsewhere.path(), "darken 1 link --outside").status.success());
}

#[test]
fn other_formats_come_and_go() {
    let folder = folder();
    let straight = icomp(folder.path(), "darken 1 a -o a.png");
    assert!(straight.status.success(), "{straight:?}");
    let png = open(folder.path(), "a.png");
    assert_eq!(png.properties.matte, Matte::Straight);
    assert_eq!(bytes(&png, Kind::Cvg), [102, 102, 0, 255]);
    // PNG in, PNG out: what is in front of nothing comes back, but for colours that cover nothing.
    let there = icomp(folder.path(), "over a.png a.png -o twice.png");
    assert!(there.status.success(), "{there:?}");
    assert_eq!(bytes(&open(folder.path(), "twice.png"), Kind::Cvg), [163, 163, 0, 255]);
    assert_eq!(bytes(&open(folder.path(), "twice.png"), Kind::Red), bytes(&png, Kind::Red));
    assert!(icomp(folder.path(), "over a b -o x.exr").status.success());
    assert_eq!(open(folder.path(), "x.exr").depth(), Depth::F32);
    let program = env!("CARGO_BIN_EXE_icomp");
    let output = Command::new(program)
        .args(["over", "-", "b", "-o", "-"])
        .current_dir(folder.path())
        .stdin(Stdio::from(File::open(folder.path().join("a.png")).unwrap()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    fs::write(folder.path().join("stream.png"), &output.stdout).unwrap();
    assert!(icomp(folder.path(), "over a.png b -o file.png").status.success());
    assert_eq!(fs::read(folder.path().join("file.png")).unwrap(), output.stdout);
    // Standard output is also where it goes unless -o says otherwise.
    let unnamed = Command::new(program)
        .args(["over", "-", "b"])
        .current_dir(folder.path())
        .stdin(Stdio::from(File::open(folder.path().join("a.png")).unwrap()))
        .output()
        .unwrap();
    assert_eq!(unnamed.stdout, output.stdout);
}

#[test]
fn indices_are_the_colors_of_their_table() {
    let folder = folder();
    let indices = Plane { kind: Kind::Enc, samples: Samples::U8(vec![1, 0, 1, 1]) };
    let mut indexed = Image::new(2, 2, vec![indices]).unwrap();
    indexed.lut = idf::Lut::new(vec![[1, 2, 3], [4, 5, 6]]);
    write_image(&folder.path().join("i"), &indexed, &WriteOptions::default()).unwrap();
    assert!(icomp(folder.path(), "a i b -o out").status.success());
    assert_eq!(bytes(&open(folder.path(), "out"), Kind::Blu), [6, 3, 6, 6]);
}

#[test]
fn a_result_may_take_the_place_of_an_image() {
    let folder = folder();
    assert!(icomp(folder.path(), "over a b -o b").status.success());
    assert_eq!(bytes(&open(folder.path(), "b"), Kind::Red), [130, 160, 150, 7]);
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_lost() {
    let folder = folder();
    let before = fs::read_dir(folder.path()).unwrap().count();
    for (arguments, status, expected) in [
        ("over a gone", 1, "cannot read `gone.idf`"),
        ("over a b -o out.xyz", 2, "found .xyz, expected a name that ends in .idf"),
        ("over a b -o gone/out", 1, "cannot write"),
        ("over a", 2, "`over` needs two images or more, found one"),
        ("darken a", 2, "`darken` needs a factor and one image, found 1 operands"),
        ("darken x a", 2, "`darken` needs a factor from 0 on, found `x`"),
        ("darken -1 a", 2, "`darken` needs a factor from 0 on, found `-1`"),
        ("over - -", 2, "standard input can be one of the images, found it twice"),
        ("over a b -o out.jpg", 2, "found .jpg, expected a name that ends in .idf .png"),
        ("over a b -o out.gif", 2, "iencode writes .gif"),
        ("over a b --threads -1", 2, "expected a whole number from 1 to"),
        ("under a b", 2, "invalid value 'under'"),
        ("over a b --at 1", 2, "expected column and row, as 40,-8"),
        ("over a b --at 2147483647,0", 1, "pixels, expected 1 to"),
        ("", 2, "required arguments"),
    ] {
        let (found, message) = failure(folder.path(), arguments);
        assert_eq!(found, Some(status), "{arguments}: {message}");
        assert!(message.contains(expected), "{arguments}: {message}");
    }
    let cut = folder.path().join("b.grg");
    fs::write(&cut, [1, 2, 3]).unwrap();
    let (status, message) = failure(folder.path(), "over a b -o a");
    assert!(status == Some(1) && message.contains("b.grg: 3 bytes, expected"), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before);
    assert_eq!(bytes(&open(folder.path(), "a"), Kind::Red), [100, 100, 0, 7]);
}

#[test]
fn help_has_the_operators_and_an_example() {
    let folder = folder();
    for (option, expected) in [
        ("--help", "icomp over FRONT.png BEHIND.png -o BOTH.png"),
        ("--help", "  ratop     B in front of A, where A is"),
        ("--version", env!("CARGO_PKG_VERSION")),
        ("--man", ".TH icomp"),
        ("--completions bash", "_icomp"),
    ] {
        let output = icomp(folder.path(), option);
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(expected), "{option}: {text}");
    }
}

#[test]
fn layers_of_exr_are_kept_of_one_image_and_named_of_several() {
    let folder = folder();
    let folder = folder.path();
    let plane = |kind| Plane { kind, samples: Samples::F32(vec![0.5; 4]) };
    let image = Image::new(2, 2, COLOR.map(plane).into()).unwrap();
    let mut layers = idf::exchange::Layers::default();
    layers.add("glow.R", &image, vec![3.0; 4]).unwrap();
    idf::exchange::write_layered(&folder.join("x.exr"), &image, &layers).unwrap();
    let said = |arguments: &str| {
        let output = icomp(folder, arguments);
        assert!(output.status.success(), "{arguments}: {output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let layers = |name: &str| {
        let read = idf::exchange::read_layered(&folder.join(name), None, &ReadOptions::default());
        read.unwrap().1.words()
    };
    assert_eq!(said("darken 0.5 x.exr -o y.exr"), "");
    assert_eq!(layers("y.exr"), ["glow"]);
    for arguments in ["over a x.exr -o z.exr", "darken 0.5 x.exr --at 1,1 -o z.exr"] {
        let said = said(arguments);
        let expected = "warning: left out of the composite, of x.exr: glow; icopy";
        assert!(said.starts_with(expected), "{arguments}: {said}");
        assert_eq!(layers("z.exr"), [""; 0]);
    }
    let said = said("darken 0.5 x.exr -o z");
    assert!(said.starts_with("warning: left out as IDF has no place for it: glow"), "{said}");
}

#[test]
fn pam_in_bands_has_the_values_of_the_whole() {
    // Wider than high, so that there are several bands of 2^20 pixels.
    let folder = tempfile::tempdir().unwrap();
    let [columns, rows] = [1_u32 << 16, 37];
    let picture = |step: u32| {
        let plane = |(kind, factor): (Kind, u32)| {
            let samples = (0..columns * rows).map(|at| (at / 7 * factor * step).to_le_bytes()[1]);
            Plane { kind, samples: Samples::U8(samples.collect()) }
        };
        let kinds = [(Kind::Red, 3), (Kind::Grn, 5), (Kind::Blu, 7), (Kind::Cvg, 11)];
        let mut image = Image::new(columns, rows, kinds.map(plane).into()).unwrap();
        image.properties.matte = Matte::Straight;
        image
    };
    for (name, step) in [("a", 1), ("b", 13)] {
        for ending in ["pam", "idf", "png"] {
            let path = folder.path().join(format!("{name}.{ending}"));
            write_image(&path, &picture(step), &WriteOptions::default()).unwrap();
        }
    }
    for arguments in [
        "a.pam b.pam -o 1.pam",
        "a.idf b.pam -o 2.pam",
        "a.png b.png -o 3.pam",
        "a.pam b.png -o 4.png",
    ] {
        assert!(icomp(folder.path(), &format!("over {arguments}")).status.success());
    }
    let expected = fs::read(folder.path().join("3.pam")).unwrap();
    for name in ["1.pam", "2.pam"] {
        assert!(fs::read(folder.path().join(name)).unwrap() == expected, "{name}");
    }
    let [pam, png] = ["3.pam", "4.png"].map(|name| open(folder.path(), name));
    assert!(pam.planes() == png.planes(), "the same picture");
}
