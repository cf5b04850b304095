//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{
    Ask, Image, Kind, Lut, Plane, ReadOptions, Samples, Transfer, WriteOptions, read, write,
};

const SIZE: [u32; 2] = [64, 48];

/// A smooth picture of more than 256 colours: red across, green down.
fn light() -> Vec<Plane> {
    let plane = |kind, value: fn(u32, u32) -> u32| {
        let places = (0..SIZE[0] * SIZE[1]).map(|at| (at % SIZE[0], at / SIZE[0]));
        let samples = places.map(|(x, y)| u8::try_from(value(x, y)).unwrap()).collect();
        Plane { kind, samples: Samples::U8(samples) }
    };
    vec![
        plane(Kind::Red, |x, _| x * 4),
        plane(Kind::Grn, |_, y| y * 5),
        plane(Kind::Blu, |x, y| (x * 3 + y * 7) % 256),
    ]
}

/// Nothing covered at the left, half in the middle, all at the right.
fn coverage() -> Plane {
    let value = |at: u32| [0, 100, 160, 255][(at % SIZE[0] / 16) as usize];
    let samples = (0..SIZE[0] * SIZE[1]).map(value).collect();
    Plane { kind: Kind::Cvg, samples: Samples::U8(samples) }
}

/// A folder with images `wine`, which has coverage, and `label.png`, which has none.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut planes = light();
    planes.push(coverage());
    let mut wine = Image::new(SIZE[0], SIZE[1], planes).unwrap();
    wine.properties.matte = idf::Matte::Straight;
    wine.properties.background = Some([1.0, 1.0, 1.0]);
    write(&folder.path().join("wine"), &wine, &WriteOptions::default()).unwrap();
    let label = Image::new(SIZE[0], SIZE[1], light()).unwrap();
    write_image(&folder.path().join("label.png"), &label, &WriteOptions::default()).unwrap();
    folder
}

