//! Words and numbers of a text, line by line, without a copy.

use glam::DVec3;

use super::check::Range;
use super::decimal::Decimal;
use super::error::ReadError;

/// What to do about derived data that is not what follows.
const STALE: &str = "does not match; compile the scene again";

/// How a file name is written.
const QUOTED: &str = "a file name in quotes";

/// The bits of 1.
pub(super) const ONE: u64 = 1_f64.to_bits();

/// How much of an unexpected word is repeated in the message.
const SHOWN: usize = 40;

/// A place in a text.
pub(super) struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
    /// Where the line begins.
    start: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0, line: 1, start: 0 }
    }

    /// The next word of this line; empty at its end, and before a byte that no line may hold.
    #[inline]
    pub(super) fn peek(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let rest = &self.text[self.at..];
        &rest[..rest.iter().position(|byte| *byte <= b' ').unwrap_or(rest.len())]
    }

    #[inline]
    fn skip_blanks(&mut self) {
        while let Some(b' ' | b'\t' | b'\r') = self.text.get(self.at) {
            self.at += 1;
        }
    }

    /// Takes the next word if it is `word`.
    #[inline]
    pub(super) fn take(&mut self, word: &str) -> bool {
        let same = self.is_at(word);
        if same {
            self.at += word.len();
        }
        same
    }

    /// True if the next word is `word`.
    #[inline]
    pub(super) fn is_at(&mut self, word: &str) -> bool {
        self.skip_blanks();
        self.text[self.at..].starts_with(word.as_bytes()) && self.is_end(self.at + word.len())
    }

    /// True if a word may end there.
    #[inline]
    fn is_end(&self, at: usize) -> bool {
        self.text.get(at).is_none_or(|byte| *byte <= b' ')
    }

    #[inline]
    pub(super) fn expect(&mut self, word: &str) -> Result<(), ReadError> {
        if self.take(word) { Ok(()) } else { Err(self.error(format!("`{word}`"))) }
    }

    /// Takes a word that `parse` understands.
    #[inline]
    pub(super) fn parsed<T>(
        &mut self,
        expected: &str,
        parse: impl FnOnce(&'a str) -> Option<T>,
    ) -> Result<T, ReadError> {
        let word = self.peek();
        match std::str::from_utf8(word).ok().and_then(parse) {
            Some(value) => {
                self.at += word.len();
                Ok(value)
            }
            None => Err(self.error(expected)),
        }
    }

    #[inline]
    pub(super) fn number(&mut self, range: &Range) -> Result<f64, ReadError> {
        if let Some((decimal, end)) = self.decimal()
            && let Some(value) = decimal.plain_value().filter(|value| range.allows(*value))
        {
            self.at = end;
            return Ok(value);
        }
        let parse = |word: &str| word.parse().ok().filter(|value| range.allows(*value));
        self.parsed(range.words, parse)
    }

    pub(super) fn vector(&mut self, range: &Range) -> Result<DVec3, ReadError> {
        Ok(DVec3::new(self.number(range)?, self.number(range)?, self.number(range)?))
    }

    /// Takes a text in quotes, in which `\` stands before a quote and before itself.
    pub(super) fn quoted(&mut self) -> Result<String, ReadError> {
        let mark = self.mark();
        let (mut bytes, mut escaped) = (Vec::new(), false);
        let rest = self.text[mark..].strip_prefix(b"\"");
        for &byte in rest.unwrap_or_default() {
            self.at += 1;
            match byte {
                b'"' if !escaped => {
                    self.at += 1;
                    let text = String::from_utf8(bytes)
                        .ok()
                        .filter(|text| !text.is_empty() && !text.contains(char::is_control));
                    return text.ok_or_else(|| self.error_at(mark, QUOTED));
                }
                b'\\' if !escaped => escaped = true,
                b'"' | b'\\' => {
                    bytes.push(byte);
                    escaped = false;
                }
                _ if escaped || byte < b' ' => break,
                _ => bytes.push(byte),
            }
        }
        Err(self.error_at(mark, QUOTED))
    }

    /// A whole number below `end`; `what` it is the number of.
    pub(super) fn index(&mut self, what: &str, end: usize) -> Result<u32, ReadError> {
        match self.whole().filter(|(index, _)| (*index as usize) < end) {
            Some((index, end)) => {
                self.at = end;
                Ok(index)
            }
            None if end == 0 => Err(self.error(format!("{what}, of which there is none so far"))),
            None => Err(self.error(format!("{what} from 0 to {}", end - 1))),
        }
    }

    /// The next word, if it is a whole number, and where it ends.
    #[inline]
    fn whole(&mut self) -> Option<(u32, usize)> {
        self.skip_blanks();
        if let [digit @ b'0'..=b'9', b' ' | b'\n', ..] = self.text[self.at..] {
            return Some((u32::from(digit - b'0'), self.at + 1));
        }
        let word = self.peek();
        let number = std::str::from_utf8(word).ok()?.parse().ok()?;
        Some((number, self.at + word.len()))
    }

    /// The number that comes next where things are counted.
    pub(super) fn ordinal(&mut self, next: usize) -> Result<(), ReadError> {
        match self.whole().filter(|(number, _)| *number as usize == next) {
            Some((_, end)) => {
                self.at = end;
                Ok(())
            }
            None => Err(self.error(format!("number {next}, the next in order"))),
        }
    }

    /// Takes a number that has to be `value`, bit for bit, as it was worked out from what precedes.
    #[inline]
    pub(super) fn same(&mut self, value: f64) -> Result<(), ReadError> {
        // Many corners are these.
        if let Some([b' ', digit @ (b'0' | b'1'), b'.', b'0', b' ' | b'\n']) =
            self.text[self.at..].first_chunk()
            && value.to_bits() == if *digit == b'0' { 0 } else { ONE }
        {
            self.at += 4;
            return Ok(());
        }
        match self.decimal() {
            Some((decimal, end)) if decimal.rounds_to(value) => {
                self.at = end;
                Ok(())
            }
            _ => self.same_by_value(value),
        }
    }

    /// [`Self::same`] for numbers of any form.
    #[cold]
    fn same_by_value(&mut self, value: f64) -> Result<(), ReadError> {
        let word = self.peek();
        let read: Option<f64> = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        if read.map(f64::to_bits) == Some(value.to_bits()) && value.is_finite() {
            self.at += word.len();
            Ok(())
        } else {
            Err(self.stale(format!("{value:?}")))
        }
    }

    /// The next word, if it is a plain decimal, and where it ends.
    #[inline(always)]
    fn decimal(&mut self) -> Option<(Decimal, usize)> {
        self.skip_blanks();
        let (decimal, length) = Decimal::scan(&self.text[self.at..])?;
        let end = self.at + length;
        self.is_end(end).then_some((decimal, end))
    }

    /// Takes a word that has to be there, as it was worked out from what precedes.
    #[inline]
    pub(super) fn same_word(&mut self, word: &str) -> Result<(), ReadError> {
        if self.take(word) { Ok(()) } else { Err(self.stale(format!("`{word}`"))) }
    }

    /// Goes to the next line with a word in it, or to the end of the text.
    #[inline]
    pub(super) fn end_line(&mut self) -> Result<(), ReadError> {
        self.skip_blanks();
        match self.text.get(self.at) {
            None => return Ok(()),
            Some(b'\n') => {}
            Some(_) => return Err(self.error("the end of the line")),
        }
        while let Some(b'\n') = self.text.get(self.at) {
            self.at += 1;
            self.line += 1;
            self.start = self.at;
            self.skip_blanks();
        }
        Ok(())
    }

    /// True if nothing is left.
    pub(super) fn is_done(&mut self) -> bool {
        self.skip_blanks();
        self.at == self.text.len()
    }

    /// Line and column of the next word, from 1; beyond the range of numbers the last one.
    pub(super) fn place(&mut self) -> (u32, u32) {
        let column = self.mark() - self.start + 1;
        let number = |place: usize| u32::try_from(place).unwrap_or(u32::MAX);
        (number(self.line), number(column))
    }

    /// Where the next word begins.
    pub(super) fn mark(&mut self) -> usize {
        self.skip_blanks();
        self.at
    }

    /// An error at a mark in this line.
    #[cold]
    pub(super) fn error_at(&mut self, mark: usize, expected: impl Into<String>) -> ReadError {
        self.at = mark;
        self.error(expected)
    }

    /// An error at the next word.
    #[cold]
    pub(super) fn error(&mut self, expected: impl Into<String>) -> ReadError {
        let word = self.peek();
        let found = match self.text.get(self.at) {
            None => "the end of the file".to_owned(),
            Some(b'\n') => "the end of the line".to_owned(),
            Some(byte) if word.is_empty() => format!("byte {byte}"),
            Some(_) => {
                let shown = String::from_utf8_lossy(&word[..word.len().min(SHOWN)]);
                let more = if word.len() > SHOWN { "…" } else { "" };
                format!("`{}{more}`", shown.escape_debug())
            }
        };
        ReadError {
            line: self.line,
            column: self.at - self.start + 1,
            found,
            expected: expected.into(),
            hint: None,
        }
    }

    #[cold]
    fn stale(&mut self, expected: String) -> ReadError {
        ReadError { hint: Some(STALE), ..self.error(expected) }
    }
}
