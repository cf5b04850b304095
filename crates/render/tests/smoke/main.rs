//! The real program: what it writes, what it says, and its exit status.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

mod part;
mod sampling;
mod watch;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::read_image;
use idf::{Image, Kind, ReadOptions, Samples};
use tempfile::TempDir;

/// A clear ball before a mirror, and a floor: what each option changes can be seen.
const GOOD: &str = "\
    object is smoothest trans (3, 1.5) sphere\n\
    object is smoothest shiny blue block at (0, 0, -4) scale (2, 2, 1)\n\
    object is paint checker red block at (0, -3, 0) scale (3, 1, 3)\n\
    light at (5, 9, 5) ambient intensity 0.3\n\
    background light gray\n\
    camera at (0, 1, 9)\n";

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("good.sdl"), GOOD).unwrap();
    fs::write(folder.path().join("bad.sdl"), "object is glas\nfog 0\n").unwrap();
    folder
}

/// Runs `portray` with the words of `arguments`.
fn portray(folder: &Path, arguments: &str, input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_portray"))
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A program that does not read its input may be gone already.
    child.stdin.take().unwrap().write_all(input.as_bytes()).ok();
    child.wait_with_output().unwrap()
}

fn says(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The small picture that `options` give, without a word on standard error.
fn picture(options: &str) -> Image {
    sized("32x24", options)
}

fn sized(size: &str, options: &str) -> Image {
    let folder = folder();
    let output = portray(folder.path(), &format!("good.sdl -o out --size {size} {options}"), "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{options}");
    read_image(&folder.path().join("out"), &ReadOptions::default()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let names =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn an_image_is_written_in_the_current_folder() {
    let folder = folder();
    let output = portray(folder.path(), "good.sdl --size 8x8", "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
    assert!(output.stdout.is_empty(), "nothing on standard output");
    let expected = [
        "bad.sdl", "good.blu", "good.cvg", "good.grn", "good.idf", "good.log", "good.red",
        "good.sdl",
    ];
    assert_eq!(names(folder.path()), expected, "and no temporary files");
    let log = fs::read_to_string(folder.path().join("good.log")).unwrap();
    let fields: Vec<&str> = log.trim_end().split('\t').collect();
    assert_eq!(
        fields[1..4],
        ["portray", env!("CARGO_PKG_VERSION"), "good.sdl --size 8x8"],
        "{log}"
    );
    let image = read_image(&folder.path().join("good"), &ReadOptions::default()).unwrap();
    assert_eq!(image.size(), [8, 8]);
}

#[test]
fn streams_carry_scenes_in_and_pictures_out() {
    let folder = folder();
    let options = "--size 32x32 --samples 4";
    portray(folder.path(), &format!("good.sdl -o out.png {options}"), "");
    let written = fs::read(folder.path().join("out.png")).unwrap();
    assert!(written.starts_with(b"\x89PNG"), "a PNG");
    for (scene, more) in [("good.sdl", ""), ("-", ""), ("-", "--threads 1"), ("-", "--accel none")]
    {
        let output = portray(folder.path(), &format!("{scene} -o - {options} {more}"), GOOD);
        assert_eq!(
            (output.status.code(), says(&output)),
            (Some(0), String::new()),
            "{scene} {more}"
        );
        assert!(output.stdout == written, "the same bytes on standard output: {scene} {more}");
    }
    let mut compiled = Vec::new();
    let scene = compile::compile_text(GOOD).scene.unwrap();
    scene::format::write(&scene, &mut compiled).unwrap();
    let compiled = String::from_utf8(compiled).unwrap();
    fs::write(folder.path().join("good.prc"), &compiled).unwrap();
    for scene in ["-", "good.prc"] {
        let output = portray(folder.path(), &format!("{scene} -o - {options}"), &compiled);
        assert!(output.stdout == written, "a compiled scene from {scene}");
    }
}

#[test]
fn errors_leave_the_output_untouched() {
    let folder = folder();
    fs::write(folder.path().join("out.png"), "before").unwrap();
    let before = names(folder.path());
    let output = portray(folder.path(), "bad.sdl -o out.png", "");
    assert_eq!(output.status.code(), Some(1));
    let expected = "\
bad.sdl:1:11: error: unknown class `glas`
1 | object is glas
  |           ^^^^
bad.sdl:2:5: error: the half distance of fog has to be above 0, found 0
2 | fog 0
  |     ^
portray: error: bad.sdl: the scene has errors
";
    assert_eq!(says(&output), expected);
    assert_eq!(fs::read_to_string(folder.path().join("out.png")).unwrap(), "before");
    for (arguments, input, expected) in [
        ("- -o out.png", "object is\n sphere scale 0", "<text>:2:15: error: a scale of 0"),
        ("none.sdl -o out.png", "", "portray: error: cannot read `none.sdl`: No such file"),
        ("none.prc -o out.png", "", "portray: error: none.prc: No such file"),
        (". -o out.png", "", "portray: error: cannot read `.`: "),
        (
            "- -o out.png",
            "portray scene 2\nnonsense",
            "portray: error: -: line 2, column 1: expected",
        ),
        ("- -o out.png", "object is sphere", "portray: error: -: the scene has no camera; add"),
        ("good.sdl --size 8x8 -o none/out.png", "", "portray: error: "),
        ("good.sdl --size 8x8 -o out.png --stats none/out.json", "", "portray: error: "),
    ] {
        let output = portray(folder.path(), arguments, input);
        assert_eq!(output.status.code(), Some(1), "{arguments}: {output:?}");
        let said = says(&output);
        assert!(said.starts_with(expected), "{arguments}: {said}");
        assert!(output.stdout.is_empty(), "{arguments}");
        assert_eq!(names(folder.path()), before, "{arguments}");
    }
}

#[test]
fn a_picture_that_cannot_be_shown_is_an_error_of_its_statement() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("torn.png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0").unwrap();
    let text = "// Walls\ncamera at (0, 0, 5)  object is paint image (\"torn.png\") sphere\n";
    fs::write(at("wall.sdl"), text).unwrap();
    fs::write(at("torn.sdl"), "include \"wall.sdl\"").unwrap();
    let pointed = "\n2 | camera at (0, 0, 5)  object is paint image (\"torn.png\") sphere\n  |\
                   \x20                                            ^^^^^^^^^^\n";
    for (scene, input, place, last) in [
        ("torn.sdl", "", "wall.sdl:2:45", "portray: error: torn.sdl: the scene has errors\n"),
        ("-", text, "<text>:2:45", "portray: error: -: the scene has errors\n"),
    ] {
        let output = portray(folder.path(), &format!("{scene} -o out.png"), input);
        assert_eq!(output.status.code(), Some(1));
        let said = says(&output);
        let first = format!("{place}: error: cannot show the picture: cannot decode `torn.png`: ");
        assert!(said.starts_with(&first), "{said}");
        assert!(said.contains(pointed) && said.ends_with(last), "{said}");
        assert!(!at("out.png").exists(), "nothing is written");
    }
}

#[test]
fn wrong_command_lines_have_status_2() {
    let folder = folder();
    let before = names(folder.path());
    for (arguments, part) in [
        ("", "Usage"),
        ("good.sdl --nonsense", "--nonsense"),
        ("good.sdl extra", "extra"),
        ("good.sdl -q -v", "cannot be used with"),
        ("good.sdl --raw --rle", "cannot be used with"),
        ("good.sdl --size 10", "640x480"),
        ("good.sdl --size 0x10", "from 1 to 65535"),
        ("good.sdl --size 65536x1", "from 1 to 65535"),
        ("good.sdl --samples 5", "the nearest is 4"),
        ("good.sdl --samples 0", "the nearest is 1"),
        ("good.sdl --samples 1000000", "the nearest is 65536"),
        ("good.sdl --samples 5 --aa none", "`--aa stochastic` takes any number"),
        ("good.sdl --samples 7 --aa adaptive", "the nearest is 4"),
        ("good.sdl --samples 0 --aa adaptive", "the nearest is 1"),
        ("good.sdl --samples 1024 --aa adaptive", "the nearest is 256"),
        ("good.sdl --samples 0 --aa stochastic", "from 1 to 65536"),
        ("good.sdl --samples 65537 --aa stochastic", "from 1 to 65536"),
        ("good.sdl --aa random", "possible values: none, adaptive, stochastic"),
        ("good.sdl --error 0", "--error 0: expected a number above 0"),
        ("good.sdl --error nan", "--error NaN: expected a number above 0"),
        ("good.sdl --error 1 --seconds 1", "cannot be used with"),
        ("good.sdl --error 1 --samples 4", "cannot be used with"),
        ("good.sdl --seconds 1 --samples 4", "cannot be used with"),
        ("good.sdl --seconds 1e99", "--seconds"),
        ("good.sdl --seconds 1 --aa adaptive", "leave `--aa` out"),
        ("good.sdl --error -1", "--error -1: expected a number above 0"),
        ("good.sdl --seconds -1", "--seconds -1: expected a number above 0"),
        ("good.sdl --error 1 --aa none", "leave `--aa` out"),
        ("good.sdl --filter gauss", "possible values: box, tent, mitchell"),
        ("good.sdl --seed -1", "-1"),
        ("good.sdl --samples -1", "-1"),
        ("good.sdl --depth 10001", "10001"),
        ("good.sdl --min-weight 1.5", "from 0 to 1"),
        ("good.sdl --min-weight nan", "from 0 to 1"),
        ("good.sdl --accel fast", "possible values: none, boxes, coherence, bvh"),
        ("good.sdl --channels depth -o x.png", "`dep` holds measured values"),
        ("good.sdl --channels deep", "no channel is called `deep`"),
        ("good.sdl --dither-output -o x.exr", "shows no bands"),
        ("good.sdl --channels rgb,lut", "a render has no `lut`"),
        ("good.sdl --threads 0", "--threads"),
        ("--completions nonsense", "nonsense"),
        ("good.sdl --man", "cannot be used with"),
    ] {
        let output = portray(folder.path(), arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {output:?}");
        let said = says(&output);
        assert!(said.starts_with("portray: ") && said.contains(part), "{arguments}: {said}");
        assert_eq!(names(folder.path()), before, "{arguments}");
    }
}

#[test]
fn options_change_the_picture() {
    let plain = picture("");
    assert!(sized("24x32", "").size() == [24, 32], "--size");
    for options in ["--samples 4", "--depth 1", "--min-weight 0.5"] {
        let other = picture(options);
        assert!(other.size() == plain.size() && other.planes() != plain.planes(), "{options}");
    }
    for options in [
        "--aa adaptive",
        "--aa adaptive --samples 16",
        "--depth 15",
        "--min-weight 0.00390625",
        "--threads 1",
        "--threads 3",
    ] {
        assert!(picture(options).planes() == plain.planes(), "{options} is the default");
    }
    for options in [
        "--accel none",
        "--accel boxes",
        "--accel coherence",
        "--accel bvh",
        "--keep-all",
        "--rle",
        "--raw",
    ] {
        assert!(picture(options).planes() == plain.planes(), "{options} does not show");
    }
    assert_eq!(plain.kinds(), [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg], "all by default");
    assert_eq!(picture("--channels cvg,blu").kinds(), [Kind::Blu, Kind::Cvg], "--channels");
    let dithered = picture("--dither-output");
    assert!(dithered.planes() != plain.planes(), "--dither-output");
    assert!(
        picture("--dither-output --threads 3").planes() == dithered.planes(),
        "always the same"
    );
    for (word, kinds) in [
        ("depth", vec![Kind::Dep]),
        ("rgb,cvg,normal", [&plain.kinds()[..], &[Kind::Nrx, Kind::Nry, Kind::Nrz]].concat()),
        ("cvg,object", vec![Kind::Cvg, Kind::Obj]),
    ] {
        let found = picture(&format!("--channels {word}"));
        assert_eq!(found.kinds(), kinds, "{word}");
        let light = found.planes().iter().filter(|p| plain.plane(p.kind).is_some());
        assert!(light.into_iter().all(|p| plain.plane(p.kind) == Some(&p.samples)), "{word}");
        for options in ["--accel none", "--accel boxes", "--threads 3"] {
            let again = picture(&format!("--channels {word} {options}"));
            assert!(again.planes() == found.planes(), "{word} {options} does not show");
        }
    }
    let Some(Samples::U8(coverage)) = plain.plane(Kind::Cvg) else { panic!("coverage") };
    assert!(coverage.contains(&0) && coverage.contains(&255), "open and covered");
}

#[test]
fn options_change_what_is_beside_the_picture() {
    let folder = folder();
    let run = |options: &str| {
        let output = portray(folder.path(), &format!("good.sdl --size 32x24 {options}"), "");
        assert_eq!(output.status.code(), Some(0), "{options}: {output:?}");
        output
    };
    let length = |name: &str| fs::metadata(folder.path().join(name)).unwrap().len();
    run("-o raw --raw");
    run("-o coded --rle");
    run("-o usual");
    assert_eq!(length("raw.cvg"), 32 * 24, "--raw");
    assert!(length("coded.cvg") < 32 * 24, "--rle");
    assert_eq!(length("usual.cvg"), length("coded.cvg"), "coded by default");

    run("-o x.png --stats stats.json --samples 4");
    let stats = fs::read_to_string(folder.path().join("stats.json")).unwrap();
    assert!(stats.starts_with("{\n") && stats.ends_with("}\n"), "{stats}");
    for line in ["  \"columns\": 32,", "  \"samples\": 4,", "  \"primary\": 3072,"] {
        assert!(stats.lines().any(|found| found == line), "{line} in {stats}");
    }
    let said = says(&run("-o x.png -v --samples 1"));
    assert!(said.contains("columns 32\n") && said.contains("primary 768\n"), "-v: {said}");

    for (options, last) in
        [("--explain", "paint "), ("--explain --keep-all", "all of it is kept: --keep-all\n")]
    {
        let said = says(&run(&format!("-o x.png -q {options}")));
        assert!(said.starts_with("pass ") && said.contains("\nunreached "), "{options}: {said}");
        let found = said.lines().last().map(|line| line.starts_with(last.trim_end()));
        assert_eq!(found, Some(true), "{options}: {said}");
    }

    let warned = "camera at (0, 0, 5) camera at (0, 0, 6)";
    let said = says(&portray(folder.path(), "- -o x.png --size 4x4", warned));
    assert!(said.contains(":1:21: warning: ") && said.contains("no objects"), "{said}");
    let said = says(&portray(folder.path(), "- -o x.png --size 4x4 -q", warned));
    assert_eq!(said, "", "-q");
}

#[test]
fn numbers_are_given_from_outside() {
    let text = "let width = 1 object is sphere scale width at (0, 0, frame) camera at (0, 0, 9) light at (0, 0, 9)";
    let folder = folder();
    let covered = |options: &str| {
        let output = portray(folder.path(), &format!("- -o out --size 40x40 {options}"), text);
        assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{options}");
        let image = read_image(&folder.path().join("out"), &ReadOptions::default()).unwrap();
        let Some(Samples::U8(coverage)) = image.plane(Kind::Cvg) else { panic!("coverage") };
        coverage.iter().filter(|sample| **sample > 0).count()
    };
    let usual = covered("");
    assert_eq!(covered("-D width=1"), usual, "as the scene says");
    assert!(covered("-D WIDTH=2") > 3 * usual, "twice as wide is four times the area");
    assert!(covered("-Dwidth=-0.5 -D frame=0") < usual / 2, "half as wide");
    assert!(covered("-D frame=4") > 2 * usual, "nearer to the camera");
    for (arguments, status, part) in [
        ("good.sdl -D n=1", 1, "-D n: the scene has no `let n`"),
        ("good.sdl -D n", 2, "-D"),
        ("good.sdl -D n=x", 2, "-D"),
        ("good.prc -D n=1", 2, "-D n: numbers are given when a scene is compiled"),
    ] {
        let compiled = "portray scene 2\nend\n";
        fs::write(folder.path().join("good.prc"), compiled).unwrap();
        let output = portray(folder.path(), &format!("{arguments} -o other.png"), "");
        assert_eq!(output.status.code(), Some(status), "{arguments}: {}", says(&output));
        assert!(says(&output).contains(part), "{arguments}: {}", says(&output));
        assert!(!folder.path().join("other.png").exists(), "{arguments}");
    }
}

#[test]
fn help_version_and_packaging() {
    let folder = folder();
    for (arguments, part) in [
        ("--help", "portray scenes/wine-glass/wine-glass.sdl -o"),
        ("--version", concat!("portray ", env!("CARGO_PKG_VERSION"))),
        ("--man", ".TH portray 1"),
        ("--completions bash", "_portray"),
        ("--completions zsh", "#compdef portray"),
    ] {
        let output = portray(folder.path(), arguments, "");
        assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{arguments}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(part), "{arguments}: {text}");
    }
}

#[test]
fn every_option_is_in_a_test() {
    let help = portray(&std::env::temp_dir(), "--help", "");
    let help = String::from_utf8(help.stdout).unwrap();
    let words = help.split(|c: char| c.is_whitespace() || ",[]=<>`".contains(c));
    let options: std::collections::BTreeSet<&str> =
        words.filter(|word| word.starts_with("--")).collect();
    // A new option needs a test of what it changes.
    let tested = [
        "--aa",
        "--accel",
        "--audit",
        "--certify",
        "--channels",
        "--completions",
        "--depth",
        "--dither-output",
        "--error",
        "--explain",
        "--filter",
        "--frames",
        "--glossy",
        "--help",
        "--keep-all",
        "--man",
        "--max-primitives",
        "--min-weight",
        "--open",
        "--output",
        "--part",
        "--part-of",
        "--quiet",
        "--raw",
        "--rle",
        "--samples",
        "--seconds",
        "--seed",
        "--size",
        "--stats",
        "--terminal",
        "--threads",
        "--tile",
        "--verbose",
        "--version",
        "--watch",
        "--window",
    ];
    assert_eq!(options.into_iter().collect::<Vec<_>>(), tested);
}

#[test]
fn repeats_have_a_limit_that_an_option_moves() {
    let folder = folder();
    let rows = "repeat i from 1 to 50 { object is sphere at (i, 0, 0) } camera at (0, 0, 99)";
    for (limit, status) in [("49", 1), ("50", 0)] {
        let line = format!("- --max-primitives {limit} --size 4x4 -o rows.png");
        let output = portray(folder.path(), &line, rows);
        assert_eq!(output.status.code(), Some(status), "{limit}: {}", says(&output));
        let said = says(&output).contains("--max-primitives raises the limit");
        assert_eq!(said, status == 1, "{limit}: {}", says(&output));
    }
}

#[test]
fn lists_of_all_boundaries_have_a_limit() {
    let folder = folder();
    let class = |level: u32| {
        let inner = level - 1;
        format!("class c{level} is c{inner} + c{inner} at ({level}, {inner}, 0) rotate (0, 0, 9)\n")
    };
    for (levels, accel, status) in [(25, "none", 1), (25, "bvh", 0), (8, "none", 0)] {
        let classes: String = (1..=levels).map(class).collect();
        let text = format!(
            "class c0 is sphere scale 0.01\n{classes} object is c{levels} camera at (0, 0, -5) target at (0, 0, -9)"
        );
        let line = format!("- --accel {accel} --size 4x4 -q -o x.png");
        let output = portray(folder.path(), &line, &text);
        assert_eq!(output.status.code(), Some(status), "{line}: {}", says(&output));
        let said = says(&output).contains("33554432 primitives that the scene stands for");
        assert_eq!(said, status == 1, "{line}: {}", says(&output));
    }
}

#[test]
fn what_cannot_be_written_is_said_before_the_work() {
    let folder = folder();
    fs::create_dir(folder.path().join("here")).unwrap();
    fs::copy(folder.path().join("good.sdl"), folder.path().join("self.png")).unwrap();
    let before = names(folder.path());
    // A picture this large takes long: that the answer comes at all says that it came first.
    for (arguments, status, message) in [
        ("-o x.gif", 2, "cannot write `x.gif`: found .gif, expected a name that ends in .idf"),
        ("-o x.jpg", 2, "cannot write `x.jpg`"),
        ("-o x.xyz", 2, "cannot write `x.xyz`"),
        ("-o none/x.png", 1, "none/x.png: No such file"),
        ("-o here/none/x", 1, "here/none/x: No such file"),
        ("-o good.sdl/x", 1, "good.sdl/x: expected a folder"),
        ("-o x.png --stats none/x.json", 1, "none/x.json: No such file"),
        ("-o - --stats -", 2, "--output and --stats cannot both be standard output"),
        ("-o x.png --size 65535x65535", 2, "--size 65535x65535"),
    ] {
        let sized = if arguments.contains("--size") { "" } else { "--size 8000x8000" };
        let output = portray(folder.path(), &format!("good.sdl {arguments} {sized}"), "");
        assert_eq!(output.status.code(), Some(status), "{arguments}: {}", says(&output));
        assert!(says(&output).contains(message), "{arguments}: {}", says(&output));
        assert_eq!(names(folder.path()), before, "{arguments}");
    }
    let output = portray(folder.path(), "self.png -o self.png", "");
    assert_eq!(output.status.code(), Some(1), "{}", says(&output));
    assert_eq!(fs::read(folder.path().join("self.png")).unwrap(), GOOD.as_bytes(), "as it was");
    // A folder is no hindrance to an image of its name.
    let output = portray(folder.path(), "good.sdl -o here --size 8x8", "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
    assert!(folder.path().join("here.idf").exists(), "beside the folder");
}
