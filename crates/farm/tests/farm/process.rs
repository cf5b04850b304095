//! Processes of a render, as the system lists them.

use std::fs;
use std::path::Path;

use rustix::process::{Pid, Signal, kill_process};

/// A worker that renders a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Worker {
    pub(crate) pid: u32,
}

impl Worker {
    /// All that work in a folder, which is named as on their command lines.
    pub(crate) fn all(folder: &Path) -> Vec<Self> {
        let folder = folder.to_str().unwrap();
        let mut found = Vec::new();
        for entry in fs::read_dir("/proc").unwrap().flatten() {
            let Ok(pid) = entry.file_name().to_string_lossy().parse() else { continue };
            // It may have ended meanwhile.
            let line = fs::read(entry.path().join("cmdline")).unwrap_or_default();
            let words: Vec<&[u8]> = line.split(|&byte| byte == 0).collect();
            if words.len() > 3 && words[1] == b"part" && words[2] == folder.as_bytes() {
                found.push(Self { pid });
            }
        }
        found.sort();
        found
    }

    /// A variable of its environment.
    pub(crate) fn variable(self, name: &str) -> Option<String> {
        let text = fs::read(format!("/proc/{}/environ", self.pid)).ok()?;
        let prefix = format!("{name}=");
        let mut words = text.split(|&byte| byte == 0).map(String::from_utf8_lossy);
        words.find_map(|word| word.strip_prefix(&prefix).map(str::to_owned))
    }

    /// The number of the process that started it.
    pub(crate) fn parent(self) -> Option<u32> {
        let text = fs::read_to_string(format!("/proc/{}/stat", self.pid)).ok()?;
        // The name, in parentheses, may hold anything.
        text.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
    }
}

/// Sends a signal; the process may have ended by itself.
pub(crate) fn send(pid: u32, signal: Signal) -> bool {
    let pid = i32::try_from(pid).ok().and_then(Pid::from_raw).unwrap();
    kill_process(pid, signal).is_ok()
}

/// Numbers that look random, the same in each run (Steele et al., `SplitMix`, 2014).
pub(crate) struct Lots(pub(crate) u64);

impl Lots {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) % limit as u64).unwrap()
    }
}

/// Whether a child of this process still runs: it is there, and not only until it is waited for.
pub(crate) fn is_running(pid: u32) -> bool {
    let text = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = text.rsplit_once(')').and_then(|(_, rest)| rest.split_whitespace().next());
    state.is_some_and(|state| state != "Z" && state != "X")
}
