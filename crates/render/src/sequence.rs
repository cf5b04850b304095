//! Sequences of pictures, and which of them are finished.
//!
//! A list beside the pictures, `x.frames` beside `x-0000.png`, has a line for each finished one: its number, its identity
//! ([`crate::identity`]), and a checksum of its files. A picture is finished if its line has the identity that it would
//! have now, and its files are as the line says: one of another scene or of other options, damaged or half written, is
//! rendered again. A line is appended when all files of a picture are in their places, so a kill loses one picture at most.

#[cfg(feature = "command")]
pub(crate) mod command;

use std::collections::BTreeMap;
use std::error::Error;
use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use idf::exchange::Format;
use idf::part::Sum;

/// Numbers of the pictures of a sequence, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last, not below the first.
    pub last: u32,
}

/// The largest number of a picture.
const MOST: u32 = 9_999_999;

/// Digits of a number in the name of a picture, at least.
const DIGITS: usize = 4;

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once("..").map(|(a, b)| (a.parse::<u32>(), b.parse::<u32>()));
        let Some((Ok(first), Ok(last))) = numbers else {
            return Err("expected the first and the last number, as 0..47".into());
        };
        if first > last || last > MOST {
            return Err(format!("expected numbers up to {MOST}, the first not above the last"));
        }
        Ok(Self { first, last })
    }
}

impl Frames {
    /// All numbers, from the first on.
    pub fn numbers(self) -> impl Iterator<Item = u32> {
        self.first..=self.last
    }

    /// The name of a picture of a sequence `output`: `x-0007.png` of `x.png`.
    #[must_use]
    pub fn name(output: &Path, number: u32) -> PathBuf {
        let mut name = output.file_stem().map_or_else(OsString::new, OsString::from);
        name.push(format!("-{number:0DIGITS$}"));
        if let Some(ending) = output.extension() {
            name.push(".");
            name.push(ending);
        }
        output.with_file_name(name)
    }
}

/// The list of the finished pictures of a sequence.
#[derive(Debug)]
pub struct Ledger {
    path: PathBuf,
    /// Identity and checksum of each finished picture, by its number.
    finished: BTreeMap<u32, (u128, u128)>,
}

/// Why a list of finished pictures cannot be used.
#[derive(Debug)]
#[non_exhaustive]
pub enum LedgerError {
    /// The system does not give or take it.
    Io {
        /// The list.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A file of another kind has its name.
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A picture cannot be read again.
    Picture {
        /// The picture.
        path: PathBuf,
        /// What the system, or the reader of its description, says.
        reason: String,
    },
}

/// How the list begins.
const HEAD: &str = "portray frames 1";

impl Ledger {
    /// The list of the sequence `output`; empty if there is none yet.
    ///
    /// # Errors
    ///
    /// If it cannot be read, or a file of another kind has its name.
    pub fn of(output: &Path) -> Result<Self, LedgerError> {
        let path = output.with_extension("frames");
        let text = match fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(source) => return Err(LedgerError::Io { path, source }),
        };
        let mut lines = text.lines();
        // A kill may have left less than the first line.
        if lines.next().is_some_and(|first| !HEAD.starts_with(first)) {
            return Err(LedgerError::Foreign { path });
        }
        // Any other line that is no entry is one that a kill left half written.
        let finished = lines.filter_map(entry).collect();
        Ok(Self { path, finished })
    }

    /// Whether the picture `number`, in the file `name`, is finished with this identity.
    #[must_use]
    pub fn has(&self, number: u32, identity: u128, name: &Path) -> bool {
        self.finished
            .get(&number)
            .is_some_and(|&(found, sum)| found == identity && content(name).is_ok_and(|s| s == sum))
    }

    /// Notes that the picture `number` is finished: it is in the file `name`.
    ///
    /// # Errors
    ///
    /// If the picture cannot be read, or the list not written.
    pub fn add(&mut self, number: u32, identity: u128, name: &Path) -> Result<(), LedgerError> {
        let sum = content(name)
            .map_err(|reason| LedgerError::Picture { path: name.to_owned(), reason })?;
        let io = |source| LedgerError::Io { path: self.path.clone(), source };
        // Not truncated: what other programs have appended meanwhile stays.
        let mut options = OpenOptions::new();
        let mut file = options.read(true).append(true).create(true).open(&self.path).map_err(io)?;
        let mut line = beginning(&mut file).map_err(io)?;
        line.push_str(&format!("{number} {identity:032x} {sum:032x}\n"));
        // One call for a whole line, so that lines of two programs do not mix.
        file.write_all(line.as_bytes()).map_err(io)?;
        self.finished.insert(number, (identity, sum));
        Ok(())
    }
}

