//! Solids with arguments: numbers by place or by name, or the points of an outline.

use scene::Form;
use scene::form::{Arguments, Row};
use scene::texture::Parameter;

use super::argument::Numbers;
use super::{Parsed, Parser};
use crate::ast::Spanned;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::token::{Symbol, Token};

impl Parser<'_> {
    /// The row of the solid called `name`, unless a class has taken the name.
    pub(super) fn form_called(&self, name: Symbol) -> Option<&'static Row> {
        let row = Row::named(self.shared.symbols.text(name))?;
        (!self.shared.classes.contains(name)).then_some(row)
    }

    /// The arguments of a solid whose word, at `start`, has been taken; nothing where they are not known or wrong.
    pub(super) fn form(&mut self, row: &'static Row, start: Span) -> Parsed<Option<Form>> {
        let numbers = match row.arguments {
            Arguments::Numbers(parameters) => self.form_numbers(row, parameters)?,
            Arguments::Points => self.form_points(row)?,
        };
        if numbers.iter().any(|number| number.value.is_nan()) {
            return Ok(None);
        }
        let values: Vec<f64> = numbers.iter().map(|number| number.value).collect();
        match Form::new(row, &values) {
            Ok(form) => Ok(Some(form)),
            Err(error) => {
                let whole = start.to(self.cursor.behind());
                let span = numbers.get(error.argument).map_or(whole, |number| number.span);
                let span = if span == Span::default() { whole } else { span };
                let error = Diagnostic::error(span, error.to_string());
                self.report(error.hint(written(row)));
                Ok(None)
            }
        }
    }

    /// Numbers up to the `)`: first by place, then by name. Without parentheses all have their defaults.
    fn form_numbers(&mut self, row: &Row, parameters: &[Parameter]) -> Parsed<Vec<Spanned<f64>>> {
        let default = |p: &Parameter| Spanned { value: p.default, span: Span::default() };
        let mut numbers: Vec<Spanned<f64>> = parameters.iter().map(default).collect();
        if self.take(Token::Open).is_none() {
            return Ok(numbers);
        }
        self.argument_list(&Numbers { row, parameters }, |parser, index, _| {
            numbers[index] = parser.expression()?;
            Ok(numbers[index].span)
        })?;
        Ok(numbers)
    }

    /// `((x, y), (x, y), …)`.
    fn form_points(&mut self, row: &Row) -> Parsed<Vec<Spanned<f64>>> {
        let mut numbers = Vec::new();
        if self.take(Token::Open).is_none() {
            return self.unexpected_because("the points of the outline", Some(written(row)));
        }
        loop {
            let Some(open) = self.take(Token::Open) else {
                return self.unexpected_because("a point (x, y)", Some(written(row)));
            };
            let x = self.expression()?.value;
            self.expect(Token::Comma, "`,`")?;
            let y = self.expression()?.value;
            let span = open.to(self.expect(Token::Close, "`)`")?);
            numbers.extend([x, y].map(|value| Spanned { value, span }));
            if self.take(Token::Close).is_some() {
                return Ok(numbers);
            }
            self.expect(Token::Comma, "`,` or `)`")?;
        }
    }
}

fn written(row: &Row) -> String {
    format!("it is written {}", row.shape())
}
