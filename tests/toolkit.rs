//! Scripts and commands of the toolkit, as written, with the programs of the suite.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::BTreeMap;
use std::fs;

use idf::exchange::{read_image, write_image};
use idf::plane::COLOR;
use idf::{Ask, Image, Kind, Plane, ReadOptions, Samples, WriteOptions};

use crate::shell::{Shell, commands};
use crate::support::{display, linear, root};

const SCRIPTS: &[&str] =
    &["prepare-texture", "palette-for-frames", "matte-over", "e-paper", "for-terminal"];

/// Writes an 8-bit picture, the colour of each pixel by its place.
fn paint(
    shell: &Shell,
    name: &str,
    [columns, rows]: [u32; 2],
    color: impl Fn(u32, u32) -> [u8; 3],
) {
    let place = |i: u32| (i % columns, i / columns);
    let channel =
        |c: usize| (0..columns * rows).map(|i| color(place(i).0, place(i).1)[c]).collect();
    let plane = |(c, kind): (usize, Kind)| Plane { kind, samples: Samples::U8(channel(c)) };
    let planes = COLOR.into_iter().enumerate().map(plane).collect();
    let image = Image::new(columns, rows, planes).unwrap();
    write_image(&shell.file(name), &image, &WriteOptions::default()).unwrap();
}

fn read(shell: &Shell, name: &str, ask: Ask) -> Image {
    let options = ReadOptions { ask, history: true, ..ReadOptions::default() };
    read_image(&shell.file(name), &options).unwrap()
}

fn bytes(image: &Image, kind: Kind) -> Vec<u8> {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples.clone(),
        other => panic!("{kind}: {other:?}"),
    }
}

/// Programs of the log, in order.
fn programs(image: &Image) -> Vec<String> {
    let known = ["icopy", "ieq", "icomp", "iencode", "ilut"];
    let program = |line: &String| {
        let mut words = line.split_whitespace();
        words.find(|word| known.contains(word)).unwrap_or("?").to_owned()
    };
    image.properties.history.iter().map(program).collect()
}

/// All files in the folder but logs, whose lines hold times.
fn files(shell: &Shell) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(shell.folder()).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.is_file() && path.extension() != Some("log".as_ref()));
    let named = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read(&path).unwrap())
    };
    files.map(named).collect()
}

/// Runs a line twice: the same bytes come out.
fn run_twice(shell: &Shell, line: &str) {
    shell.run(line);
    let first = files(shell);
    shell.run(line);
    assert!(first == files(shell), "{line} gives the same bytes again");
}

/// A slope of tones with a coarse pattern on it: nothing of it meets across the edges.
fn slope(x: u32, y: u32) -> [u8; 3] {
    let pattern = if (x / 4 + y / 4).is_multiple_of(2) { 20 } else { 0 };
    [30 + 3 * x + pattern, 40 + 4 * y, 200 - 2 * x].map(|value| u8::try_from(value).unwrap())
}

#[test]
fn a_texture_meets_at_its_edges_and_has_all_levels() {
    let shell = Shell::new();
    let size @ [columns, rows] = [64, 48];
    paint(&shell, "my wall.png", size, slope);
    run_twice(&shell, "scripts/prepare-texture.sh 'my wall.png' 'the wall'");
    let sizes = [[64, 48], [32, 24], [16, 12], [8, 6], [4, 3], [2, 1], [1, 1]];
    for (level, size) in sizes.into_iter().enumerate() {
        let name = if level == 0 { "the wall.idf".into() } else { format!("the wall.{level}.idf") };
        assert_eq!(read(&shell, &name, Ask::All).size(), size, "{name}");
    }
    assert!(!shell.file("the wall.7.idf").exists(), "no level beyond one pixel");
    let texture = read(&shell, "the wall", Ask::All);
    assert_eq!(programs(&texture), ["ieq", "icopy"]);
    let [red, grn, blu] = COLOR.map(|kind| bytes(&texture, kind));
    let across = |samples: &[u8], x: [u32; 2]| -> f64 {
        let at = |x: u32, y: u32| f64::from(samples[(y * columns + x) as usize]);
        (0..rows).map(|y| (at(x[0], y) - at(x[1], y)).abs()).sum::<f64>() / f64::from(rows)
    };
    let inside = (1..columns).map(|x| across(&red, [x - 1, x])).fold(0.0, f64::max);
    let seam = across(&red, [columns - 1, 0]);
    assert!(seam <= inside, "a step of {seam} over the edge, {inside} inside");
    let before = read(&shell, "my wall.png", Ask::Picture);
    let before = across(&bytes(&before, Kind::Red), [columns - 1, 0]);
    assert!(seam * 4.0 < before, "a step of {seam} over the edge, {before} in the picture");
    let grey = bytes(&texture, Kind::Grg);
    for i in 0..grey.len() {
        let light = [(red[i], 0.2126), (grn[i], 0.7152), (blu[i], 0.0722)];
        let luminance: f64 = light.iter().map(|&(byte, share)| linear(byte) * share).sum();
        let off = (f64::from(grey[i]) - display(luminance)).abs();
        // Colour and grey are each blended and rounded by themselves.
        assert!(off < 3.0, "pixel {i} is off by {off}");
    }
}

