//! The rules of the repository that a machine can check.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::support::root;

/// Most lines of code in a file.
const CODE_LINES: usize = 500;
/// Most lines of code in a file that holds a `main`.
const MAIN_LINES: usize = 14;

/// Endings of the files that are written by hand.
const TEXTS: &[&str] =
    &["rs", "toml", "md", "sdl", "sh", "py", "yml", "yaml", "prc", "idf", "csv", "svg", "html"];

/// A manifest, as far as the rules ask: lines by section.
#[derive(Debug, Default)]
struct Manifest {
    sections: BTreeMap<String, Vec<(String, String)>>,
}

impl Manifest {
    fn parse(text: &str) -> Self {
        let mut manifest = Self::default();
        let mut section = String::new();
        for line in text.lines().map(str::trim) {
            if let Some(name) = line.strip_prefix('[') {
                section = name.trim_matches(['[', ']']).to_owned();
                // A dependency may have a section of its own.
                if let Some((table, name)) = section.rsplit_once("dependencies.") {
                    let table = format!("{table}dependencies");
                    manifest.sections.entry(table).or_default().push((name.into(), String::new()));
                }
            } else if let Some((key, value)) = line.split_once('=') {
                let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
                manifest.sections.entry(section.clone()).or_default().push((key, value));
            }
        }
        manifest
    }

    fn section(&self, name: &str) -> &[(String, String)] {
        self.sections.get(name).map_or(&[], Vec::as_slice)
    }

    fn name(&self) -> &str {
        let mut lines = self.section("package").iter();
        lines.find(|(key, _)| key == "name").unwrap().1.trim_matches('"')
    }

    /// Names and values of the dependencies that a user of the package builds.
    fn dependencies(&self) -> Vec<(&str, &str)> {
        let tables = self.sections.iter().filter(|(name, _)| {
            name.ends_with("dependencies") && !name.contains("dev-") && !name.contains("workspace")
        });
        tables
            .flat_map(|(_, lines)| lines)
            .map(|(key, value)| (key.split('.').next().unwrap_or(key), value.as_str()))
            .collect()
    }
}

/// What is wrong with the edges of a package at `folder` (`crates/idf`) when `suite` are the packages of the suite.
fn wrong_edges(folder: &str, manifest: &Manifest, suite: &BTreeMap<String, String>) -> Vec<String> {
    let name = manifest.name();
    let tool = folder.starts_with("tools/");
    let mut wrong = Vec::new();
    for (other, value) in manifest.dependencies() {
        let other_is_tool = suite.get(other).is_some_and(|place| place.starts_with("tools/"));
        let allowed = match (name, other) {
            ("compile", "scene") | ("render", "scene" | "idf") => true,
            ("compile" | "idf", "processor") => true,
            ("lsp", "compile" | "scene") => true,
            ("live", "scene") => true,
            ("render", "compile" | "live") | ("compile", "idf") => {
                value.contains("optional = true")
            }
            ("report", _) => {
                let used = ["render", "compile", "scene", "idf", "ilut", "iencode"];
                used.contains(&other)
                    || !suite.contains_key(other) && !["image", "exr"].contains(&other)
            }
            ("farm", _) => true,
            (_, "idf") => tool,
            (_, "image" | "exr") => name == "idf",
            _ if suite.contains_key(other) => tool && other_is_tool,
            _ => true,
        };
        if !allowed {
            wrong.push(format!("{name} depends on {other}"));
        }
    }
    let features = manifest.section("features").iter();
    // What only a program needs.
    let other = if name == "compile" { "dep:idf" } else { "compile" };
    let turning_on = features.filter(|(key, value)| key != "command" && value.contains(other));
    wrong.extend(turning_on.map(|(key, _)| format!("feature {key} of {name} turns {other} on")));
    wrong
}

/// Folders of the members of the workspace, as `crates/idf`, with their manifests.
fn members() -> Vec<(String, Manifest)> {
    let mut folders = vec!["tests".to_owned()];
    for group in ["crates", "tools"] {
        for entry in fs::read_dir(root().join(group)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            folders.push(format!("{group}/{name}"));
        }
    }
    folders.sort();
    let manifest = |folder: &String| {
        let path = root().join(folder).join("Cargo.toml");
        Manifest::parse(&fs::read_to_string(&path).unwrap())
    };
    folders.iter().map(|folder| (folder.clone(), manifest(folder))).collect()
}

/// Every hand-written file of the repository: its path from the root, and its text.
fn texts() -> Vec<(String, String)> {
    let (mut folders, mut found) = (vec![root()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                let built = name == "target" || path.join("CACHEDIR.TAG").exists();
                if !built && (!name.starts_with('.') || name == ".github" || name == ".ci") {
                    folders.push(path);
                }
            } else if is_text(&path) {
                let bytes = fs::read(&path).unwrap();
                let place = path.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
                found.push((place, String::from_utf8_lossy(&bytes).into_owned()));
            }
        }
    }
    found.sort();
    assert!(found.len() > 50, "the repository was found: {} files", found.len());
    found
}

