//! Workers and drivers that are killed.

use std::fs;
use std::os::unix::fs::MetadataExt;

use rustix::process::Signal;

use crate::process::{Lots, Worker, send};
use crate::{assert_same_image, begun, done, folder, parts, says, whole};

/// Some tenths of a second of work.
const PICTURE: &str = "--size 160x120 --samples 9";

#[test]
fn twenty_killed_workers_leave_no_trace_in_the_picture() {
    let folder = folder();
    whole(folder.path(), &format!("-o OUT/whole {PICTURE} --channels rgb,cvg,depth,object"));
    let output = folder.path().join("x");
    let words = format!(
        "--engine local --jobs 2 --parts 8 -v -o {} {PICTURE} --channels rgb,cvg,depth,object",
        output.display()
    );
    let mut lots = Lots(2026);
    let (mut kills, mut runs) = (0, 0);
    while kills < 20 {
        let child = begun(folder.path(), &words);
        let mut here = 0;
        // Where this process gets little time a run may end before five of its workers are killed.
        while here < 5 && crate::process::is_running(child.id()) {
            // A look at all processes takes some milliseconds: so a worker is killed early or late in its work.
            let mut workers = Vec::new();
            for _ in 0..=lots.below(12) {
                workers = Worker::all(&output.with_extension("farm"));
            }
            if !workers.is_empty() {
                let worker = workers[lots.below(workers.len())];
                here += usize::from(send(worker.pid, Signal::KILL));
            }
        }
        let output = child.wait_with_output().unwrap();
        let text = says(&output);
        assert_eq!(output.status.code(), Some(0), "{text}");
        // A worker may be killed when its part is in its place, or when it has no longer anything to do.
        let again = text.matches("is rendered again, as its worker was killed").count();
        assert!(again <= here, "{text}");
        assert!(text.contains("1 picture in 8 parts"), "{text}");
        assert_same_image(folder.path(), "whole", "x");
        assert!(!folder.path().join("x.farm").exists(), "nothing is left over");
        (kills, runs) = (kills + again, runs + 1);
        assert!(runs < 100, "workers are found and killed");
    }
}

#[test]
fn a_killed_driver_takes_its_workers_along_and_the_next_goes_on() {
    let folder = folder();
    whole(folder.path(), &format!("-o OUT/whole.png {PICTURE}"));
    let work = folder.path().join("x.farm");
    let words = format!(
        "--engine local --jobs 2 --parts 32 -o {} {PICTURE}",
        folder.path().join("x.png").display()
    );
    let (mut finished, mut late) = (0, 0);
    for signal in [Signal::KILL, Signal::TERM, Signal::INT, Signal::KILL] {
        let mut child = begun(folder.path(), &words);
        while parts(&work) < finished + 2 {
            if crate::process::is_running(child.id()) {
                continue;
            }
            // It was done before this test had its turn, on a machine that has other things to do: once more.
            let _ = child.wait().unwrap();
            fs::remove_file(folder.path().join("x.png"))
                .expect("a driver that ends leaves its picture");
            (finished, late) = (0, late + 1);
            assert!(late < 20, "drivers can be killed");
            child = begun(folder.path(), &words);
        }
        send(child.id(), signal);
        let status = child.wait().unwrap();
        assert!(!status.success());
        while !Worker::all(&work).is_empty() {}
        finished = parts(&work);
        assert!((2..32).contains(&finished), "some are there, not all: {finished}");
        assert!(!folder.path().join("x.png").exists(), "and no picture");
    }
    let stamp = |name: &str| fs::metadata(work.join(name)).map(|m| (m.ino(), m.mtime())).ok();
    let output = done(folder.path(), &format!("{words} --keep-parts"));
    let text = says(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    // What is on disk is not made again.
    assert!(stamp("scene-0000.idf").is_some());
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("whole.png") == bytes("x.png"), "{text}");
}

#[test]
fn parts_that_are_damaged_or_of_another_picture_are_rendered_again() {
    let folder = folder();
    let small = "--size 64x48";
    whole(folder.path(), &format!("-o OUT/whole {small}"));
    let words = |more: &str| format!("--engine local --parts 4 --keep-parts -o x {small} {more}");
    let rendered = |more: &str| {
        let output = done(folder.path(), &words(more));
        assert_eq!(output.status.code(), Some(0), "{}", says(&output));
        let text = says(&output);
        let count = text.split(" in ").nth(1).unwrap().split(' ').next().unwrap().to_owned();
        count.parse::<u32>().unwrap()
    };
    assert_eq!(rendered(""), 4);
    assert_eq!(rendered(""), 0, "all parts are there");
    assert_same_image(folder.path(), "whole", "x");
    // One byte of a channel.
    let data = folder.path().join("x.farm/scene-0002.grn");
    let mut bytes = fs::read(&data).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&data, bytes).unwrap();
    fs::remove_file(folder.path().join("x.farm/scene-0001.idf")).unwrap();
    let before = done(folder.path(), &words("-v"));
    assert!(says(&before).contains("missing of 4 parts: 1-2\n"), "{}", says(&before));
    fs::remove_file(folder.path().join("x.farm/scene-0001.idf")).unwrap();
    fs::remove_file(folder.path().join("x.farm/scene-0002.idf")).unwrap();
    assert_eq!(rendered(""), 2, "the damaged and the missing one");
    assert_same_image(folder.path(), "whole", "x");
    assert_eq!(rendered("--seed 7 --aa stochastic --samples 2"), 4, "another picture");
    assert_eq!(rendered("-D size=0.5"), 4, "another scene");
    whole(folder.path(), &format!("-o OUT/half {small} -D size=0.5"));
    assert_same_image(folder.path(), "half", "x");
    assert_eq!(rendered("--accel boxes -D size=0.5"), 0, "the same picture in another way");
}

#[test]
fn retries_have_a_limit_that_an_option_moves() {
    let folder = folder();
    let output = folder.path().join("x");
    let words =
        format!("--engine local --jobs 1 --parts 4 --retries 0 -o {} {PICTURE}", output.display());
    let child = begun(folder.path(), &words);
    while !Worker::all(&output.with_extension("farm"))
        .first()
        .is_some_and(|worker| send(worker.pid, Signal::KILL))
    {
        assert!(crate::process::is_running(child.id()), "ended before it was killed");
    }
    let output = child.wait_with_output().unwrap();
    let text = says(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("was killed once without a word; --retries N allows more"), "{text}");
}
