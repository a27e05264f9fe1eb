//! What the system says about memory.

use std::path::Path;

/// Most memory the process ever held, bytes; `None` where the system does not tell.
pub fn peak_bytes() -> Option<u64> {
    kilobytes_of("/proc/self/status", "VmHWM:")
}

/// Memory that the process could still get without swapping, bytes: what the system has, bounded by
/// the control groups that the process is in (containers, batch systems) and by `ulimit -v`.
pub fn available_bytes() -> Option<u64> {
    let system = kilobytes_of("/proc/meminfo", "MemAvailable:")?;
    let bounds = [left_in_groups(), left_of_address_space()];
    Some(bounds.into_iter().flatten().fold(system, u64::min))
}

/// Memory of the machine, bytes.
pub fn total_bytes() -> Option<u64> {
    kilobytes_of("/proc/meminfo", "MemTotal:")
}

fn kilobytes_of(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    let number: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(number * 1024)
}

/// What the tightest control group (version 2) around the process leaves.
fn left_in_groups() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|l| l.strip_prefix("0::"))?;
    let root = Path::new("/sys/fs/cgroup");
    let folder = root.join(own.trim_start_matches('/'));
    let inside = folder.ancestors().take_while(|f| f.starts_with(root));
    inside.filter_map(left_in_group).min()
}

fn left_in_group(folder: &Path) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let limit: u64 = read("memory.max")?.trim().parse().ok()?;
    let used: u64 = read("memory.current")?.trim().parse().ok()?;
    // The group's share of the page cache is given up when memory is short.
    let cache = read("memory.stat").and_then(|s| cached(&s)).unwrap_or(0);
    Some(limit.saturating_sub(used.saturating_sub(cache)))
}

/// Bytes of files in memory that nobody wrote to, of a group's `memory.stat`.
fn cached(stat: &str) -> Option<u64> {
    let line = stat
        .lines()
        .find_map(|l| l.strip_prefix("inactive_file "))?;
    line.trim().parse().ok()
}

fn left_of_address_space() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let limit = address_space(&limits)?;
    let used = kilobytes_of("/proc/self/status", "VmSize:")?;
    Some(limit.saturating_sub(used))
}

/// The soft limit of the address space, if there is one.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits
        .lines()
        .find_map(|l| l.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn peak_memory_covers_what_was_touched() {
        let touched = vec![1u8; 64 << 20];
        let peak = peak_bytes().unwrap();
        assert!(peak >= touched.len() as u64, "{peak}");
        assert!(available_bytes().unwrap() > 0);
    }

    #[test]
    fn limits_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
            Max resident set          unlimited            unlimited            bytes\n\
            Max address space         4096000              unlimited            bytes\n";
        assert_eq!(address_space(limits), Some(4_096_000));
        assert_eq!(
            address_space(&limits.replace("4096000  ", "unlimited")),
            None
        );
        assert_eq!(cached("anon 5\ninactive_file 77\nfile 9\n"), Some(77));
    }
}
