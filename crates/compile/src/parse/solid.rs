//! Solids: factors, operators and parentheses, on a stack of their own so that depth costs no recursion.

mod idle;

use std::sync::Arc;

use glam::DVec3;
use scene::{Placement, Primitive};

use self::idle::without_idle_frames;
use super::call::Call;
use super::turns::Turns;
use super::{ARITHMETIC, Clause, Failed, Parsed, Parser, Seen};
use crate::ast::{Definition, Frame, Node, Solid, Spanned};
use crate::cursor::Cursor;
use crate::diagnostic::Diagnostic;
use crate::extent::LIMIT;
use crate::shared::Use;
use crate::source::Span;
use crate::token::{Keyword, Soft, Token, Word, shortened};

/// What stands between solids.
const JOINED: &str = "solids are joined by `+`, `-` or `*`";

/// Parentheses of a solid nest at most this deep.
pub(crate) const NESTING_LIMIT: usize = 50_000;

/// A part of a solid that is being read: the whole one, or one in parentheses.
#[derive(Debug)]
struct Level {
    /// Nothing for the whole.
    group: Option<Group>,
    /// What joins the terms read so far.
    join: Join,
    /// Terms read and not joined yet.
    terms: u32,
    /// Factors of the term that is being read.
    factors: u32,
    /// That term is subtracted.
    subtracted: bool,
}

/// Parentheses that are open.
#[derive(Debug)]
struct Group {
    /// The `(`.
    open: Span,
    frame: u32,
    /// Where it is read once for each value of a variable: what joins the turns.
    turns: Option<(Turns, Turned)>,
}

/// What joins the turns of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turned {
    Union,
    Intersection,
}

/// A solid that is being read: that of a statement, or of a class with parameters that the statement uses.
#[derive(Debug)]
struct Build {
    solid: Solid,
    level: Level,
    /// The levels about it.
    outer: Vec<Level>,
    /// Levels of the solids that this one is for.
    below: usize,
}

/// A solid that waits for a class to be made.
#[derive(Debug)]
struct Waiting {
    build: Build,
    cursor: Cursor,
    call: Call,
    /// How often something had gone wrong before it is made.
    failures: usize,
}

/// What a factor turned out to be.
#[derive(Debug)]
enum Factor {
    Complete,
    /// A group was opened.
    Group,
    /// A class with parameters that is to be made first; the node waits for it.
    Class(Call),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Join {
    Union,
    Difference,
}

impl Level {
    fn new(group: Option<Group>) -> Self {
        Self { group, join: Join::Union, terms: 0, factors: 0, subtracted: false }
    }

    /// The term that is being read is complete.
    fn end_term(&mut self, nodes: &mut Vec<Node>) {
        if self.factors > 1 {
            nodes.push(Node::Intersection(self.factors));
        }
        if self.subtracted {
            nodes.push(Node::Complement);
        }
        self.factors = 0;
        self.terms += 1;
    }

    /// The terms read so far become one operand.
    fn join_terms(&mut self, nodes: &mut Vec<Node>) {
        if self.terms > 1 {
            nodes.push(match self.join {
                Join::Union => Node::Union(self.terms),
                Join::Difference => Node::Intersection(self.terms),
            });
        }
        self.terms = 1;
    }

    /// The whole level is complete.
    fn end(&mut self, nodes: &mut Vec<Node>) {
        self.end_term(nodes);
        self.join_terms(nodes);
    }

    /// A `+` or `-` follows a complete term.
    fn begin_term(&mut self, join: Join, nodes: &mut Vec<Node>) {
        self.end_term(nodes);
        if self.join != join {
            self.join_terms(nodes);
        }
        self.join = join;
        self.subtracted = join == Join::Difference;
    }
}

impl Build {
    fn new(below: usize) -> Self {
        Self { solid: Solid::default(), level: Level::new(None), outer: Vec::new(), below }
    }

