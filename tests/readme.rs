//! Every command of the README does what it says: each is run, and each file it promises is there.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ has a parent").to_path_buf()
}

/// The lines of all `sh` blocks of a text.
fn commands(text: &str) -> Vec<&str> {
    let mut commands = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if let Some(language) = line.strip_prefix("```") {
            inside = language == "sh";
        } else if inside {
            commands.push(line);
        }
    }
    commands
}

/// A command's words: what is in the repository is named from its root, all other files lie in `folder`.
fn words(command: &str, folder: &Path) -> Vec<OsString> {
    let mut words = Vec::new();
    for (i, word) in command.split_whitespace().enumerate() {
        let repository = word.starts_with("scenes/");
        let number = word.starts_with(|c: char| c.is_ascii_digit());
        words.push(if i == 0 || word.starts_with('-') || number {
            word.into()
        } else if repository {
            root().join(word).into()
        } else {
            folder.join(word).into()
        });
    }
    words
}

/// Runs one command in this process; false if it fails.
fn run(words: &[OsString]) -> bool {
    match words[0].to_str() {
        Some("portray") => {
            let arguments = render::command::Arguments::try_parse_from(words).expect("arguments");
            render::command::run(&arguments).is_ok()
        }
        Some("icopy") => {
            let arguments = icopy::command::Arguments::try_parse_from(words).expect("arguments");
            icopy::command::run(&arguments).is_ok()
        }
        Some("prcomp") => {
            let status = compile::command::run(words.iter().cloned());
            format!("{status:?}") == format!("{:?}", ExitCode::SUCCESS)
        }
        other => panic!("no test knows how to run {other:?}"),
    }
}

#[test]
fn every_command_works_as_written() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("there is a README");
    let folder = tempfile::tempdir().expect("a folder can be made");
    let commands = commands(&text);
    assert!(commands.len() >= 9, "{commands:?}");
    // The first two are also run as they stand by `.ci/run`.
    assert!(commands[0].starts_with("cargo run --release -- scenes/"), "{}", commands[0]);
    assert_eq!(commands[1], "cargo test --workspace", "the second passes the tests");
    for command in commands {
        let command = command.replace("cargo run --release -- ", "portray ");
        if command == "cargo test --workspace" {
            continue;
        }
        let words = words(&command, folder.path());
        assert!(run(&words), "{command}");
        let output = words.iter().position(|word| word == "-o").map_or(2, |at| at + 1);
        let output = PathBuf::from(&words[output]);
        let written = output.exists() || output.with_extension("idf").exists();
        assert!(written, "{command} wrote {}", output.display());
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
