//! The `.idf` text: parsed and printed.

mod layout;
mod near;

use std::error::Error;
use std::fmt;

use crate::image::{Matte, checked_size};
use crate::lut::Lut;
use crate::plane::{Kind, Role};
use crate::samples::Depth;
use crate::transfer::Transfer;
use layout::Layout;

/// How a data file is coded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Samples as they are, little-endian.
    Raw,
    /// Each row run-length coded; see [`crate::rle`].
    #[default]
    Rle,
}

impl Encoding {
    /// The word in the description.
    pub fn word(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Rle => "rle",
        }
    }
}

/// One line that names a data file of samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// What it holds.
    pub kind: Kind,
    /// The file, relative to the description.
    pub file: String,
    /// Width.
    pub columns: u32,
    /// Height; for a `lut` 3, or 4 with coverage.
    pub rows: u32,
    /// How a sample is stored.
    pub depth: Depth,
    /// How the file is coded.
    pub encoding: Encoding,
}

/// What an `.idf` text says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Column and row of the picture on a larger one.
    pub origin: [i32; 2],
    /// How light is stored, if it says so.
    pub transfer: Option<Transfer>,
    /// How colour and coverage go together, if it says so.
    pub matte: Option<Matte>,
    /// Display values of what to put behind.
    pub background: Option<[f64; 3]>,
    /// Data files of samples, in the order of the text.
    pub channels: Vec<Channel>,
    /// The file of the history.
    pub log: Option<String>,
    /// Lines with keys that this version does not know, and with comments alone, as they are.
    pub unknown: Vec<String>,
    layout: Layout,
}

/// What is wrong with a text, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// The line, from 1.
    pub line: usize,
    /// What is there.
    pub found: String,
    /// What should be.
    pub expected: String,
    /// What to do about it, where that is known.
    pub hint: Option<String>,
}

/// Keys that are no plane kinds, with what follows them.
const KEYS: [(&str, &str); 5] = [
    ("size", "columns and rows"),
    ("window", "column, row, columns and rows"),
    ("transfer", "`srgb`, `linear` or `gamma` and a number"),
    ("matte", "`premultiplied` or `straight`"),
    ("background", "three display values"),
];

impl Description {
    /// The line of one kind of channel.
    pub fn channel(&self, kind: Kind) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.kind == kind)
    }
}

/// Parses a description.
///
/// # Errors
///
/// The first line that is wrong.
pub fn parse(text: &str) -> Result<Description, SyntaxError> {
    let mut description = Description::default();
    // Some editors put a mark of the order of bytes there.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut window = None;
    let mut seen: Vec<(String, usize)> = Vec::new();
    let mut header = false;
    let mut last = 0;
    for (index, source) in text.lines().enumerate() {
        last = index + 1;
        let mut line = Line::split(source, last)?;
        let Some(key) = line.take() else {
            if line.comment.is_empty() {
                description.layout.push_blank();
            } else {
                description.layout.push_kept(source);
                description.unknown.push(source.to_owned());
            }
            continue;
        };
        if !header {
            line.header(&key)?;
            description.layout.push_known(&key, line.comment, source);
            header = true;
            continue;
        }
        let known = Kind::from_word(&key).is_some() || KEYS.iter().any(|row| row.0 == key);
        if !known {
            description.layout.push_kept(source);
            description.unknown.push(source.to_owned());
            continue;
        }
        description.layout.push_known(&key, line.comment, source);
        if let Some((_, first)) = seen.iter().find(|(other, _)| *other == key) {
            return Err(
                line.error(&format!("a second `{key}`"), &format!("one, and line {first} has it"))
            );
        }
        line.value(&key, &mut description, &mut window)?;
        seen.push((key, last));
    }
    let end = |expected: &str| SyntaxError {
        line: last.max(1),
        found: "the end of the text".into(),
        expected: expected.into(),
        hint: None,
    };
    if !header {
        return Err(end("`idf 1`"));
    }
    if description.size == [0, 0] {
        return Err(end("a line `size COLUMNS ROWS`"));
    }
    if let Some((line, columns, rows)) = window.filter(|&(_, c, r)| [c, r] != description.size) {
        let [width, height] = description.size;
        return Err(SyntaxError {
            line,
            found: format!("a window of {columns} x {rows}"),
            expected: format!("the picture's size, {width} x {height}"),
            hint: Some("`window` is where all of the picture lies on a larger one".into()),
        });
    }
    let mut layout = std::mem::take(&mut description.layout);
    layout.settle(&description);
    Ok(Description { layout, ..description })
}

