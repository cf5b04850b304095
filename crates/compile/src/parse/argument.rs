//! Arguments in parentheses: first by place, then by name.

use scene::form::Row;
use scene::texture::{Parameter, Setting, Texture};

use super::{Parsed, Parser};
use crate::ast::Definition;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::suggestion::closest;
use crate::token::{Symbols, Token, shortened};

/// What may stand in the parentheses behind a word.
pub(super) trait Signature {
    /// What one of them is called.
    const NOUN: &'static str;

    /// The word.
    fn word<'t>(&'t self, symbols: &'t Symbols) -> &'t str;

    /// How many there may be.
    fn count(&self) -> usize;

    /// The name of one of them.
    fn name<'t>(&'t self, index: usize, symbols: &'t Symbols) -> &'t str;

    /// How it is written, with its defaults.
    fn shape(&self, symbols: &Symbols) -> String;
}

/// A solid with numbers.
pub(super) struct Numbers<'t> {
    pub(super) row: &'t Row,
    pub(super) parameters: &'t [Parameter],
}

impl Signature for Numbers<'_> {
    const NOUN: &'static str = "argument";

    fn word<'t>(&'t self, _: &'t Symbols) -> &'t str {
        self.row.keyword
    }

    fn count(&self) -> usize {
        self.parameters.len()
    }

    fn name<'t>(&'t self, index: usize, _: &'t Symbols) -> &'t str {
        self.parameters[index].name
    }

    fn shape(&self, _: &Symbols) -> String {
        self.row.shape()
    }
}

/// A texture function.
pub(super) struct Settings {
    pub(super) keyword: &'static str,
    pub(super) settings: Vec<Setting>,
    pub(super) shape: String,
}

impl Settings {
    pub(super) fn of(texture: &Texture) -> Self {
        let function = texture.function();
        let subject = match function.subject() {
            Some("file") => Some("\"FILE\"".to_owned()),
            Some(_) => Some("FUNCTION".to_owned()),
            None => None,
        };
        let settings: Vec<Setting> = function.settings().collect();
        let defaults = settings.iter().map(|s| format!("{} = {}", s.name(), s.default()));
        let all: Vec<String> = subject.into_iter().chain(defaults).collect();
        let shape = format!("{} ({})", function.keyword, all.join(", "));
        Self { keyword: function.keyword, settings, shape }
    }
}

impl Signature for Settings {
    const NOUN: &'static str = "argument";

    fn word<'t>(&'t self, _: &'t Symbols) -> &'t str {
        self.keyword
    }

    fn count(&self) -> usize {
        self.settings.len()
    }

    fn name<'t>(&'t self, index: usize, _: &'t Symbols) -> &'t str {
        self.settings[index].name()
    }

    fn shape(&self, _: &Symbols) -> String {
        self.shape.clone()
    }
}

impl Signature for Definition {
    const NOUN: &'static str = "parameter";

    fn word<'t>(&'t self, symbols: &'t Symbols) -> &'t str {
        symbols.text(self.name)
    }

    fn count(&self) -> usize {
        self.parameters.len()
    }

    fn name<'t>(&'t self, index: usize, symbols: &'t Symbols) -> &'t str {
        symbols.text(self.parameters[index].name.value)
    }

    fn shape(&self, symbols: &Symbols) -> String {
        let parameter = |i: usize| {
            let name = self.name(i, symbols);
            let Some(default) = &self.parameters[i].default else { return name.to_owned() };
            let range = default.span.start - self.base..default.span.end - self.base;
            let text = self.text.get(range.start as usize..range.end as usize);
            format!("{name} = {}", shortened(text.unwrap_or_default()))
        };
        let parameters: Vec<String> = (0..self.count()).map(parameter).collect();
        format!("{} ({})", self.word(symbols), parameters.join(", "))
    }
}

impl Parser<'_> {
    /// The hint that says how something is written.
    pub(super) fn written_as(&self, signature: &impl Signature) -> String {
        format!("it is written {}", signature.shape(&self.shared.symbols))
    }

    /// Arguments up to the `)`. `read` takes the value of the one with an index, and is told where its name stands; it
    /// returns where the value does.
    pub(super) fn argument_list(
        &mut self,
        signature: &impl Signature,
        mut read: impl FnMut(&mut Self, usize, Option<Span>) -> Parsed<Span>,
    ) -> Parsed<()> {
        let mut given: Vec<Option<Span>> = vec![None; signature.count()];
        let mut named = false;
        for place in 0.. {
            let (token, span) = self.peek();
            let name = (self.peek_at(1).0 == Token::Equals).then_some(span);
            let index = if name.is_some() {
                named = true;
                let index = self.argument_named(signature, token, span)?;
                self.advance();
                self.advance();
                index
            } else if named {
                let hint = "arguments without a name stand first".to_owned();
                return self.unexpected_because("an argument with its name", Some(hint));
            } else {
                place
            };
            if index >= signature.count() {
                let value = self.expression()?;
                let word = signature.word(&self.shared.symbols);
                let message = format!("too many arguments for `{word}`");
                let shape = self.written_as(signature);
                return self.fail(Diagnostic::error(value.span, message).hint(shape));
            }
            let value = read(self, index, name)?;
            let at = name.unwrap_or(value);
            if let Some(first) = given[index] {
                let text = signature.name(index, &self.shared.symbols);
                let message = format!("`{text}` is given twice");
                let error = Diagnostic::error(at, message).hint(self.written_as(signature));
                self.report(error.note(first, "first given here"));
            }
            given[index].get_or_insert(at);
            if self.take(Token::Close).is_some() {
                break;
            }
            self.expect(Token::Comma, "`,` or `)`")?;
        }
        Ok(())
    }

    fn argument_named<S: Signature>(
        &mut self,
        signature: &S,
        token: Token,
        span: Span,
    ) -> Parsed<usize> {
        let shape = self.written_as(signature);
        if !matches!(token, Token::Name(_) | Token::Word(_)) {
            return self.unexpected_because(&format!("the name of a {}", S::NOUN), Some(shape));
        }
        let (word, symbols) = (self.cursor.text(span), &self.shared.symbols);
        let names = || (0..signature.count()).map(|i| signature.name(i, symbols));
        if let Some(index) = names().position(|name| name.eq_ignore_ascii_case(word)) {
            return Ok(index);
        }
        let hint = match closest(&word.to_ascii_lowercase(), names()) {
            Some(meant) => format!("did you mean `{meant}`? {shape}"),
            None => shape,
        };
        let owner = signature.word(symbols);
        let message = format!("`{owner}` has no {} `{}`", S::NOUN, shortened(word));
        self.fail(Diagnostic::error(span, message).hint(hint))
    }
}
