//! The terminal: found, asked, and put back as it was.

use std::fs::{File, OpenOptions};
use std::io::{self, IsTerminal, Read, Write};
use std::os::unix::ffi::OsStringExt as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::io::ioctl_fionread;
use rustix::process::getpgrp;
use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcgetpgrp, tcgetwinsize,
    tcsetattr, ttyname,
};

use crate::answers::{Answers, QUESTIONS};
use crate::signals::Signals;

/// How long a terminal may take for its answers; a far one takes some tenths of a second.
const PATIENCE: Duration = Duration::from_secs(2);

/// The terminal that standard output is.
#[derive(Debug)]
pub(crate) struct Terminal {
    file: File,
}

/// A terminal whose input comes byte by byte and is not echoed, until this is dropped.
struct Quiet<'a> {
    file: &'a File,
    before: Termios,
    /// What is not read yet is answers, and is thrown away.
    discard: bool,
}

impl Terminal {
    /// The terminal of standard output, or nothing where that is none.
    ///
    /// # Errors
    ///
    /// If it cannot be opened.
    pub(crate) fn of_output() -> io::Result<Option<Self>> {
        if !io::stdout().is_terminal() {
            return Ok(None);
        }
        // Standard input may be a file, and standard output open for writing only.
        let name = ttyname(io::stdout(), Vec::new())?;
        let path = PathBuf::from(std::ffi::OsString::from_vec(name.into_bytes()));
        let flags = i32::try_from(OFlags::NOCTTY.bits()).map_err(io::Error::other)?;
        let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)?;
        Ok(Some(Self { file }))
    }

    /// Columns and rows of characters, and the size of the text in pixels, where it is known.
    pub(crate) fn size(&self) -> ([u32; 2], Option<[u32; 2]>) {
        let Ok(size) = tcgetwinsize(&self.file) else { return ([80, 24], None) };
        let or_usual = |found: u16, usual: u32| if found > 0 { found.into() } else { usual };
        let pixels = [size.ws_xpixel, size.ws_ypixel].map(u32::from);
        let cells = [or_usual(size.ws_col, 80), or_usual(size.ws_row, 24)];
        (cells, Some(pixels).filter(|pixels| pixels.iter().all(|&length| length > 0)))
    }

    /// Asks the terminal what it has. Nothing of the answers is left on its input, and its modes
    /// are as before, also where it does not answer in time or a signal came. What is typed after
    /// the last answer is left for whoever reads next.
    ///
    /// A program in the background does not ask: its terminal would stop it. Nor does one before
    /// whose answers keys would come that were typed already: they would be lost.
    ///
    /// # Errors
    ///
    /// If the terminal cannot be read or written.
    pub(crate) fn ask(&self, signals: &Signals) -> io::Result<Answers> {
        if tcgetpgrp(&self.file).is_ok_and(|front| front != getpgrp()) {
            return Ok(Answers::default());
        }
        let mut quiet = Quiet::new(&self.file)?;
        if ioctl_fionread(&self.file)? > 0 {
            quiet.discard = false;
            return Ok(Answers { were_keys_typed: true, ..Answers::default() });
        }
        (&self.file).write_all(QUESTIONS.as_bytes())?;
        let (start, mut bytes) = (Instant::now(), Vec::new());
        let mut answers = Answers::default();
        while !answers.is_complete && !signals.came() {
            let left = PATIENCE.saturating_sub(start.elapsed());
            match self.wait(left) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Ok(true) if !left.is_zero() => {}
                Ok(_) => break,
                Err(error) => return Err(error),
            }
            // One after the other: what comes after the last answer is not ours.
            let mut byte = [0];
            match (&self.file).read(&mut byte) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                // The terminal is gone.
                Ok(0) => break,
                other => other?,
            };
            bytes.push(byte[0]);
            if byte[0] == Answers::LAST {
                answers = Answers::parse(&bytes);
            }
        }
        quiet.discard = !answers.is_complete;
        Ok(answers)
    }

    /// Whether there is input within a time; a signal is an error of its own.
    fn wait(&self, time: Duration) -> io::Result<bool> {
        let time = Timespec::try_from(time).map_err(io::Error::other)?;
        let mut wait = [PollFd::new(&self.file, PollFlags::IN)];
        Ok(poll(&mut wait, Some(&time))? > 0)
    }
}

impl<'a> Quiet<'a> {
    fn new(file: &'a File) -> io::Result<Self> {
        let before = tcgetattr(file)?;
        let mut modes = before.clone();
        // Signals stay: they are held, and end the wait. Suspending would leave the modes.
        modes.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO);
        modes.special_codes[SpecialCodeIndex::VSUSP] = 0;
        modes.special_codes[SpecialCodeIndex::VMIN] = 1;
        modes.special_codes[SpecialCodeIndex::VTIME] = 0;
        tcsetattr(file, OptionalActions::Drain, &modes)?;
        Ok(Self { file, before, discard: true })
    }
}

impl Drop for Quiet<'_> {
    fn drop(&mut self) {
        let action = if self.discard { OptionalActions::Flush } else { OptionalActions::Drain };
        // A terminal that is gone has no modes.
        tcsetattr(self.file, action, &self.before).ok();
    }
}
