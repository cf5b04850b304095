//! The scanner, and the cursor that reads tokens off a file.

use std::sync::Arc;

use logos::{FilterResult, Logos};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Text};
use crate::token::{Symbols, Token, shortened};

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
    #[token("/")]
    Over,
    #[token("^")]
    Power,
    #[token("=")]
    Equals,
    #[token("{")]
    OpenBrace,
    #[token("}")]
    CloseBrace,
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

/// Reads the tokens of one file, some ahead; goes back to marks.
#[derive(Debug)]
pub(crate) struct Cursor {
    text: Arc<str>,
    base: u32,
    /// Where scanning goes on.
    position: usize,
    /// Tokens scanned: those ahead, and those behind as far as a mark may need them.
    tokens: Vec<(Token, Span)>,
    /// Which of `tokens` is the next.
    at: usize,
    /// Where the last token taken ended.
    last: u32,
    /// Marks that are out.
    marks: usize,
    /// How often tokens that a mark needs were let go.
    forgotten: u32,
}

/// A place to come back to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    offset: usize,
    at: usize,
    forgotten: u32,
}

/// How a compiled scene begins, and its expanded form.
const COMPILED: [&str; 2] = ["portray scene", "portray expanded"];

/// Tokens read at a time.
const BATCH: usize = 64;

/// Tokens kept for marks; what is longer is scanned again each time.
const KEPT: usize = 1 << 20;

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
        Self::at(text, base, position)
    }

    /// In the middle of a file, at a byte that begins a token.
    pub(crate) fn at(text: Arc<str>, base: u32, position: usize) -> Self {
        let (tokens, at, marks, forgotten) = (Vec::new(), 0, 0, 0);
        Self { text, base, position, tokens, at, last: base, marks, forgotten }
    }

    /// The first words of the file, if they are those of a compiled scene.
    pub(crate) fn compiled_scene(&self) -> Option<Span> {
        let first = COMPILED.iter().find(|words| self.text.starts_with(**words))?;
        Some(span(self.base, 0, first.len()))
    }

    /// Leaves everything behind.
    pub(crate) fn end(&mut self) {
        self.position = self.text.len();
    }

    /// The text of the file, and the offset of its first byte.
    pub(crate) fn file(&self) -> (&Arc<str>, u32) {
        (&self.text, self.base)
    }

    /// The token `n` places ahead; 0 is the next one.
    pub(crate) fn peek(
        &mut self,
        n: usize,
        symbols: &mut Symbols,
        diagnostics: &mut Diagnostics,
    ) -> (Token, Span) {
        if self.at + n >= self.tokens.len() {
            self.fill(symbols, diagnostics);
        }
        self.tokens
            .get(self.at + n)
            .copied()
            .unwrap_or_else(|| (Token::End, span(self.base, self.text.len(), self.text.len())))
    }

    /// Leaves the next token behind.
    pub(crate) fn advance(&mut self) {
        if let Some((_, span)) = self.tokens.get(self.at) {
            self.last = span.end;
            self.at += 1;
        }
    }

    /// Marks the next token, which begins at `next`, until it is released.
    pub(crate) fn mark(&mut self, next: Span) -> Mark {
        self.marks += 1;
        let offset = (next.start - self.base) as usize;
        Mark { offset, at: self.at, forgotten: self.forgotten }
    }

    /// Goes back to a mark.
    pub(crate) fn go_back(&mut self, mark: &Mark) {
        if mark.forgotten == self.forgotten {
            self.at = mark.at;
        } else {
            self.forgotten += 1;
            self.tokens.clear();
            (self.at, self.position) = (0, mark.offset);
        }
    }

    /// The mark is not needed any more.
    pub(crate) fn release(&mut self, _: Mark) {
        self.marks -= 1;
    }

    /// Bytes from a mark to the end of the last token taken.
    pub(crate) fn since(&self, mark: &Mark) -> u64 {
        u64::from(self.last - self.base).saturating_sub(mark.offset as u64)
    }

    /// The place just behind the last token taken.
    pub(crate) fn behind(&self) -> Span {
        Span { start: self.last, end: self.last }
    }

    /// The last byte of the last token taken.
    pub(crate) fn last_byte(&self) -> Option<u8> {
        let end = (self.last - self.base) as usize;
        self.text.as_bytes().get(end.checked_sub(1)?).copied()
    }

    /// The text of a span of this file.
    pub(crate) fn text(&self, span: Span) -> &str {
        let start = span.start.checked_sub(self.base);
        let end = span.end.checked_sub(self.base);
        let range = start.zip(end).map(|(start, end)| start as usize..end as usize);
        range.and_then(|range| self.text.get(range)).unwrap_or_default()
    }

    fn fill(&mut self, symbols: &mut Symbols, diagnostics: &mut Diagnostics) {
        if self.marks == 0 || self.tokens.len() > KEPT {
            self.forgotten += u32::from(self.marks > 0);
            self.tokens.drain(..self.at);
            self.at = 0;
        }
        let rest = &self.text[self.position..];
        let full = self.tokens.len() + BATCH;
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
                Ok(Raw::Over) => Token::Over,
                Ok(Raw::Power) => Token::Power,
                Ok(Raw::Equals) => Token::Equals,
                Ok(Raw::OpenBrace) => Token::OpenBrace,
                Ok(Raw::CloseBrace) => Token::CloseBrace,
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
            self.tokens.push((token, at));
            if self.tokens.len() >= full {
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
            let error = Diagnostic::error(at, format!("unexpected character {shown}"));
            match found {
                ';' => error.hint("a statement ends where the next one begins".to_owned()),
                '[' | ']' | '<' | '>' => {
                    error.hint("vectors and groups stand in parentheses".to_owned())
                }
                '#' => error.hint("a comment begins with //".to_owned()),
                '\'' => error.hint("file names stand in double quotes".to_owned()),
                _ => error,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::token::{Keyword, Word};

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
