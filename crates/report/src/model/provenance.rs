//! The provenance of numbers: code, machine, seed and day.

use serde::{Deserialize, Serialize};

/// The information needed to reproduce the numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program that wrote the report, and its version.
    pub program: String,
    /// The commit, or `unknown` outside a repository.
    pub commit: String,
    /// True if files differed from that commit.
    pub dirty: bool,
    /// The compiler.
    pub compiler: String,
    /// Versions of the libraries that numbers pass through.
    pub libraries: Vec<String>,
    /// The operating system and architecture.
    pub system: String,
    /// The processor.
    pub processor: String,
    /// The number of threads.
    pub threads: usize,
    /// The seed of all random numbers.
    pub seed: u64,
    /// True if sizes were reduced.
    pub quick: bool,
    /// The day, as year-month-day in UTC.
    pub date: String,
}
