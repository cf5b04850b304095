//! What the compiler has to say: message, place and hint, printed with the source line and a caret.

use std::collections::HashMap;
use std::fmt::{self, Write};
use std::ops::Range;

use crate::source::{SourceMap, Span};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// There is no scene.
    Error,
    /// Legal, but surely not meant.
    Warning,
}

/// Another place that matters to a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Where.
    pub span: Span,
    /// What is there.
    pub message: String,
}

/// One thing the compiler has to say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What was found and what was expected: lower case, no full stop.
    pub message: String,
    /// Where; `None` when the main file cannot be read.
    pub span: Option<Span>,
    /// What to do about it.
    pub hint: Option<String>,
    /// Other places that matter.
    pub notes: Vec<Note>,
    /// Here the text is no statement of the language, whatever its names and numbers mean.
    pub(crate) ill_formed: bool,
}

impl Diagnostic {
    /// An error at `span`.
    pub fn error(span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            span: Some(span),
            hint: None,
            notes: Vec::new(),
            ill_formed: false,
        }
    }

    /// An error that no place in a source shows.
    pub fn nowhere(message: impl Into<String>) -> Self {
        Self { span: None, ..Self::error(Span::default(), message) }
    }

    /// A warning at `span`.
    pub fn warning(span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(span, message) }
    }

    /// With a hint, if there is one.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<Option<String>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Where the text is no statement of the language.
    #[must_use]
    pub(crate) fn ill_formed(self) -> Self {
        Self { ill_formed: true, ..self }
    }

    /// With another place.
    #[must_use]
    pub fn note(mut self, span: Span, message: impl Into<String>) -> Self {
        self.notes.push(Note { span, message: message.into() });
        self
    }

    /// As lines of text: place and message, the source line with a caret, notes and hint.
    #[must_use]
    pub fn human(&self, sources: &SourceMap) -> String {
        Shown { diagnostic: self, sources, write: write_human }.to_string()
    }

    /// As one JSON object on one line.
    #[must_use]
    pub fn json(&self, sources: &SourceMap) -> String {
        Shown { diagnostic: self, sources, write: write_json }.to_string()
    }
}

/// A diagnostic with what it takes to write it.
struct Shown<'a> {
    diagnostic: &'a Diagnostic,
    sources: &'a SourceMap,
    write: fn(&Diagnostic, &SourceMap, &mut fmt::Formatter<'_>) -> fmt::Result,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (self.write)(self.diagnostic, self.sources, f)
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
        })
    }
}

/// Of errors and of warnings, more than this are counted, not kept: a file of noise must not fill the memory.
const KEPT: usize = 1000;

/// Of one that is said again in other uses of a class, more uses than this are not kept.
const USES: usize = 64;

/// Place and message of a diagnostic: there is one of each.
pub(crate) type Said = (Span, String);

/// Diagnostics of a run as they come.
#[derive(Debug, Default)]
pub(crate) struct Diagnostics {
    list: Vec<Diagnostic>,
    /// What has been said, and where it stands in the list.
    said: HashMap<Said, Option<usize>>,
    errors: usize,
    warnings: usize,
}

impl Diagnostics {
    /// True while another error would be kept; hints for others need not be worked out.
    pub(crate) fn open(&self) -> bool {
        self.errors < KEPT
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// How many errors there are.
    pub(crate) fn errors(&self) -> usize {
        self.errors
    }

    /// Keeps what has not been said before: a body that is read several times says the same each time. Of one that has,
    /// the places are kept that led to it now.
    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        let count = match diagnostic.severity {
            Severity::Error => &mut self.errors,
            Severity::Warning => &mut self.warnings,
        };
        let place = (*count < KEPT).then_some(self.list.len());
        if let Some(span) = diagnostic.span
            && self.said.len() <= 2 * KEPT
        {
            let said = (span, diagnostic.message.clone());
            if self.said.contains_key(&said) {
                self.also(&said, diagnostic.notes);
                return;
            }
            self.said.insert(said, place);
        }
        *count += 1;
        if place.is_some() {
            self.list.push(diagnostic);
        }
    }

    /// What was said came up in other places, too.
    pub(crate) fn also(&mut self, said: &Said, notes: Vec<Note>) {
        let Some(place) = self.said.get(said).copied().flatten() else { return };
        let known = &mut self.list[place].notes;
        for note in notes {
            if known.len() < USES && known.iter().all(|other| other.span != note.span) {
                known.push(note);
            }
        }
    }

    /// The last that is in the list, if it is an error.
    pub(crate) fn last_error(&self) -> Option<Said> {
        let last = self.list.last().filter(|last| last.severity == Severity::Error)?;
        Some((last.span?, last.message.clone()))
    }

