//! What was measured, a line each, as soon as it is: a sweep that was stopped goes on from there.
//!
//! A line is whole if it ends; the last one may have been cut short and is then forgotten. Keys say all that a
//! measurement depends on, so that another scene, option or version is another measurement.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The name of the file in the folder of a report.
pub const NAME: &str = "measurements.tsv";

/// The first line.
const HEADER: &str = "prreport 1\n";

/// Most bytes of a journal: a measurement takes a few hundred.
const MOST_BYTES: u64 = 1 << 28;

/// One measurement: numbers by name, and what is to be said about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    numbers: BTreeMap<String, f64>,
    /// One line of text; none if empty.
    pub note: String,
}

/// Measurements by key, in memory and on disk.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    known: BTreeMap<String, Figures>,
}

/// Why measurements cannot be kept.
#[derive(Debug)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be read or written.
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another process writes it.
    Taken {
        /// The file.
        path: PathBuf,
    },
    /// It is none of ours, or damaged.
    Line {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What should be there.
        expected: &'static str,
    },
}

impl fmt::Display for JournalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, .. } => write!(f, "{}", path.display()),
            Self::Taken { path } => {
                write!(f, "{}: another prreport is at work in this folder", path.display())
            }
            Self::Line { path, line, expected } => write!(
                f,
                "{}:{line}: expected {expected}; --fresh begins a new file",
                path.display()
            ),
        }
    }
}

impl std::error::Error for JournalError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Taken { .. } | Self::Line { .. } => None,
        }
    }
}

impl Figures {
    /// With one number more. `name` is a word.
    #[must_use]
    pub fn with(mut self, name: &str, value: f64) -> Self {
        self.numbers.insert(name.to_owned(), value);
        self
    }

    /// With a text in place of the old one; it becomes one line.
    #[must_use]
    pub fn with_note(mut self, note: impl fmt::Display) -> Self {
        self.note = one_line(&note.to_string());
        self
    }

    /// A number by name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.numbers.get(name).copied()
    }

    /// A number by name; not a number where there is none.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        self.get(name).unwrap_or(f64::NAN)
    }

    /// `key <tab> name=value … <tab> note`.
    pub(crate) fn line(&self, key: &str) -> String {
        let mut line = format!("{key}\t");
        for (place, (name, value)) in self.numbers.iter().enumerate() {
            let space = if place == 0 { "" } else { " " };
            // The shortest digits that give the same number again.
            write!(line, "{space}{name}={value:?}").expect("a string");
        }
        line + "\t" + &self.note + "\n"
    }

    pub(crate) fn parse(line: &str) -> Option<(String, Self)> {
        let mut fields = line.split('\t');
        let (key, numbers, note) = (fields.next()?, fields.next()?, fields.next()?);
        if key.is_empty() || fields.next().is_some() {
            return None;
        }
        let number = |word: &str| {
            let (name, value) = word.split_once('=')?;
            Some((name.to_owned(), value.parse().ok()?))
        };
        let numbers = numbers.split(' ').filter(|word| !word.is_empty()).map(number);
        Some((key.to_owned(), Self { numbers: numbers.collect::<Option<_>>()?, note: note.into() }))
    }
}