    fn depth(&self) -> usize {
        self.below + self.outer.len()
    }

    fn next_frame(&self) -> u32 {
        u32::try_from(self.solid.frames.len()).expect("fewer than 2³² solids are made")
    }
}

impl Parser<'_> {
    /// A solid, up to the statement that follows it.
    pub(super) fn solid(&mut self) -> Parsed<Solid> {
        let (mut build, mut waiting) = (Build::new(0), Vec::new());
        let solid = self.build(&mut build, &mut waiting);
        if solid.is_err() {
            self.abandon(build, waiting);
        }
        solid
    }

    fn build(&mut self, build: &mut Build, waiting: &mut Vec<Waiting>) -> Parsed<Solid> {
        loop {
            match self.factor(build)? {
                Factor::Group => continue,
                Factor::Class(call) => {
                    self.begin_class(build, waiting, call)?;
                    continue;
                }
                Factor::Complete => {}
            }
            while !self.operator(build)? {
                self.close(build)?;
                let solid = without_idle_frames(std::mem::take(&mut build.solid));
                match waiting.pop() {
                    None => return Ok(solid),
                    Some(last) => self.end_class(build, last, solid),
                }
            }
        }
    }

    /// The solid of a class is read next, from where its text stands.
    fn begin_class(
        &mut self,
        build: &mut Build,
        waiting: &mut Vec<Waiting>,
        call: Call,
    ) -> Parsed<()> {
        let Definition { name, text, base, start, length, .. } = &*call.definition;
        if build.depth() >= NESTING_LIMIT {
            let message = format!("classes and parentheses nest deeper than {NESTING_LIMIT}");
            return self.fail(Diagnostic::error(call.span, message));
        }
        if !self.shared.budget.may_read(*length) {
            self.too_much(call.span);
            return Err(Failed);
        }
        self.shared.budget.read(*length);
        let there = Cursor::at(Arc::clone(text), *base, *start);
        let cursor = std::mem::replace(self.cursor, there);
        self.bind(&call.definition, &call.numbers);
        self.shared.uses.push(Use::Class { name: *name, span: call.span });
        self.shared.classes.enter(call.definition.sees);
        let inner = Build::new(build.depth() + 1);
        let failures = self.shared.failures();
        waiting.push(Waiting { build: std::mem::replace(build, inner), cursor, call, failures });
        Ok(())
    }

    /// The solid of a class has been read.
    fn end_class(&mut self, build: &mut Build, waiting: Waiting, solid: Solid) {
        let Waiting { build: outer, cursor, call, failures } = waiting;
        let instance = self.shared.make(&call.definition, &call.numbers, solid, call.span);
        self.shared.remember_failure(instance, failures);
        self.leave_class(cursor);
        *build = outer;
        if let Some(Node::Made { instance: place, .. }) = build.solid.nodes.last_mut() {
            *place = instance;
        }
    }

    fn leave_class(&mut self, cursor: Cursor) {
        self.shared.classes.leave();
        self.shared.uses.pop();
        self.shared.values.close_class();
        *self.cursor = cursor;
    }

    /// Leaves every body and every class of a solid that cannot be read on.
    fn abandon(&mut self, build: Build, waiting: Vec<Waiting>) {
        let mut build = build;
        let mut waiting = waiting;
        loop {
            let levels = std::iter::once(build.level).chain(build.outer.into_iter().rev());
            for group in levels.filter_map(|level| level.group) {
                if let Some((turns, _)) = group.turns {
                    self.break_turns(&turns);
                }
            }
            let Some(last) = waiting.pop() else { return };
            self.leave_class(last.cursor);
            build = last.build;
        }
    }

