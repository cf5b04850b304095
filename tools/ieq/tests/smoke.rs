//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Depth, Image, Kind, Lut, Matte, Plane, ReadOptions, Samples, WriteOptions};
use ieq::TABLE;

fn bytes(kind: Kind, samples: &[u8]) -> Plane {
    Plane { kind, samples: Samples::U8(samples.into()) }
}

fn write(folder: &Path, name: &str, image: &Image) {
    write_image(&folder.join(name), image, &WriteOptions::default()).unwrap();
}

/// A folder with an image `grey`, 4 x 2, and a colour `wine` with coverage of none, some and all.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let grey = bytes(Kind::Grg, &[0, 51, 102, 102, 153, 204, 255, 255]);
    write(folder.path(), "grey", &Image::new(4, 2, vec![grey]).unwrap());
    let planes = vec![
        bytes(Kind::Red, &[9, 10, 20, 30, 90, 50, 60, 200]),
        bytes(Kind::Grn, &[0, 99, 0, 99, 20, 99, 0, 99]),
        bytes(Kind::Blu, &[0, 1, 2, 3, 4, 5, 6, 10]),
        bytes(Kind::Cvg, &[0, 128, 128, 150, 255, 255, 255, 255]),
        bytes(Kind::Dep, &[1, 2, 3, 4, 5, 6, 7, 8]),
    ];
    write(folder.path(), "wine", &Image::new(4, 2, planes).unwrap());
    folder
}

fn ieq(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_ieq");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

fn open(folder: &Path, name: &str) -> Image {
    read_image(&folder.join(name), &ReadOptions { history: true, ..ReadOptions::default() })
        .unwrap()
}

fn samples(image: &Image, kind: Kind) -> Vec<u8> {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples.clone(),
        other => panic!("{kind}: {other:?}"),
    }
}

/// Runs `ieq` with `arguments` and `-o out`, and reads `out`.
fn done(arguments: &str) -> Image {
    let folder = folder();
    let output = ieq(folder.path(), &format!("{arguments} -o out"));
    assert!(output.status.success(), "{arguments}: {output:?}");
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{arguments}: {output:?}");
    open(folder.path(), "out")
}

/// Exit status and standard error.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = ieq(folder, arguments);
    assert!(output.stdout.is_empty(), "{arguments}: {output:?}");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn grey_has_the_values_of_the_formulas() {
    let grey = |arguments: &str| samples(&done(arguments), Kind::Grg);
    // 255 times the square root of 0, 0.2, 0.4, 0.6, 0.8 and 1.
    assert_eq!(grey("gamma 2 grey"), [0, 114, 161, 161, 198, 228, 255, 255]);
    assert_eq!(grey("levels 0.2 0.8 grey"), [0, 0, 85, 85, 170, 255, 255, 255]);
    assert_eq!(grey("levels 1 0 grey"), [255, 204, 153, 153, 102, 51, 0, 0]);
    assert_eq!(grey("brightness 0.2 grey"), [51, 102, 153, 153, 204, 255, 255, 255]);
    assert_eq!(grey("brightness -0.2 grey"), [0, 0, 51, 51, 102, 153, 204, 204]);
    assert_eq!(grey("contrast 0.5 grey"), [64, 89, 115, 115, 140, 166, 191, 191]);
    // Of 8 pixels 1, 2, 4, 5, 6 and 8 are at or below.
    assert_eq!(grey("equalize grey"), [32, 64, 128, 128, 159, 191, 255, 255]);
    assert_eq!(grey("equalize grey --per-channel"), grey("equalize grey"));
    // A picture without colour keeps it.
    assert_eq!(grey("saturation 3 grey"), [0, 51, 102, 102, 153, 204, 255, 255]);
}

#[test]
fn every_option_of_an_operation_changes_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let ramp: Vec<u8> =
        (0..64 * 64_u32).map(|at| ((at % 64) * (at / 64) / 20 + 20).to_le_bytes()[0]).collect();
    write(folder.path(), "ramp", &Image::new(64, 64, vec![bytes(Kind::Grg, &ramp)]).unwrap());
    let run = |options: &str| {
        assert!(ieq(folder.path(), &format!("clahe ramp -o x {options}")).status.success());
        samples(&open(folder.path(), "x"), Kind::Grg)
    };
    let usual = run("");
    assert_ne!(usual, ramp);
    assert_eq!(run("--tiles 8 --clip 0.01 --bins 256"), usual);
    for options in ["--tiles 2", "--clip 0.5", "--bins 16"] {
        assert_ne!(run(options), usual, "{options}");
    }
}

