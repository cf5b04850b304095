//! Checks of plain arguments: a value of the wrong type is a `TypeError`, one out of range a `ValueError`, and both say
//! what was found and what was expected.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::{Borrowed, FromPyObject};

/// A whole number of any size; what 64 bits do not hold is the nearest that they do, which no range has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole(i64);

impl<'a, 'py> FromPyObject<'a, 'py> for Whole {
    type Error = PyErr;

    fn extract(number: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match number.extract::<i64>() {
            Ok(number) => Ok(Self(number)),
            Err(error) if error.is_instance_of::<PyOverflowError>(number.py()) => {
                Ok(Self(if number.lt(0)? { i64::MIN } else { i64::MAX }))
            }
            Err(_) => Err(wrong_type("a whole number", &number)),
        }
    }
}

impl Whole {
    /// The number, if it is in `range`; `name` is that of the argument.
    pub(crate) fn within<T>(self, name: &str, range: RangeInclusive<i64>) -> PyResult<T>
    where
        T: TryFrom<i64>,
    {
        let found = Some(self.0).filter(|number| range.contains(number));
        found.and_then(|number| T::try_from(number).ok()).ok_or_else(|| {
            let (least, most) = (range.start(), range.end());
            let found = match self.0 {
                i64::MAX => "a larger one".to_owned(),
                i64::MIN => "a smaller one".to_owned(),
                number => number.to_string(),
            };
            value(format!("{name}: expected a whole number from {least} to {most}, found {found}"))
        })
    }
}

/// A number of the right type and in the wrong range, or arguments that exclude each other.
pub(crate) fn value(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}

/// `expected`, and the type of what was found.
pub(crate) fn wrong_type(expected: &str, found: &Bound<'_, PyAny>) -> PyErr {
    let name = found.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("expected {expected}, found {name}"))
}

/// The row of a table that `found` names; `name` is that of the argument.
pub(crate) fn word<T>(
    name: &str,
    found: &str,
    rows: impl IntoIterator<Item = (&'static str, T)>,
) -> PyResult<T> {
    let mut words = Vec::new();
    for (word, row) in rows {
        if word == found {
            return Ok(row);
        }
        words.push(word);
    }
    Err(value(format!("{name}: expected one of {}, found {found:?}", words.join(", "))))
}

/// Most threads that may be asked for.
const MOST_THREADS: i64 = 1024;

/// Threads to use; nothing for as many as there are processors.
pub(crate) fn threads(threads: Option<Whole>) -> PyResult<Option<usize>> {
    threads.map(|threads| threads.within("threads", 1..=MOST_THREADS)).transpose()
}

/// Works without holding the interpreter, on so many threads.
pub(crate) fn detached<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    py.detach(|| {
        let Some(threads) = threads else { return Ok(work()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool =
            pool.map_err(|error| value(format!("cannot start {threads} threads: {error}")))?;
        Ok(pool.install(work))
    })
}

/// Between two questions whether a signal has come.
const TICK: Duration = Duration::from_millis(20);

/// Works on a thread of its own without holding the interpreter. When a signal comes whose handler raises, as Ctrl-C does,
/// `work` is told to stop, and what the handler raised is raised here.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&(dyn Fn() -> bool + Sync)) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let stopped = || stop.load(Ordering::Relaxed);
    py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            let worker = thread::Builder::new().spawn_scoped(scope, move || {
                // Who waits for it is there until the end.
                sender.send(work(&stopped)).ok();
            })?;
            loop {
                match receiver.recv_timeout(TICK) {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(raised) = Python::attach(|py| py.check_signals()) {
                            stop.store(true, Ordering::Relaxed);
                            return Err(raised);
                        }
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        let panic = worker.join().err();
                        std::panic::resume_unwind(panic.unwrap_or_else(|| Box::new("no result")));
                    }
                }
            }
        })
    })
}
