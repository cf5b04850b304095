//! Random sentences of the grammar, and the same with parentheses around all that a rule puts together.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use compile::{Compiled, Severity, SourceMap, compile_path};
use scene::texture::FUNCTIONS;
use tempfile::TempDir;

use super::{Grammar, unquoted};
use crate::oracle::author::Chance;

/// What sentences may name: numbers in 0…1, a class, and one with twelve parameters.
const PRELUDE: &str = "let a = 0.5 let b = 0.75 class ball is sphere
    class box (p1 = 1, p2 = 1, p3 = 1, p4 = 1, p5 = 1, p6 = 1, p7 = 1, p8 = 1, p9 = 1, p10 = 1, p11 = 1, p12 = 1)
    is block scale (p1 + 2, p2 + 2, 1)\n";
const PARAMETERS: usize = 12;

/// Hues that mix.
const NEIGHBOURS: &[(&str, &str)] = &[
    ("red", "orange"),
    ("orange", "yellow"),
    ("yellow", "green"),
    ("green", "blue"),
    ("blue", "purple"),
    ("purple", "red"),
    ("red", "brown"),
    ("brown", "yellow"),
];

/// Rules that stand inside each other, until only the shortest are taken.
const DEPTH: usize = 40;

/// A derivation.
#[derive(Clone, Debug)]
enum Tree {
    Word(String),
    Node(String, Vec<Self>),
}

impl Tree {
    fn children(&self) -> &[Self] {
        match self {
            Self::Word(_) => &[],
            Self::Node(_, children) => children,
        }
    }

    fn words(&self) -> Vec<&str> {
        match self {
            Self::Word(word) => vec![word],
            Self::Node(_, children) => children.iter().flat_map(Self::words).collect(),
        }
    }

    fn name(&self) -> Option<String> {
        match self {
            Self::Word(_) => None,
            Self::Node(left, _) => Some(left.clone()),
        }
    }

    fn first(&self) -> &str {
        self.words().first().copied().unwrap_or_default()
    }

    fn is(&self, name: &str) -> bool {
        matches!(self, Self::Node(left, _) if left == name)
    }

    /// The members of a list whose rule has itself first.
    fn members(&self) -> Vec<&Self> {
        let Self::Node(left, children) = self else { return Vec::new() };
        let mut members = Vec::new();
        for child in children {
            if child.is(left) {
                members.extend(child.members());
            } else if child.first() != "," {
                members.push(child);
            }
        }
        members
    }

    /// With parentheses around every operator and its operands.
    fn explicit(&self) -> String {
        let Self::Node(left, children) = self else { return self.first().to_owned() };
        let joined = || children.iter().map(Self::explicit).collect::<Vec<_>>().join(" ");
        match (left.as_str(), children.len()) {
            ("sum" | "product" | "power", 3) | ("sign" | "number", 2) => format!("({})", joined()),
            ("solid" | "term", 3) => format!("({})", self.run()),
            _ => joined(),
        }
    }

    /// A run of one operator of solids is one union, difference or intersection.
    fn run(&self) -> String {
        let children = self.children();
        let operator = children[1].first();
        let first = &children[0];
        let goes_on = first.children().len() == 3 && first.children()[1].first() == operator;
        let first = if goes_on { first.run() } else { first.explicit() };
        format!("{first} {operator} {}", children[2].explicit())
    }
}

/// Derives sentences.
struct Author<'a> {
    grammar: &'a Grammar,
    /// The least depth of a derivation.
    heights: BTreeMap<&'a str, usize>,
    chance: Chance,
    /// Words until only the shortest rules are taken.
    budget: usize,
    names: u32,
    used: BTreeSet<usize>,
}

