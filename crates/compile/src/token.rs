//! Words and signs: the table of keywords, interned words, and the cursor that reads tokens off a file.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use logos::{FilterResult, Logos};
use scene::Primitive;

use crate::color_name::{COLOR_WORDS, ColorWord};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Text};
use crate::word::{GRADES, Grade};

macro_rules! keywords {
    ($($name:ident $text:literal)+) => {
        /// A reserved word that is neither a solid, a graded word nor part of a colour.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Keyword { $($name,)+ }

        /// Every keyword.
        pub(crate) const KEYWORDS: &[(&str, Keyword)] = &[$(($text, Keyword::$name),)+];
    };
}

keywords! {
    Include "include" Class "class" Object "object" Camera "camera" Target "target" Focal "focal"
    Light "light" Ambient "ambient" Background "background" Fog "fog"
    Is "is" At "at" Length "length" Toward "toward" Intensity "intensity"
    Point "point" Beam "beam" Spot "spot" No "no" Shadows "shadows"
    Scale "scale" Rotate "rotate"
    Shininess "shininess" Smoothness "smoothness" Trans "trans" Fake "fake" Priority "priority"
    Paint "paint"
}

impl Keyword {
    /// The words that begin a statement.
    pub(crate) const STATEMENTS: &[Self] = &[
        Self::Include,
        Self::Class,
        Self::Object,
        Self::Camera,
        Self::Target,
        Self::Focal,
        Self::Light,
        Self::Ambient,
        Self::Background,
        Self::Fog,
    ];

    /// The words that begin a transform.
    pub(crate) const TRANSFORMS: &[Self] = &[Self::At, Self::Scale, Self::Rotate];

    /// Lower case.
    pub(crate) fn text(self) -> &'static str {
        let row = KEYWORDS.iter().find(|(_, keyword)| *keyword == self);
        row.map_or("", |(text, _)| text)
    }
}

/// The solids whose names are reserved; a class may take the name of any other.
const RESERVED_SOLIDS: &[Primitive] =
    &[Primitive::Sphere, Primitive::Cylinder, Primitive::Cone, Primitive::Block];

/// What a reserved word means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Word {
    Key(Keyword),
    Solid(Primitive),
    Grade(Grade),
    Color(ColorWord),
}

/// A word in lower case, as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Symbol(u32);

impl Symbol {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Every word met so far. Reserved words come first, so a word is looked up once, whatever it is.
#[derive(Debug)]
pub(crate) struct Symbols {
    indices: HashMap<Arc<str>, Symbol>,
    texts: Vec<Arc<str>>,
    reserved: Vec<Word>,
    lower: String,
}

impl Symbols {
    pub(crate) fn new() -> Self {
        let mut symbols = Self {
            indices: HashMap::new(),
            texts: Vec::new(),
            reserved: Vec::new(),
            lower: String::new(),
        };
        let keys = KEYWORDS.iter().map(|&(text, keyword)| (text, Word::Key(keyword)));
        let solids = RESERVED_SOLIDS.iter().flat_map(|&solid| {
            solid.keywords().iter().map(move |&text| (text, Word::Solid(solid)))
        });
        let grades = GRADES.iter().map(|&(text, grade)| (text, Word::Grade(grade)));
        let colors = COLOR_WORDS.iter().map(|&(text, color)| (text, Word::Color(color)));
        for (text, word) in keys.chain(solids).chain(grades).chain(colors) {
            symbols.intern(text);
            symbols.reserved.push(word);
        }
        symbols
    }

    /// The symbol of a word in any case.
    fn intern(&mut self, word: &str) -> Symbol {
        let mut lower = std::mem::take(&mut self.lower);
        let key = if word.bytes().any(|byte| byte.is_ascii_uppercase()) {
            lower.clear();
            lower.push_str(word);
            lower.make_ascii_lowercase();
            lower.as_str()
        } else {
            word
        };
        let symbol = self.indices.get(key).copied().unwrap_or_else(|| {
            let next = u32::try_from(self.texts.len()).expect("sources are shorter than 2³² bytes");
            let text: Arc<str> = key.into();
            self.texts.push(Arc::clone(&text));
            self.indices.insert(text, Symbol(next));
            Symbol(next)
        });
        self.lower = lower;
        symbol
    }

