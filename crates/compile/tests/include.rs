//! Files that include files: what is read, and what is said when it cannot be.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::fs;
use std::path::Path;

use compile::{Compiled, compile_path};
use tempfile::TempDir;

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn compile(folder: &TempDir) -> (Compiled, String) {
    let compiled = compile_path(&folder.path().join("main.sdl"));
    let report = compiled.report().replace(&format!("{}/", folder.path().display()), "");
    (compiled, report)
}

#[test]
fn paths_are_relative_to_the_file_that_names_them() {
    let folder = folder(&[
        ("main.sdl", "include \"a/b.sdl\" object is ball"),
        ("a/b.sdl", "include \"../c.sdl\""),
        ("c.sdl", "class ball is sphere"),
    ]);
    let (compiled, report) = compile(&folder);
    assert_eq!(report, "");
    assert_eq!(compiled.scene.unwrap().objects.len(), 1);
    let names: Vec<_> =
        compiled.sources.paths().map(|p| p.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["main.sdl", "b.sdl", "c.sdl"], "the files read");
}

#[test]
fn a_file_may_be_included_twice() {
    let folder = folder(&[
        ("main.sdl", "include \"ball.sdl\" include \"./ball.sdl\""),
        ("ball.sdl", "object is sphere"),
    ]);
    let (compiled, report) = compile(&folder);
    assert!(report.contains("warning: this object stands where an equal one stands"), "{report}");
    assert_eq!(compiled.scene.unwrap().objects.len(), 2, "one for each time");
    assert_eq!(compiled.sources.paths().count(), 2, "read once");
}

#[test]
fn errors_in_included_files_are_shown_there() {
    let folder = folder(&[
        ("main.sdl", "\n\ninclude \"a.sdl\"\nfocal length 0"),
        ("a.sdl", "// ä\nobject is\n  blokk\nfog -1"),
    ]);
    let expected = "\
main.sdl:4:14: error: the focal length has to be above 0, found 0
4 | focal length 0
  |              ^
a.sdl:3:3: error: unknown class `blokk`
3 |   blokk
  |   ^^^^^
hint: did you mean `block`?
a.sdl:4:5: error: the half distance of fog has to be above 0, found -1
4 | fog -1
  |     ^^
";
    assert_eq!(compile(&folder).1, expected);
}

#[test]
fn missing_files_name_the_chain() {
    let folder = folder(&[
        ("main.sdl", "include \"a.sdl\"\nobject is from_there"),
        ("a.sdl", "object is sphere  include \"b.sdl\""),
    ]);
    let (compiled, report) = compile(&folder);
    assert!(compiled.scene.is_none(), "no scene");
    let expected = "\
a.sdl:1:27: error: cannot read `b.sdl`: No such file or directory (os error 2)
1 | object is sphere  include \"b.sdl\"
  |                           ^^^^^^^
main.sdl:1:9: note: included from here
1 | include \"a.sdl\"
  |         ^^^^^^^
";
    // That `from_there` is unknown follows from this.
    assert_eq!(report, expected);
}

#[test]
fn cycles_name_the_chain() {
    let folder = folder(&[
        ("main.sdl", "include \"a.sdl\""),
        ("a.sdl", "include \"b.sdl\""),
        ("b.sdl", "object is sphere\ninclude \"a.sdl\""),
    ]);
    let (_, report) = compile(&folder);
    let first = report.lines().next().unwrap();
    assert_eq!(
        first,
        "b.sdl:2:9: error: a file cannot include itself: `a.sdl` includes `b.sdl` includes `a.sdl`"
    );
    assert!(report.contains("main.sdl:1:9: note: included from here"), "{report}");
}

#[test]
fn folders_and_devices_are_not_included() {
    let folder = folder(&[("main.sdl", "include \".\" include \"/dev/zero\"")]);
    let (_, report) = compile(&folder);
    assert_eq!(report.matches("expected a file").count(), 2, "{report}");
}

#[test]
fn a_missing_main_file_is_a_diagnostic() {
    let compiled = compile_path(Path::new("no such folder/main.sdl"));
    assert!(compiled.scene.is_none(), "no scene");
    assert!(
        compiled.report().starts_with("error: cannot read `no such folder/main.sdl`: "),
        "{}",
        compiled.report()
    );
}

#[test]
fn inclusions_that_multiply_end() {
    let mut files = vec![("main.sdl".to_owned(), "include \"f0.sdl\"".to_owned())];
    for i in 0..40 {
        let line = format!("include \"f{}.sdl\" ", i + 1);
        files.push((format!("f{i}.sdl"), line.repeat(50_000)));
    }
    files.push(("f40.sdl".to_owned(), String::new()));
    let files: Vec<(&str, &str)> = files.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    let folder = folder(&files);
    let (compiled, report) = compile(&folder);
    assert!(compiled.scene.is_none(), "no scene");
    assert!(report.contains("more than 100000 inclusions"), "{report}");
}

#[test]
fn classes_with_parameters_of_another_file_see_what_stands_there() {
    let files = [
        (
            "main.sdl",
            "include \"parts.sdl\"\nobject is wheel (2)\nrepeat size from 3 to 3 {\n  object is wheel (0)\n}",
        ),
        ("parts.sdl", "let size = 4\nclass wheel (r) is\n  cylinder scale (size / r, r + 1, 1)"),
    ];
    let (compiled, report) = compile(&folder(&files));
    assert!(compiled.scene.is_none(), "no scene");
    let expected = "\
parts.sdl:3:26: error: division by 0
3 |   cylinder scale (size / r, r + 1, 1)
  |                          ^
main.sdl:4:13: note: in this use of `wheel`
4 |   object is wheel (0)
  |             ^^^^^^^^^
main.sdl:3:8: note: in the turn with size = 3
3 | repeat size from 3 to 3 {
  |        ^^^^
hint: the number below the line has to differ from 0
";
    assert_eq!(report, expected);
    let right = files.map(|(name, text)| (name, text.replace("wheel (0)", "wheel (1)")));
    let right = right.each_ref().map(|(name, text)| (*name, text.as_str()));
    let scene = compile(&folder(&right)).0.scene.unwrap();
    let scales: Vec<f64> =
        scene.classes.iter().map(|class| class.solid.frames[0].placement.scale.x).collect();
    assert_eq!(scales, [2.0, 4.0], "4 / 2 and 4 / 1, not 3 / 1");
}

#[test]
fn a_file_name_as_long_as_a_file_is_cut() {
    let text = format!("include \"a{}z\"", "é".repeat(1_000_000));
    let report = compile::compile_text(&text).report();
    assert!(report.len() < 2_000, "{} bytes", report.len());
    assert!(report.contains("cannot read `aé") && report.contains("éz`: "), "{report}");
}
