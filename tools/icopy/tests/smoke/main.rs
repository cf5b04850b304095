//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

mod layers;

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
    assert_eq!(copied("--threads 1").planes(), copied("").planes());
}

#[test]
fn options_may_stand_between_the_names() {
    let folder = folder();
    for arguments in ["wine --flip x out", "--flip x wine out", "wine out --flip x"] {
        assert!(icopy(folder.path(), arguments).status.success(), "{arguments}");
        let red = bytes(&open(folder.path(), "out"), Kind::Red);
        assert_eq!(red, [30, 20, 10, 0, 70, 60, 50, 40], "{arguments}");
        fs::remove_file(folder.path().join("out.idf")).unwrap();
    }
    assert!(icopy(folder.path(), "wine a --crop 0,0,3,2").status.success());
    assert!(icopy(folder.path(), "wine b --crop 3,0,1,2").status.success());
    assert!(icopy(folder.path(), "a --flip y b --raw both").status.success());
    assert_eq!(open(folder.path(), "both").size(), [4, 2]);
    let (status, said) = failure(folder.path(), "wine --flip x");
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("expected an image to read and one to write"), "{said}");
}

#[test]
fn the_place_of_pixels_changes() {
    let red = |options: &str| bytes(&copied(options), Kind::Red);
    assert_eq!(red("--shift 1,0"), [30, 0, 10, 20, 70, 40, 50, 60]);
    assert_eq!(red("--shift -1,-1"), [50, 60, 70, 40, 10, 20, 30, 0]);
    let wide = copied("--extend 1,0,0,1");
    assert_eq!((wide.size(), wide.properties.origin), ([5, 3], [-1, 0]));
    assert_eq!(bytes(&wide, Kind::Cvg)[..5], [0, 0, 100, 100, 150]);
    let border = |border: &str| {
        let wide = copied(&format!("--extend 1,0,0,0 --border {border}"));
        (bytes(&wide, Kind::Blu)[5], bytes(&wide, Kind::Cvg)[5])
    };
    assert_eq!(border("clear"), (0, 0));
    assert_eq!(border("edge"), (4, 150));
    assert_eq!(border("wrap"), (255, 255));
    assert_eq!(border("#102030"), (0x30, 255));
    let window = copied("--extend-to -1,1,3,2 --border edge");
    assert_eq!((window.size(), window.properties.origin), ([3, 2], [-1, 1]));
    assert_eq!(bytes(&window, Kind::Red), [40, 40, 50, 40, 40, 50]);
    // Two columns further on, and the row between: the ends are neighbours.
    assert_eq!(bytes(&copied("--tileable"), Kind::Red)[0], 60);
}

#[test]
fn every_filter_has_its_own_result() {
    let red = |filter: &str| bytes(&copied(&format!("--resize 7x5 {filter}")), Kind::Grn);
    let found = ["", "--filter box", "--filter bicubic", "--filter lanczos"].map(red);
    for (position, one) in found.iter().enumerate() {
        assert!(found[..position].iter().all(|other| other != one), "{found:?}");
    }
    assert_eq!(red("--filter linear"), found[0]);
}

#[test]
fn channels_are_made_of_numbers_and_of_colors() {
    let mask = copied("--channels red=1,grn=0,blu=0,cvg");
    assert_eq!(mask.kinds(), [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg]);
    // White over 100/255 is stored as 168.
    assert_eq!(bytes(&mask, Kind::Red), [0, 168, 168, 202, 202, 229, 229, 255]);
    assert_eq!(bytes(&copied("--channels rgb,cvg=1"), Kind::Cvg), [255; 8]);
    let grey = copied("--channels grg=luma,cvg");
    assert_eq!(grey.kinds(), [Kind::Grg, Kind::Cvg]);
    // 70, 99 and 255 are 0.06125, 0.12477 and 1 of light: 0.17446 together, stored as 115.9.
    assert_eq!(bytes(&grey, Kind::Grg)[7], 116);
}

