//! The real program: what it writes, what it says, and its exit status.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const GOOD: &str = "object is red sphere - block at (1, 1, 1)\ncamera at (0, 0, 5)\n";
const BAD: &str = "object is glas\nfog 0\n";

fn prcomp(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_prcomp"))
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A program that does not read its input may be gone already.
    child.stdin.take().unwrap().write_all(input.as_bytes()).ok();
    child.wait_with_output().unwrap()
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("good.sdl"), GOOD).unwrap();
    fs::write(folder.path().join("bad.sdl"), BAD).unwrap();
    folder
}

fn says(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_scene_is_written_beside_its_description() {
    let folder = folder();
    let output = prcomp(folder.path(), &["good.sdl"], "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
    let written = fs::read(folder.path().join("good.prc")).unwrap();
    let scene = scene::format::read(&written).unwrap();
    assert_eq!(scene.objects.len(), 1);

    for arguments in [["good.sdl", "-o", "-"], ["-", "-o", "-"]] {
        let output = prcomp(folder.path(), &arguments, GOOD);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(output.stdout == written, "the same bytes on standard output: {arguments:?}");
    }
    let output = prcomp(folder.path(), &["-"], GOOD);
    assert!(output.stdout == written, "standard input goes to standard output");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "no other files");
}

#[test]
fn errors_leave_the_output_untouched() {
    let folder = folder();
    fs::write(folder.path().join("out.prc"), "before").unwrap();
    let output = prcomp(folder.path(), &["bad.sdl", "-o", "out.prc"], "");
    assert_eq!(output.status.code(), Some(1));
    let expected = "\
bad.sdl:1:11: error: unknown class `glas`
1 | object is glas
  |           ^^^^
bad.sdl:2:5: error: the half distance of fog has to be above 0, found 0
2 | fog 0
  |     ^
prcomp: error: `bad.sdl` has 2 errors
";
    assert_eq!(says(&output), expected);
    assert_eq!(fs::read_to_string(folder.path().join("out.prc")).unwrap(), "before");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "no temporary files");
}

#[test]
fn a_missing_file_is_named() {
    let folder = folder();
    let output = prcomp(folder.path(), &["none.sdl"], "");
    assert_eq!(output.status.code(), Some(1));
    let said = says(&output);
    assert!(said.starts_with("prcomp: error: cannot read `none.sdl`: No such file"), "{said}");
    assert_eq!(said.lines().count(), 1, "one line: {said}");

    let output = prcomp(folder.path(), &["good.sdl", "-o", "none/out.prc"], "");
    assert_eq!(output.status.code(), Some(1));
    let said = says(&output);
    assert!(said.starts_with("prcomp: error: cannot write `none/out.prc`: No such file"), "{said}");
}

#[test]
fn a_picture_that_cannot_be_shown_is_an_error_of_its_statement() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("torn.png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0").unwrap();
    fs::write(at("a.txt"), "no picture").unwrap();
    let text = "object is paint image (\"torn.png\") sphere\n\
                object is paint bump (decal (\"a.txt\")) paint image (\"torn.png\") block\n";
    fs::write(at("torn.sdl"), text).unwrap();
    let output = prcomp(folder.path(), &["torn.sdl"], "");
    assert_eq!(output.status.code(), Some(1));
    let said = says(&output);
    for part in [
        "torn.sdl:1:24: error: cannot show the picture: cannot decode `torn.png`: ",
        "\n1 | object is paint image (\"torn.png\") sphere\n  |                        ^^^^^^^^^^\n",
        "torn.sdl:2:30: error: cannot show the picture: a.txt: ",
        "torn.sdl:2:53: error: cannot show the picture: cannot decode `torn.png`: ",
        "prcomp: error: `torn.sdl` has 3 errors\n",
    ] {
        assert!(said.contains(part), "{part}\n{said}");
    }
    assert!(!at("torn.prc").exists(), "nothing is written");
}

