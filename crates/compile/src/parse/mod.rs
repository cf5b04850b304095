//! Tokens to tree: what all parts of the parser share. After an error it goes on at the next statement.

mod argument;
mod attribute;
mod call;
mod color;
mod expression;
mod form;
mod paint;
mod solid;
mod statement;
mod turns;

pub(crate) use attribute::AttributesCache;
pub(crate) use statement::Bodies;

use glam::DVec3;

use crate::ast::Spanned;
use crate::color_name::ColorWord;
use crate::cursor::Cursor;
use crate::diagnostic::Diagnostic;
use crate::habit;
use crate::number_text;
use crate::shared::Shared;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Keyword, Soft, Symbol, Token, Word, shortened};

/// The statement cannot be read on; why has been reported.
#[derive(Debug)]
pub(crate) struct Failed;

/// Where numbers may be put together.
pub(crate) const ARITHMETIC: &str = "numbers are put together in parentheses, as in scale (2 * 3)";

/// How a vector is written.
const VECTOR: &str = "a vector is written (x, y, z)";

type Parsed<T> = Result<T, Failed>;

/// Reads statements off one file.
pub(crate) struct Parser<'a> {
    cursor: &'a mut Cursor,
    shared: &'a mut Shared,
}

/// Something that may be said once.
#[derive(Clone, Copy, Debug)]
enum Clause {
    Color,
    Shininess,
    Smoothness,
    Purity,
    Transparency,
    Priority,
    At,
    Toward,
    Scale,
    Rotate,
    Intensity,
    Shadows,
    Radius,
}

/// Where each clause was first said.
#[derive(Debug, Default)]
struct Seen([Option<Span>; 13]);

impl<'a> Parser<'a> {
    pub(crate) fn new(cursor: &'a mut Cursor, shared: &'a mut Shared) -> Self {
        Self { cursor, shared }
    }

    fn peek(&mut self) -> (Token, Span) {
        self.peek_at(0)
    }

    fn peek_at(&mut self, n: usize) -> (Token, Span) {
        self.cursor.peek(n, &mut self.shared.symbols, &mut self.shared.diagnostics)
    }

    fn advance(&mut self) {
        self.cursor.advance();
    }

    /// Takes the next token if it is `token`.
    fn take(&mut self, token: Token) -> Option<Span> {
        let (found, span) = self.peek();
        (found == token).then(|| {
            self.advance();
            span
        })
    }

    fn take_key(&mut self, keyword: Keyword) -> Option<Span> {
        self.take(Token::Word(Word::Key(keyword)))
    }

    fn expect(&mut self, token: Token, text: &str) -> Parsed<Span> {
        match self.take(token) {
            Some(span) => Ok(span),
            None => self.unexpected(text, &[]),
        }
    }

    fn expect_key(&mut self, keyword: Keyword) -> Parsed<Span> {
        match self.take_key(keyword) {
            Some(span) => Ok(span),
            None => self.unexpected(&format!("`{}`", keyword.text()), &[keyword.text()]),
        }
    }

    /// The same, with a hint that says how the whole is written, unless the next word was meant as the keyword.
    fn expect_key_in(&mut self, keyword: Keyword, whole: &str) -> Parsed<Span> {
        match self.take_key(keyword) {
            Some(span) => Ok(span),
            None => {
                let hint = self.meant(&[keyword.text()]);
                let hint = hint.unwrap_or_else(|| format!("it is written {whole}"));
                self.unexpected_because(&format!("`{}`", keyword.text()), Some(hint))
            }
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.shared.report(diagnostic);
    }

    fn fail<T>(&mut self, diagnostic: Diagnostic) -> Parsed<T> {
        self.report(diagnostic);
        Err(Failed)
    }

    /// The next token is not one that can stand here. `words` are those that a misspelt one may have meant.
    fn unexpected<T>(&mut self, expected: &str, words: &[&str]) -> Parsed<T> {
        let hint = self.meant(words);
        self.unexpected_because(expected, hint)
    }

    fn unexpected_because<T>(&mut self, expected: &str, hint: Option<String>) -> Parsed<T> {
        let (token, span) = self.peek();
        if token == Token::Bad {
            return Err(Failed);
        }
        let found = self.found(token, span);
        // The end of a file is shown where its text ends, not on the empty line below.
        let span = if token == Token::End { self.cursor.behind() } else { span };
        let message = format!("expected {expected}, found {found}");
        self.fail(Diagnostic::error(span, message).hint(hint).ill_formed())
    }

    /// Which of `words` the next token may have meant.
    fn meant(&mut self, words: &[&str]) -> Option<String> {
        let Token::Name(name) = self.peek().0 else { return None };
        self.meant_by(name, words.iter().copied())
    }

    fn meant_by<'w>(
        &self,
        name: Symbol,
        words: impl IntoIterator<Item = &'w str>,
    ) -> Option<String> {
        if !self.shared.diagnostics.open() {
            return None;
        }
        let text = self.shared.symbols.text(name);
        let meant = || did_you_mean(closest(text, words));
        habit::hint(text).map(str::to_owned).or_else(meant)
    }

    fn found(&self, token: Token, span: Span) -> String {
        match token {
            Token::End => "the end of the file".to_owned(),
            Token::Text => format!("the text {}", shortened(self.cursor.text(span))),
            Token::Number(_) => format!("the number {}", shortened(self.cursor.text(span))),
            _ => format!("`{}`", shortened(self.cursor.text(span))),
        }
    }

    /// Reports a clause that is said for the second time.
    fn once(&mut self, seen: &mut Seen, clause: Clause, span: Span) {
        let place = &mut seen.0[clause as usize];
        if let Some(first) = *place {
            let message = format!("{} is given twice", clause.text());
            self.report(Diagnostic::error(span, message).note(first, "first given here"));
        }
        place.get_or_insert(span);
    }

