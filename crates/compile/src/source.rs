//! Source files, byte spans over all of them, and the lines and columns they stand for.

use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Sources together are at most this long, in bytes; a file counts each time it is included.
pub const SOURCE_LIMIT: u64 = 256 << 20;

/// Files are included at most this often: included twice each, a few would make any number.
pub const INCLUSION_LIMIT: usize = 100_000;

/// Bytes `start..end` of the sources, all files laid end to end in the order they were read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The least span that holds both.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A place as a reader counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Location<'a> {
    /// The file.
    pub path: &'a Path,
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
}

/// Why a source cannot be had.
#[derive(Debug)]
#[non_exhaustive]
pub enum SourceError {
    /// It cannot be opened or read.
    Unreadable {
        /// As it was asked for.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// It is a folder or a device.
    NotAFile(PathBuf),
    /// All sources together pass [`SOURCE_LIMIT`].
    TooLong(PathBuf),
    /// Files are included more often than [`INCLUSION_LIMIT`].
    TooMany(PathBuf),
}

impl std::fmt::Display for SourceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unreadable { path, source } => {
                write!(f, "cannot read `{}`: {source}", shown(path))
            }
            Self::NotAFile(path) => write!(f, "cannot read `{}`: expected a file", shown(path)),
            Self::TooLong(path) => write!(
                f,
                "cannot read `{}`: the sources are longer than {} MiB",
                shown(path),
                SOURCE_LIMIT >> 20
            ),
            Self::TooMany(path) => write!(
                f,
                "cannot read `{}`: there are more than {INCLUSION_LIMIT} inclusions",
                shown(path)
            ),
        }
    }
}

impl std::error::Error for SourceError {}

/// A path as a message shows it: the ends of one that is longer than any file's.
pub(crate) fn shown(path: &Path) -> String {
    const ENDS: usize = 100;
    let text = path.display().to_string();
    let mut places = text.char_indices().map(|(place, _)| place);
    let (Some(head), Some(tail)) = (places.nth(ENDS), places.nth_back(ENDS - 1)) else {
        return text;
    };
    format!("{}…{}", &text[..head], &text[tail..])
}

/// Index of a file in its map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct FileId(usize);

/// The files of one scene. The first is the main one, the others are included.
#[derive(Debug, Default)]
pub struct SourceMap {
    files: Vec<File>,
    by_identity: HashMap<PathBuf, FileId>,
    /// Texts that stand in for files.
    unsaved: HashMap<PathBuf, Arc<str>>,
    length: u64,
}

/// The text of a file.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    /// Where the file is not UTF-8, marks stand for its bytes.
    pub(crate) text: Arc<str>,
    /// The first byte that is not UTF-8, and its offset.
    pub(crate) bad: Option<(usize, u8)>,
}

#[derive(Debug)]
struct File {
    path: PathBuf,
    /// The first with the same text: a file stands here as often as it is included.
    first: FileId,
    base: u32,
    text: Text,
    marks: OnceLock<Vec<Mark>>,
}

/// What is known at every [`STRIDE`]th byte, so that a place is found without reading a file, or a line, from its
/// beginning.
#[derive(Clone, Copy, Debug)]
struct Mark {
    line: u32,
    line_start: u32,
    column: u32,
}

const STRIDE: usize = 4096;

impl SourceMap {
    /// A map whose main file is read from `path`.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or is too long.
    pub fn from_path(path: &Path) -> Result<Self, SourceError> {
        let mut sources = Self::default();
        let file = std::fs::File::open(path)
            .map_err(|source| SourceError::Unreadable { path: path.to_owned(), source })?;
        sources.read(path, identity(path), file)?;
        Ok(sources)
    }

    /// A map whose main file is read from `input` and called `path`; what it includes is looked for beside `path`.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or is too long.
    pub fn from_reader(path: &Path, input: impl Read) -> Result<Self, SourceError> {
        let mut sources = Self::default();
        sources.read(path, path.to_owned(), input)?;
        Ok(sources)
    }

    /// Has `text` stand for the file at `path` wherever it is included from now on, as an editor has it before it is
    /// saved.
    pub fn set_unsaved(&mut self, path: &Path, text: impl Into<Arc<str>>) {
        self.unsaved.insert(identity(path), text.into());
    }

