//! How much memory a picture may take: an error before it is asked for, not an end in the middle.

use std::error::Error;
use std::fmt;
use std::fs;

/// A picture takes more memory than there is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryError {
    /// Bytes that it takes at least.
    pub needed: u64,
    /// Bytes that there are.
    pub available: u64,
}

/// Bytes of a page on the processors that this runs on, in `/proc/self/statm`.
const PAGE: u64 = 4096;

/// Refuses to take `needed` bytes where the system or a limit of this process has fewer left: to be asked before work that takes
/// as much as a picture. Where the system does not tell, all is taken for free, and so are a few MiB.
///
/// # Errors
///
/// If there are fewer.
pub fn check(needed: u64) -> Result<(), MemoryError> {
    // Below this nothing is asked: what a process takes to start is more.
    const SMALL: u64 = 1 << 22;
    if needed <= SMALL {
        return Ok(());
    }
    let text = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let limit = address_space(&text("/proc/self/limits"), &text("/proc/self/statm"));
    let free = free_memory(&text("/proc/meminfo"));
    let group = group_memory(
        &text("/sys/fs/cgroup/memory.max"),
        &text("/sys/fs/cgroup/memory.current"),
        &text("/sys/fs/cgroup/memory.stat"),
    );
    let available = [limit, free, group].into_iter().flatten().min().unwrap_or(u64::MAX);
    if needed <= available { Ok(()) } else { Err(MemoryError { needed, available }) }
}

/// What the limit of addresses (`ulimit -v`) leaves.
fn address_space(limits: &str, statm: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    let taken: u64 = statm.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(taken.saturating_mul(PAGE)))
}

/// What the system could give without others losing theirs.
fn free_memory(meminfo: &str) -> Option<u64> {
    let kilobytes = |name: &str| -> Option<u64> {
        let line = meminfo.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    let available = kilobytes("MemAvailable:")?;
    Some(available.saturating_add(kilobytes("SwapFree:").unwrap_or(0)).saturating_mul(1024))
}

/// What the control group of the process has left, pages of files that it can drop among it.
fn group_memory(most: &str, current: &str, stat: &str) -> Option<u64> {
    let most: u64 = most.trim().parse().ok()?;
    let current: u64 = current.trim().parse().ok()?;
    let pages = |name: &str| -> u64 {
        let line = stat.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|number| number.trim().parse().ok()).unwrap_or(0)
    };
    let files = pages("inactive_file ") + pages("active_file ");
    Some(most.saturating_sub(current.saturating_sub(files)))
}

impl fmt::Display for MemoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [needed, available] = [self.needed.div_ceil(1 << 20), self.available >> 20];
        write!(f, "takes at least {needed} MiB of memory, found {available} MiB")
    }
}

impl Error for MemoryError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_all_limits_counts() {
        let limits = "Limit  Soft Limit  Hard Limit  Units\n\
                      Max address space         1000000              unlimited            bytes\n";
        assert_eq!(address_space(limits, "100 50 3 0 0 0 0"), Some(1_000_000 - 409_600));
        assert_eq!(address_space(limits, "1000 50 3 0 0 0 0"), Some(0));
        assert_eq!(address_space("Max address space unlimited unlimited bytes", "1"), None);
        assert_eq!(address_space("", ""), None);
        let memory = "MemTotal: 9 kB\nMemAvailable:  20 kB\nSwapFree: 2 kB\n";
        assert_eq!(free_memory(memory), Some(22 * 1024));
        assert_eq!(free_memory("MemTotal: 9 kB"), None);
        assert_eq!(group_memory("max\n", "5\n", ""), None);
        let stat = "anon 7\ninactive_file 200\nactive_file 100\n";
        assert_eq!(group_memory("1000\n", "500\n", stat), Some(800));
    }

    #[test]
    fn what_no_machine_has_is_refused() {
        assert_eq!(check(1 << 20), Ok(()));
        let error = check(u64::MAX).unwrap_err();
        assert!(error.needed == u64::MAX && error.available < u64::MAX);
        let error = MemoryError { needed: 3 << 20, available: (2 << 20) - 1 };
        assert_eq!(error.to_string(), "takes at least 3 MiB of memory, found 1 MiB");
    }
}
