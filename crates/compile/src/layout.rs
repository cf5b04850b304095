//! The layout of a scene description: the same tokens and comments, each where a reader looks for it.
//!
//! What decides is the text without its white space, so laying out twice changes nothing more. Of the white space
//! three things are kept: a comment stays behind what it follows on its line, or on a line of its own; an empty line
//! between statements, and between the terms of a solid that takes several lines; and `camera`, `target` and `focal
//! length` on one line.

mod document;
mod piece;
mod statement;
mod trivia;

use crate::{Diagnostic, Options, SourceMap, compile};

/// What keeps a text from being laid out: where it is no statement, lines say what was meant, and tokens do not.
///
/// Names that are not known, files that are not there and numbers out of their range do no harm.
pub fn mistakes(sources: &mut SourceMap) -> Vec<Diagnostic> {
    let (_, found) = compile(sources, &Options::default());
    found.into_iter().filter(|found| found.ill_formed).collect()
}

/// The main file of `sources` laid out; the files that it includes are left alone. Words keep their case and numbers
/// their digits. A line takes 100 columns at most where it can be ended; lines end in `\n`.
///
/// A text that is no legal scene keeps its tokens, but not its lines; see [`mistakes`].
///
/// # Errors
///
/// What is wrong where the text cannot be taken apart into tokens.
pub fn laid_out(sources: &SourceMap) -> Result<String, Vec<Diagnostic>> {
    let Some(main) = sources.main() else { return Ok(String::new()) };
    let (text, _) = sources.text(main);
    let items = trivia::items(&text)?;
    Ok(statement::document(&items).print())
}

#[cfg(test)]
mod tests;