    /// What follows a factor: true if that is another one, false if the solid ends.
    fn operator(&mut self, build: &mut Build) -> Parsed<bool> {
        build.level.factors += 1;
        while build.level.group.is_some() && self.take(Token::Close).is_some() {
            if self.end_group(build)? {
                return Ok(true);
            }
        }
        let Build { level, solid, .. } = build;
        let (token, _) = self.peek();
        match token {
            Token::Times => {}
            Token::Plus => level.begin_term(Join::Union, &mut solid.nodes),
            Token::Minus => level.begin_term(Join::Difference, &mut solid.nodes),
            _ if self.at_end() => return Ok(false),
            _ => return self.no_operator(),
        }
        self.advance();
        Ok(true)
    }

    /// The `)` of a group has been taken; true if the group is read once more.
    fn end_group(&mut self, build: &mut Build) -> Parsed<bool> {
        let Build { solid, level, outer, .. } = build;
        level.end(&mut solid.nodes);
        let Some(mut group) = level.group.take() else { return Ok(false) };
        if let Some((turns, turned)) = &mut group.turns {
            if self.another_turn(turns) {
                *level = Level::new(Some(group));
                return Ok(true);
            }
            let operands = u32::try_from(turns.begun()).expect("fewer than 2³² solids are made");
            if operands > 1 {
                solid.nodes.push(match turned {
                    Turned::Union => Node::Union(operands),
                    Turned::Intersection => Node::Intersection(operands),
                });
            }
        }
        *level = outer.pop().unwrap_or_else(|| Level::new(None));
        solid.frames[group.frame as usize].placement = self.placement()?;
        level.factors += 1;
        Ok(false)
    }

    /// A primitive, a class, or what opens a group.
    fn factor(&mut self, build: &mut Build) -> Parsed<Factor> {
        let attributes = self.attributes()?;
        let (token, span) = self.peek();
        let index = build.next_frame();
        let parent = build.level.group.as_ref().map(|group| group.frame);
        let mut frame = Frame { parent, placement: Placement::default(), attributes };
        let turned = if self.at_group_of_turns() { self.turned() } else { None };
        let mut call = None;
        let node = match token {
            Token::Word(Word::Solid(kind)) => {
                self.advance();
                Node::Primitive { kind, frame: index }
            }
            Token::Open => return self.open_group(build, frame, None),
            Token::Name(_) if turned.is_some() => return self.open_group(build, frame, turned),
            Token::Name(name) => {
                self.advance();
                if let Some(definition) = self.shared.parametric(name, span) {
                    let made = self.arguments(&definition, span)?;
                    let instance = self.shared.made(&definition, &made.numbers);
                    self.shared.repeat_failure(instance, name, made.span);
                    call = instance.is_none().then_some(made);
                    Node::Made { instance: instance.unwrap_or_default(), frame: index }
                } else if let Some(row) = self.form_called(name) {
                    match self.form(row, span)? {
                        Some(form) => build.solid.form(form, index),
                        None => Node::Primitive { kind: Primitive::Sphere, frame: index },
                    }
                } else {
                    if self.at_arguments(0) {
                        self.not_parametric(name, span);
                    }
                    Node::Named { name, span, frame: index }
                }
            }
            Token::Close => {
                let hint = "there is nothing in the parentheses, or nothing after an operator";
                return self.unexpected_because("a solid", Some(hint.to_owned()));
            }
            _ => {
                let expected = match self.cursor.last_byte() {
                    Some(operator @ (b'+' | b'-' | b'*')) => {
                        format!("a solid behind `{}`", char::from(operator))
                    }
                    _ => "a solid".to_owned(),
                };
                let hint = match token {
                    Token::Word(Word::Key(keyword)) if Keyword::TRANSFORMS.contains(&keyword) => {
                        let word = keyword.text();
                        Some(format!(
                            "`{word}` stands behind a solid, as in sphere {word} (1, 2, 3)"
                        ))
                    }
                    Token::Number(_) => Some(ARITHMETIC.to_owned()),
                    _ => None,
                };
                return self.unexpected_because(&expected, hint);
            }
        };
        if !self.shared.may_make() {
            self.too_much(span);
            return Err(Failed);
        }
        frame.placement = self.placement()?;
        build.solid.frames.push(frame);
        build.solid.nodes.push(node);
        Ok(call.map_or(Factor::Complete, Factor::Class))
    }

