//! Tokens with the comments and the ends of lines between them.

use std::borrow::Cow;

use crate::cursor::Cursor;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Text;
use crate::token::{Symbols, Token};

/// A token as it is written.
#[derive(Debug)]
pub(super) struct Item<'a> {
    pub(super) token: Token,
    /// Empty at the end of the file.
    pub(super) text: &'a str,
    /// In front of it, in order.
    pub(super) comments: Vec<Comment<'a>>,
    /// Ends of lines between what comes before it, a comment too, and it; many count as two.
    pub(super) lines: usize,
}

/// Comments that stand on one line, as one text.
#[derive(Debug)]
pub(super) struct Comment<'a> {
    pub(super) text: Cow<'a, str>,
    /// Ends of lines in front of it; many count as two.
    pub(super) lines: usize,
}

/// The tokens of a text and, last, its end.
pub(super) fn items(text: &Text) -> Result<Vec<Item<'_>>, Vec<Diagnostic>> {
    let (mut symbols, mut diagnostics) = (Symbols::new(), Diagnostics::default());
    let mut cursor = Cursor::new(text.clone(), 0, &mut diagnostics);
    let mut items = Vec::new();
    let mut last = if text.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    loop {
        let (token, span) = cursor.peek(0, &mut symbols, &mut diagnostics);
        let (start, end) = (span.start as usize, span.end as usize);
        let (comments, lines) = comments(&text.text[last..start], items.is_empty());
        items.push(Item { token, text: &text.text[start..end], comments, lines });
        if token == Token::End {
            break;
        }
        cursor.advance();
        last = end;
    }
    if diagnostics.has_errors() { Err(diagnostics.finish()) } else { Ok(items) }
}

/// The comments in what stands between two tokens, and the ends of lines behind the last. The beginning of a text is
/// that of a line.
fn comments(mut gap: &str, first: bool) -> (Vec<Comment<'_>>, usize) {
    let mut found: Vec<Comment<'_>> = Vec::new();
    let mut lines = usize::from(first);
    loop {
        let blank = gap.len() - gap.trim_start_matches(|c: char| c != '/').len();
        lines = (lines + gap[..blank].matches('\n').count()).min(2);
        gap = &gap[blank..];
        if gap.is_empty() {
            return (found, lines);
        }
        let end = match gap.strip_prefix("/*") {
            Some(inner) => inner.find("*/").map(|end| end + 4),
            None => gap.find('\n'),
        };
        let end = end.unwrap_or(gap.len());
        let text = gap[..end].trim_end();
        let text = if text.contains('\r') { text.replace('\r', "").into() } else { text.into() };
        match found.last_mut() {
            Some(last) if lines == 0 => last.text = format!("{} {text}", last.text).into(),
            _ => found.push(Comment { text, lines }),
        }
        lines = 0;
        gap = &gap[end..];
    }
}
