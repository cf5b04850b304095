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
    assert!(said.contains("# pass 3") && said.contains("# fail 0"), "{said}");
}

#[test]
fn the_package_holds_what_the_editor_needs() {
    let Some(output) = output("npm", &["pack", "--dry-run", "--json"]) else { return };
    let said = succeeded(&output);
    let paths = said.split("\"path\": \"").skip(1).filter_map(|rest| rest.split('"').next());
    // What npm has installed there to run it by hand does not count.
    let packed: BTreeSet<&str> = paths.filter(|path| !path.starts_with("node_modules")).collect();
    let expected = BTreeSet::from([
        "README.md",
        "extension.js",
        "language-configuration.json",
        "package.json",
        "syntaxes/sdl.tmLanguage.json",
    ]);
    assert_eq!(packed, expected, "{said}");
}
