//! What is written comes back, and a write that is stopped leaves one image or the other.

use super::*;
use crate::history::{Entry, append};
use crate::samples::Samples;
use crate::transfer::Transfer;

/// An image of one value, with a line of history.
fn image(kinds: &[Kind], value: u8) -> Image {
    let plane = |&kind| Plane { kind, samples: Samples::U8(vec![value; 1000]) };
    let mut image = Image::new(100, 10, kinds.iter().map(plane).collect()).unwrap();
    image.properties.history = vec![format!("line {value}")];
    image
}

fn read_all(path: &Path) -> Image {
    read(path, &ReadOptions { history: true, ..ReadOptions::default() }).unwrap()
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

const RLE: WriteOptions = WriteOptions { encoding: Encoding::Rle, outside: false };
const RAW: WriteOptions = WriteOptions { encoding: Encoding::Raw, outside: false };

#[test]
fn all_depths_and_properties_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd name");
    let values = (0..600_u16).map(|i| f32::from(i) * -0.7).collect();
    let planes = vec![
        Plane { kind: Kind::Grg, samples: Samples::F32(values) },
        Plane { kind: Kind::Cvg, samples: Samples::U16((0..600).map(|i| i * 109).collect()) },
        Plane { kind: Kind::Enc, samples: Samples::U8([7; 600].into()) },
    ];
    let mut image = Image::new(30, 20, planes).unwrap();
    image.lut = Lut::new(vec![[1, 2, 3]; 9]);
    image.properties.origin = [-3, 9];
    image.properties.transfer = Some(Transfer::Gamma(1.8));
    image.properties.matte = Matte::Straight;
    image.properties.background = Some([0.1, 0.2, 0.3]);
    image.properties.unknown = vec!["camera  35 mm # mine".into()];
    image.properties.history = vec!["a".into(), "b".into()];
    for options in [RLE, RAW] {
        write(&path, &image, &options).unwrap();
        assert_eq!(read_all(&path), image);
        let length = fs::metadata(folder.path().join("odd name.enc")).unwrap().len();
        // A coded row of 30 equal bytes has 2 bytes, and 4 in the table.
        assert_eq!(length, if options == RLE { 120 } else { 600 });
    }
    let names = ["cvg", "enc", "grg", "idf", "log", "lut"].map(|e| format!("odd name.{e}"));
    assert_eq!(files(folder.path()), names);
}

#[test]
fn a_file_that_would_not_shrink_is_raw() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let written = |samples: Vec<u8>, options| {
        let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples) };
        write(&path, &Image::new(100, 10, vec![plane]).unwrap(), &options).unwrap();
        read_description(&path).unwrap().channels[0].encoding
    };
    let noise = || (0..1000_u16).map(|i| (i * 37 % 251).to_le_bytes()[0]).collect();
    assert_eq!(written(noise(), RLE), Encoding::Raw);
    assert_eq!(written(vec![0; 1000], RLE), Encoding::Rle);
    assert_eq!(written(vec![0; 1000], RAW), Encoding::Raw);
}

/// Does the first `done` changes of a write, as a crash would leave them; whether these were
/// all.
fn crash_after(done: usize, path: &Path, image: &Image, description: &Description) -> bool {
    let mut staged = Vec::new();
    for channel in &description.channels {
        let bytes = image.plane(channel.kind).unwrap().raw_bytes(0..1000);
        staged.push(Staged::new(path, &channel.file, &bytes).unwrap());
    }
    let steps = commit(path, staged, description).unwrap().steps;
    let all = done >= steps.len();
    steps.into_iter().take(done).for_each(|step| step_result(step).unwrap());
    all
}

#[test]
fn a_crash_leaves_the_old_image_or_the_new() {
    let kinds = [Kind::Red, Kind::Grn, Kind::Blu];
    let (mut old, mut new) = (image(&kinds, 1), image(&kinds, 2));
    old.properties.history.clear();
    new.properties.history.clear();
    let mut found_new = 0;
    for done in 0.. {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.idf");
        write(&path, &old, &RAW).unwrap();
        let description = read_description(&path).unwrap();
        let all = crash_after(done, &path, &new, &description);
        let left = read_all(&path);
        assert!(left == old || left == new, "after {done} steps");
        found_new += usize::from(left == new);
        let before = files(folder.path());
        if all {
            assert_eq!(left, new);
            assert_eq!(before, ["x.blu", "x.grn", "x.idf", "x.red"]);
            break;
        }
        // What is left is no obstacle to the next write.
        write(&path, &old, &RAW).unwrap();
        assert_eq!(read_all(&path), old);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("\nred x.red "), "{text}");
    }
    // One rename, three links, one rename, three removals: the new image is there from the
    // first on.
    assert_eq!(found_new, 8);
}