/// The words of one line.
struct Line<'a> {
    number: usize,
    words: std::vec::IntoIter<String>,
    /// What follows from `#` on.
    comment: &'a str,
}

impl<'a> Line<'a> {
    /// Splits at blanks; a word may be in quotes, and `#` starts a comment where a word could.
    fn split(source: &'a str, number: usize) -> Result<Self, SyntaxError> {
        let mut words = Vec::new();
        let mut rest = source.trim_start();
        while !rest.is_empty() && !rest.starts_with('#') {
            let (word, after) = match rest.strip_prefix('"') {
                Some(quoted) => unquote(quoted).ok_or_else(|| SyntaxError {
                    line: number,
                    found: "the end of the line".into(),
                    expected: "a closing `\"`".into(),
                    hint: None,
                })?,
                None => {
                    let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
                    (rest[..end].to_owned(), &rest[end..])
                }
            };
            words.push(word);
            rest = after.trim_start();
        }
        Ok(Self { number, words: words.into_iter(), comment: rest })
    }

    fn take(&mut self) -> Option<String> {
        self.words.next()
    }

    fn error(&self, found: &str, expected: &str) -> SyntaxError {
        SyntaxError {
            line: self.number,
            found: found.into(),
            expected: expected.into(),
            hint: None,
        }
    }

    /// The next word, as `read` takes it.
    fn next<T>(
        &mut self,
        expected: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<T, SyntaxError> {
        let Some(word) = self.take() else {
            return Err(self.error("the end of the line", expected));
        };
        read(&word).ok_or_else(|| self.error(&format!("`{word}`"), expected))
    }

    fn end(&mut self, key: &str) -> Result<(), SyntaxError> {
        match self.take() {
            None => Ok(()),
            Some(word) => {
                Err(self.error(&format!("`{word}`"), &format!("the end of the `{key}` line")))
            }
        }
    }

    fn header(&mut self, key: &str) -> Result<(), SyntaxError> {
        if key != "idf" {
            return Err(self.error(&format!("`{key}`"), "`idf 1`"));
        }
        self.next("version 1", |word| (word == "1").then_some(()))?;
        self.end("idf")
    }

    /// Columns and rows that an image can have.
    fn size(&mut self) -> Result<[u32; 2], SyntaxError> {
        let columns = self.next("a number of columns", |word| word.parse().ok())?;
        let rows = self.next("a number of rows", |word| word.parse().ok())?;
        match checked_size(columns, rows) {
            Ok(_) => Ok([columns, rows]),
            Err(_) => Err(self.error(
                &format!("{columns} x {rows} pixels"),
                "1 to 2^31 pixels in at most 2^24 columns",
            )),
        }
    }

    /// What follows a known key.
    fn value(
        &mut self,
        key: &str,
        description: &mut Description,
        window: &mut Option<(usize, u32, u32)>,
    ) -> Result<(), SyntaxError> {
        let about = KEYS.iter().find(|row| row.0 == key).map_or("", |row| row.1);
        match key {
            "size" => description.size = self.size()?,
            "window" => {
                for offset in &mut description.origin {
                    *offset = self.next(about, |word| word.parse().ok())?;
                }
                let [columns, rows] = self.size()?;
                *window = Some((self.number, columns, rows));
            }
            "transfer" => {
                let named = self.next(about, |word| match word {
                    "srgb" => Some(Some(Transfer::Srgb)),
                    "linear" => Some(Some(Transfer::Linear)),
                    "gamma" => Some(None),
                    _ => None,
                })?;
                description.transfer = Some(match named {
                    Some(transfer) => transfer,
                    None => Transfer::Gamma(self.next("a gamma from 0.1 to 10", |word| {
                        word.parse().ok().filter(|gamma| Transfer::GAMMAS.contains(gamma))
                    })?),
                });
            }
            "matte" => {
                description.matte = Some(self.next(about, |word| match word {
                    "premultiplied" => Some(Matte::Premultiplied),
                    "straight" => Some(Matte::Straight),
                    _ => None,
                })?);
            }
            "background" => {
                let mut color = [0.0; 3];
                for value in &mut color {
                    *value = self.next(about, |w| w.parse().ok().filter(|v| f64::is_finite(*v)))?;
                }
                description.background = Some(color);
            }
            _ => self.channel(key, description)?,
        }
        self.end(key)
    }

    fn channel(&mut self, key: &str, description: &mut Description) -> Result<(), SyntaxError> {
        let Some(kind) = Kind::from_word(key) else { return Ok(()) };
        let file = self.next("a file name", |w| (!w.is_empty()).then(|| w.to_owned()))?;
        if kind.role() == Role::Text {
            description.log = Some(file);
            return Ok(());
        }
        let [columns, rows] = self.size()?;
        let depth = self.next("a depth of 8, 16 or 32f", Depth::from_word)?;
        let encoding = self.next("`raw` or `rle`", |word| {
            [Encoding::Raw, Encoding::Rle].into_iter().find(|encoding| encoding.word() == word)
        })?;
        if kind.role() == Role::Table && (!(3..=4).contains(&rows) || columns as usize > Lut::MOST)
        {
            return Err(self.error(
                &format!("a table of {columns} x {rows}"),
                "1 to 256 columns of colours and 3 rows: red, green, blue; or 4 with coverage",
            ));
        }
        if matches!(kind.role(), Role::Table | Role::Index) && depth != Depth::U8 {
            return Err(self.error(&format!("a depth of {}", depth.word()), "a depth of 8"));
        }
        description.channels.push(Channel { kind, file, columns, rows, depth, encoding });
        Ok(())
    }
}

/// The word up to the closing quote, and what follows. A backslash keeps the next character.
fn unquote(quoted: &str) -> Option<(String, &str)> {
    let mut word = String::new();
    let mut characters = quoted.char_indices();
    while let Some((at, character)) = characters.next() {
        match character {
            '"' => return Some((word, &quoted[at + 1..])),
            '\\' => word.push(characters.next()?.1),
            other => word.push(other),
        }
    }
    None
}

/// A file name as a word of the description, in quotes where it must be.
struct Name<'a>(&'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.contains(char::is_whitespace) && !self.0.starts_with(['"', '#']) {
            return f.write_str(self.0);
        }
        write!(f, "\"{}\"", self.0.replace('\\', "\\\\").replace('"', "\\\""))
    }
}

