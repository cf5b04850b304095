//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Depth, Image, Kind, Lut, Matte, Plane, ReadOptions, Samples, WriteOptions, read, write};

/// A folder with an image `wine`: 4 x 2, red, green, blue, and coverage of none, some and all.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let plane = |kind, samples: [u8; 8]| Plane { kind, samples: Samples::U8(samples.into()) };
    let planes = vec![
        plane(Kind::Red, [0, 10, 20, 30, 40, 50, 60, 70]),
        plane(Kind::Grn, [0, 99, 0, 99, 0, 99, 0, 99]),
        plane(Kind::Blu, [0, 1, 2, 3, 4, 5, 6, 255]),
        plane(Kind::Cvg, [0, 100, 100, 150, 150, 200, 200, 255]),
    ];
    let mut image = Image::new(4, 2, planes).unwrap();
    image.properties.background = Some([1.0, 1.0, 1.0]);
    write(&folder.path().join("wine"), &image, &WriteOptions::default()).unwrap();
    folder
}

fn icopy(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_icopy");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs `icopy wine out` with `options`, and reads `out`.
fn copied(options: &str) -> Image {
    let folder = folder();
    let output = icopy(folder.path(), &format!("wine out {options}"));
    assert!(output.status.success(), "{options}: {output:?}");
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{options}: {output:?}");
    open(folder.path(), "out")
}

fn open(folder: &Path, name: &str) -> Image {
    read_image(&folder.join(name), &ReadOptions { history: true, ..ReadOptions::default() })
        .unwrap()
}

fn bytes(image: &Image, kind: Kind) -> Vec<u8> {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples.clone(),
        other => panic!("{kind}: {other:?}"),
    }
}

/// Exit status and standard error.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = icopy(folder, arguments);
    assert!(output.stdout.is_empty(), "{arguments}: {output:?}");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn an_image_comes_back_from_png_and_exr() {
    let folder = folder();
    let original = open(folder.path(), "wine");
    for ending in ["png", "exr"] {
        let there = icopy(folder.path(), &format!("wine.idf x.{ending}"));
        assert!(there.status.success(), "{there:?}");
        let back = icopy(folder.path(), &format!("x.{ending} back --depth 8"));
        assert!(back.status.success(), "{back:?}");
        assert_eq!(open(folder.path(), "back").planes(), original.planes(), "{ending}");
        assert_eq!(open(folder.path(), "back").properties.matte, Matte::Premultiplied);
    }
}

#[test]
fn a_line_of_history_says_what_was_done() {
    let folder = folder();
    assert!(icopy(folder.path(), "wine a --flip x").status.success());
    assert!(icopy(folder.path(), "a b.idf --crop 0,0,1,1").status.success());
    let history = open(folder.path(), "b").properties.history;
    let fields: Vec<Vec<&str>> = history.iter().map(|line| line.split('\t').collect()).collect();
    assert_eq!(fields.len(), 2, "{history:?}");
    for (line, arguments) in fields.iter().zip(["wine a --flip x", "a b.idf --crop 0,0,1,1"]) {
        assert_eq!(line[1..4], ["icopy", env!("CARGO_PKG_VERSION"), arguments]);
        assert!(line[0].ends_with('Z') && line[4].starts_with("seconds=0."), "{line:?}");
    }
}