impl<'a> Author<'a> {
    fn new(grammar: &'a Grammar, seed: u64) -> Self {
        let mut heights: BTreeMap<&str, usize> = BTreeMap::new();
        for _ in 0..grammar.rules.len() {
            for (left, right) in &grammar.rules {
                let height = |symbol: &String| match grammar.is_rule(symbol) {
                    true => heights.get(symbol.as_str()).copied(),
                    false => Some(0),
                };
                let below: Option<Vec<usize>> = right.iter().map(height).collect();
                if let Some(below) = below {
                    let height = 1 + below.into_iter().max().unwrap_or(0);
                    let known = heights.entry(left).or_insert(height);
                    *known = (*known).min(height);
                }
            }
        }
        let mut chance = Chance::new(seed);
        let budget = 10 + chance.below(150) as usize;
        Self { grammar, heights, chance, budget, names: 0, used: BTreeSet::new() }
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.chance.below(u32::try_from(from.len()).unwrap()) as usize].clone()
    }

    fn height(&self, right: &[String]) -> usize {
        right
            .iter()
            .filter_map(|symbol| self.heights.get(symbol.as_str()))
            .max()
            .copied()
            .unwrap_or(0)
    }

    /// A rule for `symbol`. With `share` its numbers stay above 0 and at most 1.
    fn rule(&mut self, symbol: &str, depth: usize, share: bool) -> usize {
        let rules = self.grammar.rules.iter().enumerate();
        let of_symbol = rules.filter(|(_, (left, _))| left == symbol);
        let mut places: Vec<usize> = of_symbol
            .filter(|(_, (_, right))| {
                let first = right.first().map_or("", String::as_str);
                let operator = right.get(1).map_or("", String::as_str);
                match symbol {
                    "number" | "sign" => !share || right.len() == 1,
                    "sum" => !share || right.len() == 1,
                    "product" => !share || operator != "\"/\"",
                    "value" => !share || !matches!(first, "\"pi\"" | "\"frame\""),
                    _ => true,
                }
            })
            .map(|(place, _)| place)
            .collect();
        let height = |place: &usize| self.height(&self.grammar.rules[*place].1);
        if depth > DEPTH || self.budget == 0 {
            let least = places.iter().map(height).min().unwrap();
            places.retain(|place| height(place) == least);
        }
        // Chains of one rule would be most of every sentence; lists would have no members.
        let right = |place: &usize| self.grammar.rules[*place].1.as_slice();
        let chain = matches!(symbol, "sum" | "product" | "power" | "sign" | "number");
        let mut longer = places.clone();
        longer.retain(|place| match symbol {
            // Half of all statements are those that may be repeated.
            "statement" => right(place).len() == 1,
            _ if chain => right(place).len() > 1,
            _ => right(place).first().is_some_and(|first| first == symbol),
        });
        let take_longer = match symbol {
            "statement" => self.chance.below(2) == 0,
            _ if chain => self.chance.below(6) == 0,
            _ => self.chance.below(3) > 0,
        };
        if take_longer && !longer.is_empty() {
            places = longer;
        } else if chain {
            places.retain(|place| self.grammar.rules[*place].1.len() == 1 || symbol == "value");
        }
        self.pick(&places)
    }

    fn derive(&mut self, symbol: &str, depth: usize, share: bool) -> Tree {
        let place = self.rule(symbol, depth, share);
        let (left, right) = &self.grammar.rules[place];
        let first = right.first().map_or("", |symbol| unquoted(symbol));
        let share = share
            || matches!(symbol, "attribute" | "bare" | "kind" | "gleam" | "range" | "color")
            || matches!(first, "focal" | "fog" | "intensity" | "RING");
        let children: Vec<Tree> = right
            .iter()
            .map(|next| match self.grammar.is_rule(next) {
                true => self.derive(next, depth + 1, share),
                false => Tree::Word(self.word(next, left, right)),
            })
            .collect();
        match self.mended(left, children, share) {
            Some(tree) => {
                self.used.insert(place);
                tree
            }
            None => self.derive(symbol, depth, share),
        }
    }

    /// The text of a word of the rule `left : right`.
    fn word(&mut self, symbol: &str, left: &str, right: &[String]) -> String {
        self.budget = self.budget.saturating_sub(1);
        let known = |name: &str| name.to_owned();
        match symbol {
            "NUMBER" => known(self.pick(&["1", "0.5", ".25", "75e-2", "1.", "0.125"])),
            "RING" if right.len() > 1 => known("torus"),
            "TEXT" => known("\"part.sdl\""),
            "NAME" => match left {
                "core" if right.len() > 1 => known("box"),
                "core" => known("ball"),
                "value" => known(self.pick(&["a", "b"])),
                _ => {
                    self.names += 1;
                    format!("n{}", self.names)
                }
            },
            _ if symbol.starts_with('"') => unquoted(symbol).to_owned(),
            class => self.pick(&self.grammar.classes[class].clone()),
        }
    }

    /// What the grammar does not say: what may be said once, what has to be, and how many arguments there are. `None` if
    /// this cannot be mended.
    fn mended(&mut self, left: &str, mut children: Vec<Tree>, share: bool) -> Option<Tree> {
        match (left, children.as_slice()) {
            ("clauses" | "glow" | "attributes" | "transforms", [list, member]) => {
                let kind = kind(member);
                if kind != "paint" && list.members().into_iter().any(|m| self::kind(m) == kind) {
                    return Some(list.clone());
                }
            }
            ("statements" | "items", [list, next]) if takes_for_color(list, next) => {
                return Some(list.clone());
            }
            ("item", [light, kind, clauses]) if light.first() == "light" => {
                let clauses = self.needed_clauses(kind.first(), clauses.clone());
                children[2] = clauses;
            }
            ("attribute", [priority, _]) if priority.first() == "priority" => {
                let one = Tree::Node("value".to_owned(), vec![Tree::Word("1".to_owned())]);
                children[1] = Tree::Node("number".to_owned(), vec![one]);
            }
            ("attribute", [_, _, _, arguments, ..]) if arguments.is("arguments") => {
                let count = arguments.words().iter().filter(|word| **word == ",").count() + 1;
                let (keyword, names) = texture(count)?;
                children[3] = named(arguments, &names)?;
                children[1] = Tree::Word(keyword.to_owned());
            }
            ("raised", [_, _, arguments, _]) if arguments.is("arguments") => {
                let count = arguments.words().iter().filter(|word| **word == ",").count() + 1;
                let (keyword, names) = texture(count)?;
                children[2] = named(arguments, &names)?;
                children[0] = Tree::Word(keyword.to_owned());
            }
            // A decal has all arguments of an image.
            ("place", [.., arguments]) if !matches!(arguments, Tree::Word(_)) => {
                let arguments = named(arguments, &["u", "v"])?;
                *children.last_mut()? = arguments;
            }
            ("bare", [_, _, _, _, _, word, equals, _, _]) if equals.words() == ["="] => {
                children[5] = Tree::Node(word.name()?, vec![Tree::Word("height".to_owned())]);
            }
            ("aims", [list, .., member])
                if list.members().into_iter().any(|m| m.first() == member.first()) =>
            {
                return Some(list.clone());
            }
            ("aim", [name, equals, _])
                if equals.words() == ["="] && !matches!(name.first(), "at" | "toward") =>
            {
                children[0] = Tree::Word("angle".to_owned());
            }
            ("core", [_, _, arguments, _]) if arguments.is("arguments") => {
                let names: Vec<String> = (1..=PARAMETERS).map(|i| format!("p{i}")).collect();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                children[2] = named(arguments, &names)?;
            }
            // Corners of a parabola: an outline that does not meet itself.
            ("core", [_, _, points, _]) if points.is("points") => {
                children[2] = parabola(points.members().len());
            }
            ("hue", [_, _, ..]) => {
                let (a, b) = self.pick(NEIGHBOURS);
                let (a, b) = if self.chance.below(2) == 0 { (a, b) } else { (b, a) };
                let hues = &self.grammar.classes["HUE"];
                let place = hues.iter().position(|hue| hue == a)?;
                let splash = self.grammar.classes["SPLASH"][place].clone();
                let last = children.len() - 1;
                children[0] = Tree::Word(if last == 2 { a.to_owned() } else { splash });
                children[last] = Tree::Word(b.to_owned());
            }
            ("value", [_, _, values, _]) => {
                let functions: &[&str] = match values.members().len() {
                    1 if share => &["abs", "sqrt"],
                    1 => &["sin", "cos", "tan", "sqrt", "abs", "floor"],
                    2 if !share => &["min", "max", "mod"],
                    _ => &["min", "max"],
                };
                children[0] = Tree::Word(self.pick(functions).to_owned());
            }
            _ => {}
        }
        Some(Tree::Node(left.to_owned(), children))
    }

    /// A point and a spot need a place, a beam and a spot what they are aimed at.
    fn needed_clauses(&mut self, kind: &str, mut clauses: Tree) -> Tree {
        let aimed = matches!(kind, "beam" | "spot");
        if !aimed {
            clauses = without(&clauses, "toward");
        }
        let needed: &[&str] = if aimed { &["at", "toward"] } else { &["at"] };
        for word in needed {
            while !clauses.members().iter().any(|clause| clause.first() == *word) {
                self.budget = self.budget.max(4);
                let clause = self.derive("clause", 0, false);
                if clause.first() == *word {
                    clauses = Tree::Node("clauses".to_owned(), vec![clauses, clause]);
                }
            }
        }
        clauses
    }
}

