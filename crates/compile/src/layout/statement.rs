//! Where the lines of each construct may end.
//!
//! One pass over the tokens, open parentheses on a stack of their own. It takes any tokens: what cannot stand where it
//! does is kept with blanks around it.

use std::borrow::Cow;

use super::document::{Break, Document, Flow, Place};
use super::piece::is_function;
use super::trivia::Item;
use crate::token::{Keyword, Token, Word};

/// Columns by which what belongs to a line stands behind it.
pub(super) const STEP: usize = 2;
/// Where the terms of a solid stand: the operators in front of them stand one step in.
const TERM: usize = 2 * STEP;

/// A blank that may become the end of a line.
pub(super) const FOLD: Break = Break { blank: true, forced: false, empty_line: false, offset: 0 };

/// The words that clauses of a statement begin with.
const CLAUSES: &[&str] = &["at", "toward", "intensity", "no", "radius", "focus"];

/// The statements that may share a line.
const VIEW: &[Keyword] = &[Keyword::Camera, Keyword::Target, Keyword::Focal];

/// What is between a token and the one before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Gap {
    Nothing,
    Blank,
    Fold(Break),
}

/// What is open around the next token.
#[derive(Debug)]
enum Level {
    /// Braces.
    Statements,
    /// A solid, or one in parentheses.
    Solid(Solid),
}

#[derive(Debug)]
struct Solid {
    /// In front of its next factor.
    gap: Gap,
    /// The break in front of the first factor.
    first: Option<Place>,
    /// The block of its first term.
    term: Option<Place>,
    /// The next factor begins a term.
    at_term: bool,
    terms: usize,
    /// It stands in parentheses.
    group: bool,
}

/// The tokens on their way to a document.
pub(super) struct Writer<'a> {
    pub(super) items: &'a [Item<'a>],
    pub(super) at: usize,
    /// What stands in front of the next token has been written.
    gapped: bool,
    levels: Vec<Level>,
    pub(super) document: Document<'a>,
    /// The next statement stays on the line of the last.
    chained: bool,
}