/// Frames of a GIF with the time of each, and how many have a table of their own.
fn gif_frames(file: &[u8]) -> (Vec<u16>, usize) {
    let table = |flags: u8| if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) };
    let mut at = 13 + table(file[10]);
    let (mut times, mut own, mut time) = (Vec::new(), 0, 0);
    let blocks = |mut at: usize| {
        while file[at] != 0 {
            at += 1 + usize::from(file[at]);
        }
        at + 1
    };
    loop {
        match file[at] {
            0x21 => {
                if file[at + 1] == 0xf9 {
                    time = u16::from_le_bytes([file[at + 4], file[at + 5]]);
                }
                at = blocks(at + 2);
            }
            0x2c => {
                times.push(time);
                own += usize::from(file[at + 9] & 0x80 != 0);
                at = blocks(at + 10 + table(file[at + 9]) + 1);
            }
            0x3b => return (times, own),
            other => panic!("block {other:#x} at {at}"),
        }
    }
}

#[test]
fn frames_share_a_table_of_all_their_colors() {
    let shell = Shell::new();
    let color = |x: u32, y: u32, frame: u8| match (x + y) % 4 {
        0 => [200, 30, 30],
        1 => [20, 40, 60 * frame],
        _ => [250, 250, 245],
    };
    for frame in 0..4 {
        paint(&shell, &format!("f {frame}.png"), [16, 9], |x, y| color(x, y, frame));
    }
    run_twice(&shell, "scripts/palette-for-frames.sh -d 7 film.gif f\\ ?.png");
    assert_eq!(gif_frames(&fs::read(shell.file("film.gif")).unwrap()), (vec![7; 4], 0));
    let table = read(&shell, "film-table.png", Ask::Only(vec![Kind::Enc, Kind::Lut]));
    let mut colors: Vec<[u8; 4]> = table.lut.as_ref().unwrap().entries().collect();
    colors.sort_unstable();
    let mut expected = vec![[200, 30, 30, 255], [250, 250, 245, 255]];
    expected.extend((0..4).map(|frame| [20, 40, 60 * frame, 255]));
    expected.sort_unstable();
    assert_eq!(colors, expected, "six colours in all frames, none lost");
    let (first, frame) =
        (read(&shell, "film.gif", Ask::Picture), read(&shell, "f 0.png", Ask::Picture));
    for kind in COLOR {
        assert_eq!(bytes(&first, kind), bytes(&frame, kind), "{kind}");
    }
}

#[test]
fn soft_edges_mix_light_and_have_no_fringe() {
    let shell = Shell::new();
    let step = |x: u32| u8::try_from(x * 17).unwrap();
    paint(&shell, "white.png", [16, 2], |_, _| [255; 3]);
    paint(&shell, "matte.png", [16, 2], |x, _| [step(x); 3]);
    paint(&shell, "paper.png", [20, 4], |_, _| [255; 3]);
    paint(
        &shell,
        "night.png",
        [20, 4],
        |x, y| if y == 0 { [9, 8, 7] } else { [0, 0, step(x % 16)] },
    );
    run_twice(&shell, "scripts/matte-over.sh -a 2,1 white.png matte.png paper.png a.png");
    let image = read(&shell, "a.png", Ask::Picture);
    assert_eq!(image.size(), [20, 4]);
    for kind in COLOR {
        assert_eq!(bytes(&image, kind), [255; 80], "white over white is white at every coverage");
    }
    shell.run("scripts/matte-over.sh -a 2,1 white.png matte.png night.png out");
    let (image, night) = (read(&shell, "out", Ask::All), read(&shell, "night.png", Ask::Picture));
    assert_eq!(programs(&image).last().map(String::as_str), Some("icomp"));
    assert_eq!(programs(&image)[0], "icopy", "{:?}", image.properties.history);
    for kind in COLOR {
        let (found, behind) = (bytes(&image, kind), bytes(&night, kind));
        for y in 0..4_u32 {
            for x in 0..20_u32 {
                let i = (y * 20 + x) as usize;
                let is_covered = (2..18).contains(&x) && (1..3).contains(&y);
                let coverage = if is_covered { f64::from(step(x - 2)) / 255.0 } else { 0.0 };
                let expected = display(coverage + (1.0 - coverage) * linear(behind[i]));
                let off = (f64::from(found[i]) - expected).abs();
                assert!(off <= 1.0, "{kind} at {x}, {y}: {} for {expected}", found[i]);
            }
        }
    }
}