    /// `union of` or `intersection of` is next.
    pub(super) fn at_group_of_turns(&mut self) -> bool {
        let (first, second) = (self.peek().0, self.peek_at(1).0);
        (self.is_soft(first, Soft::Union) || self.is_soft(first, Soft::Intersection))
            && self.is_soft(second, Soft::Of)
    }

    fn turned(&mut self) -> Option<Turned> {
        if self.take_soft(Soft::Union).is_some() {
            return Some(Turned::Union);
        }
        self.take_soft(Soft::Intersection).map(|_| Turned::Intersection)
    }

    /// A `(`, or what precedes it where turns are joined. Its placement follows its `)`.
    fn open_group(
        &mut self,
        build: &mut Build,
        frame: Frame,
        turned: Option<Turned>,
    ) -> Parsed<Factor> {
        let range = match turned {
            None => None,
            Some(turned) => {
                let start = self.peek().1;
                self.advance();
                let range = self.range()?;
                if Self::is_empty(&range) {
                    let place = start.to(self.cursor.behind());
                    let error = Diagnostic::error(place, "expected one turn or more, found none");
                    self.report(
                        error.hint("nothing is no solid; `repeat` may have no turn".to_owned()),
                    );
                }
                Some((range, turned))
            }
        };
        let (token, open) = self.peek();
        if token != Token::Open {
            let step = self.meant(&[Soft::Step.text()]);
            let written = || "it is written union of i from 1 to 12 ( … )".to_owned();
            return self.unexpected_because("`(`", step.or_else(|| Some(written())));
        }
        if build.depth() >= NESTING_LIMIT {
            let message = format!("parentheses nest deeper than {NESTING_LIMIT}");
            return self.fail(Diagnostic::error(open, message));
        }
        self.advance();
        let turns = range.map(|(range, turned)| (self.begin_turns(range), turned));
        let inner = Level::new(Some(Group { open, frame: build.next_frame(), turns }));
        build.solid.frames.push(frame);
        build.outer.push(std::mem::replace(&mut build.level, inner));
        Ok(Factor::Group)
    }

    /// `at`, `scale` and `rotate`, each at most once.
    fn placement(&mut self) -> Parsed<Placement> {
        let (mut placement, mut seen) = (Placement::default(), Seen::default());
        loop {
            let (token, span) = self.peek();
            let Token::Word(Word::Key(keyword)) = token else { return Ok(placement) };
            let clause = match keyword {
                Keyword::At => Clause::At,
                Keyword::Scale => Clause::Scale,
                Keyword::Rotate => Clause::Rotate,
                _ => return Ok(placement),
            };
            self.advance();
            self.once(&mut seen, clause, span);
            match clause {
                Clause::At => placement.place = self.place()?,
                Clause::Scale => placement.scale = self.scale()?,
                _ => placement.rotation_degrees = self.vector()?.value,
            }
        }
    }

    fn scale(&mut self) -> Parsed<DVec3> {
        let scale = match self.peek().0 {
            Token::Open => self.factors()?,
            Token::Number(_) | Token::Minus | Token::Plus | Token::Name(_) => {
                let Spanned { value, span } = self.number()?;
                Spanned { value: DVec3::splat(value), span }
            }
            _ => return self.unexpected("a number or a vector", &[]),
        };
        let sizes = scale.value.abs().to_array();
        if sizes.iter().any(|size| *size <= 0.0) {
            self.report(
                Diagnostic::error(scale.span, "a scale of 0 leaves nothing of a solid")
                    .hint("a scale may be small, and negative to mirror".to_owned()),
            );
        } else if sizes.iter().any(|size| *size < 1.0 / LIMIT || *size > LIMIT) {
            let message = format!("expected a scale from {:e} to {LIMIT:e}", 1.0 / LIMIT);
            let found = shortened(self.cursor.text(scale.span));
            self.report(Diagnostic::error(scale.span, format!("{message}, found {found}")));
        }
        Ok(scale.value)
    }