/// A texture function of numbers that takes so many, and their names.
fn texture(count: usize) -> Option<(&'static str, Vec<&'static str>)> {
    let plain = FUNCTIONS.iter().filter(|function| function.subject().is_none());
    let function = plain.into_iter().find(|function| function.parameters.len() >= count)?;
    Some((function.keyword, function.parameters.iter().map(|p| p.name).collect()))
}

/// What a clause or an attribute says: each may be said once.
fn kind(member: &Tree) -> &str {
    let first = member.first();
    match first {
        _ if member.children().first().is_some_and(|child| child.is("color")) => "color",
        "dullest" | "duller" | "dull" | "shiny" | "shinier" | "shiniest" => "shininess",
        "roughest" | "rougher" | "rough" | "smooth" | "smoother" | "smoothest" => "smoothness",
        "composite" => "pure",
        _ => first,
    }
}

fn without(list: &Tree, kind: &str) -> Tree {
    let Tree::Node(left, children) = list else { return list.clone() };
    match children.as_slice() {
        [rest, member] if member.first() == kind => without(rest, kind),
        [rest, member] => Tree::Node(left.clone(), vec![without(rest, kind), member.clone()]),
        _ => list.clone(),
    }
}

/// Arguments with names in the order of the parameters.
fn named(arguments: &Tree, names: &[&str]) -> Option<Tree> {
    fn rename(tree: &Tree, names: &mut std::slice::Iter<'_, &str>) -> Option<Tree> {
        match tree {
            Tree::Node(left, _) if left == "word" => {
                let word = Tree::Word((*names.next()?).to_owned());
                Some(Tree::Node(left.clone(), vec![word]))
            }
            Tree::Node(left, children) => {
                let children: Option<Vec<Tree>> =
                    children.iter().map(|child| rename(child, names)).collect();
                Some(Tree::Node(left.clone(), children?))
            }
            Tree::Word(_) => Some(tree.clone()),
        }
    }
    let values = arguments.children().first()?;
    let placed = if values.is("values") { values.members().len() } else { 0 };
    rename(arguments, &mut names.get(placed..)?.iter())
}