    /// A number that `test` accepts; `range` says in words which those are.
    fn number_in(
        &mut self,
        what: &str,
        range: &str,
        test: impl Fn(f64) -> bool,
    ) -> Parsed<Spanned<f64>> {
        let number = self.number()?;
        self.check_range(number, what, range, test);
        Ok(number)
    }

    /// The same, where operators may stand.
    fn expression_in(
        &mut self,
        what: &str,
        range: &str,
        test: impl Fn(f64) -> bool,
    ) -> Parsed<Spanned<f64>> {
        let number = self.expression()?;
        self.check_range(number, what, range, test);
        Ok(number)
    }

    /// A number that is not known is in every range.
    fn check_range(
        &mut self,
        number: Spanned<f64>,
        what: &str,
        range: &str,
        test: impl Fn(f64) -> bool,
    ) {
        if !number.value.is_nan() && !test(number.value) {
            self.out_of_range(what, range, number);
        }
    }

    fn out_of_range(&mut self, what: &str, range: &str, number: Spanned<f64>) {
        let message = format!("{what} has to be {range}, found {}", self.written(number));
        self.report(Diagnostic::error(number.span, message));
    }

    /// A number as it is written, or its value where it was worked out.
    fn written(&self, number: Spanned<f64>) -> String {
        let written = shortened(self.cursor.text(number.span));
        let literal = written.trim_start_matches(['+', '-']);
        let plain =
            literal.bytes().next().is_some_and(|byte| byte.is_ascii_digit() || byte == b'.');
        if plain && literal.parse::<f64>().is_ok() { written } else { number_text(number.value) }
    }

    fn vector(&mut self) -> Parsed<Spanned<DVec3>> {
        let (token, open) = self.peek();
        if token != Token::Open {
            return self.unexpected_because("`(`", Some(VECTOR.to_owned()));
        }
        self.advance();
        let first = self.expression()?.value;
        self.rest_of_vector(open, first)
    }

    /// What follows `(x`.
    fn rest_of_vector(&mut self, open: Span, first: f64) -> Parsed<Spanned<DVec3>> {
        let mut numbers = [first, 0.0, 0.0];
        for number in &mut numbers[1..] {
            if self.take(Token::Comma).is_none() {
                return self.unexpected_because("`,`", Some(VECTOR.to_owned()));
            }
            *number = self.expression()?.value;
        }
        let Some(close) = self.take(Token::Close) else {
            return self.unexpected_because("`)`", Some(VECTOR.to_owned()));
        };
        Ok(Spanned { value: DVec3::from_array(numbers), span: open.to(close) })
    }

    /// `light`, which is next, is a lightness here and does not begin a statement.
    fn light_is_lightness(&mut self) -> bool {
        matches!(
            self.peek_at(1).0,
            Token::Word(Word::Color(
                ColorWord::Saturation(_)
                    | ColorWord::Splash(_)
                    | ColorWord::Base(_)
                    | ColorWord::Gray
            ))
        )
    }

    /// The statement that the next token begins.
    fn at_statement(&mut self) -> Option<Start> {
        match self.peek().0 {
            Token::Word(Word::Key(keyword)) if Keyword::STATEMENTS.contains(&keyword) => {
                Some(Start::Key(keyword))
            }
            Token::Name(name) => match self.shared.symbols.soft(name) {
                Some(Soft::Let) => self.named_next(Token::Equals).then_some(Start::Let),
                Some(Soft::Repeat) => {
                    let (second, _) = self.peek_at(2);
                    let from = self.is_soft(second, Soft::From);
                    let next = self.peek_at(1).0;
                    let begins = matches!(next, Token::Name(_))
                        || from && matches!(next, Token::Word(_))
                        || matches!(next, Token::OpenBrace);
                    begins.then_some(Start::Repeat)
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// A name is next but one, or any word before `sign`, or the sign itself: where none of these can follow a name,
    /// what precedes them is a keyword.
    fn named_next(&mut self, sign: Token) -> bool {
        match self.peek_at(1).0 {
            Token::Name(_) => true,
            Token::Word(_) => self.peek_at(2).0 == sign,
            other => other == sign,
        }
    }

    /// True where a statement ends: another begins, or the body or the file is at its end.
    fn at_end(&mut self) -> bool {
        matches!(self.peek().0, Token::End | Token::CloseBrace) || self.at_statement().is_some()
    }

    /// Leaves everything behind up to the next statement, and says how many `{` that was.
    fn recover(&mut self) -> usize {
        let mut skipped = 0;
        loop {
            match self.at_statement() {
                Some(Start::Key(Keyword::Light)) if self.light_is_lightness() => {}
                Some(_) => return skipped,
                None if self.at_end() => return skipped,
                None => skipped += usize::from(self.peek().0 == Token::OpenBrace),
            }
            self.advance();
        }
    }
}

/// What begins a statement.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    Key(Keyword),
    Let,
    Repeat,
}

impl Clause {
    fn text(self) -> &'static str {
        match self {
            Self::Color => "the colour",
            Self::Shininess => "the shininess",
            Self::Smoothness => "the smoothness",
            Self::Purity => "`pure` or `composite`",
            Self::Transparency => "`trans`",
            Self::Priority => "`priority`",
            Self::At => "`at`",
            Self::Toward => "`toward`",
            Self::Scale => "`scale`",
            Self::Rotate => "`rotate`",
            Self::Intensity => "`intensity`",
            Self::Shadows => "`no shadows`",
            Self::Radius => "`radius`",
        }
    }
}