#[test]
fn files_that_an_interrupted_write_left_in_use_stay_while_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.idf");
    let both = image(&[Kind::Red, Kind::Grn], 2);
    write(&path, &both, &RAW).unwrap();
    let mut description = read_description(&path).unwrap();
    description.log = None;
    crash_after(1, &path, &both, &description);
    assert_eq!(files(folder.path()).iter().filter(|name| name.starts_with(".x.")).count(), 2);
    add(&path, &image(&[Kind::Red], 3), &RAW).unwrap();
    let samples = |value| Some(Samples::U8(vec![value; 1000]));
    assert_eq!(read_all(&path).plane(Kind::Red).cloned(), samples(3));
    assert_eq!(read_all(&path).plane(Kind::Grn).cloned(), samples(2));
    write(&path, &both, &RAW).unwrap();
    assert_eq!(files(folder.path()), ["x.grn", "x.idf", "x.log", "x.red"]);
}

#[test]
fn a_crash_of_a_first_write_leaves_no_image_or_the_new() {
    let new = image(&[Kind::Red, Kind::Grn], 2);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.idf");
    let elsewhere = folder.path().join("y.idf");
    write(&elsewhere, &new, &RAW).unwrap();
    let mut description = read_description(&elsewhere).unwrap();
    description.log = None;
    for channel in &mut description.channels {
        channel.file = format!("x.{}", channel.kind);
    }
    for done in 0..3 {
        crash_after(done, &path, &new, &description);
        assert!(!path.exists(), "after {done} steps");
    }
    assert!(crash_after(3, &path, &new, &description));
    assert_eq!(read_all(&path).planes(), new.planes());
}

#[test]
fn a_channel_that_cannot_be_written_leaves_the_old_image() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let old = image(&[Kind::Red], 1);
    write(&path, &old, &RLE).unwrap();
    fs::create_dir(folder.path().join("x.grn")).unwrap();
    let before = files(folder.path());
    let error = write(&path, &image(&[Kind::Red, Kind::Grn], 2), &RLE).unwrap_err();
    assert!(matches!(error, WriteError::NotAFile { .. }), "{error}");
    assert_eq!(read_all(&path), old);
    assert_eq!(files(folder.path()), before);
}

#[test]
fn channels_are_added_and_the_rest_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let mut old = image(&[Kind::Red, Kind::Grn], 1);
    old.properties.background = Some([0.5; 3]);
    old.properties.unknown = vec!["camera 35".into()];
    write(&path, &old, &RLE).unwrap();
    let mut more = image(&[Kind::Enc, Kind::Grn], 2);
    more.lut = Lut::new(vec![[1, 2, 3]]);
    add(&path, &more, &RLE).unwrap();
    let both = read_all(&path);
    assert_eq!(both.kinds(), [Kind::Red, Kind::Grn, Kind::Enc, Kind::Lut]);
    assert_eq!(both.plane(Kind::Red), old.plane(Kind::Red));
    assert_eq!(both.plane(Kind::Grn), more.plane(Kind::Grn));
    assert_eq!(both.properties.history, ["line 1", "line 2"]);
    assert_eq!(both.properties.background, Some([0.5; 3]));
    assert_eq!(both.properties.unknown, ["camera 35"]);
    let other = Plane { kind: Kind::Cvg, samples: Samples::U8(vec![0]) };
    let error = add(&path, &Image::new(1, 1, vec![other]).unwrap(), &RLE).unwrap_err();
    let expected = "x.idf`: planes of 1 x 1, expected 100 x 10";
    assert!(error.to_string().ends_with(expected), "{error}");
    assert_eq!(read_all(&path), both);
}

