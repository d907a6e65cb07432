//! The tests of the workspace live in `tests/tests`; this library is empty.

use std::io::Write as _;
use std::path::PathBuf;
use std::time::Instant;

/// Runs a test of a harness of its own. Where `FAIRING_TEST_TIMES` names a
/// file, its name and its seconds are added there as a line.
pub fn timed<T>(name: &str, test: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = test();
    if let Some(path) = std::env::var_os("FAIRING_TEST_TIMES").map(PathBuf::from) {
        let file = std::fs::OpenOptions::new().append(true).create(true).open(path);
        // A time that cannot be written fails no test.
        let _ = file.and_then(|mut f| writeln!(f, "{name} {:.3}", start.elapsed().as_secs_f64()));
    }
    result
}
