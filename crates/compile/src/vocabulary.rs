//! The words of the language, for editors and the tests of its page.

use scene::Primitive;
use scene::form::{Arguments, FORMS, Row};
use scene::texture::{FUNCTIONS, Parameter, Range, Setting, Weight};

use crate::color_name::COLOR_WORDS;
use crate::cursor::Cursor;
use crate::diagnostic::Diagnostics;
use crate::number_text;
use crate::source::{SourceMap, Span};
use crate::token::{KEYWORDS, Keyword, RESERVED_SOLIDS, SOFT_WORDS, Soft, Symbols, Token, Word};
use crate::word::GRADES;

/// What a word is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// It begins a statement.
    Statement,
    /// A part of a statement.
    Clause,
    /// `at`, `scale`, `rotate`.
    Transform,
    /// It begins an attribute, or is one.
    Attribute,
    /// A part of a colour, or all of it. `light` is a [`Statement`](Self::Statement).
    Color,
    /// A solid.
    Solid,
    /// A texture function; it stands after `paint`.
    Texture,
    /// Where u and v of a picture come from; it stands among the arguments of a texture function.
    Mapping,
    /// A function of numbers.
    Function,
    /// A number that has a name.
    Number,
}

/// A word and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// In lower case.
    pub word: &'static str,
    /// What it is for.
    pub kind: Kind,
    /// It cannot name a class, an object or a number.
    pub reserved: bool,
}

/// Every word of the language, each once.
#[must_use]
pub fn entries() -> Vec<Entry> {
    let reserved = |word, kind| Entry { word, kind, reserved: true };
    let soft = |word, kind| Entry { word, kind, reserved: false };
    let keys = KEYWORDS.iter().map(|&(word, keyword)| reserved(word, keyword_kind(keyword)));
    let solids = RESERVED_SOLIDS.iter().flat_map(|solid| solid.keywords());
    let later = Primitive::ALL.iter().filter(|solid| !RESERVED_SOLIDS.contains(solid));
    let later = later.flat_map(|solid| solid.keywords().iter().copied());
    let later = later.chain(FORMS.iter().map(|row| row.keyword));
    keys.chain(solids.map(|word| reserved(word, Kind::Solid)))
        .chain(GRADES.iter().map(|(word, _)| reserved(word, Kind::Attribute)))
        .chain(COLOR_WORDS.iter().map(|(word, _)| reserved(word, Kind::Color)))
        .chain(SOFT_WORDS.iter().map(|&(word, meaning)| soft(word, soft_kind(meaning))))
        .chain(later.map(|word| soft(word, Kind::Solid)))
        .chain(FUNCTIONS.iter().map(|function| soft(function.keyword, Kind::Texture)))
        .chain(mappings().into_iter().map(|word| soft(word, Kind::Mapping)))
        .collect()
}

/// The words that arguments of texture functions may be.
fn mappings() -> Vec<&'static str> {
    let mut words: Vec<&str> = Vec::new();
    for parameter in FUNCTIONS.iter().flat_map(|function| function.parameters) {
        let Range::Word(offered) = parameter.range else { continue };
        words.extend(offered);
    }
    words.sort_unstable();
    words.dedup();
    words
}

/// What may stand in the parentheses of a texture function, or of a solid with numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// Its name.
    pub name: &'static str,
    /// What it is if nothing is said.
    pub default: String,
    /// The words that it may be; none if it is a number or a point.
    pub words: &'static [&'static str],
}

/// The arguments of a word, in any case; none if it takes none.
#[must_use]
pub fn arguments(word: &str) -> Vec<Argument> {
    let texture = FUNCTIONS.iter().find(|function| function.keyword.eq_ignore_ascii_case(word));
    if let Some(function) = texture {
        let argument = |setting: Setting| Argument {
            name: setting.name(),
            default: setting.default().to_string(),
            words: if let Range::Word(words) = setting.range() { words } else { &[] },
        };
        return function.settings().map(argument).collect();
    }
    match Row::named(word).map(|row| row.arguments) {
        Some(Arguments::Numbers(parameters)) => {
            let default = |number: f64| number_text(number);
            let argument =
                |p: &Parameter| Argument { name: p.name, default: default(p.default), words: &[] };
            parameters.iter().map(argument).collect()
        }
        Some(Arguments::Points) | None => Vec::new(),
    }
}

/// True for a texture function that works on another, which stands first in its parentheses.
#[must_use]
pub fn takes_texture(word: &str) -> bool {
    let texture = FUNCTIONS.iter().find(|function| function.keyword.eq_ignore_ascii_case(word));
    texture.is_some_and(|function| matches!(function.weight, Weight::Relief))
}

fn keyword_kind(keyword: Keyword) -> Kind {
    match keyword {
        _ if Keyword::STATEMENTS.contains(&keyword) => Kind::Statement,
        _ if Keyword::TRANSFORMS.contains(&keyword) => Kind::Transform,
        Keyword::Shininess
        | Keyword::Smoothness
        | Keyword::Trans
        | Keyword::Priority
        | Keyword::Paint => Kind::Attribute,
        _ => Kind::Clause,
    }
}