#[test]
fn luma_is_equalised_unless_each_channel_is_to_be() {
    let (luma, each) = (done("equalize wine"), done("equalize wine --per-channel"));
    assert_ne!(samples(&luma, Kind::Red), samples(&each, Kind::Red));
    // By itself the reddest pixel is full; the others that are covered are as far apart as before.
    assert_eq!(samples(&each, Kind::Red)[7], 255);
    assert_ne!(
        samples(&done("clahe wine"), Kind::Red),
        samples(&done("clahe wine --per-channel"), Kind::Red)
    );
}

#[test]
fn what_is_not_covered_and_what_is_not_light_stays() {
    let original = open(folder().path(), "wine");
    for operation in ["gamma 2", "equalize", "clahe", "saturation 0.5", "brightness 0.5"] {
        let image = done(&format!("{operation} wine"));
        assert_eq!(samples(&image, Kind::Red)[0], 9, "{operation}");
        assert_ne!(samples(&image, Kind::Red)[1..], samples(&original, Kind::Red)[1..]);
        for kind in [Kind::Cvg, Kind::Dep] {
            assert_eq!(image.plane(kind), original.plane(kind), "{operation}");
        }
        assert_eq!(image.properties.matte, Matte::Premultiplied);
    }
}

#[test]
fn multiplied_light_is_divided_first() {
    // Half covered: 128 of 255 of light 0.2158605 over coverage 0.50196 is a display value of
    // 0.6889; its root is 0.8300, whose light times coverage is 0.32814, stored as 155.3.
    let folder = tempfile::tempdir().unwrap();
    let planes = vec![bytes(Kind::Grg, &[128, 128]), bytes(Kind::Cvg, &[128, 255])];
    write(folder.path(), "half", &Image::new(2, 1, planes).unwrap());
    assert!(ieq(folder.path(), "gamma 2 half -o x").status.success());
    let found = samples(&open(folder.path(), "x"), Kind::Grg);
    // Where all is covered: 255 times the root of 128 / 255.
    assert_eq!(found, [155, 181]);
}

#[test]
fn colors_fade_and_turn() {
    let red = |arguments: &str| COLOR.map(|kind| samples(&done(arguments), kind)[7]);
    let grey = red("saturation 0 wine");
    assert!(grey[0] == grey[1] && grey[1] == grey[2], "{grey:?}");
    assert_eq!(red("saturation 1 wine"), [200, 99, 10]);
    assert_eq!(red("hue 360 wine"), [200, 99, 10]);
    let turned = red("hue 120 wine");
    assert!(turned[1] > turned[0] && turned[1] > turned[2], "orange turns green: {turned:?}");
    assert_eq!(red("hue -240 wine"), turned);
}

#[test]
fn words_and_floats_keep_their_depth() {
    let folder = tempfile::tempdir().unwrap();
    let plane = |samples| vec![Plane { kind: Kind::Grg, samples }];
    let deep = Image::new(3, 1, plane(Samples::U16(vec![0, 16_384, 65_535]))).unwrap();
    write(folder.path(), "deep", &deep);
    assert!(ieq(folder.path(), "gamma 2 deep -o x").status.success());
    let x = open(folder.path(), "x");
    // The root of 16384 / 65535 times 65535.
    assert_eq!(x.plane(Kind::Grg), Some(&Samples::U16(vec![0, 32_768, 65_535])));
    let float = Image::new(3, 1, plane(Samples::F32(vec![0.0, 4.0, f32::NAN]))).unwrap();
    write(folder.path(), "float", &float);
    assert!(ieq(folder.path(), "gamma 1 float -o x").status.success());
    let x = open(folder.path(), "x");
    assert_eq!(x.depth(), Depth::F32);
    let Some(Samples::F32(values)) = x.plane(Kind::Grg) else { panic!("{x:?}") };
    assert!((values[1] - 4.0).abs() < 1e-5 && values[2].is_nan(), "{values:?}");
}

#[test]
fn without_a_name_the_result_is_beside_the_image() {
    let folder = folder();
    assert!(ieq(folder.path(), "gamma 2 grey").status.success());
    assert_eq!(samples(&open(folder.path(), "grey-gamma"), Kind::Grg)[1], 114);
    write(folder.path(), "a.b.png", &open(folder.path(), "grey"));
    assert!(ieq(folder.path(), "brightness 0.2 a.b.png").status.success());
    assert_eq!(samples(&open(folder.path(), "a.b-brightness.idf"), Kind::Grg)[0], 51);
    let (status, message) = failure(folder.path(), "gamma 2 ..");
    let expected = "ieq: error: expected a name to write to, as -o OUT\n";
    assert_eq!((status, message.as_str()), (Some(2), expected));
}

