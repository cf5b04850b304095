//! Job arrays of a Slurm cluster.
//!
//! The queue is asked which units are waited for or worked at; a unit that is not is one to look at on disk. Nothing else
//! that the queue says is believed: a controller that is killed may lose jobs, and a task may be counted as completed whose
//! worker was killed.

use std::collections::BTreeSet;
use std::error::Error;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use super::{Engine, Message, Stopped, ranges};
use crate::folder::Folder;

/// Numbers of an array: below the largest that a cluster allows where nothing else is set, 1001.
const ARRAY: usize = 1000;
/// How often the queue is asked.
const POLL: Duration = Duration::from_secs(1);
/// For how long a controller may be away.
const PATIENCE: Duration = Duration::from_secs(300);
/// What programs of Slurm say where the controller is away, but may come back.
const AWAY: [&str; 6] = [
    "Unable to contact",
    "Connection refused",
    "Connection reset",
    "timed out",
    "Zero Bytes",
    "temporarily",
];

/// An array that was submitted: numbers of units in it begin at `base`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Array {
    id: u64,
    base: usize,
}

/// A queue.
#[derive(Debug)]
pub(crate) struct Slurm {
    folder: Folder,
    program: PathBuf,
    options: Vec<String>,
    threads: usize,
    arrays: Vec<Array>,
    /// Units that nobody was asked for yet, as the controller is away.
    waiting: BTreeSet<usize>,
    /// Units that were asked for.
    asked: BTreeSet<usize>,
    most: usize,
    /// When the controller was there last.
    heard: Instant,
    receiver: Receiver<Message>,
}

impl Slurm {
    /// A queue that may still hold jobs of an earlier driver of the same command.
    pub(crate) fn new(
        folder: Folder,
        options: &[String],
        threads: usize,
        receiver: Receiver<Message>,
    ) -> std::io::Result<Self> {
        let text = fs::read_to_string(folder.submitted()).unwrap_or_default();
        Ok(Self {
            folder,
            program: std::env::current_exe()?,
            options: options.to_vec(),
            threads,
            arrays: text.lines().filter_map(Array::parsed).collect(),
            waiting: BTreeSet::new(),
            asked: BTreeSet::new(),
            most: 0,
            heard: Instant::now(),
            receiver,
        })
    }

    /// Ends the jobs of an earlier driver of another command.
    pub(crate) fn forget(folder: &Folder) {
        let text = fs::read_to_string(folder.submitted()).unwrap_or_default();
        let arrays: Vec<Array> = text.lines().filter_map(Array::parsed).collect();
        cancel(&arrays);
        fs::remove_file(folder.submitted()).ok();
    }

    /// Submits the units of one array.
    fn submit_array(&mut self, base: usize, units: &[usize]) -> Result<(), Unanswered> {
        let numbers: Vec<usize> = units.iter().map(|unit| unit - base).collect();
        let mut command = Command::new("sbatch");
        command
            .args(["--parsable", "--job-name=prfarm", "--output=/dev/null", "--error=/dev/null"])
            .arg(format!("--array={}", ranges(&numbers)))
            .arg(format!("--cpus-per-task={}", self.threads))
            .args(&self.options);
        let script = script(&self.program, &self.folder.path, base);
        let output = answered(command, &script)?;
        let text = String::from_utf8_lossy(&output);
        // `ID` or `ID;CLUSTER`.
        let id = text.trim().split(';').next().and_then(|id| id.parse().ok());
        let Some(id) = id else {
            return Err(Unanswered::Refused(format!(
                "sbatch: expected a job number, found {text}"
            )));
        };
        let array = Array { id, base };
        self.arrays.push(array);
        self.asked.extend(units);
        let lines: Vec<String> = self.arrays.iter().map(Array::line).collect();
        // Without the list the next driver has parts rendered twice, which does no harm.
        idf::command::write_text(&self.folder.submitted(), &(lines.join("\n") + "\n")).ok();
        Ok(())
    }

    /// Submits what waits; while the controller is away, it goes on waiting.
    fn flush(&mut self) -> Result<(), Box<dyn Error>> {
        let bases: BTreeSet<usize> = self.waiting.iter().map(|unit| unit / ARRAY * ARRAY).collect();
        for base in bases {
            let units: Vec<usize> = self.waiting.range(base..base + ARRAY).copied().collect();
            match self.submit_array(base, &units) {
                Ok(()) => {
                    self.heard = Instant::now();
                    self.waiting.retain(|unit| !units.contains(unit));
                }
                Err(error) => return self.bear(error),
            }
        }
        Ok(())
    }

    /// Units that the queue knows.
    fn active(&mut self) -> Result<BTreeSet<usize>, Unanswered> {
        let mut command = Command::new("squeue");
        command.args(["--noheader", "--array", "--me", "--format=%i %t"]);
        let output = answered(command, "")?;
        let text = String::from_utf8_lossy(&output).into_owned();
        self.heard = Instant::now();
        let mut active = BTreeSet::new();
        let mut running = 0;
        for (array, index, state) in text.lines().filter_map(task) {
            if let Some(array) = self.arrays.iter().find(|known| known.id == array) {
                active.insert(array.base + index);
                running += usize::from(state == "R");
            }
        }
        self.most = self.most.max(running);
        Ok(active)
    }

