//! One statement after the other.

use std::sync::Arc;

use scene::Rgb;

use super::solid::NESTING_LIMIT;
use super::turns::{Range, Turns};
use super::{ARITHMETIC, Clause, Failed, Parsed, Parser, Seen, Start};
use crate::ast::{Class, Lens, Light, LightKind, Object, Spanned, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::index::Kind;
use crate::source::Span;
use crate::token::{Keyword, Soft, Symbol, Token, Word, shortened};
use crate::value::Value;

/// The words that clauses of a light begin with.
const LIGHT_CLAUSES: &[Keyword] = &[Keyword::Intensity, Keyword::At, Keyword::Toward, Keyword::No];

/// The words for the kinds of light.
const LIGHT_KINDS: &[Keyword] = &[Keyword::Point, Keyword::Beam, Keyword::Spot];

/// How a light is written.
const LIGHT: &str = "it is written light at (x, y, z), light beam toward (x, y, z), \
    or light spot (c, a) at (x, y, z) toward (x, y, z); radius r makes shadows soft";

/// How a camera is written.
const CAMERA: &str = "it is written camera at (x, y, z), camera parallel at (x, y, z), \
    or camera at (x, y, z) aperture N focus at (x, y, z)";

/// How light from everywhere is written.
const AMBIENT: &str = "it is written ambient intensity 0.3 light blue; both may be left out";

/// How a repeat is written.
const REPEAT: &str = "it is written repeat i from 1 to 12 { … }";

/// Words that begin statements although they are not reserved.
const SOFT_STATEMENTS: &[Soft] = &[Soft::Let, Soft::Repeat];

/// The repeats that the next statement of a file is in.
#[derive(Debug, Default)]
pub(crate) struct Bodies {
    open: Vec<Body>,
    /// Each `{` that was left behind after an error; its `}` says nothing new.
    skipped: usize,
}

/// A repeat that is being read.
#[derive(Debug)]
struct Body {
    /// Its `{`.
    open: Span,
    turns: Turns,
}

impl Parser<'_> {
    /// The next statement that can be read; `None` at the end of the file. `bodies` are the repeats it is in.
    pub(crate) fn next_statement(&mut self, bodies: &mut Bodies) -> Option<Statement> {
        loop {
            let (token, span) = self.peek();
            let parsed = match (self.at_statement(), token) {
                (Some(Start::Key(keyword)), _) => {
                    self.advance();
                    self.statement(keyword, span).map(Some)
                }
                (Some(Start::Let), _) => {
                    self.advance();
                    self.binding(span).map(|()| None)
                }
                (Some(Start::Repeat), _) => {
                    self.advance();
                    self.repeat(bodies).map(|()| None)
                }
                (None, Token::CloseBrace) => {
                    self.advance();
                    self.end_body(bodies, span).map(|()| None)
                }
                (None, Token::End) if bodies.open.is_empty() => return None,
                (None, Token::End) => {
                    self.unclosed(bodies);
                    return None;
                }
                (None, _) => self.no_statement(token),
            };
            match parsed {
                Ok(Some(kind)) => {
                    if bodies.open.is_empty() || self.may_be_repeated(&kind, span) {
                        return Some(Statement { span, kind });
                    }
                }
                Ok(None) => {}
                Err(Failed) => bodies.skipped += self.recover(),
            }
        }
    }

    /// Objects and lights may; others may be taken into the scene all the same, but for files, after the error.
    fn may_be_repeated(&mut self, kind: &StatementKind, span: Span) -> bool {
        if matches!(kind, StatementKind::Object(_) | StatementKind::Light(_)) {
            return true;
        }
        let found = self.cursor.text(span);
        let message = format!("expected a statement that can be repeated, found `{found}`");
        self.report(
            Diagnostic::error(span, message).hint(
                "objects, lights, `let` and `repeat` stand in the body of a repeat".to_owned(),
            ),
        );
        let included = matches!(kind, StatementKind::Include(_));
        self.shared.incomplete |= included;
        !included
    }

    fn no_statement<T>(&mut self, token: Token) -> Parsed<T> {
        let words: Vec<&str> = Keyword::STATEMENTS
            .iter()
            .map(|keyword| keyword.text())
            .chain(SOFT_STATEMENTS.iter().map(|soft| soft.text()))
            .collect();
        let hint = match token {
            Token::Plus | Token::Minus | Token::Times | Token::Over | Token::Power => {
                Some(ARITHMETIC.to_owned())
            }
            Token::Close => Some("there is one `)` too many".to_owned()),
            Token::Word(Word::Solid(_)) => Some(
                "a solid stands after `object is`, as in object is sphere at (0, 1, 0)".to_owned(),
            ),
            _ => self.meant(&words),
        };
        let failed = self.unexpected_because("a statement", hint);
        self.advance();
        failed
    }

    /// What follows `let`, which is at `start`.
    fn binding(&mut self, start: Span) -> Parsed<()> {
        let name = self.number_name("a number")?;
        let read = match self.expect(Token::Equals, "`=`") {
            Ok(_) => self.expression(),
            Err(Failed) => Err(Failed),
        };
        let mut number = read.as_ref().map_or(f64::NAN, |number| number.value);
        if self.shared.uses.is_empty()
            && let Some((given, used)) = self.shared.given.get_mut(&name.value)
        {
            (number, *used) = (*given, true);
        }
        self.shared.define(Kind::Let, name, start.to(self.cursor.behind()));
        if let Some(first) = self.shared.values.set(name.value, Value { number, span: name.span }) {
            let text = self.shared.symbols.text(name.value);
            let message = format!("there is a number `{text}` already");
            self.report(
                Diagnostic::error(name.span, message)
                    .note(first, "first named here")
                    .hint("a name keeps its number; choose another name".to_owned()),
            );
        }
        read?;
        if self.at_end() { Ok(()) } else { self.unexpected("an operator or a statement", &[]) }
    }

    fn repeat(&mut self, bodies: &mut Bodies) -> Parsed<()> {
        let (token, span) = self.peek();
        let range = match self.range() {
            Ok(range) => range,
            Err(Failed) => {
                // The body is checked all the same.
                while !self.at_end() && self.peek().0 != Token::OpenBrace {
                    self.advance();
                }
                let value = match token {
                    Token::Name(name) => name,
                    _ => self.shared.symbols.intern(Soft::Repeat.text()),
                };
                Range::unknown(Spanned { value, span })
            }
        };
        let (token, open) = self.peek();
        if token != Token::OpenBrace {
            let hint = self.meant(&[Soft::Step.text()]).unwrap_or_else(|| REPEAT.to_owned());
            return self.unexpected_because("`{`", Some(hint));
        }
        if bodies.open.len() >= NESTING_LIMIT {
            let message = format!("repeats nest deeper than {NESTING_LIMIT}");
            return self.fail(Diagnostic::error(open, message));
        }
        self.advance();
        let turns = self.begin_turns(range);
        bodies.open.push(Body { open, turns });
        Ok(())
    }

    fn end_body(&mut self, bodies: &mut Bodies, span: Span) -> Parsed<()> {
        if bodies.skipped > 0 {
            bodies.skipped -= 1;
            return Ok(());
        }
        let Some(body) = bodies.open.last_mut() else {
            let error = Diagnostic::error(span, "expected a statement, found `}`");
            return self.fail(error.hint("there is one `}` too many".to_owned()));
        };
        if !self.another_turn(&mut body.turns) {
            bodies.open.pop();
        }
        Ok(())
    }

    /// The file ends within bodies.
    fn unclosed(&mut self, bodies: &mut Bodies) {
        while let Some(body) = bodies.open.pop() {
            let error = Diagnostic::error(body.open, "this `{` is not closed");
            self.report(error.hint("expected `}` before the end of the file".to_owned()));
            self.break_turns(&body.turns);
        }
    }

    /// The statement that begins with `keyword`, which has been taken, at `start`.
    fn statement(&mut self, keyword: Keyword, start: Span) -> Parsed<StatementKind> {
        Ok(match keyword {
            Keyword::Include => self.include()?,
            Keyword::Class => self.class(start)?,
            Keyword::Object => self.object(start)?,
            Keyword::Camera => {
                let parallel = self.take_soft(Soft::Parallel).is_some();
                self.expect_key_in(Keyword::At, "camera at (x, y, z)")?;
                let at = self.vector()?.value;
                let lens = self.lens()?;
                let next = match &lens {
                    None => &[Soft::Aperture][..],
                    Some(lens) if lens.focus.is_none() => &[Soft::Focus],
                    Some(_) => &[],
                };
                self.statement_ends(&[], next, "the lens of the camera", CAMERA)?;
                StatementKind::Camera { at, parallel, lens }
            }
            Keyword::Target => {
                self.expect_key_in(Keyword::At, "target at (x, y, z)")?;
                StatementKind::Target(self.vector()?.value)
            }
            Keyword::Focal => {
                self.expect_key_in(Keyword::Length, "focal length 50")?;
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
            return self.bare_file_name(span);
        }
        self.advance();
        let text = self.cursor.text(Span { start: span.start + 1, end: span.end - 1 }).to_owned();
        if text.is_empty() {
            return self.fail(Diagnostic::error(span, "expected a file name, found none"));
        }
        Ok(StatementKind::Include(Spanned { value: text, span }))
    }

    /// A file name without quotes is many tokens, and one error.
    fn bare_file_name<T>(&mut self, first: Span) -> Parsed<T> {
        let mut name = first;
        while self.peek_at(1).0 != Token::End && self.peek_at(1).1.start == name.end {
            self.advance();
            name.end = self.peek().1.end;
        }
        if name == first {
            let hint = "it stands in quotes: include \"classes.sdl\"".to_owned();
            return self.unexpected_because("a file name", Some(hint));
        }
        self.advance();
        self.shared.diagnostics.take_back(name);
        let found = shortened(self.cursor.text(name));
        let error = Diagnostic::error(name, format!("expected a file name, found `{found}`"));
        self.fail(error.hint(format!("it stands in quotes: include \"{found}\"")))
    }

    fn class(&mut self, start: Span) -> Parsed<StatementKind> {
        let (token, span) = self.peek();
        let Token::Name(symbol) = token else {
            if !matches!(token, Token::Word(_)) || token == Token::Word(Word::Key(Keyword::Is)) {
                return self.unexpected("the name of the class", &[]);
            }
            let error = self.reserved_error("a class");
            self.report(error);
            // What follows is read and forgotten: a name that is a keyword must not begin a statement.
            self.advance();
            if self.take_key(Keyword::Is).is_some() {
                self.shared.checking += 1;
                let solid = self.solid();
                self.shared.checking -= 1;
                solid?;
            }
            return Err(Failed);
        };
        self.advance();
        let name = Spanned { value: symbol, span };
        self.shared.define(Kind::Class, name, start.to(span));
        self.shared.classes.name_current(Some(symbol));
        let (definition, solid) = if self.peek().0 == Token::Open {
            let (definition, solid) = self.parametric(name);
            (definition.map(Arc::new), solid)
        } else {
            (
                None,
                self.expect_key_in(Keyword::Is, "class NAME is SOLID").and_then(|_| self.solid()),
            )
        };
        self.shared.classes.name_current(None);
        self.shared.record.extend(span, self.cursor.behind());
        if solid.is_err() {
            self.recover();
        }
        Ok(StatementKind::Class(Class { name, solid: solid.ok(), definition }))
    }

    fn object(&mut self, start: Span) -> Parsed<StatementKind> {
        let name = self.object_name()?;
        if self.take_key(Keyword::Is).is_none() {
            let expected = if name.is_some() { "`is`" } else { "`is` or a name" };
            let hint = self.meant(&["is"]);
            let written = || "it is written object is sphere, or object NAME is sphere".to_owned();
            return self.unexpected_because(expected, hint.or_else(|| Some(written())));
        }
        let solid = self.solid();
        if let Some(name) = name {
            self.shared.define(Kind::Object, name, start.to(self.cursor.behind()));
        }
        Ok(StatementKind::Object(Object { name, solid: solid? }))
    }

    fn object_name(&mut self) -> Parsed<Option<Spanned<Symbol>>> {
        let (token, span) = self.peek();
        let is_next = self.peek_at(1).0 == Token::Word(Word::Key(Keyword::Is));
        match token {
            Token::Name(value) => {
                self.advance();
                Ok(Some(Spanned { value, span }))
            }
            Token::Word(_) if is_next => {
                let error = self.reserved_error("an object");
                self.report(error);
                self.advance();
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    pub(super) fn reserved<T>(&mut self, what: &str) -> Parsed<T> {
        let error = self.reserved_error(what);
        self.fail(error)
    }

    fn reserved_error(&mut self, what: &str) -> Diagnostic {
        let (token, span) = self.peek();
        let found = self.found(token, span);
        let message = format!("{found} is a reserved word and cannot name {what}");
        Diagnostic::error(span, message).hint("choose another name".to_owned())
    }

    fn light(&mut self) -> Parsed<StatementKind> {
        let kind = self.light_kind()?;
        let first = self.peek().1;
        let mut light =
            Light { kind, at: None, toward: None, color: Rgb::ONE, shadows: true, radius: 0.0 };
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
                _ if self.take_soft(Soft::Radius).is_some() => {
                    self.once(&mut seen, Clause::Radius, span);
                    light.radius =
                        self.number_in("the radius of a light", "0 or more", |x| x >= 0.0)?.value;
                }
                _ if self.at_color(&seen) => {
                    self.once(&mut seen, Clause::Color, span);
                    light.color = self.color()?;
                }
                _ => break,
            }
        }
        // A kind stands right behind `light`.
        let kinds = if self.peek().1 == first { LIGHT_KINDS } else { &[] };
        let words = [kinds, LIGHT_CLAUSES].concat();
        self.statement_ends(&words, &[Soft::Radius], "a clause of the light", LIGHT)?;
        light.color *= intensity;
        Ok(StatementKind::Light(light))
    }

    /// What may follow the place of a camera.
    fn lens(&mut self) -> Parsed<Option<Lens>> {
        if self.take_soft(Soft::Aperture).is_none() {
            return Ok(None);
        }
        let aperture = self.number_in("the aperture", "above 0", |x| x > 0.0)?;
        let focus = if self.take_soft(Soft::Focus).is_some() {
            self.expect_key(Keyword::At)?;
            Some(self.vector()?)
        } else {
            None
        };
        Ok(Some(Lens { aperture, focus }))
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
            self.expression_in("the concentration of a spot", "0 or more", |x| x >= 0.0)?.value;
        self.expect(Token::Comma, "`,`")?;
        let range = "above 0 and at most 180";
        let half_angle_degrees =
            self.expression_in("the half-angle of a spot", range, |x| x > 0.0 && x <= 180.0)?.value;
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
        self.statement_ends(&[Keyword::Intensity], &[], "an intensity, a colour", AMBIENT)?;
        Ok(StatementKind::Ambient(color * intensity))
    }

    fn intensity(&mut self, seen: &mut Seen, span: Span) -> Parsed<f64> {
        self.advance();
        self.once(seen, Clause::Intensity, span);
        Ok(self.number_in("the intensity", "0 or more", |x| x >= 0.0)?.value)
    }

    /// A statement with optional parts ends at another statement; what else follows was meant as a part.
    /// `whole` says how it is written.
    fn statement_ends(
        &mut self,
        parts: &[Keyword],
        soft: &[Soft],
        expected: &str,
        whole: &str,
    ) -> Parsed<()> {
        if self.at_end() {
            return Ok(());
        }
        let words = parts.iter().chain(Keyword::STATEMENTS).map(|keyword| keyword.text());
        let words: Vec<&str> = words.chain(soft.iter().map(|word| word.text())).collect();
        let colors = self.color_words();
        let hint = match self.peek().0 {
            Token::Plus | Token::Minus | Token::Times | Token::Over | Token::Power => {
                Some(ARITHMETIC.to_owned())
            }
            Token::Word(Word::Key(Keyword::Shadows)) => Some("it is written no shadows".to_owned()),
            Token::Open | Token::Number(_) | Token::Word(_) => Some(whole.to_owned()),
            Token::Name(_) => self
                .meant(&[words.as_slice(), colors.as_slice()].concat())
                .or_else(|| Some(whole.to_owned())),
            _ => None,
        };
        self.unexpected_because(&format!("{expected} or a statement"), hint)
    }
}