/// What stands before the next entry: the first line where there is none yet, and the end of a line that a kill left half
/// written.
fn beginning(file: &mut File) -> io::Result<String> {
    let head = format!("{HEAD}\n");
    if file.metadata()?.len() < head.len() as u64 {
        file.set_len(0)?;
        return Ok(head);
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1))?;
    file.read_exact(&mut last)?;
    Ok(if last == *b"\n" { String::new() } else { "\n".to_owned() })
}

fn entry(line: &str) -> Option<(u32, (u128, u128))> {
    let words: Vec<&str> = line.split(' ').collect();
    let [number, identity, sum] = words.as_slice() else { return None };
    let wide = |word: &str| u128::from_str_radix(word, 16).ok().filter(|_| word.len() == 32);
    Some((number.parse().ok()?, (wide(identity)?, wide(sum)?)))
}

/// A checksum of the files of a picture; the history of an IDF image is not one of them.
fn content(name: &Path) -> Result<u128, String> {
    let mut sum = Sum::default();
    let mut add = |path: &Path| {
        let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        sum.add(&bytes);
        Ok::<(), String>(())
    };
    if Format::of(name) != Some(Format::Idf) {
        add(name)?;
        return Ok(sum.value());
    }
    let description = idf::description_path(name);
    add(&description)?;
    let text = idf::read_description(name).map_err(|error| error.to_string())?;
    for channel in &text.channels {
        add(&description.with_file_name(&channel.file))?;
    }
    Ok(sum.value())
}

impl fmt::Display for LedgerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Foreign { path } => write!(
                f,
                "{}: expected `{HEAD}`, a list of finished pictures; move this file, or give another name with -o",
                path.display()
            ),
            Self::Picture { path, reason } => {
                write!(f, "{}: cannot be read again: {reason}", path.display())
            }
        }
    }
}

impl Error for LedgerError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbers_with_both_ends() {
        let frames: Frames = "3..5".parse().unwrap();
        assert_eq!(frames.numbers().collect::<Vec<_>>(), [3, 4, 5]);
        assert_eq!("7..7".parse(), Ok(Frames { first: 7, last: 7 }));
        for text in ["", "3", "5..3", "..3", "3..", "-1..3", "0..99999999", "0..=3"] {
            assert!(text.parse::<Frames>().is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_stand_at_the_end_of_names() {
        let name = |output: &str, number| Frames::name(Path::new(output), number);
        assert_eq!(name("a/x.png", 7), Path::new("a/x-0007.png"));
        assert_eq!(name("x", 12345), Path::new("x-12345"));
        assert_eq!(name("v1.2/x.idf", 0), Path::new("v1.2/x-0000.idf"));
    }

    #[test]
    fn what_was_changed_is_not_finished() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("x.png");
        let name = Frames::name(&output, 1);
        let mut ledger = Ledger::of(&output).unwrap();
        assert!(!ledger.has(1, 5, &name), "nothing is there");
        assert!(ledger.add(1, 5, &name).is_err(), "a picture that is not there");
        fs::write(&name, "picture").unwrap();
        ledger.add(1, 5, &name).unwrap();
        for ledger in [ledger, Ledger::of(&output).unwrap()] {
            assert!(ledger.has(1, 5, &name), "as it was noted");
            assert!(!ledger.has(1, 6, &name), "of another scene");
            assert!(!ledger.has(2, 5, &name), "another number");
        }
        fs::write(&name, "picturf").unwrap();
        assert!(!Ledger::of(&output).unwrap().has(1, 5, &name), "other bytes");
    }

    #[test]
    fn lists_that_a_kill_left_half_written_are_gone_on_with() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("x.png");
        let list = folder.path().join("x.frames");
        let names = [0, 1].map(|number| Frames::name(&output, number));
        for name in &names {
            fs::write(name, "picture").unwrap();
        }
        let mut ledger = Ledger::of(&output).unwrap();
        ledger.add(0, 5, &names[0]).unwrap();
        let first = fs::read_to_string(&list).unwrap();
        ledger.add(1, 6, &names[1]).unwrap();
        let both = fs::read_to_string(&list).unwrap();
        for length in 0..both.len() {
            fs::write(&list, &both[..length]).unwrap();
            let mut ledger = Ledger::of(&output).unwrap();
            // The first entry is whole without the end of its line.
            assert_eq!(ledger.has(0, 5, &names[0]), length + 1 >= first.len(), "{length}");
            ledger.add(1, 6, &names[1]).unwrap();
            let ledger = Ledger::of(&output).unwrap();
            assert!(ledger.has(1, 6, &names[1]), "{length}");
            assert_eq!(ledger.has(0, 5, &names[0]), length + 1 >= first.len(), "{length}");
        }
        fs::write(&list, "shopping\n").unwrap();
        assert!(matches!(Ledger::of(&output), Err(LedgerError::Foreign { .. })));
    }
}