    /// Waits for a controller that is away, but not for ever.
    fn bear(&self, error: Unanswered) -> Result<(), Box<dyn Error>> {
        match error {
            Unanswered::Refused(message) => Err(message.into()),
            Unanswered::Away(message) if self.heard.elapsed() > PATIENCE => {
                let minutes = PATIENCE.as_secs() / 60;
                Err(format!("the controller has been away for {minutes} minutes: {message}").into())
            }
            Unanswered::Away(_) => Ok(()),
        }
    }
}

impl Engine for Slurm {
    fn submit(&mut self, units: &[usize]) -> Result<(), Box<dyn Error>> {
        let active = match self.active() {
            Ok(active) => active,
            Err(error) => {
                self.bear(error)?;
                BTreeSet::new()
            }
        };
        // Of an earlier driver: they are worked at already.
        let (known, new): (Vec<usize>, Vec<usize>) =
            units.iter().partition(|unit| active.contains(unit));
        self.asked.extend(known);
        self.waiting.extend(new);
        self.flush()
    }

    fn ended(&mut self) -> Result<Vec<usize>, Box<dyn Error>> {
        loop {
            match self.receiver.recv_timeout(POLL) {
                Ok(Message::Stop) => return Err(Stopped.into()),
                Ok(Message::Ended(..)) | Err(RecvTimeoutError::Timeout) => {}
                Err(error @ RecvTimeoutError::Disconnected) => return Err(error.into()),
            }
            self.flush()?;
            let active = match self.active() {
                Ok(active) => active,
                Err(error) => {
                    self.bear(error)?;
                    continue;
                }
            };
            let ended: Vec<usize> = self.asked.difference(&active).copied().collect();
            if !ended.is_empty() {
                self.asked.retain(|unit| active.contains(unit));
                return Ok(ended);
            }
        }
    }

    fn stop(&mut self) {
        cancel(&self.arrays);
        fs::remove_file(self.folder.submitted()).ok();
    }

    fn workers(&self) -> usize {
        self.most
    }
}

impl Array {
    fn parsed(line: &str) -> Option<Self> {
        let (id, base) = line.split_once(' ')?;
        Some(Self { id: id.parse().ok()?, base: base.parse().ok()? })
    }

    fn line(&self) -> String {
        format!("{} {}", self.id, self.base)
    }
}

/// Why there is no answer of a program of Slurm.
enum Unanswered {
    /// The controller is away, and may come back.
    Away(String),
    /// It will not be otherwise the next time.
    Refused(String),
}

/// What a program of Slurm answers to `input`.
fn answered(mut command: Command, input: &str) -> Result<Vec<u8>, Unanswered> {
    let program = command.get_program().to_string_lossy().into_owned();
    let cannot = |error: std::io::Error| {
        Unanswered::Refused(format!("cannot run {program}: {error}; is Slurm installed here?"))
    };
    let piped = || Stdio::piped();
    let mut child =
        command.stdin(piped()).stdout(piped()).stderr(piped()).spawn().map_err(cannot)?;
    if let Some(mut stdin) = child.stdin.take() {
        // A program that refuses its options does not read.
        stdin.write_all(input.as_bytes()).ok();
    }
    let Output { status, stdout, stderr } = child.wait_with_output().map_err(cannot)?;
    if status.success() {
        return Ok(stdout);
    }
    let said = String::from_utf8_lossy(&stderr).trim().replace('\n', "; ");
    let message = format!("{program}: {said}");
    if AWAY.iter().any(|word| said.contains(word)) {
        Err(Unanswered::Away(message))
    } else {
        Err(Unanswered::Refused(message))
    }
}

fn cancel(arrays: &[Array]) {
    if arrays.is_empty() {
        return;
    }
    let ids = arrays.iter().map(|array| array.id.to_string());
    // Jobs that have ended are no longer known; others end with their time.
    Command::new("scancel").args(ids).stdout(Stdio::null()).stderr(Stdio::null()).status().ok();
}

/// What each task of an array runs. The worker takes the place of the shell: a killed child of a shell would count as
/// completed.
fn script(program: &Path, folder: &Path, base: usize) -> String {
    let (program, folder) = (quoted(program), quoted(folder));
    format!(
        "#!/bin/sh\nunit=$(({base} + SLURM_ARRAY_TASK_ID))\nexec {program} part {folder} \"$unit\" 2>{folder}/\"$unit\".err\n"
    )
}

/// A path as one word of a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', r"'\''"))
}

/// Array, index and state of a line as `12_3 R`.
fn task(line: &str) -> Option<(u64, usize, &str)> {
    let (id, state) = line.trim().split_once(' ')?;
    let (array, index) = id.split_once('_')?;
    Some((array.parse().ok()?, index.parse().ok()?, state.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_queue_are_read() {
        assert_eq!(task("12_3 R"), Some((12, 3, "R")));
        assert_eq!(task("12_0 PD"), Some((12, 0, "PD")));
        for line in ["", "12 R", "12_[3-5] PD", "12_3"] {
            assert_eq!(task(line), None, "{line}");
        }
    }

    #[test]
    fn what_was_submitted_is_known_again() {
        let array = Array { id: 77, base: 2000 };
        assert_eq!(Array::parsed(&array.line()), Some(array));
    }

    #[test]
    fn scripts_take_any_path() {
        let text = script(Path::new("/a b/prfarm"), Path::new("it's.farm"), 1000);
        let expected = "#!/bin/sh\nunit=$((1000 + SLURM_ARRAY_TASK_ID))\nexec '/a b/prfarm' part \
                        'it'\\''s.farm' \"$unit\" 2>'it'\\''s.farm'/\"$unit\".err\n";
        assert_eq!(text, expected);
    }
}
