//! The scenes of the repository, by what their pages say of them.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::PathBuf;

use render::{Options, World};
use scene::Scene;

use crate::support::{Shown, root, shown};

fn file(name: &str) -> PathBuf {
    root().join("scenes").join(name)
}

/// The scene of a file, that has nothing to be warned of.
fn scene(name: &str, frame: f64) -> Scene {
    let options = compile::Options {
        definitions: vec![("frame".to_owned(), frame)],
        ..compile::Options::default()
    };
    let compiled = compile::compile_path_with(&file(name), &options);
    assert_eq!(compiled.report(), "", "{name}");
    compiled.scene.unwrap()
}

fn picture(scene: &Scene) -> Shown {
    shown(scene, &Options { columns: 60, rows: 45, ..Options::default() })
}

/// Every scene of the folders, by its name from there.
fn names() -> Vec<String> {
    let mut names = Vec::new();
    for folder in fs::read_dir(root().join("scenes")).unwrap() {
        let folder = folder.unwrap().path();
        if !folder.is_dir() || folder.ends_with("include") {
            continue;
        }
        for file in fs::read_dir(&folder).unwrap() {
            let file = file.unwrap().path();
            if file.extension().is_some_and(|ending| ending == "sdl") {
                let name = file.strip_prefix(root().join("scenes")).unwrap();
                names.push(name.to_str().unwrap().to_owned());
            }
        }
    }
    names.sort();
    names
}

#[test]
fn every_scene_shows_something_without_a_warning() {
    let names = names();
    assert!(names.len() >= 14, "{names:?}");
    // The listing of the paper lacks a parenthesis.
    for name in names.iter().filter(|name| !name.starts_with("wine-glass")) {
        let scene = scene(name, 0.0);
        if scene.camera.is_none() {
            // It is included by others.
            continue;
        }
        let picture = picture(&scene);
        let covered = picture.coverage.iter().filter(|&&coverage| coverage > 0.5).count();
        assert!(covered > 200, "{name}: {covered} pixels are covered");
    }
}

#[test]
fn fog_is_one_statement() {
    let text = fs::read_to_string(file("fog/fog.sdl")).unwrap();
    let (before, statement) = text.split_once("\nfog ").unwrap();
    assert!(statement.trim().parse::<f64>().is_ok(), "{statement}");
    let clear = tempfile::tempdir().unwrap();
    fs::create_dir(clear.path().join("solids")).unwrap();
    fs::create_dir(clear.path().join("fog")).unwrap();
    fs::copy(file("solids/solids.sdl"), clear.path().join("solids/solids.sdl")).unwrap();
    let path = clear.path().join("fog/clear.sdl");
    fs::write(&path, before).unwrap();
    let compiled = compile::compile_path(&path).scene.unwrap();
    let solids = picture(&scene("solids/solids.sdl", 0.0));
    assert!(picture(&compiled) == solids, "without the statement it is `solids`");
    assert!(picture(&scene("fog/fog.sdl", 0.0)) != solids, "with it there is fog");
}

#[test]
fn what_moves_comes_back_after_48_pictures() {
    for name in ["gallery/gears.sdl", "gallery/pendulums.sdl"] {
        let at = |frame| picture(&scene(name, frame));
        let first = at(0.0);
        assert!(first.differing(&at(48.0), 5).len() <= 2, "{name} comes back");
        assert!(first.differing(&at(5.0), 5).len() > 40, "{name} moves");
    }
}

#[test]
fn the_flake_is_small_in_memory() {
    let scene = scene("gallery/flake.sdl", 0.0);
    let world = World::load(&scene).unwrap();
    // 2·10¹⁵ spheres.
    assert!(world.leaf_count() < 64, "{} primitives", world.leaf_count());
}