    fn token(&mut self, word: &str) -> Token {
        let symbol = self.intern(word);
        self.reserved.get(symbol.index()).map_or(Token::Name(symbol), |&word| Token::Word(word))
    }

    /// In lower case.
    pub(crate) fn text(&self, symbol: Symbol) -> &str {
        &self.texts[symbol.index()]
    }

    /// All reserved words with their meaning.
    pub(crate) fn reserved(&self) -> impl Iterator<Item = (&str, Word)> {
        self.texts.iter().map(|text| &**text).zip(self.reserved.iter().copied())
    }
}

/// A token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Word(Word),
    Name(Symbol),
    /// In quotes; the text is the span without its ends.
    Text,
    Open,
    Close,
    Comma,
    Plus,
    Minus,
    Times,
    Equals,
    /// Something that an error has been reported for.
    Bad,
    End,
}

/// What the scanner tells apart.
#[derive(Clone, Copy, Debug, Logos, PartialEq)]
#[logos(error = Flaw)]
#[logos(skip r"[ \t\r\n\f\v]+")]
#[logos(skip(r"//[^\n]*", allow_greedy = true))]
enum Raw {
    #[regex(r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", priority = 10)]
    Number,
    #[regex(r"\.?[0-9][0-9A-Za-z_.]*", priority = 5)]
    BadNumber,
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*")]
    Word,
    #[regex("\"[^\"\n]*\"")]
    Text,
    #[regex("\"[^\"\n]*", priority = 1)]
    OpenText,
    #[token("(")]
    Open,
    #[token(")")]
    Close,
    #[token(",")]
    Comma,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Times,
    #[token("=")]
    Equals,
    /// A regular expression would have to look past the first `*/`.
    #[token("/*", skip_comment)]
    Comment,
}

/// Why there is no token.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Flaw {
    #[default]
    Character,
    OpenComment,
}

fn skip_comment(lexer: &mut logos::Lexer<'_, Raw>) -> FilterResult<(), Flaw> {
    if let Some(end) = lexer.remainder().find("*/") {
        lexer.bump(end + 2);
        return FilterResult::Skip;
    }
    lexer.bump(lexer.remainder().len());
    FilterResult::Error(Flaw::OpenComment)
}

/// Reads the tokens of one file, some ahead.
#[derive(Debug)]
pub(crate) struct Cursor {
    text: Arc<str>,
    base: u32,
    position: usize,
    ahead: VecDeque<(Token, Span)>,
    /// Where the last token taken ended.
    last: u32,
}

/// Tokens read at a time.
const BATCH: usize = 64;

impl Cursor {
    /// At the beginning of a file whose first byte has the offset `base`.
    pub(crate) fn new(file: Text, base: u32, diagnostics: &mut Diagnostics) -> Self {
        let Text { text, bad } = file;
        let mut position = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        if let Some((at, byte)) = bad {
            let message = format!("the file is not UTF-8: found the byte 0x{byte:02x}");
            diagnostics.push(Diagnostic::error(span(base, at, at + 1), message));
            // What follows from half a file is noise.
            position = text.len();
        }
        Self { text, base, position, ahead: VecDeque::new(), last: base }
    }

    /// The token `n` places ahead; 0 is the next one.
    pub(crate) fn peek(
        &mut self,
        n: usize,
        symbols: &mut Symbols,
        diagnostics: &mut Diagnostics,
    ) -> (Token, Span) {
        if self.ahead.len() <= n {
            self.fill(symbols, diagnostics);
        }
        self.ahead
            .get(n)
            .copied()
            .unwrap_or_else(|| (Token::End, span(self.base, self.text.len(), self.text.len())))
    }

