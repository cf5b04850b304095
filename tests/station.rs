//! The pipeline of `scenes/station`, from its textures to the indices of its picture, at a small size.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Ask, Image, Kind, Lut, Matte, Plane, ReadOptions, Samples, WriteOptions};

use crate::shell::Shell;
use crate::support::{display, files, linear, root};

fn read(shell: &Shell, name: &str) -> Image {
    let options = ReadOptions { ask: Ask::All, history: true, ..ReadOptions::default() };
    read_image(&shell.file(name), &options).unwrap()
}

fn bytes(image: &Image, kind: Kind) -> &[u8] {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples,
        other => panic!("{kind}: {other:?}"),
    }
}

/// Red, green and blue of each pixel.
fn colors(image: &Image) -> Vec<[u8; 3]> {
    let [red, grn, blu] = COLOR.map(|kind| bytes(image, kind));
    (0..red.len()).map(|at| [red[at], grn[at], blu[at]]).collect()
}

/// All that is below a folder, but logs, whose lines hold times.
fn without_logs(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let named =
        files(folder).into_iter().map(|(path, bytes)| (path.to_str().unwrap().to_owned(), bytes));
    named.filter(|(name, _)| Path::new(name).extension().is_none_or(|e| e != "log")).collect()
}

/// Programs of the log, in order.
fn programs(image: &Image) -> Vec<&str> {
    image.properties.history.iter().map(|line| line.split('\t').nth(1).unwrap()).collect()
}

#[test]
fn the_compiled_scene_has_nine_functions_and_seven_files() {
    let compiled = compile::compile_path(&root().join("scenes/station/station.sdl"));
    assert_eq!(compiled.report(), "");
    let mut text = Vec::new();
    scene::format::write(&compiled.scene.unwrap(), &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let (mut functions, mut pictures) = (BTreeSet::new(), BTreeSet::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["image", _, name] => {
                pictures.insert(name.rsplit('/').next().unwrap().trim_matches('"').to_owned());
            }
            ["paint", function, ..] => {
                functions.insert(function);
            }
            _ => {}
        }
        if let Some(at) =
            words.iter().position(|word| *word == "of").filter(|_| words[0] == "paint")
        {
            functions.insert(words[at + 1]);
        }
    }
    let expected = "bump decal gradient grid image noise projection rings stripes";
    assert_eq!(functions.into_iter().collect::<Vec<_>>().join(" "), expected);
    let expected = "chart.png clouds.png earth.png planet.png plates.png screen.png sign.png";
    assert_eq!(pictures.into_iter().collect::<Vec<_>>().join(" "), expected);
    assert!(text.contains(" fake"), "the hologram is one that light goes straight through");
}

#[test]
fn each_step_of_the_pipeline_does_what_it_says() {
    let shell = Shell::new();
    let said = shell.run("scenes/station/make.sh -s 96x64 -n 4 out");
    assert!(said.starts_with("station.png: ") && said.contains(" rays, "), "{said}");
    let first = without_logs(&shell.file("out"));
    shell.run("scenes/station/make.sh -s 96x64 -n 4 out");
    let again = without_logs(&shell.file("out"));
    for (name, bytes) in &first {
        assert!(again.get(name) == Some(bytes), "{name} has the same bytes again");
    }
    assert_eq!(first.len(), again.len(), "and no file more");

    let (deck, stars, station) =
        (read(&shell, "out/deck"), read(&shell, "out/stars"), read(&shell, "out/station"));
    composited(&deck, &stars, &station);
    assert_eq!(programs(&deck), ["portray"]);
    assert_eq!(programs(&stars), ["istars"]);
    assert_eq!(programs(&station), ["portray", "istars", "icomp", "ilut", "iencode"]);
    encoded(&shell, &station);
    let six = &first["station.six"];
    assert!(
        six.starts_with(b"\x1bP") && six.ends_with(b"\x1b\\"),
        "a sixel from its start to its end"
    );
    assert!(String::from_utf8_lossy(six).contains("\"1;1;96;64"), "of this size");
}

/// Stars show exactly where the deck leaves room for them.
fn composited(deck: &Image, stars: &Image, station: &Image) {
    assert_eq!([deck, stars, station].map(Image::size), [[96, 64]; 3], "of one size");
    assert!(
        stars.plane(Kind::Cvg).is_none() && station.plane(Kind::Cvg).is_none(),
        "whole pictures"
    );
    assert_eq!(deck.properties.matte, Matte::Premultiplied, "as renders are");
    let coverage = bytes(deck, Kind::Cvg);
    let (deck, stars, station) = (colors(deck), colors(stars), colors(station));
    let (mut open, mut opaque, mut edges, mut lit) = (0, 0, 0, 0);
    for (at, &covered) in coverage.iter().enumerate() {
        match covered {
            255 => {
                opaque += 1;
                assert_eq!(station[at], deck[at], "opaque pixel {at} is as it was");
            }
            0 => {
                open += 1;
                assert_eq!(deck[at], [0; 3], "nothing is in open pixel {at}");
                assert_eq!(station[at], stars[at], "stars alone are in open pixel {at}");
                lit += usize::from(stars[at].iter().any(|&byte| byte > 60));
            }
            _ => {
                edges += 1;
                let room = 1.0 - f64::from(covered) / 255.0;
                for c in 0..3 {
                    let light = linear(deck[at][c]) + room * linear(stars[at][c]);
                    let off = f64::from(station[at][c]) - display(light.min(1.0));
                    // Half a step of rounding, and what 32-bit light adds.
                    assert!(off.abs() < 0.51, "edge pixel {at}: {:?}, off by {off}", station[at]);
                }
            }
        }
    }
    assert!(
        open > 150 && opaque > 4000 && edges > 40,
        "{open} open, {opaque} opaque, {edges} edges"
    );
    assert!(lit > 3, "{lit} stars in the windows");
}