#[test]
fn colors_go_on_under_holes() {
    let filled = copied("--fill");
    assert_eq!(filled.properties.matte, Matte::Straight);
    assert_eq!(bytes(&filled, Kind::Cvg), bytes(&copied(""), Kind::Cvg));
    let straight = copied("--matte straight");
    assert_eq!(bytes(&straight, Kind::Grn)[0], 0);
    assert!(bytes(&filled, Kind::Grn)[0] > 50, "{filled:?}");
    assert_eq!(bytes(&filled, Kind::Grn)[1..], bytes(&straight, Kind::Grn)[1..]);
    // From another format too, and to one that keeps it.
    let folder = folder();
    assert!(icopy(folder.path(), "wine x.png").status.success());
    assert!(icopy(folder.path(), "x.png y.png --fill").status.success());
    assert!(bytes(&open(folder.path(), "y.png"), Kind::Grn)[0] > 50);
}

#[test]
fn levels_of_detail_halve_to_one_pixel() {
    let folder = folder();
    for (out, names) in
        [("m", ["m", "m.1.idf", "m.2.idf"]), ("m.png", ["m.png", "m.1.png", "m.2.png"])]
    {
        let output = icopy(folder.path(), &format!("wine {out} --mips"));
        assert!(output.status.success(), "{output:?}");
        let sizes = names.map(|name| open(folder.path(), name).size());
        assert_eq!(sizes, [[4, 2], [2, 1], [1, 1]]);
    }
    let half = copied("--resize 2x1");
    assert_eq!(open(folder.path(), "m.1.idf").planes(), half.planes());
    assert!(folder.path().join("m.1.red").exists());
}

#[test]
fn windows_are_put_together() {
    let folder = folder();
    let whole = open(folder.path(), "wine");
    assert!(icopy(folder.path(), "wine a --crop 0,0,3,2").status.success());
    assert!(icopy(folder.path(), "wine b.png --crop 3,0,1,2").status.success());
    let output = icopy(folder.path(), "b.png a both.exr");
    assert!(output.status.success(), "{output:?}");
    let back = icopy(folder.path(), "both.exr back --depth 8");
    assert!(back.status.success(), "{back:?}");
    assert_eq!(open(folder.path(), "back").planes(), whole.planes());
    assert_eq!(open(folder.path(), "back").properties.origin, [0, 0]);
    let (status, message) = failure(folder.path(), "a wine out --channels grg=luma --crop 9,9,1,1");
    assert_eq!(status, Some(1));
    assert!(message.contains("expected a part of 4 x 2 pixels"), "{message}");
}

#[test]
fn indices_go_to_indexed_files_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(vec![2, 0, 1, 2]) };
    let mut indexed = Image::new(4, 1, vec![plane]).unwrap();
    indexed.lut = Lut::with_coverage(vec![[1, 2, 3, 255], [9, 9, 9, 0], [4, 5, 6, 255], [7; 4]]);
    write(&folder.path().join("x"), &indexed, &WriteOptions::default()).unwrap();
    for (out, count) in [("y.gif", 4), ("y.png", 4)] {
        let output = icopy(folder.path(), &format!("x {out} --channels enc,lut"));
        assert!(output.status.success(), "{output:?}");
        let output = icopy(folder.path(), &format!("{out} z --channels enc,lut"));
        assert!(output.status.success(), "{output:?}");
        let back = open(folder.path(), "z");
        assert_eq!(bytes(&back, Kind::Enc), [2, 0, 1, 2]);
        assert_eq!(back.lut.map(|lut| lut.colors().len()), Some(count), "{out}");
    }
    let (status, message) = failure(folder.path(), "y.png w.gif --channels rgb");
    assert_eq!(status, Some(1));
    assert!(message.ends_with("found red grn blu; make them with iencode\n"), "{message}");
    assert!(icopy(folder.path(), "y.gif w.gif --flip x").status.success());
    let (_, message) = failure(folder.path(), "none.png w.gif");
    assert!(message.contains("cannot read `none.png`: No such file"), "{message}");
    let grey = Plane { kind: Kind::Grg, samples: Samples::U8(vec![7; 4]) };
    let grey = Image::new(4, 1, vec![grey]).unwrap();
    write_image(&folder.path().join("g.png"), &grey, &WriteOptions::default()).unwrap();
    let (_, message) = failure(folder.path(), "g.png w.gif");
    let expected = "g.png: no channel `enc`, found grg; make them with iencode\n";
    assert!(message.ends_with(expected), "{message}");
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
fn what_is_perhaps_misspelt_is_said() {
    let folder = folder();
    let path = folder.path().join("wine.idf");
    let text = fs::read_to_string(&path).unwrap().replace("background", "backgruond");
    fs::write(&path, text).unwrap();
    let expected = "warning: wine.idf: the line of the unknown key `backgruond` is kept; is \
                    `background` meant?\n";
    for output in ["out", "out.png"] {
        let said = icopy(folder.path(), &format!("wine {output}"));
        assert!(said.status.success());
        assert_eq!(String::from_utf8(said.stderr).unwrap(), expected, "{output}");
        assert!(icopy(folder.path(), &format!("wine {output} -q")).stderr.is_empty());
    }
}