    /// A vector, or one number in parentheses for all three.
    fn factors(&mut self) -> Parsed<Spanned<DVec3>> {
        let (_, open) = self.peek();
        self.advance();
        let first = self.expression()?.value;
        if let Some(close) = self.take(Token::Close) {
            return Ok(Spanned { value: DVec3::splat(first), span: open.to(close) });
        }
        self.rest_of_vector(open, first)
    }

    /// A place that numbers can be trusted with.
    fn place(&mut self) -> Parsed<DVec3> {
        let place = self.vector()?;
        let size = place.value.abs();
        if size.x + size.y + size.z > LIMIT {
            let found = shortened(self.cursor.text(place.span));
            let message = format!("expected a place less than {LIMIT:e} away, found {found}");
            self.report(Diagnostic::error(place.span, message));
        }
        Ok(place.value)
    }

    fn no_operator<T>(&mut self) -> Parsed<T> {
        let (token, span) = self.peek();
        if token == Token::Close {
            return self.fail(
                Diagnostic::error(span, "expected an operator or a statement, found `)`")
                    .hint("there is one `)` too many".to_owned()),
            );
        }
        let words: Vec<&str> = Keyword::TRANSFORMS
            .iter()
            .chain(Keyword::STATEMENTS)
            .map(|keyword| keyword.text())
            .chain([Soft::Let.text(), Soft::Repeat.text()])
            .collect();
        let hint = self.meant(&words).or_else(|| match token {
            Token::Over | Token::Power | Token::Number(_) => Some(ARITHMETIC.to_owned()),
            Token::Open => Some(format!("{JOINED}, and made larger by `scale`")),
            Token::Name(_) | Token::Word(Word::Solid(_)) => Some(JOINED.to_owned()),
            Token::OpenBrace => Some(
                "what is said of a solid stands around it, as in red sphere scale 2 at (0, 1, 0)"
                    .to_owned(),
            ),
            Token::Word(Word::Color(_) | Word::Grade(_)) => {
                Some("attributes stand before the solid they describe".to_owned())
            }
            _ => None,
        });
        self.unexpected_because("an operator, a transform or a statement", hint)
    }

    /// Closes what is still open where the statement ends.
    fn close(&mut self, build: &mut Build) -> Parsed<()> {
        let Build { solid, level, outer, .. } = build;
        let levels = outer.iter().chain([&*level]);
        let last = levels
            .filter_map(|level| level.group.as_ref())
            .rfind(|group| group.turns.is_some())
            .map(|group| group.open);
        if let Some(open) = last {
            let (token, span) = self.peek();
            let found = self.found(token, span);
            let place = if token == Token::End { self.cursor.behind() } else { span };
            let error = Diagnostic::error(place, format!("expected `)`, found {found}"));
            return self.fail(error.note(open, "this parenthesis is not closed"));
        }
        let mut open = Vec::new();
        level.end(&mut solid.nodes);
        while let (Some(group), Some(about)) = (level.group.take(), outer.pop()) {
            open.push(group.open);
            *level = about;
            level.factors += 1;
            level.end(&mut solid.nodes);
        }
        let Some(first) = open.pop() else { return Ok(()) };
        let mut warning = Diagnostic::warning(
            first,
            match open.len() {
                0 => "this parenthesis is not closed".to_owned(),
                others => format!("{} parentheses are not closed", others + 1),
            },
        );
        for &span in open.iter().rev() {
            warning = warning.note(span, "so is this one");
        }
        let end = self.cursor.behind();
        self.report(warning.note(end, "a `)` is taken to stand here"));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