    /// Leaves the next token behind.
    pub(crate) fn advance(&mut self) {
        if let Some((_, span)) = self.ahead.pop_front() {
            self.last = span.end;
        }
    }

    /// The place just behind the last token taken.
    pub(crate) fn behind(&self) -> Span {
        Span { start: self.last, end: self.last }
    }

    /// The text of a span of this file.
    pub(crate) fn text(&self, span: Span) -> &str {
        let (start, end) = ((span.start - self.base) as usize, (span.end - self.base) as usize);
        self.text.get(start..end).unwrap_or_default()
    }

    fn fill(&mut self, symbols: &mut Symbols, diagnostics: &mut Diagnostics) {
        let rest = &self.text[self.position..];
        let mut lexer = Raw::lexer(rest);
        let mut flawed: Option<Span> = None;
        while let Some(raw) = lexer.next() {
            let range = lexer.span();
            let at = span(self.base, self.position + range.start, self.position + range.end);
            let text = lexer.slice();
            // A run of strange characters is one error.
            let again = flawed.is_some_and(|last| last.end == at.start);
            flawed = None;
            let token = match raw {
                Ok(Raw::Number) => number(text, at, diagnostics),
                Ok(Raw::Word) => symbols.token(text),
                Ok(Raw::Text) => Token::Text,
                Ok(Raw::Open) => Token::Open,
                Ok(Raw::Close) => Token::Close,
                Ok(Raw::Comma) => Token::Comma,
                Ok(Raw::Plus) => Token::Plus,
                Ok(Raw::Minus) => Token::Minus,
                Ok(Raw::Times) => Token::Times,
                Ok(Raw::Equals) => Token::Equals,
                Ok(Raw::BadNumber | Raw::OpenText | Raw::Comment) | Err(_) => {
                    if matches!(raw, Err(Flaw::Character)) {
                        flawed = Some(at);
                    }
                    if again {
                        continue;
                    }
                    diagnostics.push(flaw(raw, text, at));
                    Token::Bad
                }
            };
            self.ahead.push_back((token, at));
            if self.ahead.len() >= BATCH {
                break;
            }
        }
        self.position += lexer.span().end;
    }
}

fn span(base: u32, start: usize, end: usize) -> Span {
    let offset = |at: usize| base + u32::try_from(at).expect("sources are shorter than 2³² bytes");
    Span { start: offset(start), end: offset(end) }
}

fn number(text: &str, at: Span, diagnostics: &mut Diagnostics) -> Token {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Token::Number(value),
        _ => {
            let message = format!("number too large: `{}`", shortened(text));
            diagnostics.push(
                Diagnostic::error(at, message).hint("the largest is about 1.8e308".to_owned()),
            );
            Token::Bad
        }
    }
}

fn flaw(raw: Result<Raw, Flaw>, text: &str, at: Span) -> Diagnostic {
    match raw {
        Ok(Raw::BadNumber) => {
            Diagnostic::error(at, format!("malformed number `{}`", shortened(text))).hint(
                "a number is written like 12, .5 or 1e3; a name begins with a letter".to_owned(),
            )
        }
        Ok(Raw::OpenText) => Diagnostic::error(at, "the text has no closing `\"` on its line"),
        Err(Flaw::OpenComment) => {
            let opening = Span { start: at.start, end: at.start + 2 };
            Diagnostic::error(opening, "the comment is not closed")
                .hint("expected `*/` before the end of the file".to_owned())
        }
        _ => {
            let found = text.chars().next().unwrap_or_default();
            let shown = if found.is_control() || found.is_whitespace() || !found.is_ascii() {
                format!("U+{:04X}", u32::from(found))
            } else {
                format!("`{found}`")
            };
            Diagnostic::error(at, format!("unexpected character {shown}"))
        }
    }
}

