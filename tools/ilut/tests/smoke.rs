//! The real program: good and bad invocations.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use idf::exchange::write_image;
use idf::plane::COLOR;
use idf::{
    Ask, Image, Kind, Lut, Matte, Plane, ReadOptions, Samples, Transfer, WriteOptions, read, write,
};

/// 4 x 2: four colours, and where `covered`, half of them at half coverage.
fn image(covered: bool) -> Image {
    let plane = |kind, samples: [u8; 8]| Plane { kind, samples: Samples::U8(samples.into()) };
    let mut planes: Vec<Plane> = COLOR
        .into_iter()
        .zip([[10, 20, 30, 40], [0, 99, 99, 0], [200, 0, 7, 1]])
        .map(|(kind, [a, b, c, d])| plane(kind, [a, b, c, d, a, b, c, d]))
        .collect();
    if covered {
        planes.push(plane(Kind::Cvg, [255, 255, 255, 255, 128, 128, 0, 255]));
    }
    let mut image = Image::new(4, 2, planes).unwrap();
    image.properties.matte = Matte::Straight;
    image.properties.background = Some([1.0; 3]);
    image
}

/// A folder with `wine` (covered) and `photo.png`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("wine"), &image(true), &WriteOptions::default()).unwrap();
    let path = folder.path().join("photo.png");
    write_image(&path, &image(false), &WriteOptions::default()).unwrap();
    folder
}

