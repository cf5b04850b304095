//! The grammar of `docs/sdl.md`: without conflict as LALR(1), and the language that the compiler reads.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

mod derive;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use compile::SourceMap;

use crate::support::root;

/// A rule: its left side and the symbols on its right.
type Rule = (String, Vec<String>);

/// The grammar as the page has it.
#[derive(Debug)]
pub(crate) struct Grammar {
    /// The first one is that of a scene.
    pub(crate) rules: Vec<Rule>,
    /// Classes of words.
    pub(crate) classes: BTreeMap<String, Vec<String>>,
}

impl Grammar {
    fn read() -> Self {
        let page = fs::read_to_string(root().join("docs/sdl.md")).unwrap();
        Self::parse(block(&page, "lalr"), block(&page, "words"))
    }

    fn parse(rules: &str, words: &str) -> Self {
        let (mut found, mut left) = (Vec::new(), String::new());
        for line in rules.lines().filter(|line| !line.trim().is_empty()) {
            let right = match line.split_once(" : ") {
                Some((name, right)) => {
                    left = name.trim().to_owned();
                    right
                }
                None => line.trim().strip_prefix("| ").unwrap(),
            };
            for alternative in right.split(" | ") {
                let symbols = alternative.split_whitespace().filter(|word| *word != "nothing");
                found.push((left.clone(), symbols.map(str::to_owned).collect()));
            }
        }
        let mut classes: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let mut class = String::new();
        for line in words.lines() {
            let mut words = line.split_whitespace();
            if !line.starts_with(' ') {
                class = words.next().unwrap_or_default().to_owned();
            }
            classes.entry(class.clone()).or_default().extend(words.map(str::to_owned));
        }
        Self { rules: found, classes }
    }

    /// Symbols that rules stand for.
    pub(crate) fn is_rule(&self, symbol: &str) -> bool {
        symbol.starts_with(|c: char| c.is_ascii_lowercase())
    }

    fn words(&self) -> BTreeSet<String> {
        let quoted = self.rules.iter().flat_map(|(_, right)| right);
        let quoted = quoted.filter(|symbol| symbol.starts_with('"')).map(|word| unquoted(word));
        let quoted = quoted.filter(|word| word.starts_with(char::is_alphabetic));
        let classes = self.classes.values().flatten().map(String::as_str);
        quoted.chain(classes).map(str::to_owned).collect()
    }
}

/// A word without its quotes.
pub(crate) fn unquoted(symbol: &str) -> &str {
    symbol.trim_matches('"')
}

/// The fenced block of a page that is called `name`.
fn block<'a>(page: &'a str, name: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!("```{name}\n")).unwrap();
    rest.split_once("```").unwrap().0
}

#[test]
fn the_grammar_is_whole() {
    let grammar = Grammar::read();
    let left: BTreeSet<&str> = grammar.rules.iter().map(|(left, _)| left.as_str()).collect();
    let mut used: BTreeSet<&str> = BTreeSet::from(["scene"]);
    let others = ["NAME", "NUMBER", "TEXT"];
    for symbol in grammar.rules.iter().flat_map(|(_, right)| right) {
        let known = if grammar.is_rule(symbol) {
            used.insert(symbol);
            left.contains(symbol.as_str())
        } else {
            symbol.starts_with('"')
                || others.contains(&symbol.as_str())
                || grammar.classes.contains_key(symbol)
        };
        assert!(known, "{symbol} has a rule or is a class of words");
    }
    assert_eq!(left, used, "rules that are used");
}

#[test]
fn the_words_are_those_of_the_compiler() {
    let page = Grammar::read().words();
    let compiler: BTreeSet<String> =
        compile::vocabulary::entries().into_iter().map(|entry| entry.word.to_owned()).collect();
    assert_eq!(page, compiler);
}

/// The words that a pattern of the `TextMate` grammar lists: `(?i)\b(?:a|b)\b`.
fn listed(line: &str) -> BTreeSet<String> {
    let list = line.split_once(r#""(?i)\\b(?:"#).and_then(|(_, rest)| rest.split_once(r#")\\b""#));
    list.map_or_else(BTreeSet::new, |(words, _)| words.split('|').map(str::to_owned).collect())
}

#[test]
fn editors_colour_every_word() {
    let path = root().join("editors/vscode/syntaxes/sdl.tmLanguage.json");
    let text = fs::read_to_string(path).unwrap();
    let lists: Vec<BTreeSet<String>> =
        text.lines().map(listed).filter(|list| !list.is_empty()).collect();
    let entries = compile::vocabulary::entries();
    let compiler: BTreeSet<String> = entries.iter().map(|entry| entry.word.to_owned()).collect();
    let colored: BTreeSet<String> = lists.iter().flatten().cloned().collect();
    assert_eq!(colored, compiler);
    let all: usize = lists.iter().map(BTreeSet::len).sum();
    assert_eq!(all, colored.len(), "each in one list");
    // Words of a kind have one colour, but for solids in their place, and the words of ranges.
    for list in &lists {
        let kinds: BTreeSet<_> = entries
            .iter()
            .filter(|entry| list.contains(entry.word))
            .map(|entry| entry.kind)
            .filter(|kind| *kind != compile::vocabulary::Kind::Transform)
            .collect();
        assert!(kinds.len() == 1, "{list:?}: {kinds:?}");
    }
}

#[test]
fn pictures_of_the_page_are_of_scenes_beside_them() {
    let page = fs::read_to_string(root().join("docs/sdl.md")).unwrap();
    let folder = root().join("docs/sdl");
    let mut texts = Vec::new();
    for name in page.split("](sdl/").skip(1).filter_map(|rest| rest.split_once(".png)")) {
        let path = folder.join(name.0).with_extension("sdl");
        assert!(path.with_extension("png").exists(), "docs/sdl/make.sh renders {}", name.0);
        let compiled = compile::compile_path(&path);
        assert_eq!(compiled.report(), "", "{}", path.display());
        let text = fs::read_to_string(&path).unwrap();
        let laid = compile::layout::laid_out(&SourceMap::from_path(&path).unwrap()).unwrap();
        assert_eq!(text, laid, "{} is laid out", path.display());
        texts.push(text);
    }
    assert!(texts.len() > 20, "pictures: {}", texts.len());
    let pictures = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let pictures = pictures.filter(|path| path.extension().is_some_and(|ending| ending == "png"));
    assert_eq!(pictures.count(), texts.len(), "every picture is shown once");
    // The page quotes whole statements of its scenes.
    for quoted in page.split("```sdl\n").skip(1).filter_map(|rest| rest.split_once("```")) {
        assert!(texts.iter().any(|text| text.contains(quoted.0)), "{}", quoted.0);
    }
}
