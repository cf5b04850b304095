//! Places in a text: bytes on one side, lines and columns of the protocol on the other.

use lsp_types::{Position, Range};

/// What a column counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes.
    Utf8,
    /// Units of UTF-16, as clients have it that say nothing of it.
    Utf16,
}

/// A text and where its lines begin. Lines end with `\n`, `\r\n` or `\r`.
#[derive(Debug)]
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
    encoding: Encoding,
}

impl Encoding {
    fn length(self, c: char) -> usize {
        match self {
            Self::Utf8 => c.len_utf8(),
            Self::Utf16 => c.len_utf16(),
        }
    }
}

impl<'a> Lines<'a> {
    /// Finds the lines of `text`.
    #[must_use]
    pub fn new(text: &'a str, encoding: Encoding) -> Self {
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate().filter(|&(at, &byte)| {
            byte == b'\n' || byte == b'\r' && bytes.get(at + 1) != Some(&b'\n')
        });
        let starts = std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect();
        Self { text, starts, encoding }
    }

    /// The place of a byte; one inside a character is that of the character, one behind the text its end.
    #[must_use]
    pub fn position(&self, offset: usize) -> Position {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|&start| start <= offset) - 1;
        let before = &self.text[self.starts[line]..offset];
        let column: usize = before.chars().map(|c| self.encoding.length(c)).sum();
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Position::new(number(line), number(column))
    }

    /// The byte at a place; columns behind a line are its end, lines behind the text that of the text.
    #[must_use]
    pub fn offset(&self, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else { return self.text.len() };
        let end = self.starts.get(line + 1).copied().unwrap_or(self.text.len());
        let mut column = 0;
        let line = self.text[start..end].trim_end_matches(['\n', '\r']);
        for (at, c) in line.char_indices() {
            column += self.encoding.length(c);
            if column > position.character as usize {
                return start + at;
            }
        }
        start + line.len()
    }

    /// The range of some bytes.
    #[must_use]
    pub fn range(&self, bytes: std::ops::Range<usize>) -> Range {
        Range::new(self.position(bytes.start), self.position(bytes.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_by_hand() {
        // One, two, three and four bytes; one, one, one and two units.
        let text = "aß€🍷b\r\nc\rd\n";
        for (encoding, columns) in
            [(Encoding::Utf8, [0, 1, 3, 6, 10, 11]), (Encoding::Utf16, [0, 1, 2, 3, 5, 6])]
        {
            let lines = Lines::new(text, encoding);
            for (offset, column) in [0, 1, 3, 6, 10, 11].into_iter().zip(columns) {
                assert_eq!(lines.position(offset), Position::new(0, column), "{offset}");
                assert_eq!(lines.offset(Position::new(0, column)), offset, "{column}");
            }
            for (offset, line) in [(13, 1), (15, 2), (17, 3)] {
                assert_eq!(lines.position(offset), Position::new(line, 0));
                assert_eq!(lines.offset(Position::new(line, 0)), offset);
            }
        }
    }

    #[test]
    fn places_that_are_none_are_moved_to_one() {
        let lines = Lines::new("🍷\r\nb", Encoding::Utf16);
        assert_eq!(lines.offset(Position::new(0, 1)), 0, "inside a character");
        assert_eq!(lines.offset(Position::new(0, 99)), 4, "behind a line");
        assert_eq!(lines.offset(Position::new(9, 9)), 7, "behind the text");
        assert_eq!(lines.position(2), Position::new(0, 0), "inside a character");
        assert_eq!(lines.position(99), Position::new(1, 1), "behind the text");
        assert_eq!(Lines::new("", Encoding::Utf8).offset(Position::new(0, 0)), 0);
    }
}