#[test]
fn a_histogram_is_a_table_and_a_picture() {
    let folder = folder();
    let output = ieq(folder.path(), "histogram grey --bins 5");
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("figure\tgrg\npixels\t8\nnot-finite\t0\nmean\t0.55\n"), "{text}");
    assert!(
        text.ends_with(
            "\n\nfrom\tto\tgrg\n0\t0.2\t1\n0.2\t0.4\t1\n0.4\t0.6\t2\n0.6\t0.8\t1\n0.8\t1\t3\n"
        ),
        "{text}"
    );
    let output = ieq(folder.path(), "histogram wine -o h.png");
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("figure\tred\tgrn\tblu\tluma\n"), "{text}");
    assert_eq!(text.lines().count(), 13 + 1 + 257, "{text}");
    assert_eq!(open(folder.path(), "h.png").size(), [512, 256]);
    let output = ieq(folder.path(), "histogram wine -o -");
    assert!(output.stdout.starts_with(b"\x89PNG"), "the picture alone");
}

#[test]
fn indices_become_light() {
    let folder = tempfile::tempdir().unwrap();
    let mut image = Image::new(2, 1, vec![bytes(Kind::Enc, &[1, 0])]).unwrap();
    image.lut = Lut::new(vec![[0, 0, 0], [51, 102, 153]]);
    write(folder.path(), "indexed", &image);
    assert!(ieq(folder.path(), "brightness 0.2 indexed -o x").status.success());
    let x = open(folder.path(), "x");
    assert_eq!(x.kinds(), COLOR);
    assert_eq!(samples(&x, Kind::Blu), [204, 51]);
}

#[test]
fn standard_streams_are_png() {
    let folder = folder();
    write(folder.path(), "grey.png", &open(folder.path(), "grey"));
    for arguments in [&["levels", "1", "0", "-", "-o", "-"][..], &["levels", "1", "0", "-"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_ieq"))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let png = fs::read(folder.path().join("grey.png")).unwrap();
        child.stdin.take().unwrap().write_all(&png).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{arguments:?}");
        fs::write(folder.path().join("back.png"), &output.stdout).unwrap();
        assert_eq!(samples(&open(folder.path(), "back.png"), Kind::Grg)[1], 204);
    }
}

#[test]
fn threads_and_the_way_of_storing_do_not_change_the_picture() {
    let usual = done("clahe wine");
    for options in ["--threads 1", "--threads 3", "--raw", "--rle"] {
        let other = done(&format!("clahe wine {options}"));
        assert_eq!(other.planes(), usual.planes(), "{options}");
    }
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "flat", &Image::new(100, 10, vec![bytes(Kind::Grg, &[7; 1000])]).unwrap());
    for (options, word) in [("--raw", "raw"), ("--rle", "rle"), ("", "rle")] {
        assert!(ieq(folder.path(), &format!("gamma 2 flat -o x {options}")).status.success());
        let text = fs::read_to_string(folder.path().join("x.idf")).unwrap();
        assert!(text.contains(&format!("grg x.grg 100 10 8 {word}\n")), "{text}");
    }
}

#[test]
fn talk_and_history_say_what_was_done() {
    let folder = folder();
    let output = ieq(folder.path(), "gamma 2 grey -o x -v");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text, "read grey: 4 x 2, depth 8, grg\nwrite x: 4 x 2, depth 8, grg\n");
    let output = ieq(folder.path(), "gamma 2 grey -o x -q");
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    let history = open(folder.path(), "x").properties.history;
    let fields: Vec<&str> = history[0].split('\t').collect();
    assert_eq!(fields[1..4], ["ieq", env!("CARGO_PKG_VERSION"), "gamma 2 grey -o x -q"]);
}

#[test]
fn files_outside_are_followed_only_when_told() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    fs::write(inner.join("x.idf"), "idf 1\nsize 4 2\ngrg ../grey.grg 4 2 8 raw\n").unwrap();
    assert_eq!(failure(&inner, "gamma 2 x").0, Some(1));
    assert!(ieq(&inner, "gamma 2 x --outside -o y").status.success());
    assert_eq!(samples(&open(&inner, "y"), Kind::Grg)[1], 114);
}