/// The table and its indices are near the picture, and the PNG has them.
fn encoded(shell: &Shell, station: &Image) {
    let lut = Lut::read(&shell.file("out/station.lut")).unwrap();
    let entries = lut.colors();
    assert_eq!(entries.len(), 256, "all that there may be");
    let indices = bytes(station, Kind::Enc);
    let colors = colors(station);
    let (mut squares, mut worst) = (0.0, 0.0_f64);
    for (color, &index) in colors.iter().zip(indices) {
        for c in 0..3 {
            let off = f64::from(color[c]) - f64::from(entries[usize::from(index)][c]);
            squares += off * off;
            worst = worst.max(off.abs());
        }
    }
    let rms = libm::sqrt(squares / (3 * colors.len()) as f64);
    // 256 entries for 6144 pixels; dithering makes single pixels worse, and the whole better.
    assert!(rms < 6.0 && worst < 90.0, "root mean square {rms}, worst {worst}");
    let png = fs::read(shell.file("out/station.png")).unwrap();
    assert_eq!(png[25], 3, "the PNG is indexed");
    let shown = self::colors(&read(shell, "out/station.png"));
    let meant: Vec<_> = indices.iter().map(|&index| entries[usize::from(index)]).collect();
    assert!(shown == meant, "with the same indices");
}

/// Writes a picture of one's own: checks in two colours.
fn own(shell: &Shell, name: &str, [columns, rows]: [u32; 2], pair: [[u8; 3]; 2]) {
    let color = |i: u32| pair[((i % columns / 8 + i / columns / 8) % 2) as usize];
    let plane = |(c, kind): (usize, Kind)| Plane {
        kind,
        samples: Samples::U8((0..columns * rows).map(|i| color(i)[c]).collect()),
    };
    let planes = COLOR.into_iter().enumerate().map(plane).collect();
    let image = Image::new(columns, rows, planes).unwrap();
    write_image(&shell.file(name), &image, &WriteOptions::default()).unwrap();
}

#[test]
fn pictures_of_ones_own_take_their_places() {
    let shell = Shell::new();
    fs::create_dir(shell.file("my pictures")).unwrap();
    own(&shell, "my pictures/planet.png", [64, 32], [[250, 40, 30], [40, 250, 30]]);
    own(&shell, "my pictures/screen.png", [32, 16], [[255, 255, 255], [0, 0, 255]]);
    own(&shell, "my pictures/stars.png", [100, 80], [[0, 0, 0], [255, 0, 255]]);
    shell.run("scenes/station/make.sh -s 72x48 -n 1 plain");
    shell.run("scenes/station/make.sh -s 72x48 -n 1 -p 'my pictures' 'with mine'");
    let [plain, mine] = ["plain", "with mine"].map(|name| without_logs(&shell.file(name)));
    for (name, bytes) in plain.iter().filter(|(name, _)| name.starts_with("textures/")) {
        let is_own = ["textures/planet.png", "textures/screen.png"].contains(&name.as_str());
        assert_eq!(mine[name] != *bytes, is_own, "{name}");
    }
    let screen = colors(&read(&shell, "with mine/textures/screen.png"));
    assert_eq!(screen, colors(&read(&shell, "my pictures/screen.png")), "as it was");
    let deck = read(&shell, "with mine/deck");
    // Green ground behind the windows: the suite's own planet has none.
    let green =
        |[red, grn, blu]: &[u8; 3]| *grn > red.saturating_add(60) && *grn > blu.saturating_add(30);
    let count = |image: &Image| colors(image).iter().filter(|pixel| green(pixel)).count();
    let counts = [count(&read(&shell, "plain/deck")), count(&deck)];
    assert!(counts[0] == 0 && counts[1] > 10, "{counts:?}");
    let station = colors(&read(&shell, "with mine/station"));
    let open = bytes(&deck, Kind::Cvg).iter().zip(&station).filter(|(covered, _)| **covered == 0);
    let sky: Vec<_> = open.map(|(_, color)| *color).collect();
    assert!(sky.contains(&[0, 0, 0]) && sky.contains(&[255, 0, 255]), "the sky is one's own");
}

#[test]
fn the_scripts_say_what_they_expect() {
    let shell = Shell::new();
    for (line, reason) in [
        ("make.sh -s 96", "-s 96: expected a size as 960x640"),
        ("make.sh -s 0x4", "-s 0x4: expected a size"),
        ("make.sh a b", "expected one folder, found 2; see -h"),
        ("make.sh -p nowhere a", "no folder nowhere"),
        ("textures.sh -w 10", "-w 10: expected a number from 64 to 4096"),
        ("textures.sh -w many", "-w many: expected a number"),
    ] {
        let output = shell.output(&format!("scenes/station/{line}"));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(said.contains(reason), "{line}: {said}");
    }
    for script in ["make.sh", "textures.sh"] {
        let help = shell.run(&format!("scenes/station/{script} -h"));
        assert!(help.contains("-p FOLDER") && !help.contains("set -e"), "{help}");
    }
}