impl Description {
    /// Key and line of all that has a known key, in the usual order.
    fn known_lines(&self) -> Vec<(&'static str, String)> {
        let [columns, rows] = self.size;
        let [column, row] = self.origin;
        let mut lines = vec![("idf", "idf 1".into()), ("size", format!("size {columns} {rows}"))];
        if self.origin != [0, 0] {
            lines.push(("window", format!("window {column} {row} {columns} {rows}")));
        }
        if let Some(transfer) = self.transfer {
            lines.push(("transfer", format!("transfer {transfer}")));
        }
        match self.matte {
            None => {}
            Some(Matte::Premultiplied) => lines.push(("matte", "matte premultiplied".into())),
            Some(Matte::Straight) => lines.push(("matte", "matte straight".into())),
        }
        if let Some([red, green, blue]) = self.background {
            lines.push(("background", format!("background {red} {green} {blue}")));
        }
        for Channel { kind, file, columns, rows, depth, encoding } in &self.channels {
            let (file, depth, encoding) = (Name(file), depth.word(), encoding.word());
            let line = format!("{kind} {file} {columns} {rows} {depth} {encoding}");
            lines.push((kind.word(), line));
        }
        if let Some(log) = &self.log {
            lines.push((Kind::Log.word(), format!("{} {}", Kind::Log, Name(log))));
        }
        lines
    }
}

/// The text. What was parsed and not changed is as it was written.
impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.layout.print(self, f)
    }
}

impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, found {}", self.expected, self.found)?;
        self.hint.as_ref().map_or(Ok(()), |hint| write!(f, "; {hint}"))
    }
}

impl Error for SyntaxError {}

#[cfg(test)]
mod tests {
    use super::*;

    const STATION: &str = "# a station
idf 1
size      4 2            # columns rows
window    -1 7 4 2
transfer  gamma 2.2
matte     straight
background 0.8 0.5 1e-3
red  station.red  4 2 8 rle
cvg  \"a \\\"b\\\" \\\\ c.cvg\"  4 2 32f raw # quoted
lut  ../other.lut  256 3 8 raw
camera 35 mm   # kept
log  station.log
";

