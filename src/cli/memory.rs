//! What the system says about memory.

/// Most memory the process ever held, bytes; `None` where the system does not tell.
pub fn peak_bytes() -> Option<u64> {
    kilobytes_of("/proc/self/status", "VmHWM:")
}

/// Memory that the system could give without swapping, bytes.
pub fn available_bytes() -> Option<u64> {
    kilobytes_of("/proc/meminfo", "MemAvailable:")
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
}