    /// Takes back the errors inside of `span`, of which one will be said as a whole.
    pub(crate) fn take_back(&mut self, span: Span) {
        let kept = self.list.len();
        self.list.retain(|diagnostic| {
            diagnostic.severity != Severity::Error
                || !diagnostic.span.is_some_and(|at| span.start <= at.start && at.end <= span.end)
        });
        self.errors -= kept - self.list.len();
        self.said.values_mut().for_each(|place| *place = None);
        for (place, diagnostic) in self.list.iter().enumerate() {
            let Some(span) = diagnostic.span else { continue };
            if let Some(known) = self.said.get_mut(&(span, diagnostic.message.clone())) {
                *known = Some(place);
            }
        }
    }

    /// All that were kept, in source order, and last how many were not.
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.list.sort_by_key(|diagnostic| diagnostic.span);
        for (severity, count) in
            [(Severity::Error, self.errors), (Severity::Warning, self.warnings)]
        {
            if count > KEPT {
                let message = format!("{} more {severity}s are not listed", count - KEPT);
                self.list.push(Diagnostic { severity, ..Diagnostic::nowhere(message) });
            }
        }
        self.list
    }
}

/// Characters of a source line printed before and after the place that is underlined.
const WINDOW: usize = 60;
/// Other places printed for one diagnostic.
const NOTES: usize = 8;

fn write_human(
    diagnostic: &Diagnostic,
    sources: &SourceMap,
    out: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    let Diagnostic { severity, message, span, hint, notes, ill_formed: _ } = diagnostic;
    match span.and_then(|span| sources.locate(span)) {
        Some(at) => {
            let (path, line, column) = (at.path.display(), at.line, at.column);
            writeln!(out, "{path}:{line}:{column}: {severity}: {message}")?;
        }
        None => writeln!(out, "{severity}: {message}")?,
    }
    if let Some(span) = span {
        write_excerpt(*span, sources, out)?;
    }
    for note in notes.iter().take(NOTES) {
        if let Some(at) = sources.locate(note.span) {
            let (path, line, column) = (at.path.display(), at.line, at.column);
            writeln!(out, "{path}:{line}:{column}: note: {}", note.message)?;
            write_excerpt(note.span, sources, out)?;
        }
    }
    if notes.len() > NOTES {
        writeln!(out, "note: and {} more places", notes.len() - NOTES)?;
    }
    if let Some(hint) = hint {
        writeln!(out, "hint: {hint}")?;
    }
    Ok(())
}

/// The source line, cut to a window about the span, and carets under the span.
fn write_excerpt(span: Span, sources: &SourceMap, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (Some(at), Some((bytes, line_start, range))) =
        (sources.locate(span), sources.surroundings(span))
    else {
        return Ok(());
    };
    let (before, marked, after) = window(bytes, line_start, &range);
    let number = at.line.to_string();
    let dots = if before.start > line_start { "…" } else { "" };
    let rest = if ends_line(bytes, after.end) { "" } else { "…" };
    writeln!(
        out,
        "{number} | {dots}{}{}{}{rest}",
        visible(&bytes[before.clone()]),
        visible(&bytes[marked.clone()]),
        visible(&bytes[after])
    )?;
    let indent = dots.chars().count() + visible(&bytes[before]).chars().count();
    let carets = visible(&bytes[marked]).chars().count().max(1);
    let margin = " ".repeat(number.len());
    writeln!(out, "{margin} | {}{}", " ".repeat(indent), "^".repeat(carets))
}

/// What is shown of a line before, in and after `range`: at most [`WINDOW`] characters each.
fn window(
    bytes: &[u8],
    line_start: usize,
    range: &Range<usize>,
) -> (Range<usize>, Range<usize>, Range<usize>) {
    let start = range.start.min(bytes.len());
    let from = start - backward(&bytes[line_start..start]);
    let end = (start + forward(&bytes[start..])).min(range.end.max(start));
    let to = end + forward(&bytes[end..]);
    (from..start, start..end, end..to)
}

/// A byte that begins a character.
fn begins(byte: u8) -> bool {
    byte & 0xc0 != 0x80
}

/// Bytes in the first [`WINDOW`] characters of the line. A character has at most three bytes that continue it.
fn forward(bytes: &[u8]) -> usize {
    let line = bytes.iter().take(4 * WINDOW).take_while(|&&byte| byte != b'\n' && byte != b'\r');
    let mut length = 0;
    let mut characters = 0;
    for &byte in line {
        characters += usize::from(begins(byte));
        if characters > WINDOW {
            break;
        }
        length += 1;
    }
    length
}