/// `light` in front of a hue begins a statement, unless the statement before may still take a colour: then it is a
/// lightness, and the sentence another one.
fn takes_for_color(list: &Tree, next: &Tree) -> bool {
    let mut last = list.members().last().copied();
    while let Some(inner) = last.filter(|tree| tree.children().len() == 1) {
        last = inner.children().first();
    }
    let open = last.is_some_and(|last| {
        let colored =
            |list: &Tree| list.members().into_iter().any(|member| kind(member) == "color");
        match (last.first(), last.children()) {
            ("light", [_, _, clauses]) => !colored(clauses),
            ("ambient", [_, glow]) => !colored(glow),
            _ => false,
        }
    });
    let words = next.words();
    let lightness = |word: &str| {
        ["red", "orange", "brown", "yellow", "green", "blue", "purple", "gray", "grey"]
            .contains(&word)
            || word.ends_with("ish")
            || ["moderate", "strong", "vivid"].contains(&word)
    };
    open && words[0] == "light" && words.get(1).is_some_and(|word| lightness(word))
}

fn bytes(compiled: &Compiled) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    scene::format::write(compiled.scene.as_ref()?, &mut bytes).unwrap();
    Some(bytes)
}

fn compiled(folder: &Path, text: &str) -> Compiled {
    let path = folder.join("main.sdl");
    fs::write(&path, text).unwrap();
    compile_path(&path)
}

