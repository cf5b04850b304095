//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Depth, Image, Kind, Plane, ReadOptions, Samples, WriteOptions};
use ierr::TABLE;

fn plane(kind: Kind, samples: Vec<u8>) -> Plane {
    Plane { kind, samples: Samples::U8(samples) }
}

fn write(folder: &Path, name: &str, image: &Image) {
    write_image(&folder.join(name), image, &WriteOptions::default()).unwrap();
}

/// A folder with a grey `a`, 16 x 12, and `b` that is 51 steps brighter at column 3, row 2.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ramp: Vec<u8> = (0..192).collect();
    let mut other = ramp.clone();
    other[2 * 16 + 3] += 51;
    write(folder.path(), "a", &Image::new(16, 12, vec![plane(Kind::Grg, ramp)]).unwrap());
    write(folder.path(), "b.png", &Image::new(16, 12, vec![plane(Kind::Grg, other)]).unwrap());
    folder
}

fn ierr(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_ierr");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// Standard output where all went well and nothing else was said.
fn text(folder: &Path, arguments: &str) -> String {
    let output = ierr(folder, arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn open(folder: &Path, name: &str) -> Image {
    read_image(&folder.join(name), &ReadOptions { history: true, ..ReadOptions::default() })
        .unwrap()
}

/// Exit status and standard error.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = ierr(folder, arguments);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn figures_are_printed_a_line_each() {
    let folder = folder();
    let found = text(folder.path(), "a b.png");
    let words: Vec<&str> = found.lines().filter_map(|l| l.split_whitespace().next()).collect();
    let expected: Vec<&str> = TABLE.iter().map(|row| row.word).collect();
    assert_eq!(words, expected, "{found}");
    // 0.2 of one pixel in 192: its root mean square is 0.2 / sqrt(192).
    let found = text(folder.path(), "a b.png --metrics max,rmse,psnr,mean");
    let expected = "max    0.200000  51.0000 steps of 255  worst at 3,2 in grg\n\
                    rmse   0.014434  3.6806 steps of 255\n\
                    psnr   36.8124 dB\n\
                    mean   0.001042  0.2656 steps of 255\n";
    assert_eq!(found, expected);
    let same = text(folder.path(), "a a --metrics psnr,flip,ssim");
    assert_eq!(
        same,
        "psnr   inf dB\nflip   0.000000  worst at 0,0\nssim   1.000000  worst at 5,5\n"
    );
}

#[test]
fn json_is_one_object() {
    let folder = folder();
    let found = text(folder.path(), "a b.png --json --metrics max");
    let expected = "{\"reference\":\"a\",\"test\":\"b.png\",\"columns\":16,\"rows\":12,\
                    \"scale\":\"display\",\"incomparable\":0,\"metrics\":{\"max\":{\"value\":0.2,\
                    \"steps\":51,\"channels\":{\"grg\":0.2},\
                    \"worst\":{\"column\":3,\"row\":2,\"channel\":\"grg\"}}}}\n";
    assert_eq!(found, expected);
    assert!(text(folder.path(), "a a --json").contains("\"psnr\":{\"value\":null"));
}

#[test]
fn the_distance_of_viewing_changes_flip() {
    let folder = folder();
    let usual = text(folder.path(), "a b.png --metrics flip");
    assert_eq!(text(folder.path(), "a b.png --metrics flip --ppd 67"), usual);
    assert_ne!(text(folder.path(), "a b.png --metrics flip --ppd 20"), usual);
}

#[test]
fn differences_are_pictures() {
    let folder = folder();
    let at = |name: &str| match open(folder.path(), name).plane(Kind::Grg) {
        Some(Samples::U8(samples)) => [samples[0], samples[35]],
        other => panic!("{other:?}"),
    };
    let usual = text(folder.path(), "a b.png");
    assert_eq!(text(folder.path(), "a b.png --diff d.png"), usual);
    assert_eq!(at("d.png"), [0, 51]);
    text(folder.path(), "a b.png --diff d --gain 3 --raw");
    assert_eq!(at("d"), [0, 153]);
    let description = fs::read_to_string(folder.path().join("d.idf")).unwrap();
    assert!(description.contains("grg d.grg 16 12 8 raw"), "{description}");
    let history = open(folder.path(), "d").properties.history;
    assert!(history[0].contains("\tierr\t") && history[0].contains("--gain 3"), "{history:?}");
    text(folder.path(), "a b.png --diff d --diff-by flip --rle");
    let [far, near] = at("d");
    assert!(near > 20 && far < 5, "a point is seen where it is: {near}, {far}");
    text(folder.path(), "a b.png --diff d --diff-by ssim --metrics max");
    assert!(at("d")[0] < 255, "{:?}", at("d"));
    let output = ierr(folder.path(), "a b.png --diff -");
    assert!(output.stdout.starts_with(b"\x89PNG"), "the picture alone");
}

#[test]
fn limits_are_of_one_channel_and_in_lists() {
    let folder = folder();
    let color = |green: u8| {
        let planes = COLOR.map(|kind| {
            let value = if kind == Kind::Grn { green } else { 9 };
            plane(kind, vec![value; 192])
        });
        Image::new(16, 12, planes.into()).unwrap()
    };
    write(folder.path(), "x", &color(9));
    write(folder.path(), "y", &color(39));
    text(folder.path(), "x y --limit max=30/255,max.red=0,max.blu=0,mean.grn=30.001/255");
    text(folder.path(), "x y --limit rmse.grn=30.001/255,rmse.red=0");
    for (limits, name) in
        [("max.red=0,max.grn=29/255", "max.grn is 0.117"), ("max=1,rmse.grn=0.1", "rmse.grn is")]
    {
        let (status, said) = failure(folder.path(), &format!("x y --limit {limits}"));
        assert!(said.contains(name) && status == Some(1), "{limits}: {said}");
    }
}

#[test]
fn limits_decide_the_exit_status() {
    let folder = folder();
    for arguments in
        ["--limit max=51/255", "--limit psnr=36.8 --limit rmse=0.015", "--limit ssim=0.5"]
    {
        assert!(
            ierr(folder.path(), &format!("a b.png {arguments}")).status.success(),
            "{arguments}"
        );
    }
    let (status, message) = failure(folder.path(), "a b.png --limit max=50/255");
    let expected = "ierr: error: max is 0.2, expected at most 0.19607843137254902\n";
    assert_eq!((status, message.as_str()), (Some(1), expected));
    let (status, message) = failure(folder.path(), "a b.png --metrics rmse --limit psnr=40");
    assert_eq!(status, Some(1));
    assert!(message.ends_with("expected at least 40\n"), "{message}");
}

#[test]
fn floating_point_is_compared_as_light() {
    let folder = tempfile::tempdir().unwrap();
    let image = |values: &[f32]| {
        let samples = Samples::F32(values.into());
        Image::new(2, 1, vec![Plane { kind: Kind::Grg, samples }]).unwrap()
    };
    write(folder.path(), "a", &image(&[0.0, 4.0]));
    write(folder.path(), "b", &image(&[0.5, 4.0]));
    let found = text(folder.path(), "a b --metrics max --json --diff d");
    assert!(
        found.contains("\"scale\":\"linear\"")
            && found.contains("\"max\":{\"value\":0.5,\"channels\""),
        "{found}"
    );
    assert_eq!(open(folder.path(), "d").depth(), Depth::F32);
    write(folder.path(), "nan", &image(&[f32::NAN, 4.0]));
    let output = ierr(folder.path(), "a nan --metrics max");
    assert!(output.status.success());
    let warning = String::from_utf8(output.stderr).unwrap();
    assert!(warning.starts_with("warning: 1 samples are infinite or not a number"), "{warning}");
    assert!(text(folder.path(), "a nan --metrics max -q").starts_with("max    0.000000"));
    assert_eq!(failure(folder.path(), "a nan --limit max=1").0, Some(1));
    assert!(text(folder.path(), "a b --metrics ssim").contains("the images are too small"));
}

#[test]
fn coverage_is_a_channel() {
    let folder = tempfile::tempdir().unwrap();
    let color = || COLOR.map(|kind| plane(kind, vec![0, 0]));
    write(folder.path(), "a", &Image::new(2, 1, color().into()).unwrap());
    let mut planes = color().to_vec();
    planes.push(plane(Kind::Cvg, vec![255, 204]));
    write(folder.path(), "b", &Image::new(2, 1, planes).unwrap());
    let found = text(folder.path(), "a b --metrics max");
    assert!(found.contains("cvg 0.200000  worst at 1,0 in cvg"), "{found}");
}

#[test]
fn one_image_may_come_from_standard_input() {
    let folder = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ierr"))
        .args(["a", "-", "--metrics", "max"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let png = fs::read(folder.path().join("b.png")).unwrap();
    child.stdin.take().unwrap().write_all(&png).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(String::from_utf8(output.stdout).unwrap().starts_with("max    0.200000"));
    assert_eq!(failure(folder.path(), "- -").0, Some(2));
}

#[test]
fn threads_do_not_change_a_figure() {
    let folder = folder();
    let usual = text(folder.path(), "a b.png --json");
    assert_eq!(text(folder.path(), "a b.png --json --threads 1"), usual);
    assert_eq!(text(folder.path(), "a b.png --json --threads 3"), usual);
    let output = ierr(folder.path(), "a b.png --metrics max -v");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said, "max: greatest absolute difference, and where it is\n");
}

#[test]
fn files_outside_are_followed_only_when_told() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let encoding = fs::read_to_string(folder.path().join("a.idf")).unwrap();
    fs::write(inner.join("x.idf"), encoding.replace("a.grg", "../a.grg")).unwrap();
    assert_eq!(failure(&inner, "x x").0, Some(1));
    assert!(text(&inner, "x x --outside --metrics max").starts_with("max    0.000000"));
}

#[test]
fn help_names_every_metric() {
    let folder = folder();
    let help = text(folder.path(), "--help");
    assert!(help.contains("ierr right.png left.png"), "{help}");
    for row in TABLE {
        assert!(help.contains(&format!("{:5} {}", row.word, row.about)), "{}: {help}", row.word);
    }
    assert!(text(folder.path(), "--version").starts_with("ierr "));
    assert!(text(folder.path(), "--man").contains(".TH ierr"));
    assert!(text(folder.path(), "--completions bash").contains("--diff-by"));
}

#[test]
fn bad_invocations_fail_with_a_reason() {
    let folder = folder();
    write(folder.path(), "small", &Image::new(1, 1, vec![plane(Kind::Grg, vec![0])]).unwrap());
    for (arguments, status, reason) in [
        ("a", 2, "<B>"),
        ("a b.png --metrics twirl", 2, "no metric is called `twirl`, expected rmse psnr"),
        ("a b.png --diff d --diff-by rmse", 2, "`rmse` has no value for each pixel"),
        ("a b.png --diff-by flip", 2, "--diff <OUT>"),
        ("a b.png --gain 0 --diff d", 2, "expected a number from 0.000001"),
        ("a b.png --ppd 0", 2, "expected a number from 1 to 1000"),
        ("a b.png --limit max", 2, "expected METRIC=VALUE"),
        ("a b.png --limit max=1,", 2, "expected METRIC=VALUE"),
        ("a b.png --limit max.rad=1", 2, "no channel is called `rad`"),
        ("a b.png --limit max.red=1", 1, "no channel `red`, found grg"),
        ("a b.png --limit ssim.grg=1", 1, "ssim looks at all channels together"),
        ("a nothing.png", 1, "nothing.png"),
        ("a small", 1, "expected two images of one size, found 16 x 12 and 1 x 1 pixels"),
        ("small small --limit ssim=0.5", 1, "ssim: the images are too small"),
        ("a nothing.png --diff d.jpg", 2, "cannot write `d.jpg`: found .jpg"),
        ("a b.png --diff d.gif", 2, "iencode writes .gif"),
        ("a b.png --gain -1 --diff d", 2, "expected a number from 0.000001"),
        ("a b.png --ppd -1", 2, "expected a number from 1 to 1000"),
    ] {
        let (found, message) = failure(folder.path(), arguments);
        assert_eq!(found, Some(status), "{arguments}: {message}");
        assert!(message.starts_with("ierr: ") && message.contains(reason), "{message}");
    }
}

#[test]
fn layers_that_are_not_compared_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let plane = |kind| Plane { kind, samples: Samples::F32(vec![0.25; 4]) };
    let image = Image::new(2, 2, COLOR.map(plane).into()).unwrap();
    let mut layers = idf::exchange::Layers::default();
    layers.add("glow.R", &image, vec![3.0; 4]).unwrap();
    idf::exchange::write_layered(&folder.join("x.exr"), &image, &layers).unwrap();
    write(folder, "y.exr", &image);
    let (status, said) = failure(folder, "x.exr y.exr --metrics rmse");
    assert_eq!(status, Some(0));
    let expected = "warning: left out of the comparison, of x.exr: glow; icopy --channels NAME copies a layer\n";
    assert_eq!(said, expected);
}
