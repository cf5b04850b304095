//! Paint: a texture function, what it works on, its arguments, and a colour.

use scene::Paint;
use scene::texture::{FUNCTIONS, Parameter, Range, Setting, Texture, Weight};

use super::argument::Settings;
use super::{Parsed, Parser, Seen};
use crate::ast::Spanned;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Token, Word, shortened};

impl Parser<'_> {
    /// What follows `paint`.
    pub(super) fn paint(&mut self) -> Parsed<Paint> {
        let texture = self.texture()?;
        let color = if texture.needs_color() || self.at_color(&Seen::default()) {
            Some(self.color()?)
        } else {
            None
        };
        Ok(Paint { texture, color })
    }

    /// A texture function with all that stands in its parentheses.
    fn texture(&mut self) -> Parsed<Texture> {
        let (mut texture, word) = self.texture_function()?;
        let subject = texture.function().subject();
        if self.take(Token::Open).is_some() {
            if subject.is_some() {
                texture = self.subject(texture)?;
            }
            let more = if subject.is_some() { self.another_argument()? } else { true };
            if more {
                self.settings(&mut texture)?;
            }
        } else if let Some(subject) = subject {
            let message = format!("expected a {subject} for `{}`, found none", keyword(&texture));
            return self.fail(Diagnostic::error(word, message).hint(shape(&texture)));
        }
        Ok(texture)
    }

    fn texture_function(&mut self) -> Parsed<(Texture, Span)> {
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
            return Ok((texture, span));
        }
        let message = format!("unknown texture function `{}`", shortened(word));
        if let Token::Word(Word::Color(_)) = token {
            let hint = "a paint has a texture function, as in paint checker red; a colour alone \
                        stands in front of its solid";
            let message = format!("expected a texture function, found `{}`", shortened(word));
            return self.fail(Diagnostic::error(span, message).hint(hint.to_owned()));
        }
        let meant = closest(&word.to_ascii_lowercase(), FUNCTIONS.iter().map(|f| f.keyword));
        let hint = match did_you_mean(meant) {
            Some(question) => format!("{question} {}", list()),
            None => list(),
        };
        self.fail(Diagnostic::error(span, message).hint(hint))
    }

    /// What a function works on: the file of a picture, or another function.
    fn subject(&mut self, texture: Texture) -> Parsed<Texture> {
        let (token, span) = self.peek();
        if matches!(texture.function().weight, Weight::Relief) {
            let refused = Diagnostic::error(span, "a relief cannot be made of a relief")
                .hint("give each a `paint bump` of its own".to_owned());
            // Before it is read: a text can nest them as deeply as it likes.
            let next = Texture::named(self.cursor.text(span));
            if next.is_some_and(|next| matches!(next.function().weight, Weight::Relief)) {
                return self.fail(refused);
            }
            let inner = self.texture()?;
            return match texture.of_function(inner) {
                Some(texture) => Ok(texture),
                None => self.fail(refused),
            };
        }
        if token != Token::Text {
            let hint = format!("it stands in quotes, and first; {}", shape(&texture));
            return self.unexpected_because("a file name", Some(hint));
        }
        self.advance();
        let name = self.cursor.text(Span { start: span.start + 1, end: span.end - 1 });
        if name.is_empty() {
            return self.fail(Diagnostic::error(span, "expected a file name, found none"));
        }
        if name.contains(char::is_control) {
            let message = "expected a file name without control characters";
            return self.fail(Diagnostic::error(span, message));
        }
        Ok(texture.of_image(self.shared.images.add(name, span)))
    }

    /// Takes the `,` before another argument, or the `)` after the last.
    fn another_argument(&mut self) -> Parsed<bool> {
        if self.take(Token::Close).is_some() {
            return Ok(false);
        }
        self.expect(Token::Comma, "`,` or `)`")?;
        Ok(true)
    }

    /// Arguments up to the `)`.
    fn settings(&mut self, texture: &mut Texture) -> Parsed<()> {
        let signature = Settings::of(texture);
        let mut given: Vec<Option<Span>> = vec![None; signature.settings.len()];
        self.argument_list(&signature, |parser, index, name| {
            let value = parser.setting(texture, &signature.settings[index])?;
            given[index] = Some(name.unwrap_or(value));
            Ok(value)
        })?;
        self.check_points(texture, &signature.settings, &given);
        Ok(())
    }

    /// The value of an argument; returns where it stands.
    fn setting(&mut self, texture: &mut Texture, setting: &Setting) -> Parsed<Span> {
        match setting.range() {
            Range::Word(words) => {
                let (_, span) = self.peek();
                let number = self.one_of(words)?;
                self.set(texture, setting.first, Spanned { value: number, span });
                Ok(span)
            }
            Range::Coordinate(_) => {
                let point = self.vector()?;
                for (axis, value) in point.value.to_array().into_iter().enumerate() {
                    self.set(texture, setting.first + axis, Spanned { value, span: point.span });
                }
                Ok(point.span)
            }
            _ => {
                let number = self.expression()?;
                self.set(texture, setting.first, number);
                Ok(number.span)
            }
        }
    }

    /// Sets a number, or says what it has to be; one that is not known is in every range.
    fn set(&mut self, texture: &mut Texture, index: usize, number: Spanned<f64>) {
        let known = !number.value.is_nan();
        if let Err(Some(&Parameter { name, range, .. })) = texture.set(index, number.value)
            && known
        {
            self.out_of_range(&format!("`{name}`"), &range.to_string(), number);
        }
    }

    /// The place of the next word among `words`.
    fn one_of(&mut self, words: &[&str]) -> Parsed<f64> {
        let (token, span) = self.peek();
        let range = format!("one of {}", words.join(", "));
        if !matches!(token, Token::Name(_) | Token::Word(_)) {
            return self.unexpected_because(&range, None);
        }
        let word = self.cursor.text(span);
        if let Some(place) = words.iter().position(|known| known.eq_ignore_ascii_case(word)) {
            self.advance();
            return Ok(place as f64);
        }
        let meant = closest(&word.to_ascii_lowercase(), words.iter().copied());
        self.unexpected_because(&range, did_you_mean(meant))
    }

    /// What goes from one point to another needs two.
    fn check_points(&mut self, texture: &Texture, settings: &[Setting], given: &[Option<Span>]) {
        let coordinates = |setting: &Setting| {
            let numbers = &texture.arguments()[setting.first..setting.first + setting.rows.len()];
            numbers.iter().map(|number| number.to_bits()).collect::<Vec<u64>>()
        };
        let mut points = settings
            .iter()
            .zip(given)
            .filter(|(setting, _)| matches!(setting.range(), Range::Coordinate(_)));
        let (Some((first, from)), Some((second, to))) = (points.next(), points.next()) else {
            return;
        };
        if let Some(at) = to.or(*from)
            && coordinates(first) == coordinates(second)
            && self.shared.checking == 0
        {
            let (first, second) = (first.name(), second.name());
            let message = format!("`{first}` and `{second}` are the same point");
            self.report(Diagnostic::error(at, message).hint(shape(texture)));
        }
    }
}

fn keyword(texture: &Texture) -> &'static str {
    texture.function().keyword
}

/// How the function is written, with its defaults.
fn shape(texture: &Texture) -> String {
    format!("it is written {}", Settings::of(texture).shape)
}