/// What is wrong with numbers, not with the sentence.
const NUMBERS: &[&str] = &[
    "division by 0",
    "has no value",
    "is no number",
    "is too large for a number",
    "has to be",
    "a scale of 0",
    "stands at its target",
    "aimed at the point it comes from",
    "is not in front of the camera",
    "one turn or more",
    "are the same point",
    "for their distance to be a number",
];

#[test]
fn derived_sentences_are_read_as_they_are_derived() {
    let grammar = Grammar::read();
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("part.sdl"), "// nothing\n").unwrap();
    let (mut used, mut scenes) = (BTreeSet::new(), 0);
    for seed in 0..300 {
        let mut author = Author::new(&grammar, seed);
        let tree = author.derive("scene", 0, false);
        used.append(&mut author.used);
        let sentence = format!("{PRELUDE}{}\n", tree.words().join(" "));
        let found = compiled(folder.path(), &sentence);
        let explicit = compiled(folder.path(), &format!("{PRELUDE}{}\n", tree.explicit()));
        let errors = found.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        for error in errors {
            let number = NUMBERS.iter().any(|known| error.message.contains(known));
            assert!(number, "seed {seed}: {}", error.human(&found.sources));
        }
        assert!(bytes(&found) == bytes(&explicit), "seed {seed}: {}", explicit.report());
        scenes += u32::from(found.scene.is_some());
        laid_out(folder.path(), &sentence, &found);
    }
    assert!(scenes > 150, "sentences without an error: {scenes}");
    let unused: Vec<_> = (0..grammar.rules.len()).filter(|rule| !used.contains(rule)).collect();
    let unused: Vec<_> = unused.into_iter().map(|rule| &grammar.rules[rule]).collect();
    assert!(unused.is_empty(), "rules that no sentence has: {unused:?}");
}

/// The layout means the same, and laying out twice is as good as once.
fn laid_out(folder: &Path, sentence: &str, found: &Compiled) {
    let laid = |text: &str| {
        let sources = SourceMap::from_reader(Path::new("main.sdl"), text.as_bytes()).unwrap();
        compile::layout::laid_out(&sources).unwrap()
    };
    let once = laid(sentence);
    assert_eq!(laid(&once), once, "{sentence}");
    assert!(bytes(&compiled(folder, &once)) == bytes(found), "{sentence}\nis laid out as\n{once}");
}

/// That many corners of a parabola.
fn parabola(count: usize) -> Tree {
    let point = |k: usize| Tree::Word(format!("({k}, {})", k * k));
    let comma = |k: usize| (k > 0).then(|| Tree::Word(",".to_owned()));
    let corners = (0..count).flat_map(|k| comma(k).into_iter().chain([point(k)]));
    Tree::Node("points".to_owned(), corners.collect())
}
