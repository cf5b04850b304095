//! A text with places where lines may end, and the choice of those where they do.
//!
//! The document is flat, and its two passes are loops (after Oppen, "Prettyprinting", 1980, with the whole document
//! at hand instead of a window of it): nothing that nests can exhaust the stack.

use std::borrow::Cow;

/// Columns of a line that is not longer than it has to be.
const WIDTH: usize = 100;

/// Lines are indented at most this far, so that what nests deeply does not grow with the square of its depth.
const DEEPEST: usize = 48;

/// Wider than any line; few enough that a text of 2²⁸ bytes cannot overflow a sum of them.
const ENDLESS: u64 = 1 << 32;

/// How the breaks of a block go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    /// All of them end lines, or none does.
    Together,
    /// Each ends a line only if what follows does not fit.
    Fill,
}

/// A place where a line may end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Break {
    /// In place of the end of a line.
    pub(super) blank: bool,
    /// The line ends whatever follows.
    pub(super) forced: bool,
    /// If the line ends an empty one follows.
    pub(super) empty_line: bool,
    /// Indentation of the next line, relative to that of the block.
    pub(super) offset: usize,
}

#[derive(Debug)]
enum Part<'a> {
    Text(Cow<'a, str>),
    /// A text at the end of its line: it may pass the width.
    Tail(Cow<'a, str>),
    Blank,
    Break(Break),
    Begin {
        flow: Flow,
        indent: usize,
    },
    End,
}

/// A text that is being laid out.
#[derive(Debug, Default)]
pub(super) struct Document<'a> {
    parts: Vec<Part<'a>>,
}

/// A block or a break that is there already; what it is like may still change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place(usize);

impl<'a> Document<'a> {
    /// A text that stays together.
    pub(super) fn text(&mut self, text: impl Into<Cow<'a, str>>) {
        self.parts.push(Part::Text(text.into()));
    }

    /// A text that a forced break follows.
    pub(super) fn tail(&mut self, text: impl Into<Cow<'a, str>>) {
        self.parts.push(Part::Tail(text.into()));
    }

    /// A blank, if a text follows on the same line.
    pub(super) fn blank(&mut self) {
        self.parts.push(Part::Blank);
    }

    pub(super) fn line_break(&mut self, line_break: Break) {
        self.parts.push(Part::Break(line_break));
    }

    /// The last part.
    pub(super) fn last(&self) -> Place {
        Place(self.parts.len().saturating_sub(1))
    }

    /// Begins a block indented by `indent` more than the one around it.
    pub(super) fn begin(&mut self, flow: Flow, indent: usize) -> Place {
        self.parts.push(Part::Begin { flow, indent });
        Place(self.parts.len() - 1)
    }

    pub(super) fn end(&mut self) {
        self.parts.push(Part::End);
    }

    /// Changes the indentation of a block.
    pub(super) fn indent(&mut self, block: Place, by: usize) {
        if let Some(Part::Begin { indent, .. }) = self.parts.get_mut(block.0) {
            *indent = by;
        }
    }

    /// Makes a blank of a break that is not forced, and says whether it was one.
    pub(super) fn glue(&mut self, line_break: Place) -> bool {
        let part = self.parts.get_mut(line_break.0);
        match part {
            Some(part @ Part::Break(Break { forced: false, .. })) => {
                *part = Part::Blank;
                true
            }
            _ => false,
        }
    }

    /// The width of everything before each part on one line without end, and of the whole.
    fn widths(&self) -> Vec<u64> {
        let mut sum = 0;
        let mut widths = Vec::with_capacity(self.parts.len() + 1);
        widths.push(0);
        for part in &self.parts {
            sum += match part {
                Part::Text(text) if text.contains('\n') => ENDLESS,
                Part::Text(text) => text.chars().count() as u64,
                Part::Break(Break { forced: true, .. }) => ENDLESS,
                Part::Break(Break { blank, .. }) => u64::from(*blank),
                Part::Blank => 1,
                Part::Tail(_) | Part::Begin { .. } | Part::End => 0,
            };
            widths.push(sum);
        }
        widths
    }