#[test]
fn failed_work_is_status_1_and_one_line() {
    let folder = folder();
    let cases = [
        ("none out", "cannot read `none.idf`: No such file or directory (os error 2)"),
        ("none.png out", "cannot read `none.png`: No such file or directory (os error 2)"),
        ("wine no/x.png", "cannot write `no/x.png`: No such file or directory (os error 2)"),
        (
            "wine out --crop 2,0,3,1",
            "expected a part of 4 x 2 pixels, found 3 x 1 at column 2, row 0",
        ),
        ("wine out --channels dep", "wine.idf: no channel `dep`, found red grn blu cvg"),
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
        ("wine", "one to write, found one"),
        ("wine out --fast", "unexpected argument '--fast'"),
        (
            "none x.tga",
            "cannot write `x.tga`: found .tga, expected a name that ends in .idf .png .exr .ppm .pgm .pbm \
             .pnm .pam .gif, or one without an ending for IDF; as an IDF image: x.tga.idf",
        ),
        ("none x.webp", ".webp is only read"),
        ("none x.lut", "ilut writes .lut"),
        (
            "wine out --crop 1,2,3",
            "expected column, row, columns and rows inside the picture, as 0,0,64,48",
        ),
        ("wine out --crop -10,0,5,5", "expected column, row, columns and rows inside the picture"),
        ("wine out --extend -1", "expected left, top, right and bottom, each from 0 on"),
        ("wine out --extend -1,0,0,0", "--extend-to goes inwards, too"),
        ("wine out --resize -4x4", "expected two whole numbers above 0, as 4x3"),
        ("wine out --tile -1x4", "expected two whole numbers above 0, as 4x3"),
        ("wine out --flatten -1,0,0", "three numbers from 0 to 1, found `-1,0,0`"),
        ("wine out --flatten -.5,0,0", "three numbers from 0 to 1, found `-.5,0,0`"),
        ("wine out --tileable -1,0", "unexpected value '-1,0' for '--tileable'"),
        ("--flatten wine out", "say --flatten behind the names of images"),
        ("wine out --threads -2", "expected a whole number from 1 to"),
        ("wine out --resize 0x5", "expected two whole numbers above 0, as 4x3"),
        ("wine out --flip z", "[possible values: x, y]"),
        ("wine out --rotate 45", "[possible values: 90, 180, 270]"),
        ("wine out --depth 12", "[possible values: 8, 16, 32f]"),
        ("wine out --channels rgb,zzz", "no channel is called `zzz`"),
        ("wine out --channels red=rgb", "expected NEW=OLD of channels of one shape"),
        ("wine out --flatten #12", "#rgb, #rrggbb or three numbers from 0 to 1, found `#12`"),
        ("wine out --flatten 0,0,2", "#rrggbb or three numbers from 0 to 1, found `0,0,2`"),
        (
            "wine out --extend 1,2,3",
            "expected left, top, right and bottom, each from 0 on, as 8,0,8,0",
        ),
        ("wine out --extend-to 0,0,0,1", "expected column, row, columns and rows, as -8,0,64,48"),
        ("wine out --extend 1,1,1,1 --extend-to 0,0,9,9", "cannot be used with"),
        ("wine out --border edge", "--border is for --extend or --extend-to"),
        ("wine out --extend 1,1,1,1 --border round", "clear, edge, wrap, #rgb, #rrggbb or"),
        ("wine out --shift 1", "expected columns and rows, as 16,-3"),
        ("wine out --filter gauss", "expected linear, box, bicubic, lanczos"),
        ("wine out --channels red=2", "expected a number from 0 to 1 for red, found `red=2`"),
        ("wine out --channels enc=1.5", "expected a whole number from 0 to 255 for enc"),
        ("wine out --channels dep=luma", "expected a channel of the same shape for dep"),
        ("wine out --fill --matte premultiplied", "--fill gives straight light"),
        ("wine out.exr --fill", "--fill gives straight light"),
        ("wine - --mips", "--mips writes several files"),
        ("- - out", "standard input is one image"),
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

#[test]
fn errors_say_what_was_perhaps_meant() {
    let folder = folder();
    let run = |arguments: &str| assert!(icopy(folder.path(), arguments).status.success());
    run("wine wall --mips --flatten");
    run("wine grey --channels grg=luma");
    for (arguments, hint) in [
        ("grey x --channels rgb", "grey as a colour is --channels rgb=grg"),
        ("wall x --channels grg", "the grey of a colour is --channels grg=luma"),
        (
            "grey x --channels grg,cvg",
            "a picture that is covered everywhere is --channels with cvg=1",
        ),
        ("wall.1 x", "; there is `wall.1.idf`"),
        ("wall.red x", "for the image `wall.idf`, red alone by icopy --channels red"),
    ] {
        let (status, message) = failure(folder.path(), arguments);
        assert_eq!(status, Some(1), "{arguments}");
        assert!(message.trim_end().ends_with(hint), "{arguments}: {message}");
    }
    // What the hints say works.
    for arguments in ["grey x --channels rgb=grg", "grey x --channels grg,cvg=1", "wall.1.idf x"] {
        run(arguments);
    }
    // Neither a level nor a channel.
    let (_, message) = failure(folder.path(), "wall.7 x");
    assert!(message.trim_end().ends_with(".tiff .webp"), "{message}");
}

#[test]
fn what_is_not_covered_gets_light_before_coverage_is_left_out() {
    for option in ["--flatten #102030", "--flatten", "--fill"] {
        let (some, all) = (copied(&format!("{option} --channels rgb")), copied(option));
        assert_eq!(some.kinds(), COLOR, "{option}");
        for kind in COLOR {
            assert_eq!(bytes(&some, kind), bytes(&all, kind), "{option}: {kind}");
        }
    }
    // Red of none, of shares 100, 150 and 200 of 255, and of all, over white.
    let red = bytes(&copied("--flatten #ffffff --channels grg=red"), Kind::Grg);
    assert_eq!((red[0], red[7]), (255, 70));
}

/// Whatever is left of memory, the work is done or said to be too large.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_too_large_for_memory_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let plane = |kind| Plane { kind, samples: Samples::U8(vec![7; 36_000_000]) };
    let large = Image::new(6000, 6000, COLOR.map(plane).into()).unwrap();
    write(&folder.path().join("large"), &large, &WriteOptions::default()).unwrap();
    let before = names(folder.path());
    for (arguments, kilobytes) in
        [("large x --rotate 90", 400_000), ("large x.png", 350_000), ("large x.exr", 900_000)]
    {
        let line =
            format!("ulimit -c 0; ulimit -v {kilobytes}; exec \"$0\" {arguments} --threads 2");
        let output = Command::new("bash")
            .args(["-c", &line, env!("CARGO_BIN_EXE_icopy")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments} of {kilobytes}: {said}");
        assert!(said.contains("memory"), "{arguments} of {kilobytes}: {said}");
        assert_eq!(names(folder.path()), before, "{arguments} of {kilobytes}: {said}");
    }
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    names
}