/// The document of a whole text.
pub(super) fn document<'a>(items: &'a [Item<'a>]) -> Document<'a> {
    let mut writer = Writer {
        items,
        at: 0,
        gapped: false,
        levels: Vec::new(),
        document: Document::default(),
        chained: false,
    };
    while writer.token() != Token::End {
        match writer.levels.last() {
            Some(Level::Solid(_)) => writer.factor(),
            _ => writer.statement(),
        }
    }
    writer.close();
    writer.gap(Gap::Fold(Break { forced: true, empty_line: true, ..FOLD }));
    writer.document
}

impl Writer<'_> {
    pub(super) fn item(&self, ahead: usize) -> &Item<'_> {
        let last = self.items.len() - 1;
        &self.items[(self.at + ahead).min(last)]
    }

    pub(super) fn token(&self) -> Token {
        self.item(0).token
    }

    pub(super) fn is(&self, ahead: usize, word: &str) -> bool {
        self.item(ahead).text.eq_ignore_ascii_case(word)
    }

    pub(super) fn is_one_of(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is(0, word))
    }

    pub(super) fn key(&self) -> Option<Keyword> {
        match self.token() {
            Token::Word(Word::Key(keyword)) => Some(keyword),
            _ => None,
        }
    }

    /// Comments in front of the next token, and the gap.
    pub(super) fn gap(&mut self, gap: Gap) {
        if std::mem::replace(&mut self.gapped, true) {
            return;
        }
        let items = self.items;
        let item = &items[self.at];
        let mut fold = match gap {
            Gap::Fold(fold) => fold,
            Gap::Nothing | Gap::Blank => Break { offset: STEP, ..FOLD },
        };
        let keep_empty = fold.empty_line;
        let begins = self.at > 0 && items[self.at - 1].text == "{";
        for (i, comment) in item.comments.iter().enumerate() {
            let lines_behind = match item.comments.get(i + 1) {
                Some(next) => next.lines,
                None if item.token == Token::End => 1,
                None => item.lines,
            };
            let text = Cow::Borrowed(&*comment.text);
            let empty_line = keep_empty && comment.lines > 1 && (i > 0 || !begins);
            if lines_behind == 0 {
                // It belongs to the token that it stands in front of.
                let tight = gap == Gap::Nothing && self.at > 0 && items[self.at - 1].text == "(";
                if fold.forced || matches!(gap, Gap::Fold(_)) {
                    self.document.line_break(Break { empty_line, ..fold });
                } else if !tight {
                    self.document.blank();
                }
                self.document.text(text);
                if !matches!(item.text, "," | ")") {
                    self.document.blank();
                }
                return;
            }
            if comment.lines == 0 {
                self.document.blank();
            } else {
                let offset = match (gap, item.text) {
                    (Gap::Fold(_), "+" | "-" | "*" | ")") => TERM,
                    (_, "}") => STEP,
                    _ => fold.offset,
                };
                self.document.line_break(Break { forced: true, empty_line, offset, ..fold });
            }
            self.document.tail(text);
            fold.forced = true;
        }
        match gap {
            Gap::Nothing if !fold.forced => {}
            Gap::Blank if !fold.forced => self.document.blank(),
            _ => {
                let begins = begins && item.comments.is_empty();
                let empty_line = keep_empty && item.lines > 1 && !begins;
                self.document.line_break(Break { empty_line, ..fold });
            }
        }
    }

    /// The next token itself.
    pub(super) fn word(&mut self) {
        self.gap(Gap::Blank);
        self.document.text(self.items[self.at].text);
        self.at += 1;
        self.gapped = false;
    }

    pub(super) fn put(&mut self, gap: Gap) {
        self.gap(gap);
        self.word();
    }

    /// A statement begins here, or the statements end.
    pub(super) fn at_statement(&self) -> bool {
        match self.token() {
            Token::End => true,
            Token::Word(Word::Key(keyword)) => Keyword::STATEMENTS.contains(&keyword),
            _ => self.is_one_of(&["{", "}"]) || self.at_let() || self.at_repeat(),
        }
    }

    fn at_let(&self) -> bool {
        self.is(0, "let") && self.is(2, "=")
    }

    fn at_repeat(&self) -> bool {
        self.is(0, "repeat") && self.is(2, "from")
    }

    fn statement(&mut self) {
        let keyword = self.key().filter(|keyword| Keyword::STATEMENTS.contains(keyword));
        if self.is(0, "}") {
            return self.close_braces();
        }
        if !self.chained {
            self.gap(Gap::Fold(Break { forced: true, empty_line: true, ..FOLD }));
            self.document.begin(Flow::Together, 0);
        } else {
            self.gap(Gap::Fold(FOLD));
        }
        if self.at_let() {
            self.constant();
        } else if self.at_repeat() {
            self.document.begin(Flow::Fill, STEP);
            self.range();
            self.document.end();
        } else if matches!(keyword, Some(Keyword::Class | Keyword::Object)) {
            return self.named_solid();
        } else if self.is(0, "{") {
            self.chained = false;
            self.word();
            self.document.begin(Flow::Together, STEP);
            self.levels.push(Level::Statements);
            return;
        } else {
            self.clauses(keyword);
        }
        if self.is(0, "{") {
            self.chained = false;
            self.put(Gap::Blank);
            self.document.begin(Flow::Together, STEP);
            self.levels.push(Level::Statements);
            return;
        }
        let next = self.item(0);
        self.chained = keyword.is_some_and(|keyword| VIEW.contains(&keyword))
            && self.key().is_some_and(|next| VIEW.contains(&next))
            && next.lines == 0
            && next.comments.is_empty();
        if !self.chained {
            self.document.end();
        }
    }

    fn close_braces(&mut self) {
        let open = self.levels.pop().is_some();
        if open {
            // Of the statements in the braces; the break stands in that of the statement that has them.
            self.document.end();
        }
        self.put(Gap::Fold(Break { forced: true, ..FOLD }));
        if open {
            self.document.end();
        }
    }

    /// `let NAME = expression`
    fn constant(&mut self) {
        self.word();
        self.put(Gap::Blank);
        self.put(Gap::Blank);
        self.document.begin(Flow::Fill, STEP);
        self.expression();
        self.document.end();
        self.rest();
    }

    /// Words up to what a range is for, `{` or `(`.
    fn range(&mut self) {
        self.word();
        while !self.at_statement() && !self.is(0, "(") {
            let bound = self.is_one_of(&["from", "to", "step"]);
            self.put(if bound { Gap::Fold(FOLD) } else { Gap::Blank });
            if bound {
                self.expression();
            }
        }
    }

    fn named_solid(&mut self) {
        self.word();
        while !self.at_statement() && !self.is(0, "is") {
            self.put(Gap::Blank);
            if self.is(0, "(") {
                self.arguments(Gap::Blank);
            }
        }
        if self.at_statement() {
            return self.document.end();
        }
        self.put(Gap::Blank);
        self.document.begin(Flow::Together, 0);
        let gap = Gap::Fold(Break { offset: TERM, ..FOLD });
        self.levels.push(Level::Solid(Solid::new(gap, false)));
        if self.at_statement() {
            // Nothing follows.
            self.factor();
        }
    }

    /// A statement that is a word and clauses.
    fn clauses(&mut self, keyword: Option<Keyword>) {
        let colored =
            matches!(keyword, Some(Keyword::Light | Keyword::Ambient | Keyword::Background));
        let mut color_may_stand = colored;
        self.document.begin(Flow::Fill, STEP);
        self.word();
        loop {
            if color_may_stand && self.at_color() {
                self.gap(Gap::Fold(FOLD));
                self.color();
                color_may_stand = false;
            } else if self.at_statement() {
                break;
            } else if self.is(0, "(") {
                let called = is_function(self.items[self.at - 1].text);
                self.arguments(if called { Gap::Nothing } else { Gap::Blank });
            } else {
                let before = &self.items[self.at - 1];
                let first = before.text.eq_ignore_ascii_case("camera")
                    || before.text.eq_ignore_ascii_case("target");
                let gap = if matches!(before.token, Token::Minus | Token::Plus) {
                    Gap::Nothing
                } else if !first && self.is_one_of(CLAUSES) {
                    Gap::Fold(FOLD)
                } else {
                    Gap::Blank
                };
                self.put(gap);
            }
        }
        self.document.end();
    }

    /// What cannot stand here, up to the next statement.
    fn rest(&mut self) {
        while !self.at_statement() {
            self.put(Gap::Blank);
        }
    }

    /// One factor and what follows it, up to the next one.
    fn factor(&mut self) {
        let Some(Level::Solid(solid)) = self.levels.last_mut() else { return };
        let (gap, at_term) = (solid.gap, std::mem::replace(&mut solid.at_term, false));
        self.gap_of_factor(gap);
        if at_term {
            let term = self.document.begin(Flow::Together, TERM);
            if let Some(Level::Solid(solid)) = self.levels.last_mut() {
                solid.terms += 1;
                solid.term.get_or_insert(term);
            }
        }
        let factor = self.document.begin(Flow::Together, STEP);
        self.document.begin(Flow::Fill, 0);
        let mut attributes = 0;
        while self.at_attribute() {
            self.gap(Gap::Fold(FOLD));
            self.attribute();
            attributes += 1;
        }
        self.document.end();
        if attributes == 0 {
            self.document.indent(factor, 0);
        }
        let before_core = if attributes > 0 { Gap::Fold(FOLD) } else { Gap::Nothing };
        if self.is_one_of(&["union", "intersection"]) && self.is(1, "of") {
            self.gap(if attributes > 0 { Gap::Blank } else { Gap::Nothing });
            self.document.begin(Flow::Fill, STEP);
            self.range();
            self.document.end();
        }
        if self.is(0, "(") {
            let bare = attributes == 0 && self.gapped;
            self.document.indent(factor, 0);
            self.put(if bare { Gap::Nothing } else { Gap::Blank });
            self.document.begin(Flow::Together, 0);
            let gap = Gap::Fold(Break { blank: false, offset: TERM, ..FOLD });
            self.levels.push(Level::Solid(Solid::new(gap, true)));
            return;
        }
        if matches!(self.token(), Token::Name(_) | Token::Word(Word::Solid(_))) {
            self.gap(before_core);
            self.document.begin(Flow::Fill, STEP);
            self.word();
            if self.is(0, "(") {
                self.arguments(Gap::Blank);
            }
        } else {
            self.document.begin(Flow::Fill, STEP);
        }
        self.behind_factor();
    }

    /// In front of a factor, its break remembered if it is the first of its solid.
    fn gap_of_factor(&mut self, gap: Gap) {
        self.gap(gap);
        let place = self.document.last();
        if let Some(Level::Solid(solid)) = self.levels.last_mut() {
            solid.first.get_or_insert(place);
        }
    }

    /// Transforms, closing parentheses, and the operator; or the end of the statement.
    fn behind_factor(&mut self) {
        loop {
            let group = matches!(self.levels.last(), Some(Level::Solid(solid)) if solid.group);
            if self.at_statement() {
                return self.close();
            } else if self.key().is_some_and(|key| Keyword::TRANSFORMS.contains(&key)) {
                self.put(Gap::Fold(FOLD));
                self.operand(Gap::Blank);
            } else if group && self.token() == Token::Close {
                (0..3).for_each(|_| self.document.end());
                self.put(Gap::Fold(Break { blank: false, ..FOLD }));
                self.document.end();
                self.levels.pop();
                self.document.begin(Flow::Fill, STEP);
            } else if let Token::Plus | Token::Minus | Token::Times = self.token() {
                let new_term = self.token() != Token::Times;
                (0..if new_term { 3 } else { 2 }).for_each(|_| self.document.end());
                let operator = Break { offset: STEP, empty_line: new_term, ..FOLD };
                self.put(Gap::Fold(operator));
                if let Some(Level::Solid(solid)) = self.levels.last_mut() {
                    solid.gap = Gap::Blank;
                    solid.at_term = new_term;
                }
                return;
            } else {
                self.put(Gap::Fold(FOLD));
            }
        }
    }

    /// Ends the solids that are open.
    fn close(&mut self) {
        let mut blocks = 4;
        let mut statement = false;
        while let Some(Level::Solid(_)) = self.levels.last() {
            let Some(Level::Solid(solid)) = self.levels.pop() else { return };
            (0..blocks).for_each(|_| self.document.end());
            blocks = 3;
            statement = true;
            // One term begins on the line of the statement.
            if let (false, 1, Some(first), Some(term)) =
                (solid.group, solid.terms, solid.first, solid.term)
                && self.document.glue(first)
            {
                self.document.indent(term, 0);
            }
        }
        if statement {
            self.document.end();
        }
    }
}

impl Solid {
    fn new(gap: Gap, group: bool) -> Self {
        Self { gap, first: None, term: None, at_term: true, terms: 0, group }
    }
}