/// Text from a source, short enough for a message.
pub(crate) fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> (Vec<Token>, Vec<String>) {
        let (mut symbols, mut diagnostics) = (Symbols::new(), Diagnostics::default());
        let mut cursor = Cursor::new(Text { text: text.into(), bad: None }, 7, &mut diagnostics);
        let mut tokens = Vec::new();
        loop {
            let (token, span) = cursor.peek(0, &mut symbols, &mut diagnostics);
            assert!(span.start >= 7 && span.end as usize <= 7 + text.len(), "in the file");
            if token == Token::End {
                break;
            }
            tokens.push(token);
            cursor.advance();
        }
        (tokens, diagnostics.finish().into_iter().map(|d| d.message).collect())
    }

    #[test]
    fn reserved_words_are_distinct_and_lower_case() {
        let symbols = Symbols::new();
        assert_eq!(symbols.texts.len(), symbols.reserved.len(), "no word twice");
        for (text, _) in symbols.reserved() {
            assert!(text.bytes().all(|byte| byte.is_ascii_lowercase()), "{text}");
        }
    }

    #[test]
    fn numbers_are_read() {
        let (found, errors) = tokens("12 .5 1e3 5. 1.5E-3 0 1e-999");
        let expected = [12.0, 0.5, 1000.0, 5.0, 0.0015, 0.0, 0.0].map(Token::Number);
        assert_eq!(found, expected);
        assert!(errors.is_empty(), "{errors:?}");
        assert_eq!(tokens("3-4").0.len(), 3, "a sign is a token of its own");
    }

    #[test]
    fn bad_numbers_are_refused() {
        for (text, message) in [
            ("1e999", "number too large: `1e999`"),
            ("12abc", "malformed number `12abc`"),
            ("1.2.3", "malformed number `1.2.3`"),
            ("1e", "malformed number `1e`"),
            ("0x10", "malformed number `0x10`"),
        ] {
            assert_eq!(tokens(text), (vec![Token::Bad], vec![message.to_owned()]));
        }
        let (found, errors) = tokens(&"9".repeat(1_000_000));
        assert_eq!(found, [Token::Bad]);
        assert!(errors[0].len() < 80, "cut: {}", errors[0].len());
    }

    #[test]
    fn words_have_no_case_and_names_are_interned() {
        let (found, _) = tokens("OBJECT Object glass GLASS glasses");
        assert_eq!(found[0], found[1]);
        assert_eq!(found[0], Token::Word(Word::Key(Keyword::Object)));
        assert_eq!(found[2], found[3]);
        assert_ne!(found[3], found[4]);
    }

    #[test]
    fn comments_separate() {
        let (found, errors) = tokens("(/* * / ** // \n*/)//)\n=/**/,/***/+");
        let expected = [Token::Open, Token::Close, Token::Equals, Token::Comma, Token::Plus];
        assert_eq!(found, expected);
        assert!(errors.is_empty(), "{errors:?}");
        assert_eq!(tokens("( /* */ /* ").1, ["the comment is not closed"]);
        assert_eq!(tokens("/*/").1, ["the comment is not closed"], "the star counts once");
    }

    #[test]
    fn strange_characters_are_one_error() {
        assert_eq!(tokens("( ¤¤¤ )").1, ["unexpected character U+00A4"]);
        assert_eq!(tokens("; ;").1.len(), 2, "two runs");
        assert_eq!(tokens("\"abc\n(").1, ["the text has no closing `\"` on its line"]);
        assert_eq!(tokens("a\u{feff}").1, ["unexpected character U+FEFF"]);
        assert!(tokens("\u{feff}fog").1.is_empty(), "a mark at the beginning");
    }

    #[test]
    fn many_tokens_come_in_order() {
        let text: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
        let (found, _) = tokens(&text.join(" "));
        let expected: Vec<Token> = (0..1000).map(|i| Token::Number(f64::from(i))).collect();
        assert_eq!(found, expected);
    }
}
