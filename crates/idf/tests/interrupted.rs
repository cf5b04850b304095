//! A process that writes an image is killed at any moment: the old image is left or the new one.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use idf::rows::{Reader, Writer};
use idf::{Depth, Image, Kind, Plane, ReadOptions, Samples, WriteOptions, read, write};

/// Tells a child where to write, over and over.
const TARGET: &str = "IDF_TEST_WRITES_TO";
const KINDS: [Kind; 4] = [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg];
const COLUMNS: u32 = 300;
const ROWS: u32 = 200;

/// An image all of one value, with a line of history that says so.
fn image(value: u8) -> Image {
    let samples = Samples::U8(vec![value; (COLUMNS * ROWS) as usize]);
    let plane = |kind| Plane { kind, samples: samples.clone() };
    let mut image = Image::new(COLUMNS, ROWS, KINDS.map(plane).into()).unwrap();
    image.properties.history = vec![value.to_string()];
    image
}

/// Writes images of 0, 1, 2, …, at once and in bands by turns, each after a line.
fn write_for_ever(path: &Path) {
    for value in (0..=255_u8).cycle() {
        // Not `println`, which a test does not write at once.
        let mut out = std::io::stdout();
        out.write_all(b"writes\n").unwrap();
        if value % 2 == 0 {
            write(path, &image(value), &WriteOptions::default()).unwrap();
            continue;
        }
        let options = WriteOptions::default();
        let channels = KINDS.map(|kind| (kind, Depth::U8));
        let mut bands = Reader::from(image(value));
        let properties = bands.properties().clone();
        let size = [COLUMNS, ROWS];
        let mut writer = Writer::create(path, size, &channels, properties, &options).unwrap();
        for row in (0..ROWS).step_by(50) {
            writer.write(&bands.band(row..row + 50).unwrap()).unwrap();
        }
        writer.finish(vec![value.to_string()]).unwrap();
    }
}

#[test]
fn a_killed_writer_leaves_a_whole_image() {
    if let Some(path) = std::env::var_os(TARGET) {
        write_for_ever(Path::new(&path));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    write(&path, &image(255), &WriteOptions::default()).unwrap();
    let mut seed = 1_u32;
    let mut values = Vec::new();
    for _ in 0..40 {
        let name = "a_killed_writer_leaves_a_whole_image";
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", name, "--nocapture"])
            .env(TARGET, &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Some writes, and then some way into the next.
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let writes = lines.map(Result::unwrap).filter(|line| line.ends_with("writes"));
        assert_eq!(writes.take(1 + (seed >> 29) as usize).count(), 1 + (seed >> 29) as usize);
        let mut steps = seed >> 12;
        while black_box(steps) > 0 {
            steps -= 1;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let options = ReadOptions { history: true, ..ReadOptions::default() };
        let found = read(&path, &options).unwrap();
        let Some(Samples::U8(samples)) = found.plane(Kind::Red) else { panic!("{found:?}") };
        let value = samples[0];
        assert!(found == image(value), "a mixture after {values:?}");
        values.push(value);
    }
    // What the killed left goes with the next write.
    write(&path, &image(7), &WriteOptions::default()).unwrap();
    let entries = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["x.blu", "x.cvg", "x.grn", "x.idf", "x.log", "x.red"]);
    values.dedup();
    assert!(values.len() > 5, "the children wrote too little: {values:?}");
}