fn soft_kind(word: Soft) -> Kind {
    match word {
        Soft::Let | Soft::Repeat => Kind::Statement,
        Soft::Pi | Soft::Frame => Kind::Number,
        _ if is_function(word) => Kind::Function,
        _ => Kind::Clause,
    }
}

/// A function of numbers.
pub(crate) fn is_function(word: Soft) -> bool {
    matches!(
        word,
        Soft::Sin
            | Soft::Cos
            | Soft::Tan
            | Soft::Sqrt
            | Soft::Abs
            | Soft::Min
            | Soft::Max
            | Soft::Floor
            | Soft::Mod
    )
}

/// What a piece of text is, told without its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// A reserved word.
    Word(Kind),
    /// Another word: a name, or one that means something in its place only.
    Name,
    /// A number.
    Number,
    /// In quotes.
    Text,
    /// Parentheses, braces, commas, operators.
    Sign,
    /// It cannot stand anywhere.
    Bad,
}

/// The main file of `sources` in pieces; what stands between them is white space and comments.
#[must_use]
pub fn pieces(sources: &SourceMap) -> Vec<(Span, Piece)> {
    let (mut symbols, mut diagnostics) = (Symbols::new(), Diagnostics::default());
    let Some(main) = sources.main() else { return Vec::new() };
    let (text, base) = sources.text(main);
    let mut cursor = Cursor::new(text, base, &mut diagnostics);
    let mut pieces = Vec::new();
    loop {
        let (token, span) = cursor.peek(0, &mut symbols, &mut diagnostics);
        let piece = match token {
            Token::End => return pieces,
            Token::Word(Word::Key(keyword)) => Piece::Word(keyword_kind(keyword)),
            Token::Word(Word::Solid(_)) => Piece::Word(Kind::Solid),
            Token::Word(Word::Grade(_)) => Piece::Word(Kind::Attribute),
            Token::Word(Word::Color(_)) => Piece::Word(Kind::Color),
            Token::Name(_) => Piece::Name,
            Token::Number(_) => Piece::Number,
            Token::Text => Piece::Text,
            Token::Bad => Piece::Bad,
            _ => Piece::Sign,
        };
        pieces.push((span, piece));
        cursor.advance();
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn words_are_distinct_and_lower_case() {
        let mut words: Vec<&str> = entries().iter().map(|entry| entry.word).collect();
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), count, "each once");
        assert!(words.iter().all(|word| *word == word.to_ascii_lowercase()), "{words:?}");
    }

    #[test]
    fn kinds_by_hand() {
        let kind = |word: &str| entries().into_iter().find(|entry| entry.word == word).unwrap();
        for (word, expected, reserved) in [
            ("light", Kind::Statement, true),
            ("toward", Kind::Clause, true),
            ("rotate", Kind::Transform, true),
            ("trans", Kind::Attribute, true),
            ("shiniest", Kind::Attribute, true),
            ("greenish", Kind::Color, true),
            ("cube", Kind::Solid, true),
            ("paraboloid", Kind::Solid, false),
            ("torus", Kind::Solid, false),
            ("marble", Kind::Texture, false),
            ("sqrt", Kind::Function, false),
            ("pi", Kind::Number, false),
            ("repeat", Kind::Statement, false),
            ("step", Kind::Clause, false),
        ] {
            assert_eq!((kind(word).kind, kind(word).reserved), (expected, reserved), "{word}");
        }
    }

    #[test]
    fn arguments_by_hand() {
        let names = |word: &str| -> Vec<&str> { arguments(word).iter().map(|a| a.name).collect() };
        assert_eq!(names("Checker"), ["u", "v"]);
        assert_eq!(names("projection"), ["at", "toward", "angle"]);
        assert_eq!(names("terrain"), ["seed", "roughness", "detail"]);
        assert_eq!(names("prism"), [""; 0]);
        let mapping = &arguments("decal")[0];
        assert_eq!((mapping.name, mapping.default.as_str()), ("mapping", "surface"));
        assert!(mapping.words.contains(&"cylindrical"), "{mapping:?}");
        assert!(takes_texture("bump") && !takes_texture("brick"));
    }

    #[test]
    fn a_text_in_pieces() {
        let text = "Object /* x */ is red ball - \"a\" 2 $";
        let sources = SourceMap::from_reader(Path::new("a"), text.as_bytes()).unwrap();
        let found: Vec<(&str, Piece)> = pieces(&sources)
            .into_iter()
            .map(|(span, piece)| (&text[span.start as usize..span.end as usize], piece))
            .collect();
        let expected = [
            ("Object", Piece::Word(Kind::Statement)),
            ("is", Piece::Word(Kind::Clause)),
            ("red", Piece::Word(Kind::Color)),
            ("ball", Piece::Name),
            ("-", Piece::Sign),
            ("\"a\"", Piece::Text),
            ("2", Piece::Number),
            ("$", Piece::Bad),
        ];
        assert_eq!(found, expected);
    }
}