/// Bytes in the last [`WINDOW`] characters.
fn backward(bytes: &[u8]) -> usize {
    let firsts = bytes.iter().rev().take(4 * WINDOW).enumerate().filter(|&(_, &byte)| begins(byte));
    firsts.take(WINDOW).last().map_or(0, |(i, _)| i + 1)
}

fn ends_line(bytes: &[u8], at: usize) -> bool {
    matches!(bytes.get(at), None | Some(b'\n' | b'\r'))
}

/// Text that takes one column a character.
fn visible(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn write_json(
    diagnostic: &Diagnostic,
    sources: &SourceMap,
    out: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    write!(out, "{{\"severity\":\"{}\",\"message\":", diagnostic.severity)?;
    write_json_string(&diagnostic.message, out)?;
    if let Some(span) = diagnostic.span {
        write_json_place(span, sources, out)?;
    }
    if let Some(hint) = &diagnostic.hint {
        out.write_str(",\"hint\":")?;
        write_json_string(hint, out)?;
    }
    out.write_str(",\"notes\":[")?;
    for (i, note) in diagnostic.notes.iter().enumerate() {
        out.write_str(if i > 0 { ",{\"message\":" } else { "{\"message\":" })?;
        write_json_string(&note.message, out)?;
        write_json_place(note.span, sources, out)?;
        out.write_char('}')?;
    }
    out.write_str("]}")?;
    Ok(())
}

fn write_json_place(span: Span, sources: &SourceMap, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (Some(start), Some(end)) = (sources.locate(span), sources.locate_end(span)) else {
        return Ok(());
    };
    out.write_str(",\"file\":")?;
    write_json_string(&start.path.to_string_lossy(), out)?;
    write!(
        out,
        ",\"line\":{},\"column\":{},\"end_line\":{},\"end_column\":{}",
        start.line, start.column, end.line, end.column
    )
}

/// A string by RFC 8259.
fn write_json_string(text: &str, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    out.write_char('"')?;
    for c in text.chars() {
        match c {
            '"' => out.write_str("\\\"")?,
            '\\' => out.write_str("\\\\")?,
            '\n' => out.write_str("\\n")?,
            c if c < ' ' => write!(out, "\\u{:04x}", u32::from(c))?,
            c => out.write_char(c)?,
        }
    }
    out.write_char('"')?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn sources(text: &str) -> SourceMap {
        SourceMap::from_reader(Path::new("a.sdl"), text.as_bytes()).unwrap()
    }

    #[test]
    fn the_caret_stands_under_the_word() {
        let sources = sources("object is\n\tgläs at\n");
        let diagnostic = Diagnostic::error(Span { start: 11, end: 16 }, "unknown class `gläs`")
            .hint("did you mean `glass`?".to_owned())
            .note(Span { start: 0, end: 6 }, "in this object");
        let expected = "\
a.sdl:2:2: error: unknown class `gläs`
2 |  gläs at
  |  ^^^^
a.sdl:1:1: note: in this object
1 | object is
  | ^^^^^^
hint: did you mean `glass`?
";
        assert_eq!(diagnostic.human(&sources), expected);
    }

    #[test]
    fn long_lines_are_cut() {
        let text = format!("{}x{}", "a ".repeat(1000), " b".repeat(1000));
        let sources = sources(&text);
        let printed = Diagnostic::warning(Span { start: 2000, end: 2001 }, "here").human(&sources);
        let lines: Vec<&str> = printed.lines().collect();
        assert_eq!(lines[0], "a.sdl:1:2001: warning: here");
        assert_eq!(
            lines[1].chars().count(),
            4 + 60 + 1 + 60 + 2,
            "cut on both sides: {}",
            lines[1]
        );
        let caret = lines[2].chars().position(|c| c == '^').unwrap();
        assert_eq!(lines[1].chars().nth(caret), Some('x'), "{printed}");
        let all = Diagnostic::error(Span { start: 0, end: 4000 }, "all").human(&sources);
        assert!(all.len() < 400, "{all}");
    }

    #[test]
    fn places_at_the_end_of_a_file_are_shown() {
        let sources = sources("fog");
        let printed = Diagnostic::error(Span { start: 3, end: 3 }, "end").human(&sources);
        assert_eq!(printed, "a.sdl:1:4: error: end\n1 | fog\n  |    ^\n");
    }

    #[test]
    fn json_is_escaped() {
        let sources = sources("object\n is");
        let diagnostic = Diagnostic::error(Span { start: 8, end: 10 }, "a \"b\"\\\n\u{1}");
        assert_eq!(
            diagnostic.json(&sources),
            r#"{"severity":"error","message":"a \"b\"\\\n\u0001","file":"a.sdl","line":2,"column":2,"end_line":2,"end_column":4,"notes":[]}"#
        );
    }
}
