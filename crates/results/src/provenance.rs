//! Where numbers come from: the code, the machine, the seed, the day.

use serde::{Deserialize, Serialize};

/// What somebody needs to know to get the same numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program that wrote the report, and its version.
    pub program: String,
    /// The commit, or `unknown` outside a repository.
    pub commit: String,
    /// Whether files differed from that commit.
    pub dirty: bool,
    /// The compiler.
    pub compiler: String,
    /// Versions of the libraries that numbers pass through.
    pub libraries: Vec<String>,
    /// The operating system and architecture.
    pub system: String,
    /// The processor.
    pub processor: String,
    /// How many threads ran.
    pub threads: usize,
    /// The seed of everything random.
    pub seed: u64,
    /// Whether sizes were reduced.
    pub quick: bool,
    /// The day, as year-month-day in UTC.
    pub date: String,
}
