//! The pages of `docs/tasks`: each begins in an empty folder, its texts are saved, and its commands are run as they stand.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::collections::BTreeSet;
use std::fs;

use crate::shell::Shell;
use crate::support::root;

/// How commands begin that other tests run, or that fetch something; and which those are.
const ELSEWHERE: &[(&str, &str)] = &[
    ("cargo install --path ", "scripts/test-install.sh"),
    ("npm install", "needs a registry"),
    ("npm run package", "needs a registry; tests/editors.rs looks at what is packed"),
    ("code ", "needs an editor"),
    ("portray --watch ", "goes on until it is ended; crates/render/tests/browser"),
    ("pip install ", "scripts/test-python.sh"),
    ("maturin build ", "scripts/test-python.sh"),
];

/// A block of a page.
#[derive(Debug)]
struct Block<'a> {
    /// The last line of text before it.
    before: &'a str,
    language: &'a str,
    lines: Vec<&'a str>,
}

fn blocks(text: &str) -> Vec<Block<'_>> {
    let (mut blocks, mut before) = (Vec::new(), "");
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let lines = lines.by_ref().take_while(|line| *line != "```").collect();
            blocks.push(Block { before, language, lines });
        } else if !line.is_empty() {
            before = line;
        }
    }
    blocks
}

/// The name of the file that a block is: the last word in quotes before it that is one.
fn file_name<'a>(block: &Block<'a>) -> Option<&'a str> {
    block.before.split('`').skip(1).step_by(2).filter(|word| word.ends_with(".sdl")).last()
}

/// Whether a command is run here; the programs of the installation are there already.
fn is_run(command: &str) -> bool {
    ELSEWHERE.iter().all(|(begin, _)| !command.starts_with(begin))
}

/// Runs a page. Returns how many commands it has.
fn run(name: &str, text: &str) -> usize {
    let shell = Shell::new();
    let mut commands = 0;
    for block in blocks(text) {
        match block.language {
            "sdl" => {
                let file =
                    file_name(&block).unwrap_or_else(|| panic!("{name}: a scene has a name"));
                fs::write(shell.file(file), block.lines.join("\n") + "\n").unwrap();
            }
            "sh" => {
                for command in block.lines {
                    commands += 1;
                    if is_run(command) {
                        shell.run(command);
                        check_promise(&shell, command);
                    }
                }
            }
            "python" => assert_eq!(name, "python.md", "python/tests runs the page of Python alone"),
            other => panic!("{name}: a block of {other:?}"),
        }
    }
    commands
}

/// The file that a command promises by -o is there.
fn check_promise(shell: &Shell, command: &str) {
    let mut words = command.split_whitespace().skip_while(|word| *word != "-o").skip(1);
    let Some(output) = words.next() else { return };
    let file = shell.file(output);
    let numbered = command.contains("--frames");
    assert!(numbered || file.exists() || file.with_extension("idf").exists(), "{command}");
}

fn page(name: &str) {
    let text = fs::read_to_string(root().join("docs/tasks").join(name)).unwrap();
    assert!(text.starts_with("# I want to "), "{name}");
    let commands = run(name, &text);
    assert!(commands >= 2, "{name} has {commands} commands");
    for link in text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next()) {
        let there = link.starts_with("http") || root().join("docs/tasks").join(link).exists();
        assert!(there, "{name}: {link} is there");
    }
}

macro_rules! pages {
    ($($test:ident $name:literal;)*) => {
        /// All pages. A new one is a new row.
        const PAGES: &[&str] = &[$($name),*];

        $(#[test]
        fn $test() {
            page($name);
        })*
    };
}

pages! {
    a_film "animation.md";
    channels "channels.md";
    comparing "compare.md";
    converting "convert.md";
    an_editor "editor.md";
    installing "install.md";
    live "live.md";
    a_matte "matte.md";
    habits_of_openscad "openscad.md";
    a_palette "palette.md";
    parts "parts.md";
    a_picture "picture.md";
    habits "pov-ray.md";
    python "python.md";
    quality "quality.md";
    a_texture "texture.md";
    tones "tones.md";
    a_turntable "turntable.md";
}

#[test]
fn the_index_has_every_page_and_no_other() {
    let index = fs::read_to_string(root().join("docs/tasks.md")).unwrap();
    let links = index.split("](tasks/").skip(1).filter_map(|rest| rest.split(')').next());
    let linked: BTreeSet<String> = links.map(str::to_owned).collect();
    let entries = fs::read_dir(root().join("docs/tasks")).unwrap();
    let there: BTreeSet<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    let tested: BTreeSet<String> = PAGES.iter().map(|&page| page.to_owned()).collect();
    assert_eq!(linked, there);
    assert_eq!(tested, there);
}

#[test]
fn every_program_is_installed_by_a_command_of_the_page() {
    let text = fs::read_to_string(root().join("docs/tasks/install.md")).unwrap();
    let folders: BTreeSet<&str> =
        text.lines().filter_map(|line| line.strip_prefix("cargo install --path ")).collect();
    let mut programs = BTreeSet::new();
    for group in ["crates", "tools"] {
        for entry in fs::read_dir(root().join(group)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let source = root().join(group).join(&name).join("src");
            if source.join("main.rs").exists() || source.join("bin").exists() {
                programs.insert(format!("{group}/{name}"));
            }
        }
    }
    assert_eq!(folders, programs.iter().map(String::as_str).collect());
}
