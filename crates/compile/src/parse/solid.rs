//! Solids: factors, operators and parentheses, on a stack of their own so that depth costs no recursion.

use glam::DVec3;
use scene::{AttributesId, Placement};

use super::{Clause, Parsed, Parser, Seen};
use crate::ast::{Frame, Node, Solid, Spanned};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::token::{Keyword, Token, Word};

/// Parentheses of a solid nest at most this deep.
pub(crate) const NESTING_LIMIT: usize = 50_000;

/// A solid that is being read: the whole one, or one in parentheses.
#[derive(Debug)]
struct Level {
    /// Its `(`, and its frame; nothing for the whole.
    group: Option<(Span, u32)>,
    /// What joins the terms read so far.
    join: Join,
    /// Terms read and not joined yet.
    terms: u32,
    /// Factors of the term that is being read.
    factors: u32,
    /// That term is subtracted.
    subtracted: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Join {
    Union,
    Difference,
}

impl Level {
    fn new(group: Option<(Span, u32)>) -> Self {
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

impl Parser<'_> {
    /// A solid, up to the statement that follows it.
    pub(super) fn solid(&mut self) -> Parsed<Solid> {
        let mut solid = Solid::default();
        let (mut levels, mut level) = (Vec::new(), Level::new(None));
        loop {
            if let Some(inner) = self.factor(&level, levels.len(), &mut solid)? {
                levels.push(std::mem::replace(&mut level, inner));
                continue;
            }
            level.factors += 1;
            while let Some((_, frame)) = level.group
                && self.take(Token::Close).is_some()
            {
                level.end(&mut solid.nodes);
                solid.frames[frame as usize].placement = self.placement()?;
                level = levels.pop().unwrap_or_else(|| Level::new(None));
                level.factors += 1;
            }
            let (token, _) = self.peek();
            match token {
                Token::Times => {}
                Token::Plus => level.begin_term(Join::Union, &mut solid.nodes),
                Token::Minus => level.begin_term(Join::Difference, &mut solid.nodes),
                _ if token == Token::End || self.at_statement().is_some() => break,
                _ => return self.no_operator(),
            }
            self.advance();
        }
        self.close(level, levels, &mut solid.nodes);
        Ok(without_idle_frames(solid))
    }

    /// A primitive or a class; or, where a group is opened, its level.
    fn factor(&mut self, level: &Level, depth: usize, solid: &mut Solid) -> Parsed<Option<Level>> {
        let attributes = self.attributes()?;
        let (token, span) = self.peek();
        let index = u32::try_from(solid.frames.len()).expect("sources are shorter than 2³² bytes");
        let node = match token {
            Token::Word(Word::Solid(kind)) => Some(Node::Primitive { kind, frame: index }),
            Token::Name(name) => Some(Node::Named { name, span, frame: index }),
            Token::Open => None,
            Token::Close => {
                let hint = "there is nothing in the parentheses, or nothing after an operator";
                return self.unexpected_because("a solid", Some(hint.to_owned()));
            }
            _ => return self.unexpected("a solid", &[]),
        };
        self.advance();
        let parent = level.group.map(|(_, frame)| frame);
        let mut frame = Frame { parent, placement: Placement::default(), attributes };
        let Some(node) = node else {
            if depth >= NESTING_LIMIT {
                let message = format!("parentheses nest deeper than {NESTING_LIMIT}");
                return self.fail(Diagnostic::error(span, message));
            }
            // Its placement follows its `)`.
            solid.frames.push(frame);
            return Ok(Some(Level::new(Some((span, index)))));
        };
        frame.placement = self.placement()?;
        solid.frames.push(frame);
        solid.nodes.push(node);
        Ok(None)
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
                Clause::At => placement.place = self.vector()?.value,
                Clause::Scale => placement.scale = self.scale()?,
                _ => placement.rotation_degrees = self.vector()?.value,
            }
        }
    }

    fn scale(&mut self) -> Parsed<DVec3> {
        let scale = match self.peek().0 {
            Token::Open => self.vector()?,
            Token::Number(_) | Token::Minus | Token::Plus => {
                let Spanned { value, span } = self.number()?;
                Spanned { value: DVec3::splat(value), span }
            }
            _ => return self.unexpected("a number or a vector", &[]),
        };
        if scale.value.to_array().iter().any(|factor| factor.abs() <= 0.0) {
            self.report(
                Diagnostic::error(scale.span, "a scale of 0 leaves nothing of a solid")
                    .hint("a scale may be small, and negative to mirror".to_owned()),
            );
        }
        Ok(scale.value)
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
            .collect();
        let hint = self.meant(&words).or_else(|| match token {
            Token::Open | Token::Name(_) | Token::Word(Word::Solid(_)) => {
                Some("solids are joined by `+`, `-` or `*`".to_owned())
            }
            Token::Word(Word::Color(_) | Word::Grade(_)) => {
                Some("attributes stand before the solid they describe".to_owned())
            }
            _ => None,
        });
        self.unexpected_because("an operator, a transform or a statement", hint)
    }

