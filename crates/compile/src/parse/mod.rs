//! Tokens to tree: what all parts of the parser share. After an error it goes on at the next statement.

mod attribute;
mod color;
mod paint;
mod solid;
mod statement;

pub(crate) use attribute::AttributesCache;

use glam::DVec3;
use scene::Scene;

use crate::ast::Spanned;
use crate::color_name::ColorWord;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::resolve::Classes;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Cursor, Keyword, Symbol, Symbols, Token, Word, shortened};

/// What all files of a run share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) symbols: Symbols,
    pub(crate) diagnostics: Diagnostics,
    pub(crate) attributes: AttributesCache,
    pub(crate) classes: Classes,
    pub(crate) scene: Scene,
}

impl Shared {
    pub(crate) fn new() -> Self {
        Self {
            symbols: Symbols::new(),
            diagnostics: Diagnostics::default(),
            attributes: AttributesCache::default(),
            classes: Classes::default(),
            scene: Scene::default(),
        }
    }
}

/// The statement cannot be read on; why has been reported.
#[derive(Debug)]
pub(crate) struct Failed;

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
}

/// Where each clause was first said.
#[derive(Debug, Default)]
struct Seen([Option<Span>; 12]);

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

    fn report(&mut self, diagnostic: Diagnostic) {
        self.shared.diagnostics.push(diagnostic);
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
        self.fail(Diagnostic::error(span, format!("expected {expected}, found {found}")).hint(hint))
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
        did_you_mean(closest(self.shared.symbols.text(name), words))
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

    fn number(&mut self) -> Parsed<Spanned<f64>> {
        let (token, start) = self.peek();
        let sign = match token {
            Token::Minus => -1.0,
            _ => 1.0,
        };
        if matches!(token, Token::Minus | Token::Plus) {
            self.advance();
        }
        let (token, span) = self.peek();
        let Token::Number(value) = token else {
            return self.unexpected("a number", &[]);
        };
        self.advance();
        Ok(Spanned { value: sign * value, span: start.to(span) })
    }

    /// A number that `test` accepts; `range` says in words which those are.
    fn number_in(
        &mut self,
        what: &str,
        range: &str,
        test: impl Fn(f64) -> bool,
    ) -> Parsed<Spanned<f64>> {
        let number = self.number()?;
        if !test(number.value) {
            self.out_of_range(what, range, number.span);
        }
        Ok(number)
    }

    fn out_of_range(&mut self, what: &str, range: &str, span: Span) {
        let found = shortened(self.cursor.text(span));
        self.report(Diagnostic::error(span, format!("{what} has to be {range}, found {found}")));
    }

    fn vector(&mut self) -> Parsed<Spanned<DVec3>> {
        let (token, open) = self.peek();
        let shape = "a vector is written (x, y, z)";
        if token != Token::Open {
            return self.unexpected_because("`(`", Some(shape.to_owned()));
        }
        self.advance();
        let mut numbers = [0.0; 3];
        for (i, number) in numbers.iter_mut().enumerate() {
            if i > 0 && self.take(Token::Comma).is_none() {
                return self.unexpected_because("`,`", Some(shape.to_owned()));
            }
            *number = self.number()?.value;
        }
        let Some(close) = self.take(Token::Close) else {
            return self.unexpected_because("`)`", Some(shape.to_owned()));
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
    fn at_statement(&mut self) -> Option<Keyword> {
        match self.peek().0 {
            Token::Word(Word::Key(keyword)) if Keyword::STATEMENTS.contains(&keyword) => {
                Some(keyword)
            }
            _ => None,
        }
    }

    /// Leaves everything behind up to the next statement.
    fn recover(&mut self) {
        loop {
            match self.at_statement() {
                Some(Keyword::Light) if self.light_is_lightness() => self.advance(),
                Some(_) => return,
                None if self.peek().0 == Token::End => return,
                None => self.advance(),
            }
        }
    }
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
        }
    }
}
