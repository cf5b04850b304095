//! One statement after the other.

use scene::Rgb;

use super::{Clause, Failed, Parsed, Parser, Seen};
use crate::ast::{Class, Light, LightKind, Object, Spanned, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::token::{Keyword, Symbol, Token, Word};

/// The words that clauses of a light begin with.
const LIGHT_CLAUSES: &[Keyword] = &[Keyword::Intensity, Keyword::At, Keyword::Toward, Keyword::No];

impl Parser<'_> {
    /// The next statement that can be read; `None` at the end of the file.
    pub(crate) fn next_statement(&mut self) -> Option<Statement> {
        loop {
            let (token, span) = self.peek();
            if token == Token::End {
                return None;
            }
            let parsed = match self.at_statement() {
                Some(keyword) => {
                    self.advance();
                    self.statement(keyword)
                }
                None => self.no_statement(token),
            };
            match parsed {
                Ok(kind) => return Some(Statement { span, kind }),
                Err(Failed) => self.recover(),
            }
        }
    }

    fn no_statement<T>(&mut self, token: Token) -> Parsed<T> {
        let words: Vec<&str> = Keyword::STATEMENTS.iter().map(|keyword| keyword.text()).collect();
        let hint = match token {
            Token::Close => Some("there is one `)` too many".to_owned()),
            Token::Word(Word::Solid(_)) => Some("a solid stands after `object is`".to_owned()),
            _ => self.meant(&words),
        };
        let failed = self.unexpected_because("a statement", hint);
        self.advance();
        failed
    }

    fn statement(&mut self, keyword: Keyword) -> Parsed<StatementKind> {
        Ok(match keyword {
            Keyword::Include => self.include()?,
            Keyword::Class => self.class()?,
            Keyword::Object => self.object()?,
            Keyword::Camera => {
                self.expect_key(Keyword::At)?;
                StatementKind::Camera(self.vector()?.value)
            }
            Keyword::Target => {
                self.expect_key(Keyword::At)?;
                StatementKind::Target(self.vector()?.value)
            }
            Keyword::Focal => {
                self.expect_key(Keyword::Length)?;
                StatementKind::FocalLength(
                    self.number_in("the focal length", "above 0", |x| x > 0.0)?.value,
                )
            }
            Keyword::Light => self.light()?,
            Keyword::Ambient => self.ambient()?,
            Keyword::Background => StatementKind::Background(self.color()?),
            Keyword::Fog => StatementKind::Fog(
                self.number_in("the half distance of fog", "above 0", |x| x > 0.0)?.value,
            ),
            _ => return self.unexpected("a statement", &[]),
        })
    }

    fn include(&mut self) -> Parsed<StatementKind> {
        let (token, span) = self.peek();
        if token != Token::Text {
            return self.unexpected_because(
                "a file name",
                Some("it stands in quotes: include \"classes.sdl\"".to_owned()),
            );
        }
        self.advance();
        let text = self.cursor.text(Span { start: span.start + 1, end: span.end - 1 }).to_owned();
        if text.is_empty() {
            return self.fail(Diagnostic::error(span, "expected a file name, found none"));
        }
        Ok(StatementKind::Include(Spanned { value: text, span }))
    }

    fn class(&mut self) -> Parsed<StatementKind> {
        let (token, span) = self.peek();
        let Token::Name(symbol) = token else {
            return match token {
                Token::Word(_) => self.reserved("a class"),
                _ => self.unexpected("the name of the class", &[]),
            };
        };
        self.advance();
        let name = Spanned { value: symbol, span };
        let solid = match self.expect_key(Keyword::Is).and_then(|_| self.solid()) {
            Ok(solid) => Some(solid),
            Err(Failed) => {
                self.recover();
                None
            }
        };
        Ok(StatementKind::Class(Class { name, solid }))
    }

    fn object(&mut self) -> Parsed<StatementKind> {
        let name = self.object_name()?;
        if self.take_key(Keyword::Is).is_none() {
            let expected = if name.is_some() { "`is`" } else { "`is` or a name" };
            return self.unexpected(expected, &["is"]);
        }
        Ok(StatementKind::Object(Object { name, solid: self.solid()? }))
    }

    fn object_name(&mut self) -> Parsed<Option<Spanned<Symbol>>> {
        let (token, span) = self.peek();
        let is_next = self.peek_at(1).0 == Token::Word(Word::Key(Keyword::Is));
        match token {
            Token::Name(value) => {
                self.advance();
                Ok(Some(Spanned { value, span }))
            }
            Token::Word(_) if is_next => self.reserved("an object"),
            _ => Ok(None),
        }
    }

    fn reserved<T>(&mut self, what: &str) -> Parsed<T> {
        let (token, span) = self.peek();
        let found = self.found(token, span);
        let message = format!("{found} is a reserved word and cannot name {what}");
        self.fail(Diagnostic::error(span, message).hint("choose another name".to_owned()))
    }

    fn light(&mut self) -> Parsed<StatementKind> {
        let kind = self.light_kind()?;
        let mut light = Light { kind, at: None, toward: None, color: Rgb::ONE, shadows: true };
        let (mut seen, mut intensity) = (Seen::default(), 1.0);
        loop {
            let (token, span) = self.peek();
            match token {
                Token::Word(Word::Key(Keyword::At)) => {
                    self.advance();
                    self.once(&mut seen, Clause::At, span);
                    light.at = Some(self.vector()?);
                }
                Token::Word(Word::Key(Keyword::Toward)) => {
                    self.advance();
                    self.once(&mut seen, Clause::Toward, span);
                    light.toward = Some(self.vector()?);
                }
                Token::Word(Word::Key(Keyword::No)) => {
                    self.advance();
                    self.expect_key(Keyword::Shadows)?;
                    self.once(&mut seen, Clause::Shadows, span);
                    light.shadows = false;
                }
                Token::Word(Word::Key(Keyword::Intensity)) => {
                    intensity = self.intensity(&mut seen, span)?;
                }
                _ if self.at_color(&seen) => {
                    self.once(&mut seen, Clause::Color, span);
                    light.color = self.color()?;
                }
                _ => break,
            }
        }
        self.statement_ends(LIGHT_CLAUSES, "a clause of the light")?;
        light.color *= intensity;
        Ok(StatementKind::Light(light))
    }

    fn light_kind(&mut self) -> Parsed<LightKind> {
        if self.take_key(Keyword::Beam).is_some() {
            return Ok(LightKind::Beam);
        }
        if self.take_key(Keyword::Spot).is_none() {
            self.take_key(Keyword::Point);
            return Ok(LightKind::Point);
        }
        if self.peek().0 != Token::Open {
            let shape = "a spot is written spot (concentration, half-angle)".to_owned();
            return self.unexpected_because("`(`", Some(shape));
        }
        self.advance();
        let concentration =
            self.number_in("the concentration of a spot", "0 or more", |x| x >= 0.0)?.value;
        self.expect(Token::Comma, "`,`")?;
        let range = "above 0 and at most 180";
        let half_angle_degrees =
            self.number_in("the half-angle of a spot", range, |x| x > 0.0 && x <= 180.0)?.value;
        self.expect(Token::Close, "`)`")?;
        Ok(LightKind::Spot { concentration, half_angle_degrees })
    }

    fn ambient(&mut self) -> Parsed<StatementKind> {
        let (mut seen, mut intensity, mut color) = (Seen::default(), 1.0, Rgb::ONE);
        loop {
            let (token, span) = self.peek();
            if token == Token::Word(Word::Key(Keyword::Intensity)) {
                intensity = self.intensity(&mut seen, span)?;
            } else if self.at_color(&seen) {
                self.once(&mut seen, Clause::Color, span);
                color = self.color()?;
            } else {
                break;
            }
        }
        self.statement_ends(&[Keyword::Intensity], "an intensity or a colour")?;
        Ok(StatementKind::Ambient(color * intensity))
    }

    fn intensity(&mut self, seen: &mut Seen, span: Span) -> Parsed<f64> {
        self.advance();
        self.once(seen, Clause::Intensity, span);
        Ok(self.number_in("the intensity", "0 or more", |x| x >= 0.0)?.value)
    }

    /// A statement with optional parts ends at another statement; what else follows was meant as a part.
    fn statement_ends(&mut self, parts: &[Keyword], expected: &str) -> Parsed<()> {
        if self.at_statement().is_some() || self.peek().0 == Token::End {
            return Ok(());
        }
        let words: Vec<&str> =
            parts.iter().chain(Keyword::STATEMENTS).map(|keyword| keyword.text()).collect();
        let colors = self.color_words();
        let hint = self.meant(&[words.as_slice(), colors.as_slice()].concat());
        self.unexpected_because(&format!("{expected} or a statement"), hint)
    }
}
