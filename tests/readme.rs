//! Every command of the README does what it says: each is run, and each file it promises is there.

use crate::shell::{Shell, commands};
use crate::support::root;

/// The file that a command promises: that after -o or --diff, else the second name.
fn promised(command: &str) -> &str {
    let words: Vec<&str> = command.split_whitespace().collect();
    let output =
        words.iter().position(|word| ["-o", "--diff"].contains(word)).map_or(2, |at| at + 1);
    words[output].trim_matches('\'')
}

#[test]
fn every_command_works_as_written() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("there is a README");
    let shell = Shell::new();
    let commands = commands(&text);
    assert!(commands.len() >= 14, "{commands:?}");
    // The first two are also run as they stand by `.ci/run`.
    assert!(commands[0].starts_with("cargo run --release -- scenes/"), "{}", commands[0]);
    assert_eq!(commands[1], "cargo test --workspace", "the second passes the tests");
    for command in commands {
        let command = command.replace("cargo run --release -- ", "portray ");
        if command == "cargo test --workspace" {
            continue;
        }
        shell.run(&command);
        if !command.starts_with("ishow ") {
            let output = shell.file(promised(&command));
            let written = output.exists() || output.with_extension("idf").exists();
            assert!(written, "{command} wrote {}", output.display());
        }
    }
}

#[test]
fn the_scene_in_the_readme_compiles() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("there is a README");
    let start = text.find("class bolt").expect("the scene is there");
    let end = start + text[start..].find("```").expect("it ends");
    let compiled = compile::compile_text(&text[start..end]);
    assert!(compiled.diagnostics.is_empty(), "{}", compiled.report());
    assert_eq!(compiled.scene.map(|scene| scene.objects.len()), Some(1), "one object");
}

#[test]
fn every_scene_compiles_and_is_listed() {
    let list = std::fs::read_to_string(root().join("scenes/README.md")).expect("there is a list");
    let mut scenes = 0;
    for folder in ["wine-glass", "gallery"] {
        for entry in std::fs::read_dir(root().join("scenes").join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_none_or(|ending| ending != "sdl") {
                continue;
            }
            let name = format!("{folder}/{}", path.file_name().unwrap().to_string_lossy());
            assert!(list.contains(&name), "{name} is listed in scenes/README.md");
            let compiled = compile::compile_path(&path);
            assert!(compiled.scene.is_some(), "{}", compiled.report());
            scenes += 1;
        }
    }
    assert!(scenes >= 4, "{scenes} scenes");
}
