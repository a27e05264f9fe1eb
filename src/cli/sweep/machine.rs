//! The machine that measures, as far as it tells.

use crate::cli::memory;
use crate::report::sweep::Machine;
use std::fs::read_to_string;

/// Asks the system.
pub fn ask() -> Machine {
    let line = |file: &str, key: &str, between: char| {
        let text = read_to_string(file).ok()?;
        let line = text.lines().find(|l| l.starts_with(key))?;
        let value = line.split_once(between)?.1.trim();
        Some(value.trim_matches('"').to_owned())
    };
    let unknown = || "unknown".to_owned();
    let kernel = read_to_string("/proc/sys/kernel/osrelease");
    Machine {
        processor: line("/proc/cpuinfo", "model name", ':').unwrap_or_else(unknown),
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        memory_bytes: memory::total_bytes(),
        system: line("/etc/os-release", "PRETTY_NAME", '=').unwrap_or_else(unknown),
        kernel: kernel.map_or_else(|_| unknown(), |k| k.trim().to_owned()),
        libraries: libraries(),
    }
}

#[cfg(feature = "oiio")]
fn libraries() -> Vec<String> {
    vec![format!("OpenImageIO {}", crate::image::oiio::version())]
}

#[cfg(not(feature = "oiio"))]
fn libraries() -> Vec<String> {
    Vec::new()
}
