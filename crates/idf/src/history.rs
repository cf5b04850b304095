//! History: one line of the log for each program that touched an image.
//!
//! A line has five fields with tabs between them: time (UTC), program, version, arguments,
//! figures. The log and the renderer's statistics are the only outputs that hold times.

use std::fmt;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::error::WriteError;
use crate::file;
use crate::read::{data_path, description_path, read_description};
use crate::write::data_name;

/// What one program did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// When, in seconds since 1970.
    pub seconds: u64,
    /// Which program.
    pub program: String,
    /// Which version of it.
    pub version: String,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// Figures, as pairs of name and value: seconds, rays, error.
    pub figures: Vec<(String, String)>,
}

impl Entry {
    /// What `program` does now, with the arguments of this process.
    pub fn now(program: &str, version: &str) -> Self {
        let arguments = std::env::args_os().skip(1);
        Self {
            seconds: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs()),
            program: program.into(),
            version: version.into(),
            arguments: arguments.map(|word| word.to_string_lossy().into_owned()).collect(),
            figures: Vec::new(),
        }
    }

    /// The same with one more figure.
    #[must_use]
    pub fn with_figure(mut self, name: &str, value: impl fmt::Display) -> Self {
        self.figures.push((name.into(), value.to_string()));
        self
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { program, version, .. } = self;
        write!(f, "{}\t{}\t{}\t", time(self.seconds), Word(program), Word(version))?;
        for (position, argument) in self.arguments.iter().enumerate() {
            write!(f, "{}{}", if position > 0 { " " } else { "" }, Word(argument))?;
        }
        f.write_str("\t")?;
        for (position, (name, value)) in self.figures.iter().enumerate() {
            let gap = if position > 0 { " " } else { "" };
            write!(f, "{gap}{}={}", Word(name), Word(value))?;
        }
        Ok(())
    }
}

/// Appends one line to the log of the image at `path`, which gets a log if it has none.
///
/// # Errors
///
/// If the description cannot be read, names a log outside its folder without `outside`, or a file
/// cannot be written.
pub fn append(path: &Path, entry: &Entry, outside: bool) -> Result<(), WriteError> {
    let path = description_path(path);
    let mut description = read_description(&path).map_err(WriteError::Read)?;
    let line = format!("{entry}\n");
    let Some(log) = &description.log else {
        let name = data_name(&path, "log")?;
        file::replace(&file::folder(&path).join(&name), line.as_bytes())?;
        description.log = Some(name);
        return file::replace(&path, description.to_string().as_bytes());
    };
    let log = data_path(&path, log, outside).map_err(WriteError::Read)?;
    file::check_target(&log)?;
    let io = |source| file::io_error(&log, source);
    // One call for the whole line, so that lines of two programs do not mix.
    let mut log_file = OpenOptions::new().append(true).open(&log).map_err(io)?;
    log_file.write_all(line.as_bytes()).map_err(io)
}

/// A word between blanks, quoted where it has to be.
struct Word<'a>(&'a str);

impl fmt::Display for Word<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = |c: char| !c.is_whitespace() && !c.is_control() && !"'\"\\".contains(c);
        if !self.0.is_empty() && self.0.chars().all(plain) {
            f.write_str(self.0)
        } else {
            write!(f, "{:?}", self.0)
        }
    }
}

/// UTC in the form of ISO 8601 of seconds since 1970.
///
/// Days are counted in eras of 400 years from March on, so the leap day comes last (Hinnant,
/// "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`).
fn time(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_calendar() {
        // From `date -u -d @SECONDS`.
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_709_210_096, "2024-02-29T12:34:56Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(time(seconds), expected);
        }
    }

    #[test]
    fn an_entry_is_one_line_of_five_fields() {
        let entry = Entry {
            seconds: 0,
            program: "icopy".into(),
            version: "0.1.0".into(),
            arguments: ["a.idf", "b c.png", "", "tab\t\nline"].map(String::from).into(),
            figures: Vec::new(),
        };
        let entry = entry.with_figure("seconds", 0.5).with_figure("rays", 7);
        assert_eq!(
            entry.to_string(),
            "1970-01-01T00:00:00Z\ticopy\t0.1.0\ta.idf \"b c.png\" \"\" \"tab\\t\\nline\"\t\
             seconds=0.5 rays=7"
        );
    }
}
