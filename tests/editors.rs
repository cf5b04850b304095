//! The extension for Visual Studio Code: what it does in an editor, and what goes into its package. Nothing is fetched.

use std::collections::BTreeSet;
use std::process::{Command, Output};

use crate::support::root;

/// What comes of a command in the folder of the extension, or nothing where the program is not installed.
fn output(program: &str, arguments: &[&str]) -> Option<Output> {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root().join("editors/vscode"));
    command.env("npm_config_update_notifier", "false").env("npm_config_offline", "true");
    let output = command.output();
    if output.is_err() {
        idf::command::print(&format!(
            "skipped: {program} is not installed to try editors/vscode\n"
        ));
    }
    output.ok()
}

fn succeeded(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}\n{errors}");
    said
}

#[test]
fn the_extension_starts_the_server() {
    let Some(output) = output("node", &["--test", "--test-reporter=tap"]) else { return };
    let said = succeeded(&output);
    assert!(said.contains("# pass 4") && said.contains("# fail 0"), "{said}");
}

#[test]
fn the_package_holds_what_the_editor_needs() {
    let folder = tempfile::tempdir().unwrap();
    let destination = folder.path().to_str().unwrap();
    let Some(output) = output("npm", &["pack", "--pack-destination", destination]) else { return };
    succeeded(&output);
    let name = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().file_name();
    assert_eq!(name, "sdl-0.1.0.tgz");
    let unpacked = Command::new("tar")
        .args(["-xzf", "sdl-0.1.0.tgz"])
        .current_dir(folder.path())
        .status()
        .unwrap();
    assert!(unpacked.success());
    let mut packed = BTreeSet::new();
    let mut folders = vec![folder.path().join("package")];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder.path().join("package")).unwrap();
            // What npm has installed there to run it by hand does not count.
            if path.is_dir() && name.to_str() != Some("node_modules") {
                folders.push(path);
            } else if path.is_file() {
                packed.insert(name.to_str().unwrap().to_owned());
            }
        }
    }
    let expected = [
        "README.md",
        "extension.js",
        "language-configuration.json",
        "package.json",
        "syntaxes/sdl.tmLanguage.json",
    ];
    assert_eq!(packed, expected.map(str::to_owned).into());
    for name in &packed {
        let [ours, theirs] =
            [root().join("editors/vscode").join(name), folder.path().join("package").join(name)]
                .map(|path| std::fs::read(path).unwrap());
        // npm writes its own line ends at the end of the manifest.
        assert!(ours.trim_ascii() == theirs.trim_ascii(), "{name} is packed as it is");
    }
}
