//! The same scene gives the same bytes: with any number of threads, by any way of finding surfaces, compiled before or
//! in passing.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use tempfile::TempDir;

use crate::support::{LISTING, files, portray, prcomp};

const SETTINGS: &str = "--size 96x96 --samples 4";

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("glass.sdl"), LISTING).unwrap();
    folder
}

/// What `portray` writes for `scene` with `options`, but for the log, which holds times.
fn written(folder: &Path, scene: &str, output: &str, options: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let place = TempDir::new_in(folder).unwrap();
    let name = place.path().file_name().unwrap().to_str().unwrap();
    portray(folder, &format!("@{scene} -q -o @{name}/{output} {SETTINGS} {options}")).unwrap();
    let mut written = files(place.path());
    written.retain(|(name, _)| name.extension().is_none_or(|ending| ending != "log"));
    written
}

#[test]
fn threads_and_ways_of_tracing_do_not_show() {
    let folder = folder();
    for output in ["glass", "glass.png", "glass.exr"] {
        let written = |options: &str| written(folder.path(), "glass.sdl", output, options);
        let one = written("--threads 1");
        let expected = if output == "glass" { 4 } else { 1 };
        assert_eq!(one.len(), expected, "files of {output}");
        let differs = written("--threads 1 --depth 3");
        assert!(differs != one, "{output}: the comparison can see a difference");
        for options in [
            "--threads 2",
            "--threads 3",
            "--threads 7",
            "--accel none",
            "--accel boxes",
            "--accel coherence",
            "--accel bvh",
            "--keep-all",
        ] {
            assert!(written(options) == one, "{output} with {options}");
        }
    }
}

#[test]
fn a_compiled_scene_gives_the_bytes_of_its_description() {
    let folder = folder();
    for output in ["@glass.prc", "@again.prc"] {
        let status = prcomp(folder.path(), &format!("@glass.sdl -q -o {output}"));
        assert_eq!(status, ExitCode::SUCCESS, "compiled");
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("glass.prc") == read("again.prc"), "compiled twice");
    for output in ["glass", "glass.png"] {
        let direct = written(folder.path(), "glass.sdl", output, "--accel bvh");
        for options in ["--accel bvh", "--accel none --threads 3"] {
            let compiled = written(folder.path(), "glass.prc", output, options);
            assert!(compiled == direct, "{output} through .prc with {options}");
        }
    }
}

#[test]
fn pictures_and_compiled_scenes_name_no_place() {
    let folder = folder();
    prcomp(folder.path(), "@glass.sdl -q");
    portray(folder.path(), "@glass.sdl -q -o @glass --size 8x8").unwrap();
    portray(folder.path(), "@glass.sdl -q -o @glass.png --size 8x8").unwrap();
    let place = folder.path().file_name().unwrap().to_str().unwrap().as_bytes();
    let names = |bytes: &[u8]| bytes.windows(place.len()).any(|window| window == place);
    assert!(names(folder.path().as_os_str().as_encoded_bytes()), "the search finds it");
    let written = files(folder.path());
    assert_eq!(written.len(), 8, "description, compiled scene, PNG, and five of an IDF image");
    let naming: Vec<&PathBuf> =
        written.iter().filter(|(_, bytes)| names(bytes)).map(|(name, _)| name).collect();
    assert!(naming.is_empty(), "{naming:?}");
}
