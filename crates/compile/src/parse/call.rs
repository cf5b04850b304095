//! Classes with parameters: how they are named, and how they are made where they are used.

use std::sync::Arc;

use scene::Primitive;

use super::{Parsed, Parser};
use crate::ast::{Definition, Parameter, Solid, Spanned, Standard};
use crate::cursor::Cursor;
use crate::diagnostic::Diagnostic;
use crate::index::Kind;
use crate::source::Span;
use crate::token::{Keyword, Symbol, Token, Word};
use crate::value::Value;

/// A class with a number for each of its parameters; NaN where that is not known.
#[derive(Debug)]
pub(super) struct Call {
    pub(super) definition: Arc<Definition>,
    pub(super) numbers: Vec<f64>,
    /// The name and the arguments.
    pub(super) span: Span,
}

impl Parser<'_> {
    /// Parameters and solid of the class `name`, up to the statement that follows. The solid is checked for numbers that
    /// are not known; nothing is made of it.
    pub(super) fn parametric(
        &mut self,
        name: Spanned<Symbol>,
    ) -> (Option<Definition>, Parsed<Solid>) {
        self.shared.values.open_class();
        self.shared.checking += 1;
        let mut definition = None;
        let solid = self.parameters().and_then(|parameters| {
            self.expect_key(Keyword::Is)?;
            let (_, next) = self.peek();
            let (text, base) = self.cursor.file();
            let start = (next.start - base) as usize;
            let text = Arc::clone(text);
            let solid = self.solid();
            let length = u64::from(self.cursor.behind().end.saturating_sub(next.start));
            let (name, sees) = (name.value, self.shared.classes.count());
            definition = Some(Definition { name, text, base, start, length, parameters, sees });
            solid
        });
        self.shared.checking -= 1;
        self.shared.values.close_definition();
        (definition, solid)
    }

    /// `(a, b = 1)`.
    fn parameters(&mut self) -> Parsed<Vec<Parameter>> {
        self.expect(Token::Open, "`(`")?;
        let mut parameters: Vec<Parameter> = Vec::new();
        loop {
            let name = self.number_name("a parameter")?;
            let mut default = None;
            if self.take(Token::Equals).is_some() {
                let (_, next) = self.peek();
                let start = (next.start - self.cursor.file().1) as usize;
                let Spanned { value, span } = self.expression()?;
                default = Some(Standard { start, value, span });
            } else if parameters.last().is_some_and(|last| last.default.is_some()) {
                let text = self.shared.symbols.text(name.value);
                let message = format!("expected a default for `{text}`, found none");
                self.report(
                    Diagnostic::error(name.span, message)
                        .hint("parameters without a default stand first".to_owned()),
                );
            }
            self.shared.define(Kind::Parameter, name, name.span);
            let value = Value { number: f64::NAN, span: name.span };
            if let Some(first) = self.shared.values.set(name.value, value) {
                let text = self.shared.symbols.text(name.value);
                let message = format!("there is a parameter `{text}` already");
                let error = Diagnostic::error(name.span, message);
                self.report(error.note(first, "first named here"));
            } else {
                parameters.push(Parameter { name, default });
            }
            if self.take(Token::Close).is_some() {
                return Ok(parameters);
            }
            if self.take(Token::Comma).is_none() {
                return self.unexpected("`,`, `=` or `)`", &[]);
            }
        }
    }

    /// The arguments of a class whose name, at `start`, has been taken.
    pub(super) fn arguments(&mut self, definition: &Arc<Definition>, start: Span) -> Parsed<Call> {
        let mut given: Vec<Option<Spanned<f64>>> = vec![None; definition.parameters.len()];
        if self.take(Token::Open).is_some() {
            let parameters = &definition.parameters;
            self.argument_list(&**definition, |parser, index, name| {
                if let Some(name) = name {
                    parser.shared.record.refer(name, parameters[index].name.span);
                }
                let number = parser.expression()?;
                given[index] = Some(number);
                Ok(number.span)
            })?;
        }
        let span = start.to(self.cursor.behind());
        let mut complete = true;
        for (parameter, given) in definition.parameters.iter().zip(&given) {
            if given.is_none() && parameter.default.is_none() {
                let text = self.shared.symbols.text(parameter.name.value);
                let message = format!("expected a number for `{text}`, found none");
                let shape = self.written_as(&**definition);
                self.report(Diagnostic::error(span, message).hint(shape));
                complete = false;
            }
        }
        let numbers = if complete && self.shared.checking == 0 {
            self.completed(definition, &given)?
        } else {
            vec![f64::NAN; given.len()]
        };
        Ok(Call { definition: Arc::clone(definition), numbers, span })
    }

    /// The numbers given, and the defaults of the others, which may depend on those that precede them.
    fn completed(
        &mut self,
        definition: &Definition,
        given: &[Option<Spanned<f64>>],
    ) -> Parsed<Vec<f64>> {
        let mut numbers = Vec::with_capacity(given.len());
        for (i, given) in given.iter().enumerate() {
            let default = definition.parameters[i].default.as_ref();
            numbers.push(match (given, default) {
                (Some(given), _) => given.value,
                (None, Some(default)) if default.value.is_nan() => {
                    self.bind(definition, &numbers);
                    let text = Arc::clone(&definition.text);
                    let there = Cursor::at(text, definition.base, default.start);
                    let here = std::mem::replace(self.cursor, there);
                    let number = self.expression();
                    *self.cursor = here;
                    self.shared.values.close_class();
                    number?.value
                }
                (None, default) => default.map_or(f64::NAN, |default| default.value),
            });
        }
        Ok(numbers)
    }

    /// Opens the class, with these numbers for its first parameters.
    pub(super) fn bind(&mut self, definition: &Definition, numbers: &[f64]) {
        self.shared.values.open_class();
        for (parameter, &number) in definition.parameters.iter().zip(numbers) {
            let Spanned { value: name, span } = parameter.name;
            self.shared.values.set(name, Value { number, span });
        }
    }

    /// The next token is a `(` behind the name of no class, with what can only be arguments in it.
    pub(super) fn at_arguments(&mut self, n: usize) -> bool {
        self.peek_at(n).0 == Token::Open
            && match self.peek_at(n + 1).0 {
                Token::Number(_) | Token::Minus | Token::Plus => true,
                Token::Name(_) | Token::Word(Word::Key(_)) => {
                    matches!(
                        self.peek_at(n + 2).0,
                        Token::Equals | Token::Comma | Token::Over | Token::Power
                    )
                }
                _ => false,
            }
    }

    /// A class that is not known, or has no parameters, is used with arguments.
    pub(super) fn not_parametric(&mut self, name: Symbol, span: Span) {
        self.skip_parentheses();
        let text = self.shared.symbols.text(name);
        let solid = !self.shared.classes.contains(name) && Primitive::named(text).is_some();
        if solid || self.shared.classes.is_plain(name) {
            let what = if solid { "solid" } else { "class" };
            let message = format!("{what} `{text}` has no parameters");
            let span = span.to(self.cursor.behind());
            self.report(Diagnostic::error(span, message));
        }
    }
}