/// The table and the indices of an indexed picture.
fn indexed(shell: &Shell, name: &str) -> (Vec<[u8; 4]>, Vec<u8>, [u32; 2]) {
    let image = read(shell, name, Ask::Only(vec![Kind::Enc, Kind::Lut]));
    let table = image.lut.as_ref().unwrap().entries().collect();
    (table, bytes(&image, Kind::Enc), image.size())
}

#[test]
fn a_panel_gets_its_own_colors_in_its_order() {
    let shell = Shell::new();
    paint(&shell, "photo.png", [64, 40], |x, y| {
        let value = u8::try_from(x * 4).unwrap();
        if y < 20 { [value; 3] } else { [255 - value, value / 2, value] }
    });
    run_twice(&shell, "scripts/e-paper.sh -s 48x20 photo.png grey.png");
    let (table, indices, size) = indexed(&shell, "grey.png");
    assert_eq!(size, [48, 20]);
    let greys: Vec<[u8; 4]> = (0..16).map(|n| [17 * n, 17 * n, 17 * n, 255]).collect();
    assert_eq!(table, greys, "16 greys, black first");
    assert!(indices.iter().all(|&index| index < 16), "indices are in the table");
    let sum = |range: std::ops::Range<usize>| -> u32 { range.map(|x| u32::from(indices[x])).sum() };
    assert!(sum(0..8) < 3 * 8 && sum(40..48) > 12 * 8, "dark at the left, light at the right");

    shell.run("scripts/e-paper.sh -p color7 -s 20x30 photo.png color.png");
    let (table, indices, size) = indexed(&shell, "color.png");
    assert_eq!(size, [20, 30]);
    let expected = [
        [0, 0, 0, 255],
        [255, 255, 255, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [255, 0, 0, 255],
        [255, 255, 0, 255],
        [255, 128, 0, 255],
    ];
    assert_eq!(table, expected, "the panel's colours in the panel's order");
    assert!(indices.contains(&0) && indices.contains(&1), "black and white are used");

    // A table with the same colour twice and one that no pixel wants.
    fs::write(shell.file("own.lut"), [255, 0, 1, 255, 255, 0, 254, 255, 255, 0, 1, 255]).unwrap();
    shell.run("scripts/e-paper.sh -p own.lut -s 20x30 photo.png own.png");
    let (table, _, _) = indexed(&shell, "own.png");
    assert_eq!(table, [[255, 255, 255, 255], [0, 0, 0, 255], [1, 254, 1, 255], [255; 4]]);
}

#[test]
fn pictures_for_terminals_are_sixel_and_half_blocks() {
    let shell = Shell::new();
    paint(&shell, "photo.png", [64, 48], slope);
    run_twice(&shell, "scripts/for-terminal.sh -w 32 -b 20x5 photo.png shown");
    let sixel = fs::read_to_string(shell.file("shown.six")).unwrap();
    assert!(sixel.starts_with("\x1bP") && sixel.trim_end().ends_with("\x1b\\"), "a sixel string");
    assert!(sixel.contains("\"1;1;32;24"), "square pixels, fitted to 32 columns");
    let blocks = fs::read_to_string(shell.file("shown.ans")).unwrap();
    assert_eq!(blocks.lines().count(), 5, "{blocks:?}");
    assert!(blocks.contains('▀') && blocks.contains("\x1b[38;2;"), "{blocks:?}");
    let printed = shell.run("scripts/for-terminal.sh photo.png shown");
    assert_eq!(printed, "", "no terminal, nothing shown");
    let sixel = fs::read_to_string(shell.file("shown.six")).unwrap();
    assert!(sixel.contains("\"1;1;64;48"), "small pictures are not enlarged");
}

#[test]
fn scripts_explain_themselves_and_refuse_what_is_wrong() {
    let shell = Shell::new();
    for script in SCRIPTS {
        let help = shell.run(&format!("scripts/{script}.sh -h"));
        assert!(help.contains(&format!("  {script}.sh [")), "{help}");
        assert!(!help.contains('#') || help.contains("#ffffff"), "no comment signs: {help}");
        for arguments in ["", "one", "-z a b c d"] {
            let output = shell.output(&format!("scripts/{script}.sh {arguments}"));
            assert_eq!(output.status.code(), Some(2), "{script} {arguments}");
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(message.contains("see -h"), "{script} {arguments}: {message}");
        }
    }
    for line in [
        "prepare-texture.sh missing.png out",
        "palette-for-frames.sh out.gif missing.png missing.png",
        "matte-over.sh missing.png missing.png missing.png out",
        "e-paper.sh missing.png out.png",
        "for-terminal.sh missing.png out",
    ] {
        let output = shell.output(&format!("scripts/{line}"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {message}");
        assert!(message.contains("missing.png"), "{line}: {message}");
        assert!(files(&shell).is_empty(), "{line} leaves nothing: {:?}", files(&shell).keys());
    }
    let listed = fs::read_dir(root().join("scripts")).unwrap().count();
    // Comparisons with other programs and the package for Python have tests of their own; instructions are counted, and a
    // program is installed, by `.ci/run`.
    assert_eq!(listed, SCRIPTS.len() + 5, "a script that nothing runs");
}

/// At a small size, without what it would have to build; other programs where they are installed.
#[test]
fn quantisers_are_compared_on_pictures_of_ones_own() {
    let shell = Shell::new();
    paint(&shell, "a slope.png", [64, 48], slope);
    paint(&shell, "flat.png", [64, 48], |x, _| [if x < 40 { 200 } else { 30 }, 9, 9]);
    let line =
        "scripts/compare-quantisers.sh -x -s 0.003072 -r 1 -c out.csv 'a slope.png' flat.png";
    let printed = shell.run(line);
    assert!(printed.contains("0.003072 megapixels, 2 pictures"), "{printed}");
    let figures = fs::read_to_string(shell.file("out.csv")).unwrap();
    let header =
        "megapixels,picture,method,psnr,ssimulacra2,dssim,memory1,memory2,files1,files2,bytes";
    assert_eq!(figures.lines().next(), Some(header));
    for method in ["heckbert", "fast", "best rgb", "best oklab"] {
        assert!(printed.contains(&format!("\n| ilut {method} | ")), "{method}: {printed}");
        let field = |picture: &str, at: usize| {
            let start = format!("0.003072,{picture},ilut {method},");
            let line = figures.lines().find(|line| line.starts_with(&start)).unwrap();
            line.split(',').nth(at).unwrap().to_owned()
        };
        let decibels: f64 = field("a slope", 3).parse().unwrap();
        assert!((30.0..70.0).contains(&decibels), "{method}: {decibels}");
        assert!(field("a slope", 8).parse::<f64>().unwrap() > 0.0, "{method}: a time");
        assert!(field("a slope", 10).parse::<f64>().unwrap() > 64.0, "{method}: a size");
    }
    assert!(printed.contains("exact) |"), "two colours come back: {printed}");
    assert!(!printed.contains("inf"), "{printed}");
    for (program, name) in
        [("pngquant", "pngquant"), ("convert", "ImageMagick"), ("pnmquant", "netpbm")]
    {
        let is_there = shell.output(&format!("command -v {program}")).status.success();
        let said = if is_there { format!("\n| {name}") } else { format!("installed: {name}") };
        assert!(printed.contains(&said), "{name}: {printed}");
    }
    for wrong in ["-s none", "-r 0", "-z", "-s 0"] {
        let output = shell.output(&format!("scripts/compare-quantisers.sh {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}: {output:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("see -h"), "{wrong}: {output:?}");
    }
    let output = shell.output("scripts/compare-quantisers.sh -x -s 0.003 missing.png");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("missing.png"), "{output:?}");
    assert!(shell.run("scripts/compare-quantisers.sh -h").contains("  compare-quantisers.sh ["));
}

#[test]
fn every_command_of_the_tour_works_as_written() {
    let text = fs::read_to_string(root().join("docs/toolkit.md")).unwrap();
    let shell = Shell::new();
    let lines = commands(&text);
    assert!(lines.len() >= 20, "{lines:?}");
    for line in lines {
        shell.run(line);
    }
    for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        if !link.starts_with("http") && !link.starts_with('#') {
            assert!(root().join("docs").join(link).exists(), "{link} is there");
        }
    }
    for entry in fs::read_dir(root().join("docs/toolkit")).unwrap() {
        let path = entry.unwrap().path();
        assert!(path.metadata().unwrap().len() < 40_000, "{} is small", path.display());
    }
}
