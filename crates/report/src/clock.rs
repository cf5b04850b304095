//! Time that a work takes of the processors.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// Seconds of all threads of this process together: where one thread works, those of one core, whatever else the machine
/// does meanwhile.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    begun: Duration,
}

impl Stopwatch {
    /// Begins now.
    #[must_use]
    pub fn start() -> Self {
        Self { begun: now() }
    }

    /// Seconds since it began; never 0, as clocks have steps.
    #[must_use]
    pub fn seconds(self) -> f64 {
        let taken = now().saturating_sub(self.begun);
        taken.max(Duration::from_nanos(1)).as_secs_f64()
    }
}

fn now() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
    let nanoseconds = u32::try_from(time.tv_nsec).unwrap_or(0);
    Duration::new(seconds, nanoseconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_time() {
        let watch = Stopwatch::start();
        let first = watch.seconds();
        let sum: u64 = (0..3_000_000_u64).map(std::hint::black_box).sum();
        assert_eq!(sum, 4_499_998_500_000);
        assert!(first > 0.0 && watch.seconds() > first, "{first}");
    }
}