#[test]
fn wrong_command_lines_have_status_2() {
    let folder = folder();
    for arguments in [
        &[][..],
        &["good.sdl", "--nonsense"],
        &["good.sdl", "-q", "-v"],
        &["good.sdl", "--format", "--explain"],
        &["good.sdl", "--format", "--keep-all"],
        &["good.sdl", "--check", "-o", "x.prc"],
        &["good.sdl", "-o", "good.sdl"],
        &["good.sdl", "--max-primitives", "many"],
        &["good.sdl", "-D", "n"],
        &["good.sdl", "-D", "2n=1"],
        &["good.sdl", "-D", "n=red"],
        &["good.sdl", "-D", "n=1e999"],
    ] {
        let output = prcomp(folder.path(), arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(says(&output).starts_with("prcomp: "), "{arguments:?}: {}", says(&output));
    }
    assert_eq!(fs::read_to_string(folder.path().join("good.sdl")).unwrap(), GOOD, "untouched");
}

#[test]
fn check_writes_nothing() {
    let folder = folder();
    let output = prcomp(folder.path(), &["--check", "good.sdl"], "");
    assert_eq!(output.status.code(), Some(0));
    assert!(!folder.path().join("good.prc").exists(), "no output");
    assert!(output.stdout.is_empty(), "nothing on standard output");
    assert_eq!(prcomp(folder.path(), &["--check", "bad.sdl"], "").status.code(), Some(1));
}

#[test]
fn quiet_and_verbose() {
    let folder = folder();
    let warned = "object is (sphere\n";
    let said = says(&prcomp(folder.path(), &["-", "--check"], warned));
    assert!(said.starts_with("standard input:1:11: warning: this parenthesis"), "{said}");
    let said = says(&prcomp(folder.path(), &["-", "--check", "-q"], warned));
    assert_eq!(said, "", "no warnings");
    let said = says(&prcomp(folder.path(), &["-q", "--check", "bad.sdl"], ""));
    assert!(said.contains("unknown class"), "errors all the same: {said}");
    let said = says(&prcomp(folder.path(), &["-v", "--check", "good.sdl"], ""));
    let expected =
        "good.sdl: files 1, classes 0, objects 1, primitives and instances 2, lights 0\n";
    assert_eq!(said, expected);
}

#[test]
fn json_is_one_object_a_line() {
    let folder = folder();
    let json = ["--message-format", "json"];
    let said = says(&prcomp(folder.path(), &[&json[..], &["bad.sdl"]].concat(), ""));
    let expected = r#"{"severity":"error","message":"unknown class `glas`","file":"bad.sdl","line":1,"column":11,"end_line":1,"end_column":15,"notes":[]}
{"severity":"error","message":"the half distance of fog has to be above 0, found 0","file":"bad.sdl","line":2,"column":5,"end_line":2,"end_column":6,"notes":[]}
"#;
    assert_eq!(said, expected);
    let said = says(&prcomp(folder.path(), &[&json[..], &["none.sdl"]].concat(), ""));
    assert!(said.starts_with(r#"{"severity":"error","message":"cannot read `none.sdl`"#), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn json_carries_hints_and_notes() {
    let folder = folder();
    let parts = "class wheel (r) is\n  cylinder scale (r, 1 / r, 1)\n";
    fs::write(folder.path().join("parts.sdl"), parts).unwrap();
    let text = "include \"parts.sdl\"\nclass a is sphere\nclass a is block\nobject is wheel (0)\nobject is smoth sphere\n";
    fs::write(folder.path().join("notes.sdl"), text).unwrap();
    let output = prcomp(folder.path(), &["--message-format", "json", "notes.sdl"], "");
    assert_eq!(output.status.code(), Some(1));
    let expected = r#"{"severity":"error","message":"there is a class `a` already","file":"notes.sdl","line":3,"column":7,"end_line":3,"end_column":8,"notes":[{"message":"first named here","file":"notes.sdl","line":2,"column":7,"end_line":2,"end_column":8}]}
{"severity":"error","message":"expected an attribute or a solid, found `smoth`","file":"notes.sdl","line":5,"column":11,"end_line":5,"end_column":16,"hint":"did you mean `smooth`?","notes":[]}
{"severity":"error","message":"a scale of 0 leaves nothing of a solid","file":"parts.sdl","line":2,"column":18,"end_line":2,"end_column":31,"hint":"a scale may be small, and negative to mirror","notes":[{"message":"in this use of `wheel`","file":"notes.sdl","line":4,"column":11,"end_line":4,"end_column":20}]}
{"severity":"error","message":"division by 0","file":"parts.sdl","line":2,"column":26,"end_line":2,"end_column":27,"hint":"the number below the line has to differ from 0","notes":[{"message":"in this use of `wheel`","file":"notes.sdl","line":4,"column":11,"end_line":4,"end_column":20}]}
"#;
    assert_eq!(says(&output), expected);
}

#[test]
fn the_form_of_the_paper_is_printed() {
    let folder = folder();
    let output = prcomp(folder.path(), &["--paper", "good.sdl"], "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("portray expanded 1\n"), "{text}");
    assert!(!folder.path().join("good.prc").exists(), "to standard output");
    let output = prcomp(folder.path(), &["--paper", "--max-primitives", "1", "good.sdl"], "");
    assert_eq!(output.status.code(), Some(1), "two are more than one");
    assert!(says(&output).contains("more than 1"), "{}", says(&output));
}

#[test]
fn numbers_are_given_from_outside() {
    let folder = folder();
    let text = "let n = 2 object is sphere scale n at (frame, 0, 0)";
    let written = |arguments: &[&str]| {
        let output = prcomp(folder.path(), &[&["-"], arguments].concat(), text);
        assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().find(|line| line.contains("sphere")).unwrap().trim().to_owned()
    };
    assert_eq!(written(&[]), "sphere scale 2.0 2.0 2.0");
    assert_eq!(written(&["-D", "N=-0.5"]), "sphere scale -0.5 -0.5 -0.5");
    let both = written(&["-D", "n=3", "-Dframe=7"]);
    assert_eq!(both, "sphere scale 3.0 3.0 3.0 at 7.0 0.0 0.0");
    let output = prcomp(folder.path(), &["-", "-D", "m=1"], text);
    assert_eq!(output.status.code(), Some(1), "no such number");
    let expected = "error: -D m: the scene has no `let m`
hint: -D gives the number of a `let` another value
prcomp: error: standard input has an error
";
    assert_eq!(says(&output), expected);
    let long = prcomp(folder.path(), &["-", "-D", "lenght=1"], "let length_ = 2");
    assert!(says(&long).contains("did you mean `length_`?"), "{}", says(&long));
}

#[test]
fn what_repeats_make_is_limited() {
    let folder = folder();
    let text = "repeat i from 1 to 100 { object is sphere at (i, 0, 0) + block }";
    let output = prcomp(folder.path(), &["-", "--check", "--max-primitives", "200"], text);
    assert_eq!(output.status.code(), Some(0), "{}", says(&output));
    let output = prcomp(folder.path(), &["-", "--check", "--max-primitives", "199"], text);
    assert_eq!(output.status.code(), Some(1));
    assert!(says(&output).contains("at most 199 solids"), "{}", says(&output));
    let output = prcomp(folder.path(), &["-", "--check", "--max-primitives", "99"], text);
    assert!(says(&output).contains("expected at most 99 turns, found 100"), "{}", says(&output));
}

#[test]
fn what_no_object_comes_to_is_left_out() {
    let folder = folder();
    let text = "class lone is red cone  class used is sphere  object is used";
    let compiled = |arguments: &[&str]| {
        let output = prcomp(folder.path(), &[&["-", "-q"], arguments].concat(), text);
        assert_eq!(output.status.code(), Some(0), "{}", says(&output));
        (String::from_utf8(output.stdout.clone()).unwrap(), says(&output))
    };
    let (left, said) = compiled(&[]);
    assert!(said.is_empty() && left.contains("used") && !left.contains("lone"), "{left}");
    let (kept, said) = compiled(&["--keep-all"]);
    assert!(said.is_empty() && kept.contains("used") && kept.contains("lone"), "{kept}");
    let rows = "pass           before    after
classes             2        1  no object is made of them
attributes          2        1  they are said of no solid that is left
pictures            0        0  no paint that is left shows them
";
    assert_eq!(compiled(&["--explain"]), (left, rows.to_owned()));
    let all = format!("{rows}all of it is kept: --keep-all\n");
    assert_eq!(compiled(&["--explain", "--keep-all"]), (kept, all));
    assert_eq!(compiled(&["--explain", "--check"]), (String::new(), rows.to_owned()));
}

#[test]
fn a_compiled_scene_is_no_description() {
    let folder = folder();
    prcomp(folder.path(), &["good.sdl"], "");
    let output = prcomp(folder.path(), &["good.prc", "-o", "x.prc"], "");
    assert_eq!(output.status.code(), Some(1));
    let expected = "\
good.prc:1:1: error: expected a scene description, found a compiled scene
1 | portray scene 2
  | ^^^^^^^^^^^^^
hint: portray renders it as it is; prcomp reads the .sdl file it was made from
prcomp: error: `good.prc` has an error
";
    assert_eq!(says(&output), expected);
}

#[test]
fn help_version_and_packaging() {
    let folder = folder();
    for (arguments, part) in [
        (&["--help"][..], "Example: prcomp wine-glass.sdl"),
        (&["--version"], concat!("prcomp ", env!("CARGO_PKG_VERSION"))),
        (&["--man"], ".TH prcomp 1"),
        (&["--completions", "bash"], "_prcomp"),
    ] {
        let output = prcomp(folder.path(), arguments, "");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(part), "{arguments:?}: {text}");
    }
}

#[test]
fn a_description_is_laid_out_in_place() {
    let folder = folder();
    let laid = "object is red sphere - block at (1, 1, 1)\ncamera at (0, 0, 5)\n";
    let loose = "object is red sphere-block at(1,1,1) camera at(0,0,5)";
    fs::write(folder.path().join("loose.sdl"), loose).unwrap();
    let run = |arguments: &[&str], input: &str| {
        let output = prcomp(folder.path(), &[&["--format"], arguments].concat(), input);
        (output.status.code(), String::from_utf8(output.stdout.clone()).unwrap(), says(&output))
    };
    let done = |out: &str| (Some(0), out.to_owned(), String::new());
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(run(&["-"], loose), done(laid), "standard input to standard output");
    assert_eq!(run(&["loose.sdl", "-o", "-"], ""), done(laid));
    assert_eq!(run(&["loose.sdl", "-o", "other.sdl"], ""), done(""));
    assert_eq!((read("other.sdl").as_str(), read("loose.sdl").as_str()), (laid, loose));
    let (status, _, said) = run(&["--check", "loose.sdl"], "");
    let expected = "prcomp: error: the layout of `loose.sdl` would change\n";
    assert_eq!((status, said.as_str()), (Some(1), expected));
    assert_eq!(run(&["loose.sdl"], ""), done(""));
    assert_eq!(read("loose.sdl"), laid, "in place");
    assert_eq!(run(&["--check", "loose.sdl"], ""), done(""));
    assert_eq!(run(&["loose.sdl", "--paper"], "").0, Some(2));

    // What means nothing keeps its tokens; what is not made of tokens is left alone.
    assert_eq!(run(&["bad.sdl"], ""), done(""));
    assert_eq!(read("bad.sdl"), BAD);
    fs::write(folder.path().join("odd.sdl"), "fog  $ 1").unwrap();
    let (status, _, said) = run(&["odd.sdl"], "");
    assert_eq!(status, Some(1));
    assert!(said.starts_with("odd.sdl:1:6: error: unexpected character `$`"), "{said}");
    assert!(said.ends_with("prcomp: error: `odd.sdl` has an error\n"), "{said}");
    assert_eq!(read("odd.sdl"), "fog  $ 1");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5, "no temporary files");
}

#[cfg(unix)]
#[test]
fn layout_in_place_keeps_links_and_permissions() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder();
    let (file, link) = (folder.path().join("good.sdl"), folder.path().join("link.sdl"));
    fs::write(&file, "fog  1").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("good.sdl", &link).unwrap();
    assert_eq!(prcomp(folder.path(), &["--format", "link.sdl"], "").status.code(), Some(0));
    assert_eq!(fs::read_to_string(&file).unwrap(), "fog 1\n");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink(), "still a link");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn what_is_no_statement_is_not_laid_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("half.sdl");
    let half = "object is\ncamera at (0,0,50)\n";
    fs::write(&path, half).unwrap();
    let output = prcomp(folder.path(), &["--format", "half.sdl"], "");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("half.sdl:2:1: error: expected a solid"), "{said}");
    assert_eq!(fs::read_to_string(&path).unwrap(), half, "it is as it was");
    // A class of another file, and a number out of its range, do not matter.
    let output = prcomp(folder.path(), &["--format", "-"], "object  is wheel (3)  fog  0");
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        "object is wheel (3)\nfog 0\n",
        "laid out"
    );
}
