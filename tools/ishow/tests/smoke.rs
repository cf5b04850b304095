//! The real program without a terminal: refusals, and what it writes when it is told all.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use idf::exchange::write_image;
use idf::{Image, Kind, Plane, Samples, WriteOptions};

/// A folder with `grey.png`: 6 x 4, black and white columns.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let samples = [0, 255].repeat(12);
    let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples) };
    let image = Image::new(6, 4, vec![plane]).unwrap();
    write_image(&folder.path().join("grey.png"), &image, &WriteOptions::default()).unwrap();
    folder
}

fn ishow(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_ishow");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// What a good invocation writes.
fn written(folder: &Path, arguments: &str) -> String {
    let output = ishow(folder, arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn without_a_terminal_it_is_refused() {
    let folder = folder();
    let expected = "ishow: error: standard output is not a terminal; to write what one would get, \
                    say a protocol and --size, as --sixel --size 80x24\n";
    for arguments in ["grey.png", "grey.png --sixel", "grey.png --size 80x24", "none.png"] {
        let output = ishow(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), expected, "{arguments}");
    }
}

#[test]
fn a_protocol_and_a_size_say_what_to_write() {
    let folder = folder();
    // Three characters of 8 x 16 pixels are 24 x 16; two thirds of it is the picture's shape.
    let blocks = written(folder.path(), "grey.png --blocks --size 6x9 --colors 16");
    let line = "\x1b[40m \x1b[107m \x1b[40m \x1b[107m \x1b[40m \x1b[107m \x1b[0m\n";
    assert_eq!(blocks, line.repeat(2));
    let sixel = written(folder.path(), "grey.png --sixel --size 3x9 --threads 1");
    assert!(sixel.starts_with("\x1bP0;0;0q\"1;1;24;16#0;2;"), "{sixel:?}");
    assert!(written(folder.path(), "grey.png --kitty --size 3x9").starts_with("\x1b_Ga=T"));
    let matte = written(folder.path(), "grey.png --blocks --size 6x9 --colors 256 --matte #ff0000");
    assert!(matte.contains("48;5;16m") && matte.contains("48;5;231m"), "{matte:?}");
}

#[test]
fn it_says_what_it_found() {
    let folder = folder();
    let output = ishow(folder.path(), "grey.png --blocks --size 3x9 --colors true -v");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.starts_with("half blocks, 3 x 9 characters of 8 x 16 pixels"), "{said}");
    assert!(ishow(folder.path(), "grey.png --blocks --size 3x9 -q").stderr.is_empty());
}

#[test]
fn files_outside_are_followed_only_when_told() {
    let folder = folder();
    fs::write(folder.path().join("a.grg"), [7; 24]).unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    fs::write(inner.join("x.idf"), "idf 1\nsize 6 4\ngrg ../a.grg 6 4 8 raw\n").unwrap();
    let output = ishow(&inner, "x --blocks --size 3x9");
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.ends_with("if you trust it, say --outside\n"), "{said}");
    assert!(!written(&inner, "x --blocks --size 3x9 --outside").is_empty());
}

#[test]
fn bad_invocations_have_their_status() {
    let folder = folder();
    let cases = [
        ("none.png --kitty --size 3x9", 1, "cannot read `none.png`: No such file or directory"),
        ("", 2, "<IMAGE>"),
        ("grey.png --kitty --sixel", 2, "cannot be used with"),
        ("grey.png --size 3", 2, "expected two whole numbers from 1 to 65535, as 80x24"),
        ("grey.png --size -1x3", 2, "expected two whole numbers from 1 to 65535, as 80x24"),
        ("grey.png --size 0x3", 2, "expected two whole numbers from 1 to 65535, as 80x24"),
        ("grey.png --colors 8", 2, "[possible values: true, 256, 16, none]"),
        (
            "grey.png --matte red",
            2,
            "expected #rgb, #rrggbb or three numbers from 0 to 1, found `red`",
        ),
        ("grey.png -q -v", 2, "cannot be used with"),
        ("grey.png --threads 0", 2, "--threads"),
        ("grey.png --fast", 2, "unexpected argument '--fast'"),
    ];
    for (arguments, status, message) in cases {
        let output = ishow(folder.path(), arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.starts_with("ishow: error: ") && said.contains(message), "{said}");
        assert_eq!(output.status.code(), Some(status), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}");
    }
}

#[test]
fn help_version_and_packaging_are_status_0() {
    let folder = folder();
    for (arguments, part) in [
        ("--help", "Example:\n  ishow wine.idf"),
        ("--version", concat!("ishow ", env!("CARGO_PKG_VERSION"), "\n")),
        ("--man", ".TH ishow 1"),
        ("--completions bash", "_ishow()"),
    ] {
        assert!(written(folder.path(), arguments).contains(part), "{arguments}");
    }
}
