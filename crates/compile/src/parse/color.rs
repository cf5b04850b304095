//! Colours: names, hsv and rgb.

use scene::{Rgb, color};

use super::{Clause, Parsed, Parser, Seen};
use crate::color_name::{self, Base, COLOR_WORDS, ColorWord, Hue, Lightness};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::token::{Keyword, Token, Word};

const SHARE: &str = "from 0 to 1";

fn is_share(number: f64) -> bool {
    (0.0..=1.0).contains(&number)
}

impl Parser<'_> {
    /// True if a colour begins here. `light` does it only where a colour may still stand.
    pub(super) fn at_color(&mut self, seen: &Seen) -> bool {
        match self.peek().0 {
            Token::Word(Word::Color(_)) => true,
            Token::Word(Word::Key(Keyword::Light)) => {
                seen.0[Clause::Color as usize].is_none() && self.light_is_lightness()
            }
            _ => false,
        }
    }

    pub(super) fn color_words(&self) -> Vec<&'static str> {
        COLOR_WORDS.iter().map(|(text, _)| *text).collect()
    }

    /// A colour, linear.
    pub(super) fn color(&mut self) -> Parsed<Rgb> {
        let (token, _) = self.peek();
        match token {
            Token::Word(Word::Color(ColorWord::Black)) => self.achromatic(Lightness::BLACK),
            Token::Word(Word::Color(ColorWord::White)) => self.achromatic(Lightness::WHITE),
            Token::Word(Word::Color(ColorWord::Hsv)) => self.hsv(),
            Token::Word(Word::Color(ColorWord::Rgb)) => self.rgb(),
            Token::Word(Word::Color(_)) => self.color_name(),
            Token::Word(Word::Key(Keyword::Light)) => {
                if !self.light_is_lightness() && matches!(self.peek_at(1).0, Token::Name(_)) {
                    self.advance();
                }
                self.color_name()
            }
            _ => self.no_color("a colour"),
        }
    }

    fn no_color<T>(&mut self, expected: &str) -> Parsed<T> {
        let mut words = self.color_words();
        words.push(Keyword::Light.text());
        let hint = match self.peek().0 {
            Token::Open | Token::Number(_) => Some("it is written rgb (r, g, b)".to_owned()),
            Token::Word(_) => match expected {
                "a colour" => {
                    Some("a paint blends to a colour, as in paint checker red".to_owned())
                }
                _ => {
                    Some("a lightness and a saturation belong to a hue, as in dark red".to_owned())
                }
            },
            _ => self.meant(&words),
        };
        self.unexpected_because(expected, hint)
    }

    fn achromatic(&mut self, lightness: Lightness) -> Parsed<Rgb> {
        self.advance();
        Ok(color_name::gray(lightness))
    }

    fn color_word(&mut self) -> Option<ColorWord> {
        match self.peek().0 {
            Token::Word(Word::Color(word)) => Some(word),
            _ => None,
        }
    }

    fn color_name(&mut self) -> Parsed<Rgb> {
        let lightness = self.lightness()?;
        let saturation = match self.color_word() {
            Some(ColorWord::Saturation(share)) => {
                self.advance();
                Some(share)
            }
            _ => None,
        };
        if self.color_word() == Some(ColorWord::Gray) {
            if saturation.is_some() {
                let hint = "gray has a lightness only".to_owned();
                return self.unexpected_because("a hue", Some(hint));
            }
            return self.achromatic(lightness.unwrap_or(Lightness::MEDIUM));
        }
        let hue = self.hue(saturation.is_none())?;
        let lightness = lightness.unwrap_or(Lightness::MEDIUM);
        Ok(color_name::named(lightness, saturation.unwrap_or(1.0), hue))
    }

    fn lightness(&mut self) -> Parsed<Option<Lightness>> {
        let very = self.take(Token::Word(Word::Color(ColorWord::Very))).is_some();
        let lightness = match self.peek().0 {
            Token::Word(Word::Color(ColorWord::Dark)) if very => Lightness::VERY_DARK,
            Token::Word(Word::Key(Keyword::Light)) if very => Lightness::VERY_LIGHT,
            _ if very => return self.unexpected("`dark` or `light`", &["dark", "light"]),
            Token::Word(Word::Color(ColorWord::Dark)) => Lightness::DARK,
            Token::Word(Word::Color(ColorWord::Medium)) => Lightness::MEDIUM,
            Token::Word(Word::Key(Keyword::Light)) if self.light_is_lightness() => Lightness::LIGHT,
            _ => return Ok(None),
        };
        self.advance();
        Ok(Some(lightness))
    }

    fn hue(&mut self, saturation_may_stand: bool) -> Parsed<Hue> {
        let (_, start) = self.peek();
        match self.color_word() {
            Some(ColorWord::Splash(splash)) => {
                self.advance();
                let Some(ColorWord::Base(base)) = self.color_word() else {
                    return self.no_color("a hue");
                };
                let (_, end) = self.peek();
                self.advance();
                if let Some(joined) = self.joined() {
                    let message = "a mixed hue cannot be joined to another";
                    return self.fail(Diagnostic::error(start.to(joined.1), message));
                }
                self.neighbours(base, splash, 0.25, start.to(end))
            }
            Some(ColorWord::Base(base)) => {
                self.advance();
                match self.joined() {
                    Some((other, end)) => self.neighbours(base, other, 0.5, start.to(end)),
                    None => Ok(base.hue()),
                }
            }
            _ if saturation_may_stand => self.no_color("a saturation or a hue"),
            _ => self.no_color("a hue"),
        }
    }

    /// `- HUE` after a hue.
    fn joined(&mut self) -> Option<(Base, Span)> {
        let (token, span) = self.peek_at(1);
        match (self.peek().0, token) {
            (Token::Minus, Token::Word(Word::Color(ColorWord::Base(other)))) => {
                self.advance();
                self.advance();
                Some((other, span))
            }
            _ => None,
        }
    }

    fn neighbours(&mut self, base: Base, other: Base, share: f64, span: Span) -> Parsed<Hue> {
        if let Some(hue) = base.toward(other, share) {
            return Ok(hue);
        }
        let words = (base.word(), other.word());
        let (message, hint) = match base.between(other) {
            Some(middle) => (
                format!("{} and {} are not neighbours", words.0, words.1),
                format!("{} lies between them", middle.word()),
            ),
            None => (
                format!("no hue lies between {} and {}", words.0, words.1),
                "neighbours are red, orange, yellow, green, blue, purple, red; red, brown, yellow"
                    .to_owned(),
            ),
        };
        self.fail(Diagnostic::error(span, message).hint(hint))
    }

    fn hsv(&mut self) -> Parsed<Rgb> {
        self.advance();
        self.expect_components("hsv (hue, saturation, value)")?;
        let hue = self.expression()?.value;
        self.expect(Token::Comma, "`,`")?;
        let saturation = self.channel("the saturation")?;
        self.expect(Token::Comma, "`,`")?;
        let value = self.channel("the value")?;
        self.expect(Token::Close, "`)`")?;
        Ok(color_name::from_hsv(hue, saturation, value))
    }

    fn rgb(&mut self) -> Parsed<Rgb> {
        self.advance();
        self.expect_components("rgb (r, g, b)")?;
        let red = self.primary("red")?;
        self.expect(Token::Comma, "`,`")?;
        let green = self.primary("green")?;
        self.expect(Token::Comma, "`,`")?;
        let blue = self.primary("blue")?;
        self.expect(Token::Close, "`)`")?;
        Ok(color::linear([red, green, blue]))
    }

    /// The `(` of what is written so.
    fn expect_components(&mut self, written: &str) -> Parsed<()> {
        match self.take(Token::Open) {
            Some(_) => Ok(()),
            None => self.unexpected_because("`(`", Some(format!("it is written {written}"))),
        }
    }

    /// A number in 0…1.
    pub(super) fn share(&mut self, what: &str) -> Parsed<f64> {
        Ok(self.number_in(what, SHARE, is_share)?.value)
    }

    /// Red, green or blue.
    fn primary(&mut self, what: &str) -> Parsed<f64> {
        let number = self.expression()?;
        if number.value > 1.0 && number.value <= 255.0 {
            let message = format!("{what} has to be {SHARE}, found {}", self.written(number));
            let hint = "what is counted to 255 is divided by 255".to_owned();
            self.report(Diagnostic::error(number.span, message).hint(hint));
        } else {
            self.check_range(number, what, SHARE, is_share);
        }
        Ok(number.value)
    }

    /// A number in 0…1, in parentheses.
    fn channel(&mut self, what: &str) -> Parsed<f64> {
        let number = self.expression()?;
        if number.value > 1.0 && number.value <= 100.0 {
            let message = format!("{what} has to be {SHARE}, found {}", self.written(number));
            let hint = "percent are divided by 100".to_owned();
            self.report(Diagnostic::error(number.span, message).hint(hint));
        } else {
            self.check_range(number, what, SHARE, is_share);
        }
        Ok(number.value)
    }
}
