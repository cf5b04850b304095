//! Sequences that are stopped, and gone on with.

use std::fs;

use rustix::process::Signal;

use crate::process::{Worker, is_running, send};
use crate::{begun, done, files, folder, says, whole};

#[test]
fn an_animation_of_48_frames_is_stopped_five_times() {
    let folder = folder();
    let small = "--size 64x48 --samples 9";
    let words = format!(
        "--engine local --jobs 2 --frames 0..47 -v -o {} {small}",
        folder.path().join("x.png").display()
    );
    let finished = || files(folder.path(), "x-");
    let mut seen: Vec<(std::path::PathBuf, Vec<u8>)> = Vec::new();
    let signals = [Signal::KILL, Signal::INT, Signal::TERM, Signal::KILL, Signal::INT];
    for (stop, signal) in signals.into_iter().enumerate() {
        let mut child = begun(folder.path(), &words);
        while finished().len() < 3 * (stop + 1) {
            assert!(is_running(child.id()), "ended before it was stopped");
        }
        send(child.id(), signal);
        assert!(!child.wait().unwrap().success());
        while !Worker::all(&folder.path().join("x.farm")).is_empty() {}
        for (path, bytes) in &seen {
            assert!(fs::read(path).unwrap() == *bytes, "{} was finished", path.display());
        }
        seen = finished().into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect();
        assert!(seen.len() < 48, "not all were finished");
    }
    let output = done(folder.path(), &words);
    let text = says(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let before = text.lines().find_map(|line| line.strip_suffix(" pictures were finished before"));
    let before: usize = before.unwrap().parse().unwrap();
    // A kill may come between a picture and its line in the list.
    assert!(before + 1 >= seen.len() && before <= seen.len(), "{before} of {}", seen.len());
    assert!(text.contains(&format!("{} pictures in", 48 - before)), "{text}");
    whole(folder.path(), &format!("-o OUT/y.png --frames 0..47 {small}"));
    for number in 0..48 {
        let bytes =
            |name: &str| fs::read(folder.path().join(format!("{name}-{number:04}.png"))).unwrap();
        assert!(bytes("x") == bytes("y"), "picture {number}");
    }
    let output = done(folder.path(), &words);
    assert!(says(&output).contains("48 pictures were finished before"), "{}", says(&output));
    // The list is that of one process, too: it has nothing to do.
    let before = fs::metadata(folder.path().join("x-0000.png")).unwrap().modified().unwrap();
    whole(folder.path(), &format!("-o OUT/x.png --frames 0..47 {small}"));
    let after = fs::metadata(folder.path().join("x-0000.png")).unwrap().modified().unwrap();
    assert_eq!(before, after);
}

#[test]
fn frames_in_parts_are_those_of_one_process() {
    let folder = folder();
    let words = "--size 70x50 --aa adaptive --filter mitchell";
    let output =
        done(folder.path(), &format!("--engine local --parts 3 --frames 8..9 -o x {words}"));
    assert_eq!(output.status.code(), Some(0), "{}", says(&output));
    assert!(says(&output).starts_with("2 pictures in 6 parts"), "{}", says(&output));
    whole(folder.path(), &format!("-o OUT/y --frames 8..9 {words}"));
    crate::assert_same_image(folder.path(), "y-0008", "x-0008");
    crate::assert_same_image(folder.path(), "y-0009", "x-0009");
}