#[test]
fn every_option_changes_the_copy() {
    let red = |options: &str| bytes(&copied(options), Kind::Red);
    assert_eq!(red(""), [0, 10, 20, 30, 40, 50, 60, 70]);
    assert_eq!(red("--crop 1,0,2,2"), [10, 20, 50, 60]);
    assert_eq!(copied("--crop 1,0,2,2").properties.origin, [1, 0]);
    assert_eq!(red("--flip x"), [30, 20, 10, 0, 70, 60, 50, 40]);
    assert_eq!(red("--flip y"), [40, 50, 60, 70, 0, 10, 20, 30]);
    assert_eq!(red("--rotate 90"), [40, 0, 50, 10, 60, 20, 70, 30]);
    assert_eq!(red("--rotate 180"), [70, 60, 50, 40, 30, 20, 10, 0]);
    assert_eq!(red("--rotate 270"), [30, 70, 20, 60, 10, 50, 0, 40]);
    assert_eq!(copied("--tile 3x2").size(), [12, 4]);
    assert_eq!(copied("--resize 2x6").size(), [2, 6]);
    assert_eq!(copied("--channels cvg,blu").kinds(), [Kind::Cvg, Kind::Blu]);
    let grey = copied("--channels rgb=cvg");
    assert_eq!(grey.kinds(), COLOR);
    assert_eq!(bytes(&grey, Kind::Blu), [0, 100, 100, 150, 150, 200, 200, 255]);
    assert_eq!(copied("--depth 16").depth(), Depth::U16);
    assert_eq!(copied("--depth 32f").depth(), Depth::F32);
    assert_eq!(copied("--matte straight").properties.matte, Matte::Straight);
    let flat = copied("--flatten");
    assert_eq!(flat.kinds(), COLOR);
    // White where nothing covers, and what was there where all is covered.
    assert_eq!(bytes(&flat, Kind::Red)[0], 255);
    assert_eq!(bytes(&flat, Kind::Red)[7], 70);
    assert_eq!(bytes(&copied("--flatten #102030"), Kind::Blu)[0], 0x30);
    assert_eq!(bytes(&copied("--flatten 1,0,0.2"), Kind::Blu)[0], 51);
    assert_eq!(copied("--threads 1"), {
        let mut expected = copied("");
        expected.properties.history = copied("--threads 1").properties.history;
        expected
    });
}

#[test]
fn files_are_raw_or_coded() {
    let folder = tempfile::tempdir().unwrap();
    let plane = Plane { kind: Kind::Grg, samples: Samples::U8(vec![7; 1000]) };
    let flat = Image::new(100, 10, vec![plane]).unwrap();
    write_image(&folder.path().join("flat.png"), &flat, &WriteOptions::default()).unwrap();
    for (options, word) in [("", "rle"), ("--rle", "rle"), ("--raw", "raw")] {
        assert!(icopy(folder.path(), &format!("flat.png x {options}")).status.success());
        let text = fs::read_to_string(folder.path().join("x.idf")).unwrap();
        assert!(text.contains(&format!("grg x.grg 100 10 8 {word}\n")), "{text}");
    }
}

#[test]
fn files_outside_are_followed_only_when_told() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    fs::write(inner.join("x.idf"), "idf 1\nsize 4 2\ngrg ../wine.red 4 2 8 raw\n").unwrap();
    let (status, message) = failure(&inner, "x y");
    assert_eq!(status, Some(1));
    let expected = "icopy: error: x.idf: expected files in its own folder, found `../wine.red`; if \
                    you trust it, say --outside\n";
    assert_eq!(message, expected);
    assert!(icopy(&inner, "x y --outside").status.success());
    assert_eq!(bytes(&open(&inner, "y"), Kind::Grg)[7], 70);
}