    /// For each beginning and each break the part before which a line has to have room for what follows it: of a
    /// block the first break behind it, of a break the next one of its block, or the first behind that.
    fn reaches(&self) -> Vec<usize> {
        let last = self.parts.len();
        let mut reaches = vec![last; last];
        // The first break at or behind the part that is looked at, and in each open block the next one.
        let mut next = last;
        let mut open: Vec<usize> = vec![last];
        let mut behind: Vec<usize> = Vec::new();
        for (i, part) in self.parts.iter().enumerate().rev() {
            match part {
                Part::End => {
                    behind.push(next);
                    open.push(next);
                }
                Part::Begin { .. } => {
                    reaches[i] = behind.pop().unwrap_or(last);
                    open.pop();
                }
                Part::Break(_) => {
                    if let Some(following) = open.last_mut() {
                        reaches[i] = std::mem::replace(following, i);
                    }
                    next = i;
                }
                Part::Text(_) | Part::Tail(_) | Part::Blank => {}
            }
        }
        reaches
    }

    /// The text, its lines ended; empty if there is nothing.
    pub(super) fn print(&self) -> String {
        let (widths, reaches) = (self.widths(), self.reaches());
        let room = |i: usize, column: usize| {
            widths[reaches[i]] - widths[i] <= (WIDTH.saturating_sub(column)) as u64
        };
        let mut printed = Printed::default();
        // Indentation of each open block, how its breaks go, and whether it is on one line.
        let mut open = vec![(0, Flow::Together, false)];
        for (i, part) in self.parts.iter().enumerate() {
            let (base, flow, flat) = open.last().copied().unwrap_or((0, Flow::Together, false));
            match part {
                Part::Text(text) | Part::Tail(text) => printed.text(text),
                Part::Blank => printed.blank = true,
                Part::Begin { flow, indent } => {
                    open.push((base + indent, *flow, flat || room(i, printed.column)));
                }
                Part::End => {
                    open.pop();
                }
                Part::Break(this) => {
                    let one_line =
                        !this.forced && (flat || flow == Flow::Fill && room(i, printed.column));
                    if one_line {
                        printed.blank |= this.blank;
                    } else {
                        printed.end_line(this.empty_line, base + this.offset);
                    }
                }
            }
        }
        printed.finish()
    }
}

/// Text so far, and where its last line is.
#[derive(Debug, Default)]
struct Printed {
    text: String,
    column: usize,
    /// A blank is due before the next text.
    blank: bool,
    /// Nothing is on the line yet but this indentation.
    indentation: Option<usize>,
}

impl Printed {
    fn text(&mut self, text: &str) {
        if let Some(indentation) = self.indentation.take() {
            self.text.extend(std::iter::repeat_n(' ', indentation));
            self.column = indentation;
        } else if self.blank {
            self.text.push(' ');
            self.column += 1;
        }
        self.blank = false;
        self.text.push_str(text);
        self.column = match text.rsplit_once('\n') {
            Some((_, last)) => last.chars().count(),
            None => self.column + text.chars().count(),
        };
    }

    fn end_line(&mut self, empty_line: bool, indentation: usize) {
        let indentation = indentation.min(DEEPEST);
        self.blank = false;
        // Of two breaks without a text between them the second says how the next line begins.
        if self.indentation.is_none() && !self.text.is_empty() {
            self.text.push('\n');
        }
        if empty_line && !self.text.is_empty() && !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
        self.indentation = Some(indentation);
        self.column = indentation;
    }

    fn finish(mut self) -> String {
        while self.text.ends_with('\n') {
            self.text.pop();
        }
        if !self.text.is_empty() {
            self.text.push('\n');
        }
        self.text
    }
}