fn iencode(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_iencode");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// What a good invocation says on standard error.
fn done(folder: &Path, arguments: &str) -> String {
    let output = iencode(folder, arguments);
    assert!(output.status.success(), "{arguments}: {output:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Exit status and standard error of a bad one.
fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = iencode(folder, arguments);
    assert!(output.stdout.is_empty(), "{arguments}: {output:?}");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

fn open(folder: &Path, name: &str) -> Image {
    let options = ReadOptions { history: true, ..ReadOptions::default() };
    read_image(&folder.join(name), &options).unwrap()
}

fn bytes(image: &Image, kind: Kind) -> Vec<u8> {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples.clone(),
        other => panic!("{kind}: {other:?}"),
    }
}

/// Indices and table of an indexed picture.
fn encoded(folder: &Path, name: &str) -> (Vec<u8>, Vec<[u8; 4]>) {
    let ask = Ask::Only(vec![Kind::Enc, Kind::Lut]);
    let options = ReadOptions { ask, ..ReadOptions::default() };
    let image = read_image(&folder.join(name), &options).unwrap();
    (bytes(&image, Kind::Enc), image.lut.as_ref().unwrap().entries().collect())
}

fn copy_of(folder: &Path, arguments: &str) -> (Vec<u8>, Vec<[u8; 4]>) {
    done(folder, &format!("{arguments} -o copy.png"));
    encoded(folder, "copy.png")
}

#[test]
fn an_idf_image_gets_indices_and_a_table() {
    let folder = folder();
    let before = open(folder.path(), "wine");
    let said = done(folder.path(), "wine");
    assert!(said.starts_with("wine: 256 colours, ") && said.contains(" dB (off by "), "{said}");
    let after = open(folder.path(), "wine");
    assert_eq!(after.planes()[..4], *before.planes());
    assert_eq!(after.kinds()[4..], [Kind::Enc, Kind::Lut]);
    assert!(folder.path().join("wine.enc").exists() && folder.path().join("wine.lut").exists());
    let line: Vec<&str> = after.properties.history[0].split('\t').collect();
    assert_eq!(line[1..4], ["iencode", env!("CARGO_PKG_VERSION"), "wine"]);
    assert!(line[4].starts_with("colors=256 rms="), "{line:?}");
    // Its own table is taken then, and stays.
    let table = fs::read(folder.path().join("wine.lut")).unwrap();
    done(folder.path(), "wine --dither floyd-steinberg --strength 1");
    assert_eq!(fs::read(folder.path().join("wine.lut")).unwrap(), table);
    assert_ne!(open(folder.path(), "wine").plane(Kind::Enc), after.plane(Kind::Enc));
    // Unless another is asked for.
    done(folder.path(), "wine -n 9");
    assert_eq!(open(folder.path(), "wine").lut.unwrap().colors().len(), 9);
}

#[test]
fn other_images_become_idf_beside_them() {
    let folder = folder();
    done(folder.path(), "label.png -q");
    let image = open(folder.path(), "label");
    assert_eq!(image.kinds(), [Kind::Enc, Kind::Lut]);
    assert_eq!(image.properties.history.len(), 1);
    // A second time they are put into it.
    done(folder.path(), "label.png -n 8");
    assert_eq!(open(folder.path(), "label").lut.unwrap().colors().len(), 8);
    assert_eq!(open(folder.path(), "label").properties.history.len(), 2);
}

#[test]
fn every_option_changes_the_copy() {
    let folder = folder();
    let plain = copy_of(folder.path(), "label.png");
    assert_eq!(plain.1.len(), 256);
    assert_eq!(copy_of(folder.path(), "label.png -n 16").1.len(), 16);
    assert_eq!(copy_of(folder.path(), "label.png --threads 1"), plain);
    let kept = copy_of(folder.path(), "label.png --keep #fff,#00112233 -n 16").1;
    assert_eq!((kept.len(), &kept[..2]), (16, &[[255; 4], [0, 0x11, 0x22, 0x33]][..]));
    let mut others = vec![plain];
    for options in [
        "--method heckbert",
        "--method fast",
        "--metric oklab",
        "--dither floyd-steinberg",
        "--dither floyd-steinberg --strength 0.3",
        "--dither blue-noise",
        "--dither blue-noise --strength 0.3",
    ] {
        let copy = copy_of(folder.path(), &format!("label.png {options}"));
        assert!(!others.contains(&copy), "{options}");
        others.push(copy);
    }
}

#[test]
fn coverage_is_kept_unless_there_is_a_matte() {
    let folder = folder();
    done(folder.path(), "wine -o kept.png");
    let kept = open(folder.path(), "kept.png");
    let expected = bytes(&open(folder.path(), "wine"), Kind::Cvg);
    for (found, expected) in bytes(&kept, Kind::Cvg).into_iter().zip(expected) {
        match expected {
            0 | 255 => assert_eq!(found, expected),
            _ => assert!(found.abs_diff(expected) < 12, "{found} for {expected}"),
        }
    }
    done(folder.path(), "wine -o flat.png --matte #0000ff");
    let flat = open(folder.path(), "flat.png");
    assert_eq!(flat.kinds(), COLOR);
    let corner = COLOR.map(|kind| bytes(&flat, kind)[0]);
    assert!(corner[0] < 6 && corner[1] < 6 && corner[2] > 249, "{corner:?}");
    // GIF has no half coverage.
    done(folder.path(), "wine -o kept.gif");
    let gif = bytes(&open(folder.path(), "kept.gif"), Kind::Cvg);
    assert_eq!([gif[0], gif[20], gif[40], gif[60]], [0, 0, 255, 255]);
}

#[test]
fn a_table_from_outside_is_used_exactly() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let colors = vec![[255, 255, 255], [0, 0, 0], [0, 0, 0], [200, 30, 9], [1, 255, 3]];
    let expected: Vec<[u8; 4]> = colors.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
    let lut = Lut::new(colors.clone()).unwrap();
    lut.write(&path("five.lut")).unwrap();
    // As an image: a row of pixels, and an IDF image in linear light.
    let plane = |(channel, kind)| {
        let samples = colors.iter().map(|color: &[u8; 3]| color[channel]).collect();
        Plane { kind, samples: Samples::U8(samples) }
    };
    let strip = Image::new(5, 1, COLOR.into_iter().enumerate().map(plane).collect()).unwrap();
    write_image(&path("strip.png"), &strip, &WriteOptions::default()).unwrap();
    let mut holder = Image::new(1, 1, Vec::new()).unwrap();
    holder.lut = Lut::new(vec![[255; 3], [0; 3], [128, 0, 0]]);
    holder.properties.transfer = Some(Transfer::Linear);
    write(&path("holder"), &holder, &WriteOptions::default()).unwrap();
    for dither in ["none", "floyd-steinberg", "blue-noise"] {
        let options = format!("label.png --lut five.lut --dither {dither}");
        let (indices, table) = copy_of(folder.path(), &options);
        assert_eq!(table, expected);
        // Of equal entries the first.
        assert!(indices.contains(&1) && !indices.contains(&2), "{dither}");
    }
    let strip = copy_of(folder.path(), "label.png --lut strip.png").1;
    assert_eq!(strip, [expected[0], expected[1], expected[3], expected[4]]);
    // 128 of 255 in linear light is 188 on a display.
    let linear = copy_of(folder.path(), "label.png --lut holder").1;
    assert_eq!(linear, [[255; 4], [0, 0, 0, 255], [188, 0, 0, 255]]);
    // A picture in a table's colours has them.
    copy_of(folder.path(), "label.png --lut five.lut");
    fs::rename(path("copy.png"), path("five.png")).unwrap();
    assert_eq!(copy_of(folder.path(), "label.png --lut five.png").1, expected);
}

#[test]
fn encoding_twice_changes_nothing() {
    let folder = folder();
    for options in ["", "--dither floyd-steinberg", "--dither blue-noise --metric oklab"] {
        for name in ["label.png", "wine"] {
            done(folder.path(), &format!("{name} {options} -o once.png"));
            let said = done(folder.path(), &format!("once.png {options} -o twice.png"));
            assert!(said.ends_with(" colours, unchanged\n"), "{said}");
            let [once, twice] = ["once.png", "twice.png"].map(|name| open(folder.path(), name));
            assert_eq!(once.planes(), twice.planes(), "{name} {options}");
        }
    }
}

#[test]
fn several_images_share_a_table() {
    let folder = folder();
    done(folder.path(), "wine label.png -n 32");
    let [wine, label] = ["wine", "label"].map(|name| open(folder.path(), name));
    assert_eq!(wine.lut, label.lut);
    assert_eq!(label.lut.unwrap().colors().len(), 32);
}

#[test]
fn several_images_make_an_animation() {
    let folder = folder();
    done(
        folder.path(),
        "label.png label.png wine -o moving.gif --matte #ffffff --delay 7 --loops 3",
    );
    let gif = fs::read(folder.path().join("moving.gif")).unwrap();
    let count = |part: &[u8]| gif.windows(part.len()).filter(|window| *window == part).count();
    // A graphic control extension with its delay for each picture (GIF89a, section 23).
    let delays = gif.windows(6).filter(|w| w[..3] == [0x21, 0xf9, 4] && w[4..] == [7, 0]).count();
    assert_eq!(delays, 3);
    // Shown three times is repeated twice.
    assert_eq!(count(b"NETSCAPE2.0\x03\x01\x02\x00"), 1);
    done(folder.path(), "label.png wine -o moving.gif");
    let gif = fs::read(folder.path().join("moving.gif")).unwrap();
    assert!(
        gif.windows(6).any(|w| w[..3] == [0x21, 0xf9, 4] && w[4..] == [10, 0]),
        "10 by default"
    );
}

#[test]
fn sixel_is_written_for_terminals() {
    let folder = folder();
    let piped = iencode(folder.path(), "label.png --sixel").stdout;
    let text = String::from_utf8(piped).unwrap();
    assert!(text.starts_with("\x1bP0;0;0q\"1;1;64;48#0;2;") && text.ends_with("\x1b\\"), "{text}");
    assert_eq!(text.matches('-').count(), 7);
    for arguments in ["label.png -o x.six", "label.png -o x.sixel", "label.png --sixel -o x.six"] {
        done(folder.path(), arguments);
        let name = arguments.rsplit(' ').next().unwrap();
        assert_eq!(fs::read_to_string(folder.path().join(name)).unwrap(), text);
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    let two = iencode(folder.path(), "label.png wine --sixel -o -").stdout;
    let two = String::from_utf8(two).unwrap();
    // The second keeps what is behind it where nothing is covered.
    assert_eq!((two.matches("\x1bP0;0;0q").count(), two.matches("\x1bP0;1;0q").count()), (1, 1));
}

#[test]
fn pipes_carry_png() {
    let folder = folder();
    let mut program = Command::new(env!("CARGO_BIN_EXE_iencode"))
        .args(["-", "-q", "-n", "4"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let png = fs::read(folder.path().join("label.png")).unwrap();
    program.stdin.take().unwrap().write_all(&png).unwrap();
    let output = program.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    fs::write(folder.path().join("piped.png"), output.stdout).unwrap();
    assert_eq!(encoded(folder.path(), "piped.png").1.len(), 4);
    assert!(iencode(folder.path(), "label.png -o -").stdout.starts_with(b"\x89PNG"));
}

#[test]
fn a_linear_image_gets_its_table_in_linear_light() {
    let folder = tempfile::tempdir().unwrap();
    let plane = Plane { kind: Kind::Grg, samples: Samples::U8(vec![128, 128]) };
    let mut grey = Image::new(2, 1, vec![plane]).unwrap();
    grey.properties.transfer = Some(Transfer::Linear);
    write(&folder.path().join("grey"), &grey, &WriteOptions::default()).unwrap();
    done(folder.path(), "grey");
    let lut = open(folder.path(), "grey").lut.unwrap();
    // 188 on a display is 128 or, by its rounding, 127 to 129 of 255 in linear light.
    assert_eq!(lut.colors().len(), 1);
    assert!(lut.colors()[0].iter().all(|&byte| byte.abs_diff(128) <= 1), "{lut:?}");
}

#[test]
fn it_says_as_much_as_it_is_told_to() {
    let folder = folder();
    assert_eq!(done(folder.path(), "label.png -o x.png -q"), "");
    let said = done(folder.path(), "label.png -o x.png -v");
    assert!(said.starts_with("read label.png: 64 x 48\nlabel.png: 256 colours, "), "{said}");
}

#[test]
fn files_are_raw_or_coded_and_followed_outside_when_told() {
    let folder = folder();
    for (options, word) in [("", "rle"), ("--rle", "rle"), ("--raw", "raw")] {
        done(folder.path(), &format!("label.png -n 2 -o x {options}"));
        let text = fs::read_to_string(folder.path().join("x.idf")).unwrap();
        assert!(text.contains(&format!("enc x.enc 64 48 8 {word}\n")), "{text}");
    }
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    fs::write(inner.join("x.idf"), "idf 1\nsize 64 48\ngrg ../wine.red 64 48 8 raw\n").unwrap();
    fs::write(folder.path().join("wine.red"), vec![7; 64 * 48]).unwrap();
    let (status, message) = failure(&inner, "x -o y");
    let expected = "iencode: error: x.idf: expected files in its own folder, found `../wine.red`; if \
                    you trust it, say --outside\n";
    assert_eq!((status, message.as_str()), (Some(1), expected));
    done(&inner, "x -o y --outside");
}

#[test]
fn failed_work_is_status_1_and_one_line() {
    let folder = folder();
    fs::write(folder.path().join("bad.lut"), [0; 7]).unwrap();
    let cases = [
        ("none", "cannot read `none.idf`: No such file or directory (os error 2)"),
        (
            "label.png -o no/x.png",
            "cannot write `no/x.png`: No such file or directory (os error 2)",
        ),
        ("label.png --lut bad.lut", "bad.lut: 7 bytes, expected three rows of 1 to 256 bytes"),
        (
            "label.png --lut label.png",
            "label.png: expected a table or at most 256 colours; ilut makes a table of a picture",
        ),
    ];
    for (arguments, message) in cases {
        let (status, found) = failure(folder.path(), arguments);
        assert_eq!(found.lines().last(), Some(format!("iencode: error: {message}").as_str()));
        assert_eq!(status, Some(1), "{arguments}");
    }
    assert!(!folder.path().join("label.idf").exists());
}

#[test]
fn a_wrong_command_line_is_status_2() {
    let folder = folder();
    let cases = [
        ("", "<IMAGE>"),
        ("wine --fast", "unexpected argument '--fast'"),
        ("wine -n 0", "expected a whole number from 1 to 256"),
        ("wine -n 257", "expected a whole number from 1 to 256"),
        ("wine -n -1", "'-1' for '--colors <COLOURS>': expected a whole number from 1 to 256"),
        ("wine -n 1 --keep #fff,#000", "2 colours to keep, expected at most the 1 of the table"),
        ("wine --keep #12", "expected #rgb, #rgba, #rrggbb or #rrggbbaa, found `#12`"),
        ("wine --dither blue-noise --strength -0.1", "'-0.1' for '--strength <SHARE>': expected"),
        ("none -o x.jpg", "cannot write `x.jpg`: found .jpg, expected a name that ends in .idf"),
        ("none.png -o x.lut", "ending for IDF; ilut writes .lut"),
        ("wine --delay -4", "expected a whole number from 0 to 65535"),
        ("wine --dither atkinson", "[possible values: none, floyd-steinberg, blue-noise]"),
        ("wine --metric lab", "[possible values: rgb, oklab]"),
        ("wine --method wu", "[possible values: heckbert, fast, best]"),
        ("wine --dither blue-noise --strength 1.5", "expected a number from 0 to 1"),
        ("wine --strength 0.5", "--strength belongs to a --dither"),
        ("wine --lut x -n 5", "cannot be used with"),
        ("wine --lut x --method fast", "cannot be used with"),
        ("wine --lut x --keep #fff", "cannot be used with"),
        ("wine --matte red", "expected #rgb, #rrggbb or three numbers from 0 to 1, found `red`"),
        (
            "wine label.png -o x.png",
            "several images make one file only as an animation, -o OUT.gif",
        ),
        (
            "wine label.png -o x.six",
            "several images make one file only as an animation, -o OUT.gif",
        ),
        ("wine wine.png", "two of the images would become one"),
        ("wine --delay 5", "--delay and --loops belong to several images with -o OUT.gif"),
        ("wine -o x.gif --loops 5", "--delay and --loops belong to several images with -o OUT.gif"),
        ("wine --raw --rle", "cannot be used with"),
        ("wine -q -v", "cannot be used with"),
        ("wine --threads 0", "--threads"),
    ];
    for (arguments, message) in cases {
        let (status, found) = failure(folder.path(), arguments);
        assert!(found.starts_with("iencode: error: ") && found.contains(message), "{found}");
        assert_eq!(status, Some(2), "{arguments}");
    }
}

#[test]
fn help_version_and_packaging_are_status_0() {
    let folder = folder();
    for (arguments, part) in [
        ("--help", "Example:\n  iencode photo.png"),
        ("--version", concat!("iencode ", env!("CARGO_PKG_VERSION"), "\n")),
        ("--man", ".TH iencode 1"),
        ("--completions bash", "_iencode()"),
    ] {
        let output = iencode(folder.path(), arguments);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(part), "{arguments}: {text}");
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments}");
    }
}

#[test]
fn an_image_is_as_before_where_it_cannot_be_written() {
    let folder = folder();
    let text = fs::read(folder.path().join("wine.idf")).unwrap();
    fs::create_dir(folder.path().join("wine.enc")).unwrap();
    assert_eq!(failure(folder.path(), "wine").0, Some(1));
    assert_eq!(fs::read(folder.path().join("wine.idf")).unwrap(), text);
    assert!(read(&folder.path().join("wine"), &ReadOptions::default()).is_ok());
}

#[test]
fn the_table_of_an_image_of_indices_is_not_replaced() {
    let folder = folder();
    done(folder.path(), "label.png -q -n 8 -o indexed");
    let before = open(folder.path(), "indexed");
    for options in ["-n 2", "--method fast", "--lut label.lut"] {
        fs::write(folder.path().join("label.lut"), [0; 6]).unwrap();
        let (status, said) = failure(folder.path(), &format!("indexed {options}"));
        let message =
            "indexed: its colours are in its table alone, which stays; give a name with -o";
        assert!(said.contains(message) && status == Some(1), "{options}: {said}");
        assert_eq!(open(folder.path(), "indexed"), before);
    }
    done(folder.path(), "indexed -q -n 2 -o two");
    assert_eq!(open(folder.path(), "two").lut.unwrap().entries().count(), 2);
    done(folder.path(), "indexed -q");
    let again = open(folder.path(), "indexed");
    assert_eq!(bytes(&again, Kind::Enc), bytes(&before, Kind::Enc));
}

#[test]
fn it_is_said_where_coverage_is_lost() {
    let folder = folder();
    let expected =
        "wine: pixels covered in part, 1536 of them, become covered or not; --matte puts";
    for output in ["x.gif", "x.six"] {
        let said = done(folder.path(), &format!("wine -o {output}"));
        assert!(said.contains(expected), "{said}");
        let said = done(folder.path(), &format!("wine --matte #ffffff -o {output}"));
        assert!(!said.contains("covered"), "{said}");
    }
    assert!(!done(folder.path(), "wine -o x.png").contains("covered"));
}

/// A damaged image is named, whatever is wrong with it.
#[test]
fn an_index_beyond_the_table_names_its_image() {
    let folder = folder();
    done(folder.path(), "label.png -q -n 8 -o indexed");
    fs::write(folder.path().join("indexed.lut"), [0; 6]).unwrap();
    let description = fs::read_to_string(folder.path().join("indexed.idf")).unwrap();
    let description = description.replace("indexed.lut 8 3", "indexed.lut 2 3");
    fs::write(folder.path().join("indexed.idf"), description).unwrap();
    let (status, said) = failure(folder.path(), "indexed -o x.png");
    assert!(said.contains("indexed: index ") && status == Some(1), "{said}");
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
        [("large -q -n 4 -o x", 300_000), ("large -q -n 4 -o x.png", 400_000)]
    {
        let line =
            format!("ulimit -c 0; ulimit -v {kilobytes}; exec \"$0\" {arguments} --threads 2");
        let output = Command::new("bash")
            .args(["-c", &line, env!("CARGO_BIN_EXE_iencode")])
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
