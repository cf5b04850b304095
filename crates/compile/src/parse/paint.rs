//! Paint: a texture function, its arguments, and a colour.

use scene::Paint;
use scene::texture::{FUNCTIONS, Texture};

use super::{Parsed, Parser};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Token, shortened};

impl Parser<'_> {
    /// What follows `paint`.
    pub(super) fn paint(&mut self) -> Parsed<Paint> {
        let mut texture = self.texture()?;
        if self.take(Token::Open).is_some() {
            self.settings(&mut texture)?;
        }
        Ok(Paint { texture, color: self.color()? })
    }

    fn texture(&mut self) -> Parsed<Texture> {
        let (token, span) = self.peek();
        let list = || {
            let words: Vec<&str> = FUNCTIONS.iter().map(|function| function.keyword).collect();
            format!("the texture functions are {}", words.join(", "))
        };
        if !matches!(token, Token::Name(_) | Token::Word(_)) {
            return self.unexpected_because("a texture function", Some(list()));
        }
        let word = self.cursor.text(span);
        if let Some(texture) = Texture::named(word) {
            self.advance();
            return Ok(texture);
        }
        let message = format!("unknown texture function `{}`", shortened(word));
        let meant = closest(&word.to_ascii_lowercase(), FUNCTIONS.iter().map(|f| f.keyword));
        let hint = match did_you_mean(meant) {
            Some(question) => format!("{question} {}", list()),
            None => list(),
        };
        self.fail(Diagnostic::error(span, message).hint(hint))
    }

    /// Arguments up to the `)`: first by place, then by name.
    fn settings(&mut self, texture: &mut Texture) -> Parsed<()> {
        let parameters = texture.function().parameters;
        let mut given: Vec<Option<Span>> = vec![None; parameters.len()];
        let mut named = false;
        for place in 0.. {
            let (token, span) = self.peek();
            let index = if self.peek_at(1).0 == Token::Equals {
                named = true;
                let index = self.parameter(texture, token, span)?;
                self.advance();
                self.advance();
                index
            } else if named {
                return self.unexpected("an argument with its name", &[]);
            } else {
                place
            };
            let number = self.expression()?;
            let at = if named { span } else { number.span };
            if let Some(first) = given.get(index).copied().flatten() {
                let message = format!("`{}` is given twice", parameters[index].name);
                self.report(Diagnostic::error(at, message).note(first, "first given here"));
            }
            let known = !number.value.is_nan();
            match texture.set(index, number.value) {
                Ok(()) => given[index] = Some(at),
                Err(Some(_)) if !known => given[index] = Some(at),
                Err(Some(parameter)) => {
                    let range = parameter.range.to_string();
                    self.out_of_range(&format!("`{}`", parameter.name), &range, number);
                }
                Err(None) => {
                    let message = format!("too many arguments for `{}`", keyword(texture));
                    return self.fail(Diagnostic::error(number.span, message).hint(shape(texture)));
                }
            }
            if self.take(Token::Close).is_some() {
                return Ok(());
            }
            self.expect(Token::Comma, "`,` or `)`")?;
        }
        Ok(())
    }

    fn parameter(&mut self, texture: &Texture, token: Token, span: Span) -> Parsed<usize> {
        if !matches!(token, Token::Name(_) | Token::Word(_)) {
            return self.unexpected_because("the name of an argument", Some(shape(texture)));
        }
        let word = self.cursor.text(span);
        let parameters = texture.function().parameters;
        if let Some(index) = parameters.iter().position(|p| p.name.eq_ignore_ascii_case(word)) {
            return Ok(index);
        }
        let message = format!("`{}` has no argument `{}`", keyword(texture), shortened(word));
        self.fail(Diagnostic::error(span, message).hint(shape(texture)))
    }
}

fn keyword(texture: &Texture) -> &'static str {
    texture.function().keyword
}

/// How the function is written, with its defaults.
fn shape(texture: &Texture) -> String {
    let parameters: Vec<String> = texture
        .function()
        .parameters
        .iter()
        .map(|parameter| format!("{} = {}", parameter.name, parameter.default))
        .collect();
    format!("it is written {} ({})", keyword(texture), parameters.join(", "))
}
