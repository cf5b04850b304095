//! Signals that end a program: taken note of, so that the terminal is put back first.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::{flag, low_level};

const ENDING: [i32; 4] = [SIGHUP, SIGINT, SIGQUIT, SIGTERM];

/// Which ending signal came last, from when this was made.
#[derive(Clone, Debug)]
pub(crate) struct Signals {
    /// 0 where none came.
    last: Arc<AtomicUsize>,
}

impl Signals {
    /// Holds ending signals back from now on. A second one ends the program at once, so that it
    /// can be ended while it waits for the terminal.
    pub(crate) fn held() -> io::Result<Self> {
        let (last, came) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        for signal in ENDING {
            flag::register_conditional_default(signal, Arc::clone(&came))?;
            flag::register(signal, Arc::clone(&came))?;
            let number = usize::try_from(signal).map_err(io::Error::other)?;
            flag::register_usize(signal, Arc::clone(&last), number)?;
        }
        Ok(Self { last })
    }

    /// Whether one came.
    pub(crate) fn came(&self) -> bool {
        self.last.load(Ordering::Relaxed) != 0
    }

    /// Ends the program as the signal that came would have, if one came.
    pub(crate) fn pass_on(&self) -> io::Result<()> {
        match i32::try_from(self.last.load(Ordering::Relaxed)) {
            Ok(0) => Ok(()),
            Ok(signal) => low_level::emulate_default_handler(signal),
            Err(error) => Err(io::Error::other(error)),
        }
    }
}