    fn station() -> Description {
        let channel = |kind, file: &str, columns, rows, depth, encoding| Channel {
            kind,
            file: file.into(),
            columns,
            rows,
            depth,
            encoding,
        };
        Description {
            size: [4, 2],
            origin: [-1, 7],
            transfer: Some(Transfer::Gamma(2.2)),
            matte: Some(Matte::Straight),
            background: Some([0.8, 0.5, 0.001]),
            channels: vec![
                channel(Kind::Red, "station.red", 4, 2, Depth::U8, Encoding::Rle),
                channel(Kind::Cvg, "a \"b\" \\ c.cvg", 4, 2, Depth::F32, Encoding::Raw),
                channel(Kind::Lut, "../other.lut", 256, 3, Depth::U8, Encoding::Raw),
            ],
            log: Some("station.log".into()),
            unknown: vec!["# a station".into(), "camera 35 mm   # kept".into()],
            layout: Layout::default(),
        }
    }

    #[test]
    fn a_text_is_read() {
        assert_eq!(parse(STATION), Ok(station()));
    }

    #[test]
    fn what_is_printed_reads_the_same() {
        let printed = station().to_string();
        assert_eq!(parse(&printed), Ok(station()));
        assert!(printed.contains("\ncamera 35 mm   # kept\n"), "{printed}");
        assert!(printed.contains("\ncvg \"a \\\"b\\\" \\\\ c.cvg\" 4 2 32f raw\n"), "{printed}");
    }

    #[test]
    fn odd_names_come_back() {
        for name in ["a", "#a", "a#", "\"", "\\", "a\\b", "tab\tbed", "ü \u{a0}ö", "a\"b"] {
            let log = Some(name.to_owned());
            let description = Description { size: [1, 1], log, ..Description::default() };
            assert_eq!(parse(&description.to_string()), Ok(description), "{name}");
        }
    }

    #[test]
    fn errors_name_the_line_what_is_there_and_what_should_be() {
        let cases = [
            ("", "1: expected `idf 1`, found the end of the text"),
            ("P5 3", "1: expected `idf 1`, found `P5`"),
            ("idf 2", "1: expected version 1, found `2`"),
            ("idf 1\n", "1: expected a line `size COLUMNS ROWS`, found the end of the text"),
            ("idf 1\nsize 4", "2: expected a number of rows, found the end of the line"),
            ("idf 1\nsize 4 -2", "2: expected a number of rows, found `-2`"),
            (
                "idf 1\nsize 0 2",
                "2: expected 1 to 2^31 pixels in at most 2^24 columns, found 0 x 2 pixels",
            ),
            (
                "idf 1\nsize 65536 65536",
                "2: expected 1 to 2^31 pixels in at most 2^24 columns, found 65536 x 65536 pixels",
            ),
            ("idf 1\nsize 4 2 1", "2: expected the end of the `size` line, found `1`"),
            (
                "idf 1\nsize 4 2\nsize 4 2",
                "3: expected one, and line 2 has it, found a second `size`",
            ),
            (
                "idf 1\nsize 4 2\nwindow 0 0 5 2",
                "3: expected the picture's size, 4 x 2, found a window of 5 x 2; `window` is where \
                 all of the picture lies on a larger one",
            ),
            ("idf 1\ntransfer gamma 0", "2: expected a gamma from 0.1 to 10, found `0`"),
            ("idf 1\ntransfer gamma nan", "2: expected a gamma from 0.1 to 10, found `nan`"),
            ("idf 1\nbackground 1 inf 1", "2: expected three display values, found `inf`"),
            ("idf 1\nred \"r", "2: expected a closing `\"`, found the end of the line"),
            ("idf 1\nred \"\" 1 1 8 raw", "2: expected a file name, found ``"),
            ("idf 1\nred r 1 1 9 raw", "2: expected a depth of 8, 16 or 32f, found `9`"),
            ("idf 1\nred r 1 1 8 zip", "2: expected `raw` or `rle`, found `zip`"),
            ("idf 1\nenc e 1 1 16 raw", "2: expected a depth of 8, found a depth of 16"),
            (
                "idf 1\nlut l 257 3 8 raw",
                "2: expected 1 to 256 columns of colours and 3 rows: red, green, blue; or 4 with \
                 coverage, found a table of 257 x 3",
            ),
        ];
        for (text, message) in cases {
            let error = parse(text).unwrap_err();
            assert_eq!(format!("{}: {error}", error.line), message, "{text}");
        }
    }
}
