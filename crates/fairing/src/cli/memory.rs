//! Memory that is left, for errors before the machine swaps.

use std::fmt::Display;
use std::fs;

use super::context::Failure;

/// The memory that reading and writing take at least, for each byte of a file: measured are 3.6 for
/// text and 4.3 for binary files.
const READING: u64 = 3;
/// The memory that work on a mesh takes at least, for each vertex, in bytes: 490 are measured for
/// topology and incidence, which every verb but `convert` needs.
const TOPOLOGY: u64 = 400;
/// The memory that modes take at least, for each vertex and for each of its values in modes, in
/// bytes: the factored matrix, and vectors of the solver.
const FACTOR: u64 = 2500;
const VALUE: u64 = 16;

/// Bytes that the program may still take: the memory that the system has left without swapping, or
/// less by the limits of the control group and of the address space. `None` where it is unknown,
/// as on systems other than Linux.
pub(crate) fn left() -> Option<u64> {
    let status = fs::read_to_string("/proc/meminfo").ok()?;
    let system = kilobytes(&status, "MemAvailable:");
    [system, left_to_group(), left_to_address_space()].into_iter().flatten().min()
}

/// The largest file for which there is memory; `None` where it is unknown.
pub(crate) fn largest_file() -> Option<u64> {
    left().map(|bytes| bytes / READING)
}

/// Fails if there is no memory to work on a mesh of so many vertices.
pub(crate) fn require_for_mesh(vertices: usize) -> Result<(), Failure> {
    require(TOPOLOGY.saturating_mul(vertices as u64), format_args!("{vertices} vertices"))
}

/// Fails if there is no memory for `k` modes of a mesh.
pub(crate) fn require_for_modes(vertices: usize, k: usize) -> Result<(), Failure> {
    // More modes than vertices are another error.
    let values = (k.min(vertices) as u64).saturating_mul(VALUE).saturating_add(FACTOR);
    let needed = values.saturating_mul(vertices as u64);
    require(needed, format_args!("{k} modes of {vertices} vertices"))
}

fn require(needed: u64, what: impl Display) -> Result<(), Failure> {
    match left() {
        Some(left) if left < needed => Err(anyhow::anyhow!(
            "{what} need at least {} MB of memory, but {} MB are left",
            needed / 1_000_000,
            left / 1_000_000
        )
        .into()),
        _ => Ok(()),
    }
}

/// The value of a line in kB, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
}

/// Bytes left by the control group of a container or a batch job.
fn left_to_group() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let group = groups.lines().find_map(|line| line.strip_prefix("0::"))?;
    let number = |name: &str| -> Option<u64> {
        let path = format!("/sys/fs/cgroup{}/{name}", group.trim_end_matches('/'));
        fs::read_to_string(path).ok()?.trim().parse().ok()
    };
    Some(number("memory.max")?.saturating_sub(number("memory.current")?))
}

/// Bytes left by `ulimit -v`.
fn left_to_address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    // The allocator has reserved more than is in use, and gives it out first.
    Some(limit.saturating_sub(kilobytes(&status, "VmRSS:")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_kilobytes_are_read() {
        let text = "MemTotal:       24555308 kB\nMemAvailable:         12 kB\nHugePages_Total: 0\n";
        assert_eq!(kilobytes(text, "MemAvailable:"), Some(12 * 1024));
        assert_eq!(kilobytes(text, "HugePages_Total:"), None);
        assert_eq!(kilobytes(text, "SwapFree:"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn there_is_memory_left() {
        assert!(left().is_some_and(|bytes| bytes > 1 << 20));
    }
}