    /// Closes what is still open where the statement ends.
    fn close(&mut self, mut level: Level, mut levels: Vec<Level>, nodes: &mut Vec<Node>) {
        let mut open = Vec::new();
        level.end(nodes);
        while let (Some((span, _)), Some(outer)) = (level.group, levels.pop()) {
            open.push(span);
            level = outer;
            level.factors += 1;
            level.end(nodes);
        }
        let Some(first) = open.pop() else { return };
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
    }
}

/// Leaves out the frames of groups of which nothing is said.
fn without_idle_frames(mut solid: Solid) -> Solid {
    let mut used = vec![false; solid.frames.len()];
    for node in &solid.nodes {
        if let Node::Primitive { frame, .. } | Node::Named { frame, .. } = *node {
            used[frame as usize] = true;
        }
    }
    // For each frame the one that stands for it now: itself, or the nearest used one about it.
    let mut place: Vec<Option<u32>> = Vec::with_capacity(solid.frames.len());
    let mut kept = Vec::with_capacity(solid.frames.len());
    for (frame, used) in solid.frames.iter().zip(used) {
        let parent = frame.parent.and_then(|parent| place[parent as usize]);
        let says = frame.attributes != AttributesId::NONE || !frame.placement.is_identity();
        if used || says {
            place.push(u32::try_from(kept.len()).ok());
            kept.push(Frame { parent, ..*frame });
        } else {
            place.push(parent);
        }
    }
    for node in &mut solid.nodes {
        if let Node::Primitive { frame, .. } | Node::Named { frame, .. } = node {
            *frame = place[*frame as usize].unwrap_or_default();
        }
    }
    solid.frames = kept;
    solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Diagnostics;
    use crate::parse::Shared;
    use crate::source::Text;
    use crate::token::Cursor;

    fn solid(text: &str) -> Solid {
        let mut shared = Shared::new();
        let file = Text { text: text.into(), bad: None };
        let mut cursor = Cursor::new(file, 0, &mut Diagnostics::default());
        let solid = Parser::new(&mut cursor, &mut shared).solid().unwrap();
        assert!(!shared.diagnostics.has_errors(), "{text}");
        solid
    }

    /// The nodes in a line: primitives by their first letter, operators with their count.
    fn shape(text: &str) -> String {
        let words = solid(text).nodes.into_iter().map(|node| match node {
            Node::Primitive { kind, .. } => kind.keywords()[0][..2].to_owned(),
            Node::Named { .. } => "name".to_owned(),
            Node::Union(n) => format!("+{n}"),
            Node::Intersection(n) => format!("*{n}"),
            Node::Complement => "!".to_owned(),
        });
        words.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn operators_keep_their_order() {
        for (text, expected) in [
            ("sphere", "sp"),
            ("sphere + block + cone", "sp bl co +3"),
            ("sphere * block * cone", "sp bl co *3"),
            ("sphere - block", "sp bl ! *2"),
            ("sphere - block - cone", "sp bl ! co ! *3"),
            ("sphere + block - cone + cylinder", "sp bl +2 co ! *2 cy +2"),
            ("sphere - block + cone + cylinder", "sp bl ! *2 co cy +3"),
            ("sphere + block * cone", "sp bl co *2 +2"),
            ("sphere - block * cone", "sp bl co *2 ! *2"),
            ("sphere - (block + cone)", "sp bl co +2 ! *2"),
            ("(sphere + block) * cone", "sp bl +2 co *2"),
            ("((sphere)) + (((block)))", "sp bl +2"),
            ("cube", "bl"),
        ] {
            assert_eq!(shape(text), expected, "{text}");
        }
    }

    #[test]
    fn only_groups_that_say_something_have_frames() {
        let plain = solid("((sphere + block))");
        assert_eq!(plain.frames.len(), 2, "one for each primitive");
        assert!(plain.frames.iter().all(|frame| frame.parent.is_none()), "{plain:?}");

        let moved = solid("((sphere + block) at (1, 2, 3) + red (cone))");
        let parents: Vec<_> = moved.frames.iter().map(|frame| frame.parent).collect();
        assert_eq!(parents, [None, Some(0), Some(0), None, Some(3)]);
        assert_eq!(moved.frames[0].placement.place, DVec3::new(1.0, 2.0, 3.0));
        assert_ne!(moved.frames[3].attributes, AttributesId::NONE, "red");
    }

    #[test]
    fn transforms_stand_in_any_order() {
        let frame = solid("cone rotate (0, 0, 90) scale -2 at (1, 2, 3)").frames[0];
        assert_eq!(frame.placement.scale, DVec3::splat(-2.0));
        assert_eq!(frame.placement.rotation_degrees, DVec3::new(0.0, 0.0, 90.0));
        assert_eq!(frame.placement.place, DVec3::new(1.0, 2.0, 3.0));
        let frame = solid("cone scale (1, 2, 3)").frames[0];
        assert_eq!(frame.placement.scale, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(shape("sphere scale 2 - block scale 2 * cone"), "sp bl co *2 ! *2");
    }
}