impl Journal {
    /// Opens the journal of a folder that is there, or begins it; `fresh` forgets what it holds.
    ///
    /// # Errors
    ///
    /// [`JournalError`] if it cannot be read or written, is none of ours, or another process writes it.
    pub fn open(folder: &Path, fresh: bool) -> Result<Self, JournalError> {
        let path = folder.join(NAME);
        let error = |source| JournalError::Io { path: path.clone(), source };
        let mut options = OpenOptions::new();
        let mut file = options.read(true).append(true).create(true).open(&path).map_err(error)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => return Err(JournalError::Taken { path }),
            // Where there are no locks, nobody is kept out.
            Err(std::fs::TryLockError::Error(_)) => {}
        }
        if fresh {
            file.set_len(0).map_err(error)?;
        }
        let mut bytes = Vec::new();
        Read::by_ref(&mut file).take(MOST_BYTES).read_to_end(&mut bytes).map_err(error)?;
        // What a killed run left of its last line.
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let wrong = |line, expected| JournalError::Line { path: path.clone(), line, expected };
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| wrong(1, "text"))?;
        let mut known = BTreeMap::new();
        let mut lines = text.lines();
        let begun = match lines.next() {
            None if HEADER.as_bytes().starts_with(&bytes) => false,
            Some(first) if first == HEADER.trim_end() => true,
            _ => return Err(wrong(1, "`prreport 1`")),
        };
        for (number, line) in (2..).zip(lines) {
            let parsed = Figures::parse(line);
            let (key, figures) = parsed.ok_or_else(|| wrong(number, "a key and numbers"))?;
            known.entry(key).or_insert(figures);
        }
        if whole < bytes.len() {
            file.set_len(whole as u64).map_err(error)?;
        }
        file.seek(SeekFrom::End(0)).map_err(error)?;
        if !begun {
            file.write_all(HEADER.as_bytes()).map_err(error)?;
        }
        Ok(Self { path, file, known })
    }

    /// What is known by a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Figures> {
        self.known.get(&one_line(key))
    }

    /// Keeps a measurement; what is known already stays.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn keep(&mut self, key: &str, figures: &Figures) -> Result<(), JournalError> {
        let key = one_line(key);
        if self.known.contains_key(&key) {
            return Ok(());
        }
        let line = figures.line(&key);
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|source| JournalError::Io { path: self.path.clone(), source })?;
        self.known.insert(key, figures.clone());
        Ok(())
    }
}

/// A text without tabs and line ends.
fn one_line(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ")
}

/// FNV-1a over 64 bits (Fowler, Noll and Vo): tells contents apart, and is the same everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// With some bytes more.
    #[must_use]
    pub fn and(self, bytes: &[u8]) -> Self {
        let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        Self(bytes.iter().fold(self.0, step))
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(seconds: f64) -> Figures {
        Figures::default().with("seconds", seconds).with("error", f64::INFINITY)
    }

    #[test]
    fn measurements_come_back_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), false).unwrap();
        let noted = Figures::default().with_note("too\tlong,\nand more");
        journal.keep("a\tkey", &figures(0.1 + 0.2)).unwrap();
        journal.keep("b", &noted).unwrap();
        journal.keep("b", &figures(7.0)).unwrap();
        drop(journal);
        let journal = Journal::open(folder.path(), false).unwrap();
        assert_eq!(journal.get("a key"), Some(&figures(0.1 + 0.2)));
        assert_eq!(journal.get("b").unwrap().note, "too long, and more");
        assert_eq!(journal.get("c"), None);
        drop(journal);
        assert_eq!(Journal::open(folder.path(), true).unwrap().get("b"), None, "fresh");
    }

    #[test]
    fn wherever_a_run_is_cut_whole_lines_stay() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), false).unwrap();
        for key in ["one", "two", "three"] {
            journal.keep(key, &figures(1.0)).unwrap();
        }
        drop(journal);
        let path = folder.path().join(NAME);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..=bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut journal = Journal::open(folder.path(), false).unwrap();
            let lines = bytes[..cut].iter().filter(|&&byte| byte == b'\n').count();
            assert_eq!(journal.known.len(), lines.saturating_sub(1), "cut at {cut}");
            for key in ["one", "two", "three"] {
                journal.keep(key, &figures(1.0)).unwrap();
            }
            drop(journal);
            let mended = Journal::open(folder.path(), false).unwrap();
            assert_eq!(mended.known.len(), 3, "cut at {cut}");
        }
    }

    #[test]
    fn other_files_and_other_processes_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let refusal = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Journal::open(folder.path(), false).unwrap_err().to_string()
        };
        assert!(refusal("a,b\n1,2\n").contains(":1: expected `prreport 1`"));
        assert!(refusal("prreport 1\nk\tx=1\t\nk\tx\t\n").contains(":3: expected a key"));
        std::fs::remove_file(&path).unwrap();
        let _held = Journal::open(folder.path(), false).unwrap();
        let other = Journal::open(folder.path(), false).unwrap_err().to_string();
        assert!(other.contains("another prreport"), "{other}");
    }

    #[test]
    fn digests_are_those_of_the_definition() {
        // Test vectors of the authors.
        assert_eq!(Digest::default().to_string(), "cbf29ce484222325");
        assert_eq!(Digest::default().and(b"a").to_string(), "af63dc4c8601ec8c");
        assert_eq!(Digest::default().and(b"foo").and(b"bar").to_string(), "85944171f73967e8");
    }
}