    /// The file that `span` is in: its path, its text, and the bytes of `span` in that.
    #[must_use]
    pub fn within(&self, span: Span) -> Option<(&Path, &str, std::ops::Range<usize>)> {
        let file = self.file(span)?;
        let length = file.text.text.len();
        let offset = |at: u32| (at.saturating_sub(file.base) as usize).min(length);
        Some((&file.path, &file.text.text, offset(span.start)..offset(span.end)))
    }

    /// The files read, the main one first, in the order of their first mention.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let files = self.files.iter().enumerate();
        files.filter(|(i, file)| file.first.0 == *i).map(|(_, file)| file.path.as_path())
    }

    /// Where the first byte of `span` is.
    #[must_use]
    pub fn locate(&self, span: Span) -> Option<Location<'_>> {
        let file = self.file(span)?;
        let (line, _, column) = file.place((span.start - file.base) as usize);
        Some(Location { path: &file.path, line, column })
    }

    /// Where the byte after `span` is.
    #[must_use]
    pub fn locate_end(&self, span: Span) -> Option<Location<'_>> {
        let file = self.file(span)?;
        let (line, _, column) = file.place((span.end - file.base) as usize);
        Some(Location { path: &file.path, line, column })
    }

    /// The word in quotes at a line and column of a file, with its quotes; only its first character where there is none.
    #[must_use]
    pub fn quoted_at(&self, path: &Path, line: u32, column: u32) -> Option<Span> {
        let file = self.files.iter().find(|file| file.path == path)?;
        let text = file.text.text.as_ref();
        let above: usize =
            text.split_inclusive('\n').take(line.checked_sub(1)? as usize).map(str::len).sum();
        let row = text.get(above..)?;
        let (before, first) = row.char_indices().nth(column.checked_sub(1)? as usize)?;
        let inner = row[before..].strip_prefix('"').and_then(|rest| rest.find('"'));
        let length = inner.map_or(first.len_utf8(), |inner| inner + 2);
        let offset = |at: usize| Some(file.base + u32::try_from(at).ok()?);
        Some(Span { start: offset(above + before)?, end: offset(above + before + length)? })
    }

    /// The text of the file around `span`, as bytes, with the offsets of its line and of `span` in it.
    pub(crate) fn surroundings(
        &self,
        span: Span,
    ) -> Option<(&[u8], usize, std::ops::Range<usize>)> {
        let file = self.file(span)?;
        let (start, end) = (span.start - file.base, span.end - file.base);
        let (_, line_start, _) = file.place(start as usize);
        Some((file.text.text.as_bytes(), line_start as usize, start as usize..end as usize))
    }

    pub(crate) fn main(&self) -> Option<FileId> {
        (!self.files.is_empty()).then_some(FileId(0))
    }

    pub(crate) fn path(&self, id: FileId) -> &Path {
        &self.files[id.0].path
    }

    /// The first mention of the same file.
    pub(crate) fn first(&self, id: FileId) -> FileId {
        self.files[id.0].first
    }

    pub(crate) fn text(&self, id: FileId) -> (Text, u32) {
        (self.files[id.0].text.clone(), self.files[id.0].base)
    }

    /// Reads the file that `name` means in the file `from`. A file already read is not read again.
    pub(crate) fn include(&mut self, name: &str, from: FileId) -> Result<FileId, SourceError> {
        let path = match self.path(from).parent() {
            Some(folder) => folder.join(name),
            None => PathBuf::from(name),
        };
        if self.files.len() > INCLUSION_LIMIT {
            return Err(SourceError::TooMany(path));
        }
        if let Some(text) = self.unsaved.get(&identity(&path)) {
            let text = Text { text: Arc::clone(text), bad: None };
            return self.push(&path, identity(&path), text);
        }
        let unreadable = |source| SourceError::Unreadable { path: path.clone(), source };
        // A device or a pipe could keep the compiler waiting for ever.
        if !std::fs::metadata(&path).map_err(unreadable)?.is_file() {
            return Err(SourceError::NotAFile(path));
        }
        let identity = identity(&path);
        if let Some(known) = self.by_identity.get(&identity) {
            let text = self.files[known.0].text.clone();
            return self.push(&path, identity, text);
        }
        let file = std::fs::File::open(&path).map_err(unreadable)?;
        self.read(&path, identity, file)
    }

    fn read(
        &mut self,
        path: &Path,
        identity: PathBuf,
        input: impl Read,
    ) -> Result<FileId, SourceError> {
        let mut bytes = Vec::new();
        input
            .take(SOURCE_LIMIT + 1)
            .read_to_end(&mut bytes)
            .map_err(|source| SourceError::Unreadable { path: path.to_owned(), source })?;
        self.push(path, identity, Text::new(bytes))
    }

    fn push(&mut self, path: &Path, identity: PathBuf, text: Text) -> Result<FileId, SourceError> {
        // One byte between files keeps the end of one apart from the start of the next.
        let base = self.length + self.files.len() as u64;
        self.length += text.text.len() as u64;
        let base = match u32::try_from(base) {
            Ok(base) if self.length <= SOURCE_LIMIT => base,
            _ => return Err(SourceError::TooLong(path.to_owned())),
        };
        let path = path.to_owned();
        let id = FileId(self.files.len());
        let first = *self.by_identity.entry(identity).or_insert(id);
        self.files.push(File { path, first, base, text, marks: OnceLock::new() });
        Ok(id)
    }

    fn file(&self, span: Span) -> Option<&File> {
        let after = self.files.partition_point(|file| file.base <= span.start);
        self.files[..after].last()
    }
}

