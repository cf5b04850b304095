//! Who does the work: processes here, or a queue.

pub(crate) mod local;
pub(crate) mod slurm;

use std::error::Error;
use std::fmt;
use std::process::ExitStatus;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// What the driver waits for.
#[derive(Debug)]
pub(crate) enum Message {
    /// A worker of this machine has ended.
    Ended(usize, std::io::Result<ExitStatus>),
    /// The user, or the system, wants the driver to end.
    Stop,
}

/// The driver was told to end.
#[derive(Debug)]
pub(crate) struct Stopped;

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stopped")
    }
}

impl Error for Stopped {}

/// Something that renders units by their numbers.
pub(crate) trait Engine {
    /// Has units rendered, in any order.
    ///
    /// # Errors
    ///
    /// If they cannot be begun, now or ever.
    fn submit(&mut self, units: &[usize]) -> Result<(), Box<dyn Error>>;

    /// Waits until units are no longer worked at: they are done, or failed.
    ///
    /// # Errors
    ///
    /// [`Stopped`], or if nothing can be learned about them any more.
    fn ended(&mut self) -> Result<Vec<usize>, Box<dyn Error>>;

    /// Ends all work.
    fn stop(&mut self);

    /// How many units were worked at at a time, at most.
    fn workers(&self) -> usize;
}

/// Where messages come in. The first signal to end is one.
///
/// # Errors
///
/// If signals cannot be heard of.
pub(crate) fn messages() -> std::io::Result<(Sender<Message>, Receiver<Message>)> {
    let (sender, receiver) = channel();
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    let stop = sender.clone();
    thread::Builder::new().name("signals".into()).spawn(move || {
        for _ in signals.forever() {
            // The driver has ended if nobody listens.
            stop.send(Message::Stop).ok();
        }
    })?;
    Ok((sender, receiver))
}

/// Ascending numbers as `0-3,7`.
pub(crate) fn ranges(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let word = |&(first, last): &(usize, usize)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    runs.iter().map(word).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2,5,7-8");
        assert_eq!(ranges(&[9]), "9");
    }
}