fn is_text(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| TEXTS.contains(&ending)) || path.ends_with(".ci/run")
}

fn sources() -> impl Iterator<Item = (String, String)> {
    texts().into_iter().filter(|(path, _)| path.ends_with(".rs"))
}

/// Lines that are neither blank nor comment, up to the tests at the end of the file.
fn code_lines(text: &str) -> usize {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let tests = lines.windows(2).position(|pair| {
        pair[0] == "#[cfg(test)]" && pair[1].starts_with("mod ") && pair[1].ends_with('{')
    });
    let code = &lines[..tests.unwrap_or(lines.len())];
    code.iter().filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// A machine's own path in `text`.
fn machine_path(text: &str) -> Option<String> {
    let tops = ["work", "root", "home", "Users", "tmp"].map(|top| format!("/{top}/"));
    text.lines().find_map(|line| {
        let whole = |at: usize| {
            let before = line[..at].chars().next_back();
            // `crates/home/` and `https://x.org/home/` are no places on a machine.
            before.is_none_or(|c| !c.is_alphanumeric() && !".-_/~".contains(c))
        };
        let found = tops.iter().any(|top| line.match_indices(top).any(|(at, _)| whole(at)));
        found.then(|| line.trim().to_owned())
    })
}

fn none(what: &str, found: Vec<String>) {
    assert!(found.is_empty(), "{what}:\n{}", found.join("\n"));
}

#[test]
fn packages_depend_on_those_they_may() {
    let members = members();
    let suite: BTreeMap<String, String> = members
        .iter()
        .map(|(folder, manifest)| (manifest.name().to_owned(), folder.clone()))
        .collect();
    let known: Vec<&str> = suite.keys().map(String::as_str).collect();
    for name in ["idf", "scene", "compile", "render", "icopy"] {
        assert!(known.contains(&name), "{name} is among {known:?}");
    }
    let others = members.iter().filter(|(folder, _)| folder != "tests");
    let wrong = others.flat_map(|(folder, manifest)| wrong_edges(folder, manifest, &suite));
    none("edges that `ARCHITECTURE.md` does not have", wrong.collect());
}

#[test]
fn wrong_edges_are_seen() {
    let place = |name: &str, folder: &str| (name.to_owned(), folder.to_owned());
    let suite = BTreeMap::from([
        place("idf", "crates/idf"),
        place("scene", "crates/scene"),
        place("compile", "crates/compile"),
        place("render", "crates/render"),
        place("report", "crates/report"),
        place("processor", "crates/processor"),
        place("live", "crates/live"),
        place("icopy", "tools/icopy"),
        place("ilut", "tools/ilut"),
    ]);
    for (folder, name, lines, wrong) in [
        ("crates/idf", "idf", "[dependencies]\nlibm.workspace = true", 0),
        ("crates/idf", "idf", "[dependencies]\nscene.workspace = true", 1),
        ("crates/idf", "idf", "[dependencies]\nprocessor.workspace = true", 0),
        ("crates/scene", "scene", "[dependencies]\nprocessor.workspace = true", 1),
        ("crates/idf", "idf", "[dependencies.scene]\nworkspace = true", 1),
        ("crates/idf", "idf", "[build-dependencies]\nscene = \"1\"", 1),
        ("crates/idf", "idf", "[dev-dependencies]\nscene.workspace = true", 0),
        ("crates/scene", "scene", "[dependencies]\nidf.workspace = true", 1),
        ("crates/compile", "compile", "[dependencies]\nscene.workspace = true", 0),
        ("crates/compile", "compile", "[dependencies]\nrender.workspace = true", 1),
        ("crates/compile", "compile", "[dependencies]\nidf.workspace = true", 1),
        ("crates/compile", "compile", "[dependencies]\nidf = { optional = true }", 0),
        ("crates/compile", "compile", "[features]\ndefault = [\"dep:idf\"]", 1),
        ("crates/compile", "compile", "[features]\ncommand = [\"dep:idf\"]", 0),
        ("crates/render", "render", "[dependencies]\ncompile.workspace = true", 1),
        ("crates/render", "render", "[dependencies]\ncompile = { optional = true }", 0),
        ("crates/render", "render", "[features]\ndefault = [\"dep:compile\"]", 1),
        ("crates/render", "render", "[features]\ncommand = [\"dep:compile\"]", 0),
        ("crates/render", "render", "[dependencies]\nimage = \"1\"", 1),
        ("tools/icopy", "icopy", "[dependencies]\nidf = { features = [\"exchange\"] }", 0),
        ("tools/icopy", "icopy", "[dependencies]\nilut.workspace = true", 0),
        ("tools/icopy", "icopy", "[dependencies]\nrender.workspace = true", 1),
        ("tools/icopy", "icopy", "[dependencies]\nscene.workspace = true", 1),
        ("crates/report", "report", "[dependencies]\nrender.workspace = true", 0),
        ("crates/report", "report", "[dependencies]\nilut.workspace = true", 0),
        ("crates/report", "report", "[dependencies]\nicopy.workspace = true", 1),
        ("crates/report", "report", "[dependencies]\nimage = \"1\"", 1),
        ("crates/render", "render", "[dependencies]\nreport.workspace = true", 1),
        ("crates/render", "render", "[dependencies]\nlive.workspace = true", 1),
        ("crates/render", "render", "[dependencies]\nlive = { optional = true }", 0),
        ("crates/live", "live", "[dependencies]\nscene.workspace = true", 0),
        ("crates/live", "live", "[dependencies]\nrender.workspace = true", 1),
        ("crates/live", "live", "[dependencies]\nidf.workspace = true", 1),
    ] {
        let manifest = Manifest::parse(&format!("[package]\nname = \"{name}\"\n{lines}\n"));
        let found = wrong_edges(folder, &manifest, &suite);
        assert_eq!(found.len(), wrong, "{name}: {lines}: {found:?}");
    }
}

#[test]
fn packages_share_the_lints() {
    let strange = members().into_iter().filter(|(_, manifest)| {
        manifest.section("lints") != [("workspace".to_owned(), "true".to_owned())]
    });
    none("packages without the lints", strange.map(|(folder, _)| folder).collect());
}

#[test]
fn files_are_short_and_say_what_they_hold() {
    let mut long = Vec::new();
    for (path, text) in sources() {
        let is_main = path.ends_with("src/main.rs") || path.contains("/src/bin/");
        let limit = if is_main { MAIN_LINES } else { CODE_LINES };
        let lines = code_lines(&text);
        if lines > limit {
            long.push(format!("{path}: {lines} lines of code, at most {limit}"));
        }
        if !text.starts_with("//! ") {
            long.push(format!("{path}: does not begin with `//!`"));
        }
    }
    none("files", long);
}

#[test]
fn lines_of_code_are_counted() {
    let text = "//! A.\n\nuse a;\n// b\n/// c\nfn d() {\n}\n\n#[cfg(test)]\nmod tests {\n}\n";
    assert_eq!(code_lines(text), 3, "comments, blanks and tests do not count");
    let apart = "//! A.\n#[cfg(test)]\nmod tests;\nfn a() {}\n";
    assert_eq!(code_lines(apart), 3, "tests in a file of their own");
}

#[test]
fn command_lines_are_known_to_commands_alone() {
    let strange = sources().filter(|(path, text)| {
        let library = path.contains("/src/");
        let command = ["/command.rs", "/main.rs"].iter().any(|end| path.ends_with(end))
            || path.contains("/src/bin/");
        let word = |word: &str| {
            text.match_indices(word).any(|(at, _)| {
                let before = text[..at].chars().next_back();
                before.is_none_or(|c| !c.is_alphanumeric() && c != '_')
            })
        };
        library
            && !command
            && ["clap::", "clap_complete::", "clap_mangen::"].iter().any(|w| word(w))
    });
    none("files that know `clap`", strange.map(|(path, _)| path).collect());
    let compiler = sources().filter(|(path, text)| {
        path.starts_with("crates/render/src/")
            && !["command.rs", "/tests.rs"].iter().any(|end| path.ends_with(end))
            && text.contains("compile::")
    });
    none("files of the renderer that know the compiler", compiler.map(|(path, _)| path).collect());
}

#[test]
fn nothing_is_left_over() {
    // Put together here, so that this file does not hold what it looks for.
    let words: Vec<String> = [
        ("todo", "!"),
        ("unimplemented", "!"),
        ("#[ig", "nore"),
        ("allow(dead", "_code"),
        ("allow(un", "used"),
        ("thread::sl", "eep"),
        ("FIX", "ME"),
    ]
    .map(|(a, b)| format!("{a}{b}"))
    .into();
    let mut found = Vec::new();
    for (path, text) in sources() {
        found.extend(words.iter().filter(|w| text.contains(*w)).map(|w| format!("{path}: {w}")));
    }
    none("left-overs", found);
}

#[test]
fn no_file_names_a_place_on_a_machine() {
    for (text, expected) in [
        ("see /wor#k/x", true),
        ("`/ho#me/me/a.sdl`", true),
        ("cd /ro#ot/", true),
        ("crates/ho#me/x", false),
        ("https://x.org/ho#me/", false),
        ("../wor#k/", false),
    ] {
        let text = text.replace('#', "");
        assert_eq!(machine_path(&text).is_some(), expected, "{text}");
    }
    let found = texts().into_iter().filter_map(|(path, text)| {
        let line = machine_path(&text)?;
        Some(format!("{path}: {line}"))
    });
    none("files that name a machine's own paths", found.collect());
}

#[test]
fn every_scene_is_in_the_list() {
    let folder = root().join("scenes");
    let list = fs::read_to_string(folder.join("README.md")).expect("scenes/README.md lists scenes");
    let scenes: BTreeSet<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir() && has_scene(path))
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert!(scenes.contains("wine-glass"), "scenes were found: {scenes:?}");
    let missing = scenes.into_iter().filter(|name| !list.contains(name.as_str()));
    none("scenes that scenes/README.md does not list", missing.collect());
}

fn has_scene(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.any(|path| path.extension().is_some_and(|ending| ending == "sdl"))
}