fn identity(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

impl Mark {
    const START: Self = Self { line: 1, line_start: 0, column: 1 };

    fn advanced(mut self, from: usize, bytes: &[u8]) -> Self {
        for (i, &byte) in (from..).zip(bytes) {
            if byte == b'\n' {
                let line_start = u32::try_from(i + 1).expect("sources are shorter than 2³² bytes");
                self = Self { line: self.line + 1, line_start, column: 1 };
            } else if byte & 0xc0 != 0x80 {
                self.column += 1;
            }
        }
        self
    }
}

impl Text {
    fn new(bytes: Vec<u8>) -> Self {
        match String::from_utf8(bytes) {
            Ok(text) => Self { text: text.into(), bad: None },
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let bad = Some((at, error.as_bytes()[at]));
                Self { text: String::from_utf8_lossy(error.as_bytes()).into(), bad }
            }
        }
    }
}

impl File {
    /// Line, start of the line, and column of a byte.
    fn place(&self, offset: usize) -> (u32, u32, u32) {
        let bytes = self.text.text.as_bytes();
        let offset = offset.min(bytes.len());
        let marks = self.marks.get_or_init(|| {
            let mut marks = vec![Mark::START];
            for (i, chunk) in bytes.chunks_exact(STRIDE).enumerate() {
                marks.push(marks[i].advanced(i * STRIDE, chunk));
            }
            marks
        });
        let from = offset / STRIDE * STRIDE;
        let mark = marks[offset / STRIDE].advanced(from, &bytes[from..offset]);
        (mark.line, mark.line_start, mark.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(text: &str) -> SourceMap {
        SourceMap::from_reader(Path::new("test.sdl"), text.as_bytes()).unwrap()
    }

    fn place(sources: &SourceMap, start: usize) -> (u32, u32) {
        let start = u32::try_from(start).unwrap();
        let location = sources.locate(Span { start, end: start }).unwrap();
        (location.line, location.column)
    }

    #[test]
    fn columns_count_characters() {
        let sources = map("ä b\n  c\r\nd");
        assert_eq!(place(&sources, 0), (1, 1), "first");
        assert_eq!(place(&sources, 3), (1, 3), "after a character of two bytes");
        assert_eq!(place(&sources, 7), (2, 3), "second line");
        assert_eq!(place(&sources, 10), (3, 1), "after CR LF");
        assert_eq!(place(&sources, 11), (3, 2), "end of file");
    }

    #[test]
    fn places_are_right_across_strides() {
        let text = "é\n".repeat(3000) + &"ü".repeat(3000);
        let sources = map(&text);
        assert_eq!(place(&sources, 3 * 2000), (2001, 1), "within the lines");
        assert_eq!(place(&sources, 9000 + 2 * 2500), (3001, 2501), "within the long line");
        assert_eq!(place(&sources, text.len()), (3001, 3001), "at the end");
    }

    #[test]
    fn too_long_is_a_named_error() {
        let endless = std::io::repeat(b' ');
        let error = SourceMap::from_reader(Path::new("-"), endless).unwrap_err();
        assert_eq!(error.to_string(), "cannot read `-`: the sources are longer than 256 MiB");
    }
}
