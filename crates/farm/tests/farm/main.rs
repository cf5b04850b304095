//! The real program: what is left of a render when workers, the driver and nodes are killed.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

mod command;
mod faults;
mod process;
mod sequence;
mod slurm;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use clap::Parser;
use tempfile::TempDir;

/// A clear ball before a mirror, and a floor; `frame` moves the eye, and `size` the ball.
const SCENE: &str = "\
    let size = 1\n\
    object is smoothest trans (3, 1.5) sphere scale size\n\
    object is smoothest shiny blue block at (0, 0, -4) scale (2, 2, 1)\n\
    object is paint checker red block at (0, -3, 0) scale (3, 1, 3)\n\
    light at (5, 9, 5) ambient intensity 0.3\n\
    background light gray\n\
    camera at (frame/9, 1, 9)\n";

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.sdl"), SCENE).unwrap();
    folder
}

/// `prfarm render scene.sdl` with more words.
fn farm(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_prfarm"));
    command
        .current_dir(folder)
        .args(["render", "scene.sdl"])
        .args(words.split_whitespace())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn begun(folder: &Path, words: &str) -> Child {
    farm(folder, words).spawn().unwrap()
}

fn done(folder: &Path, words: &str) -> Output {
    farm(folder, words).output().unwrap()
}

fn says(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The same picture by one process: this one.
fn whole(folder: &Path, words: &str) {
    let scene = folder.join("scene.sdl");
    let scene = scene.to_str().unwrap();
    let output = words.split_whitespace().map(|word| match word.strip_prefix("OUT/") {
        Some(name) => folder.join(name).to_str().unwrap().to_owned(),
        None => word.to_owned(),
    });
    let words = ["portray", "-q", scene].map(str::to_owned).into_iter().chain(output);
    let arguments = render::command::Arguments::try_parse_from(words).unwrap();
    render::command::run(&arguments).unwrap();
}

/// Files of a folder whose names begin so.
fn files(folder: &Path, prefix: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.file_name().unwrap().to_str().unwrap().starts_with(prefix));
    paths.sort();
    paths
}

/// Finished parts in a work folder.
fn parts(folder: &Path) -> usize {
    let is_part = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "idf");
    files(folder, "").iter().filter(|path| is_part(path)).count()
}

/// Whether all channels and the description of two images are the same bytes; only the log has times.
fn assert_same_image(folder: &Path, one: &str, other: &str) {
    let endings = |name: &str| -> Vec<String> {
        let ending = |path: &PathBuf| path.extension().unwrap().to_str().unwrap().to_owned();
        let all = files(folder, &format!("{name}."));
        all.iter().map(ending).filter(|ending| ending != "log" && ending != "farm").collect()
    };
    assert_eq!(endings(one), endings(other), "the same channels");
    for ending in endings(one) {
        let bytes = |name: &str| fs::read(folder.join(format!("{name}.{ending}"))).unwrap();
        if ending == "idf" {
            let text = |name| String::from_utf8(bytes(name)).unwrap();
            let found = text(other).replace(&format!(" {other}."), &format!(" {one}."));
            assert_eq!(text(one), found, "the same description");
        } else {
            assert!(bytes(one) == bytes(other), "{ending} differs");
        }
    }
}