#[test]
fn help_names_every_operation() {
    let folder = folder();
    let text = |arguments: &str| {
        let output = ieq(folder.path(), arguments);
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let help = text("--help");
    assert!(help.contains("ieq gamma 2.2 wine -o brighter.png"), "{help}");
    for row in TABLE {
        assert!(help.contains(row.word) && help.contains(row.about), "{}: {help}", row.word);
        let own = text(&format!("{} --help", row.word));
        for parameter in row.parameters {
            assert!(own.contains(parameter.name) && own.contains(parameter.about), "{own}");
        }
        assert_eq!(own.contains("--per-channel"), row.looks_at_luma(), "{own}");
    }
    assert!(text("--version").starts_with("ieq "));
    assert!(text("--man").contains(".TH ieq"));
    assert!(text("--completions bash").contains("equalize"));
}

#[test]
fn bad_invocations_fail_with_a_reason() {
    let folder = folder();
    for (arguments, status, reason) in [
        ("", 2, "expected an operation, one of equalize clahe"),
        ("twirl grey", 2, "unrecognized subcommand 'twirl'"),
        ("gamma grey", 2, "expected a number, found `grey`"),
        ("gamma 0 grey", 2, "expected G from 0.01 to 100, found 0"),
        ("clahe --tiles 2.5 grey", 2, "expected tiles from 1 to 64, found 2.5"),
        ("gamma 2 grey --per-channel", 2, "unexpected argument '--per-channel'"),
        ("gamma 2 nothing", 1, "nothing.idf"),
        ("gamma 2 grey -o x.jpg", 2, "cannot write `x.jpg`: found .jpg, expected a name that ends"),
        ("gamma 2 nothing -o x.gif", 2, "iencode writes .gif"),
        ("histogram nothing -o x.tga", 2, "found .tga"),
        ("gamma -1 grey", 2, "expected G from 0.01 to 100, found -1"),
        ("clahe --tiles -1 grey", 2, "expected tiles from 1 to 64, found -1"),
        ("clahe --clip -.1,2 grey", 2, "expected a number, found `-.1,2`"),
    ] {
        let (found, message) = failure(folder.path(), arguments);
        assert_eq!(found, Some(status), "{arguments}: {message}");
        assert!(message.starts_with("ieq: ") && message.contains(reason), "{message}");
    }
    write(folder.path(), "depth", &Image::new(1, 1, vec![bytes(Kind::Dep, &[1])]).unwrap());
    let (status, message) = failure(folder.path(), "equalize depth");
    assert_eq!((status, message.as_str()), (Some(1), "ieq: error: no `grg`, found dep\n"));
}

#[test]
fn options_stand_before_the_operation_or_behind_it() {
    let folder = folder();
    for arguments in ["-v --raw -o out gamma 2 grey", "gamma 2 grey -v --raw -o out"] {
        let output = ieq(folder.path(), arguments);
        assert!(output.status.success(), "{arguments}: {output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("write out"), "{arguments}: {said}");
        fs::remove_file(folder.path().join("out.idf")).unwrap();
    }
}

#[test]
fn layers_of_exr_go_along_or_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let plane = |kind| Plane { kind, samples: Samples::F32(vec![0.25, 0.5]) };
    let kinds = [COLOR.as_slice(), &[Kind::Dep]].concat();
    let image = Image::new(2, 1, kinds.into_iter().map(plane).collect()).unwrap();
    let mut layers = idf::exchange::Layers::default();
    layers.add("glow.R", &image, vec![3.0, -1.0]).unwrap();
    idf::exchange::write_layered(&folder.join("x.exr"), &image, &layers).unwrap();
    let said = |arguments: &str| {
        let output = ieq(folder, arguments);
        assert!(output.status.success(), "{arguments}: {output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(said("brightness 0.5 x.exr -o y.exr"), "");
    let options = ReadOptions::default();
    let (new, others) = idf::exchange::read_layered(&folder.join("y.exr"), None, &options).unwrap();
    assert_eq!(others.words(), ["glow"]);
    assert_eq!(new.plane(Kind::Dep), image.plane(Kind::Dep), "measured values stay");
    assert_ne!(new.plane(Kind::Red), image.plane(Kind::Red));
    let (glow, _) =
        idf::exchange::read_layered(&folder.join("y.exr"), Some("glow"), &options).unwrap();
    assert_eq!(glow.planes()[0].samples, Samples::F32(vec![3.0, -1.0]), "as it was");
    let said = said("brightness 0.5 x.exr -o y");
    assert!(
        said.starts_with("warning: left out as IDF has no place for it: glow; icopy"),
        "{said}"
    );
    assert!(said.lines().count() == 1 && ieq(folder, "gamma 2 x.exr -o y -q").stderr.is_empty());
}

/// Whatever is left of memory, the work is done or said to be too large.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_too_large_for_memory_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let plane = |kind| Plane { kind, samples: Samples::U8(vec![7; 36_000_000]) };
    let large = Image::new(6000, 6000, COLOR.map(plane).into()).unwrap();
    write(folder.path(), "large", &large);
    let before = names(folder.path());
    for (arguments, kilobytes) in
        [("gamma 2.2 large -o x", 200_000), ("gamma 2.2 large -o x.png", 250_000)]
    {
        let line =
            format!("ulimit -c 0; ulimit -v {kilobytes}; exec \"$0\" {arguments} --threads 2");
        let output = Command::new("bash")
            .args(["-c", &line, env!("CARGO_BIN_EXE_ieq")])
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
