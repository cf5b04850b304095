//! The page of `--watch` in a browser: `person.mjs` does what a person would.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// The first of some programs that is there.
fn found(names: &[&'static str]) -> Option<&'static str> {
    let runs = |name: &&&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    names.iter().find(runs).copied()
}

#[test]
#[expect(clippy::print_stderr, reason = "who reads the log should know what was not tried")]
fn a_person_edits_a_scene_beside_the_page() {
    let browser = found(&["chromium", "chromium-browser", "google-chrome"]);
    let (Some(browser), Some(node)) = (browser, found(&["node"])) else {
        eprintln!("skipped: this test takes Chromium and Node.js");
        return;
    };
    let folder = TempDir::new().expect("a folder");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/person.mjs");
    let output = Command::new(node)
        .arg(script)
        .args([browser, env!("CARGO_BIN_EXE_portray")])
        .arg(folder.path())
        .output()
        .expect("node runs");
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}\n{}", said(&output.stdout), said(&output.stderr));
    assert!(said(&output.stdout).contains("ok: nothing went wrong on the page"), "to its end");
}
