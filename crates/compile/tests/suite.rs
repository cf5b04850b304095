//! Annotated scenes: the expected diagnostics stand in comments above the offending line.
//!
//! A comment `error 9-13: message` expects an error from column 9 up to column 13 of the next line that is no
//! such comment; a hint follows the message after `; `. Nothing else may be reported.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use compile::{Compiled, Severity, compile_path};

fn data(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder);
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty(), "there are scenes");
    files
}

/// What is reported, a line each: file, line, `severity from-to: message`, and the hint.
fn found(compiled: &Compiled) -> Vec<(String, String)> {
    let lines = compiled.diagnostics.iter().map(|diagnostic| {
        let span = diagnostic.span.unwrap();
        let start = compiled.sources.locate(span).unwrap();
        let end = compiled.sources.locate_end(span).unwrap();
        let place = format!(
            "{}:{}: {} {}-{}: {}",
            start.path.file_name().unwrap().display(),
            start.line,
            diagnostic.severity,
            start.column,
            end.column,
            diagnostic.message.replace(&format!("{}/", start.path.parent().unwrap().display()), "")
        );
        (place, diagnostic.hint.clone().unwrap_or_default())
    });
    lines.collect()
}

fn expected(compiled: &Compiled) -> BTreeSet<String> {
    let mut expected = BTreeSet::new();
    for path in compiled.sources.paths() {
        let name = path.file_name().unwrap().display().to_string();
        let text = fs::read_to_string(path).unwrap();
        let mut waiting = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            match line.trim().strip_prefix("// ") {
                Some(note) if note.starts_with("error ") || note.starts_with("warning ") => {
                    waiting.push(note.to_owned());
                }
                _ => {
                    expected
                        .extend(waiting.drain(..).map(|note| format!("{name}:{number}: {note}")));
                }
            }
        }
        assert!(waiting.is_empty(), "{name}: annotations without a line");
    }
    expected
}

fn check(path: &Path, compiled: &Compiled) {
    let expected = expected(compiled);
    let found = found(compiled);
    let mut met = BTreeSet::new();
    for (message, hint) in &found {
        let full = format!("{message}; {hint}");
        let line = [message, &full].into_iter().find(|line| expected.contains(*line));
        assert!(line.is_some(), "{}: not expected:\n{full}", path.display());
        assert!(met.insert(line.unwrap().clone()), "{}: twice: {full}", path.display());
    }
    let missing: Vec<&String> = expected.difference(&met).collect();
    assert!(missing.is_empty(), "{}: not reported: {missing:#?}\n{found:#?}", path.display());
}

#[test]
fn accepted_scenes_compile_and_are_well_formed() {
    for path in data("accepted") {
        let compiled = compile_path(&path);
        check(&path, &compiled);
        let scene = compiled.scene.unwrap();
        let mut text = Vec::new();
        scene::format::write(&scene, &mut text).unwrap();
        let read = scene::format::read(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert!(read == scene, "{}: written and read again", path.display());
    }
}

#[test]
fn rejected_scenes_say_why() {
    for path in data("rejected") {
        let compiled = compile_path(&path);
        check(&path, &compiled);
        assert!(compiled.scene.is_none(), "{}: no scene", path.display());
        let errors = compiled.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        assert!(errors.count() > 0, "{}: an error", path.display());
        let spans: Vec<_> = compiled.diagnostics.iter().map(|d| d.span).collect();
        assert!(spans.is_sorted(), "{}: in source order", path.display());
    }
}