#[test]
fn indices_go_where_their_table_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let mut both = image(&[Kind::Red, Kind::Enc], 1);
    both.lut = Lut::new(vec![[0; 3], [9; 3]]);
    write(&path, &both, &RLE).unwrap();
    let mut table = Image::new(100, 10, Vec::new()).unwrap();
    table.lut = both.lut.clone();
    assert_eq!(add(&path, &table, &RLE).unwrap(), [], "the same table");
    assert_eq!(read_all(&path).plane(Kind::Enc), both.plane(Kind::Enc));
    table.lut = Lut::new(vec![[7; 3]]);
    assert_eq!(add(&path, &table, &RLE).unwrap(), [Kind::Enc]);
    assert_eq!(read_all(&path).kinds(), [Kind::Red, Kind::Lut]);
    assert_eq!(files(folder.path()), ["x.idf", "x.log", "x.lut", "x.red"]);
    // Indices with their table replace both.
    let mut indexed = image(&[Kind::Enc], 1);
    indexed.lut = both.lut.clone();
    assert_eq!(add(&path, &indexed, &RLE).unwrap(), []);
    assert_eq!(read_all(&path).plane(Kind::Enc), indexed.plane(Kind::Enc));
    // Indices that are all there is are shown in other colours.
    write(&path, &indexed, &RLE).unwrap();
    table.lut = Lut::new(vec![[3; 3], [7; 3]]);
    assert_eq!(add(&path, &table, &RLE).unwrap(), []);
    assert_eq!(read_all(&path).kinds(), [Kind::Enc, Kind::Lut]);
}

#[test]
fn a_file_of_another_image_stays_where_its_indices_go() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let mut both = image(&[Kind::Red, Kind::Enc], 1);
    both.lut = Lut::new(vec![[0; 3], [9; 3]]);
    write(&path, &both, &RLE).unwrap();
    fs::rename(folder.path().join("x.enc"), folder.path().join("y.enc")).unwrap();
    let text = fs::read_to_string(path.with_extension("idf")).unwrap();
    fs::write(path.with_extension("idf"), text.replace("x.enc", "y.enc")).unwrap();
    let mut table = Image::new(100, 10, Vec::new()).unwrap();
    table.lut = Lut::new(vec![[7; 3]]);
    assert_eq!(add(&path, &table, &RLE).unwrap(), [Kind::Enc]);
    assert_eq!(read_all(&path).kinds(), [Kind::Red, Kind::Lut]);
    assert!(folder.path().join("y.enc").exists());
}

#[test]
fn a_line_of_history_is_appended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let mut old = image(&[Kind::Red], 1);
    old.properties.history.clear();
    write(&path, &old, &RLE).unwrap();
    let entry = Entry::now("test", "1");
    for count in 1..3 {
        append(&path, &entry, false).unwrap();
        assert_eq!(read_all(&path).properties.history, vec![entry.to_string(); count]);
    }
}

#[test]
fn what_killed_writers_left_goes_with_the_next_write() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x");
    let red = image(&[Kind::Red], 1);
    write(&path, &red, &RAW).unwrap();
    // No process has this number: it is above the largest that a system gives.
    let dead = |name: &str| format!(".{name}.{}.abcdef", 1 << 30);
    let stray = ["x.red", "x.cvg", "x.idf", "x.log", "x.jpg", "y.red", "x.red.idf"].map(dead);
    for name in &stray {
        fs::write(folder.path().join(name), [9; 1000]).unwrap();
    }
    // One of them is in use, as an interrupted write leaves it.
    let text = fs::read_to_string(path.with_extension("idf")).unwrap();
    let line = format!("{text}cvg {} 100 10 8 raw\n", stray[1]);
    fs::write(path.with_extension("idf"), line).unwrap();
    add(&path, &image(&[Kind::Grn], 2), &RAW).unwrap();
    let expected = [&stray[1], &stray[4], &stray[5], &stray[6]].map(String::clone);
    let hidden = |names: Vec<String>| -> Vec<String> {
        names.into_iter().filter(|name| name.starts_with('.')).collect()
    };
    let mut found = hidden(files(folder.path()));
    found.sort();
    let mut expected = expected.to_vec();
    expected.sort();
    assert_eq!(found, expected);
    assert_eq!(read_all(&path).plane(Kind::Cvg), Some(&Samples::U8(vec![9; 1000])));
    write(&path, &red, &RAW).unwrap();
    let mut expected = [&stray[4], &stray[5], &stray[6]].map(String::clone);
    expected.sort();
    assert_eq!(hidden(files(folder.path())), expected);
}

#[cfg(unix)]
#[test]
fn files_can_be_read_by_others_as_the_system_is_set() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let plain = folder.path().join("plain");
    fs::write(&plain, "").unwrap();
    write(&folder.path().join("x"), &image(&[Kind::Red], 1), &RLE).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    for name in ["x.idf", "x.red"] {
        assert_eq!(mode(&folder.path().join(name)), mode(&plain), "{name}");
    }
}
