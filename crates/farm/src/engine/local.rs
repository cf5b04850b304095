//! Processes on this machine.

use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::fs::File;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, Sender};
use std::thread;

use rustix::process::{Pid, Signal, kill_process};

use super::{Engine, Message, Stopped};
use crate::folder::Folder;

/// A few processes at a time.
#[derive(Debug)]
pub(crate) struct Local {
    folder: Folder,
    program: PathBuf,
    jobs: usize,
    waiting: VecDeque<usize>,
    /// Process numbers of units that are worked at.
    running: BTreeMap<usize, u32>,
    most: usize,
    sender: Sender<Message>,
    receiver: Receiver<Message>,
}

impl Local {
    pub(crate) fn new(
        folder: Folder,
        jobs: usize,
        (sender, receiver): (Sender<Message>, Receiver<Message>),
    ) -> std::io::Result<Self> {
        let program = std::env::current_exe()?;
        let (waiting, running) = (VecDeque::new(), BTreeMap::new());
        Ok(Self { folder, program, jobs, waiting, running, most: 0, sender, receiver })
    }

    /// Begins waiting units while there is room. All workers are children of the thread that calls this: it has to be the
    /// main thread, as they end with it.
    fn begin(&mut self) -> Result<(), Box<dyn Error>> {
        while self.running.len() < self.jobs {
            let Some(unit) = self.waiting.pop_front() else { break };
            let path = self.folder.errors(unit);
            let errors =
                File::create(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            let mut child = Command::new(&self.program)
                .arg("part")
                .arg(&self.folder.path)
                .arg(unit.to_string())
                .args(["--parent", &std::process::id().to_string()])
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(errors)
                .spawn()
                .map_err(|error| format!("cannot start a worker: {error}"))?;
            self.running.insert(unit, child.id());
            self.most = self.most.max(self.running.len());
            let sender = self.sender.clone();
            thread::Builder::new().spawn(move || {
                // The driver has ended if nobody listens.
                sender.send(Message::Ended(unit, child.wait())).ok();
            })?;
        }
        Ok(())
    }
}

impl Engine for Local {
    fn submit(&mut self, units: &[usize]) -> Result<(), Box<dyn Error>> {
        self.waiting.extend(units);
        self.begin()
    }

    fn ended(&mut self) -> Result<Vec<usize>, Box<dyn Error>> {
        match self.receiver.recv()? {
            Message::Stop => Err(Stopped.into()),
            Message::Ended(unit, status) => {
                self.running.remove(&unit);
                status?;
                self.begin()?;
                Ok(vec![unit])
            }
        }
    }

    fn stop(&mut self) {
        self.waiting.clear();
        for pid in self.running.values() {
            let pid = i32::try_from(*pid).ok().and_then(Pid::from_raw);
            // It may have ended by itself.
            pid.map(|pid| kill_process(pid, Signal::TERM));
        }
    }

    fn workers(&self) -> usize {
        self.most
    }
}