#[test]
fn pipes_carry_png() {
    let folder = folder();
    let png = icopy(folder.path(), "wine - --flatten").stdout;
    assert!(png.starts_with(b"\x89PNG"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_icopy"))
        .args(["-", "piped"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    program.stdin.take().unwrap().write_all(&png).unwrap();
    assert!(program.wait().unwrap().success());
    assert_eq!(bytes(&open(folder.path(), "piped"), Kind::Red)[7], 70);
}

#[test]
fn it_says_as_much_as_it_is_told_to() {
    let folder = folder();
    let said = |arguments: &str| {
        let output = icopy(folder.path(), arguments);
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let warning = "warning: this format is opaque; the background is painted in\n";
    assert_eq!(said("wine x.ppm"), warning);
    assert_eq!(said("wine x.ppm -q"), "");
    assert_eq!(
        said("wine x.png -v --crop 0,0,2,1"),
        "read wine: 4 x 2, depth 8, red grn blu cvg\nwrite x.png: 2 x 1, depth 8, red grn blu cvg\n"
    );
}

#[test]
fn indices_become_colors_in_other_formats() {
    let folder = tempfile::tempdir().unwrap();
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(vec![1, 0]) };
    let mut indexed = Image::new(2, 1, vec![plane]).unwrap();
    indexed.lut = Lut::new(vec![[1, 2, 3], [4, 5, 6]]);
    write(&folder.path().join("x"), &indexed, &WriteOptions::default()).unwrap();
    assert!(icopy(folder.path(), "x x.png").status.success());
    assert_eq!(bytes(&open(folder.path(), "x.png"), Kind::Grn), [5, 2]);
}

#[test]
fn failed_work_is_status_1_and_one_line() {
    let folder = folder();
    let cases = [
        ("none out", "cannot read `none.idf`: No such file or directory (os error 2)"),
        ("none.png out", "cannot read `none.png`: No such file or directory (os error 2)"),
        ("wine no/x.png", "cannot write `no/x.png`: No such file or directory (os error 2)"),
        (
            "wine x.tga",
            "cannot write `x.tga`: expected a name that ends in .idf .png .exr .ppm .pgm .pbm .pnm",
        ),
        (
            "wine out --crop 2,0,3,1",
            "expected a part of 4 x 2 pixels, found 3 x 1 at column 2, row 0",
        ),
        ("wine out --channels grg", "wine.idf: no channel `grg`, found red grn blu cvg"),
        (
            "wine out --tile 99999x99999",
            "399996 x 199998 pixels, expected 1 to 2147483648 in at most 16777216 columns",
        ),
    ];
    for (arguments, message) in cases {
        let (status, found) = failure(folder.path(), arguments);
        assert_eq!(found, format!("icopy: error: {message}\n"), "{arguments}");
        assert_eq!(status, Some(1), "{arguments}");
    }
    assert!(!folder.path().join("out.idf").exists());
}

#[test]
fn a_wrong_command_line_is_status_2() {
    let folder = folder();
    let cases = [
        ("wine", "<OUT>"),
        ("wine out --fast", "unexpected argument '--fast'"),
        ("wine out --crop 1,2,3", "expected column, row, columns and rows, as 0,0,64,48"),
        ("wine out --resize 0x5", "expected two whole numbers above 0, as 4x3"),
        ("wine out --flip z", "[possible values: x, y]"),
        ("wine out --rotate 45", "[possible values: 90, 180, 270]"),
        ("wine out --depth 12", "[possible values: 8, 16, 32f]"),
        ("wine out --channels rgb,zzz", "no channel is called `zzz`"),
        ("wine out --channels red=rgb", "expected NEW=OLD of channels of one shape"),
        ("wine out --flatten #12", "expected #rrggbb or three numbers from 0 to 1, found `#12`"),
        (
            "wine out --flatten 0,0,2",
            "expected #rrggbb or three numbers from 0 to 1, found `0,0,2`",
        ),
        ("wine out --raw --rle", "cannot be used with"),
        ("wine out -q -v", "cannot be used with"),
        ("wine out --threads 0", "--threads"),
    ];
    for (arguments, message) in cases {
        let (status, found) = failure(folder.path(), arguments);
        assert!(found.starts_with("icopy: error: ") && found.contains(message), "{found}");
        assert_eq!(status, Some(2), "{arguments}");
    }
}

#[test]
fn help_version_and_packaging_are_status_0() {
    let folder = folder();
    for (arguments, part) in [
        ("--help", "Example:\n  icopy wine.idf"),
        ("--version", concat!("icopy ", env!("CARGO_PKG_VERSION"), "\n")),
        ("--man", ".TH icopy 1"),
        ("--completions bash", "_icopy()"),
        ("--completions zsh", "#compdef icopy"),
    ] {
        let output = icopy(folder.path(), arguments);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(part), "{arguments}: {text}");
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments}");
    }
}

#[test]
fn in_place_is_safe() {
    let folder = folder();
    assert!(icopy(folder.path(), "wine wine --flip x").status.success());
    let copy = read(&folder.path().join("wine"), &ReadOptions::default()).unwrap();
    assert_eq!(bytes(&copy, Kind::Red), [30, 20, 10, 0, 70, 60, 50, 40]);
}