fn ilut(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    let program = env!("CARGO_BIN_EXE_ilut");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// Standard error of a run that succeeds and prints nothing.
fn success(folder: &Path, arguments: &str) -> String {
    let output = ilut(folder, arguments);
    assert!(output.status.success() && output.stdout.is_empty(), "{arguments}: {output:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn failure(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = ilut(folder, arguments);
    assert!(output.stdout.is_empty(), "{arguments}: {output:?}");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Colours of the bare table that `ilut photo.png -o x.lut` and `options` write.
fn colors(options: &str) -> Vec<[u8; 3]> {
    let folder = folder();
    let said = success(folder.path(), &format!("photo.png -q -o x.lut {options}"));
    assert!(said.is_empty(), "{options}: {said}");
    Lut::read(&folder.path().join("x.lut")).unwrap().colors().to_vec()
}

#[test]
fn an_idf_image_gets_a_channel_and_keeps_all_else() {
    let folder = folder();
    let said = success(folder.path(), "wine");
    assert!(said.starts_with("wine: 7 colours, unchanged\n"), "{said}");
    let options = ReadOptions { history: true, ..ReadOptions::default() };
    let wine = read(&folder.path().join("wine"), &options).unwrap();
    assert_eq!(wine.planes(), image(true).planes());
    let entries: Vec<[u8; 4]> = wine.lut.unwrap().entries().collect();
    assert_eq!(entries[..3], [[0, 0, 0, 0], [10, 0, 200, 128], [20, 99, 0, 128]]);
    assert_eq!(entries.len(), 7);
    let fields: Vec<&str> = wine.properties.history[0].split('\t').collect();
    assert_eq!(fields[1..4], ["ilut", env!("CARGO_PKG_VERSION"), "wine"]);
    assert!(fields[4].starts_with("colors=7 rms=0.000 "), "{fields:?}");
}

#[test]
fn the_table_is_stored_as_the_image_stores_its_light() {
    let folder = folder();
    let mut linear = image(false);
    linear.properties.transfer = Some(Transfer::Linear);
    write(&folder.path().join("linear"), &linear, &WriteOptions::default()).unwrap();
    success(folder.path(), "linear -q");
    let options = ReadOptions { ask: Ask::Only(vec![Kind::Lut]), ..ReadOptions::default() };
    let lut = read(&folder.path().join("linear"), &options).unwrap().lut.unwrap();
    // Dark linear bytes are far apart as display values, so they come back.
    let mut reds: Vec<u8> = lut.colors().iter().map(|color| color[0]).collect();
    reds.sort_unstable();
    assert_eq!(reds, [10, 20, 30, 40]);
}

#[test]
fn a_photograph_gets_a_bare_table_beside_it() {
    let folder = folder();
    success(folder.path(), "photo.png");
    let rows = fs::read(folder.path().join("photo.lut")).unwrap();
    assert_eq!(rows, [10, 20, 30, 40, 0, 99, 99, 0, 200, 0, 7, 1]);
    // A bare table is opaque, so the image goes over its background, or over the matte.
    success(folder.path(), "wine -o wine.lut");
    let table = Lut::read(&folder.path().join("wine.lut")).unwrap();
    assert!(table.colors().contains(&[255, 255, 255]), "{table:?}");
    success(folder.path(), "wine -o wine.lut --matte #00ff00");
    let table = Lut::read(&folder.path().join("wine.lut")).unwrap();
    assert!(table.colors().contains(&[0, 255, 0]), "{table:?}");
}

#[test]
fn a_table_can_be_a_picture() {
    let folder = folder();
    for ending in ["png", "gif"] {
        success(folder.path(), &format!("wine -o table.{ending}"));
        let path = folder.path().join(format!("table.{ending}"));
        let ask = Ask::Only(vec![Kind::Enc, Kind::Lut]);
        let options = ReadOptions { ask, ..ReadOptions::default() };
        let picture = idf::exchange::read_image(&path, &options).unwrap();
        assert_eq!(picture.plane(Kind::Enc), Some(&Samples::U8((0..7).collect())));
        assert!(picture.lut.is_some(), "{ending}");
    }
    let output = ilut(folder.path(), "wine -q -o -");
    assert!(output.status.success() && output.stdout.starts_with(b"\x89PNG"), "{output:?}");
}

#[test]
fn every_option_changes_the_table_or_what_is_said() {
    assert_eq!(colors(""), [[10, 0, 200], [20, 99, 0], [30, 99, 7], [40, 0, 1]]);
    assert_eq!(colors("-n 3").len(), 3);
    assert_eq!(colors("--colors 2").len(), 2);
    assert_eq!(colors("--keep #ffffff,#00000080 -n 6")[..2], [[255, 255, 255], [0, 0, 0]]);
    assert_eq!(colors("--keep #f0c,#1238 -n 6")[..2], [[255, 0, 204], [0x11, 0x22, 0x33]]);
    assert_ne!(colors("-n 2 --spread"), colors("-n 2"));
    // Cell centres of 5 bits: (25, 99, 3.5) of two pixels.
    assert!(colors("-n 3 --method heckbert").contains(&[24, 100, 4]), "heckbert");
    assert!(colors("-n 3 --method fast").contains(&[25, 99, 4]), "fast");
    assert_ne!(colors("-n 2 --metric oklab"), colors("-n 2"));
    assert_eq!(colors("--max-error 3").len(), 3);
    assert_eq!(colors("--threads 1"), colors("--threads 2"));
    let folder = folder();
    let loud = success(folder.path(), "photo.png -v");
    assert!(loud.contains("read photo.png: 4 x 2") && loud.contains("write photo.lut"), "{loud}");
    assert_eq!(success(folder.path(), "photo.png wine --quiet"), "");
    assert!(folder.path().join("wine.lut").exists() && folder.path().join("photo.lut").exists());
    success(folder.path(), "photo.png -o flat --raw");
    success(folder.path(), "photo.png -o coded --rle");
    for name in ["flat", "coded"] {
        let picture = read(&folder.path().join(name), &ReadOptions::default()).unwrap();
        assert_eq!(picture.size(), [4, 1]);
    }
    fs::create_dir(folder.path().join("sub")).unwrap();
    let text = fs::read_to_string(folder.path().join("wine.idf")).unwrap();
    fs::write(folder.path().join("sub/wine.idf"), text.replace(" wine.", " ../wine.")).unwrap();
    assert_eq!(failure(folder.path(), "sub/wine -o x.png").0, Some(1));
    success(folder.path(), "sub/wine -o x.png --outside");
}

#[test]
fn several_images_get_one_table() {
    let folder = folder();
    let said = success(folder.path(), "wine photo.png -o both.lut -n 3");
    assert_eq!(said.lines().count(), 2, "{said}");
    assert_eq!(Lut::read(&folder.path().join("both.lut")).unwrap().colors().len(), 3);
    assert!(!folder.path().join("photo.lut").exists());
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let folder = folder();
    let before = fs::read_to_string(folder.path().join("wine.idf")).unwrap();
    for (arguments, status, message) in [
        ("absent", 1, "ilut: error: cannot read `absent.idf`"),
        ("wine --max-error 0.01 -n 2", 1, "2 colours leave an error of "),
        ("wine -n 1 --keep #000000,#ffffff", 2, "2 colours to keep, expected at most the 1"),
        ("- -q", 2, "standard input has no name for a table; give one with -o"),
        ("wine -n 0", 2, "expected a whole number from 1 to 256"),
        ("wine -n -3", 2, "'-3' for '--colors <COLOURS>': expected a whole number from 1 to 256"),
        ("wine --keep red", 2, "expected #rgb, #rgba, #rrggbb or #rrggbbaa, found `red`"),
        ("wine --keep #12345", 2, "expected #rgb, #rgba, #rrggbb or #rrggbbaa, found `#12345`"),
        ("wine --max-error=-1", 2, "expected a number of 0 or more"),
        ("wine --max-error -1", 2, "expected a number of 0 or more"),
        ("wine --method octree", 2, "octree"),
        ("", 2, "IMAGE"),
        ("photo.png -o x.jpg", 2, "cannot write `x.jpg`: found .jpg, expected a name that ends in"),
        ("absent.png -o x.tga", 2, "; as an IDF image: x.tga.idf"),
    ] {
        let (code, said) = failure(folder.path(), arguments);
        assert_eq!(code, Some(status), "{arguments}: {said}");
        assert!(said.contains(message), "{arguments}: {said}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("wine.idf")).unwrap(), before);
    assert!(!folder.path().join("photo.lut").exists());
}

#[test]
fn the_table_of_an_image_of_indices_is_not_replaced() {
    let folder = folder();
    let indices = Plane { kind: Kind::Enc, samples: Samples::U8(vec![3, 2, 1, 0]) };
    let mut image = Image::new(4, 1, vec![indices]).unwrap();
    image.lut = Lut::new([[1, 2, 3], [99, 0, 9], [50, 50, 50], [255, 0, 7]].into());
    write(&folder.path().join("indexed"), &image, &WriteOptions::default()).unwrap();
    let (code, said) = failure(folder.path(), "indexed -n 2");
    let expected = "ilut: error: indexed: its colours are in its table alone, which stays; give a \
                    name with -o\n";
    assert_eq!((code, said.as_str()), (Some(1), expected));
    let kept = read(&folder.path().join("indexed"), &ReadOptions::default()).unwrap();
    assert_eq!(kept.lut, image.lut);
    ilut(folder.path(), "indexed -n 2 -o two.lut");
    assert_eq!(fs::read(folder.path().join("two.lut")).unwrap().len(), 6);
}

#[test]
fn indices_of_another_table_go() {
    let folder = folder();
    let path = folder.path().join("wine");
    let mut indexed = image(true);
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(vec![8; 8]) };
    let planes = [indexed.planes(), &[plane]].concat();
    indexed = indexed.with_planes(4, 2, planes).unwrap();
    indexed.lut = Lut::new(vec![[1; 3]; 9]);
    write(&path, &indexed, &WriteOptions::default()).unwrap();
    let said = success(folder.path(), "wine -q -n 2 -o other.lut");
    assert!(said.is_empty() && path.with_extension("enc").exists(), "{said}");
    let said = success(folder.path(), "wine -n 2");
    assert!(said.contains("warning: wine: its channel `enc` is gone"), "{said}");
    assert!(!path.with_extension("enc").exists());
    let wine = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(wine.planes(), image(true).planes());
    assert_eq!(wine.lut.unwrap().colors().len(), 2);
}

#[test]
fn heckbert_has_no_spread() {
    let folder = folder();
    let (status, said) = failure(folder.path(), "photo.png --spread --method heckbert");
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("--spread is for --method fast and best"), "{said}");
    assert!(!folder.path().join("photo.lut").exists());
}
