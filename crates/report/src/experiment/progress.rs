//! The hook by which a program shows how far the experiments are.

/// Receives the events of a run of experiments; it cannot affect the run.
pub trait Progress: Sync {
    /// A run that is expected to take so long begins.
    fn start(&self, expected_seconds: f64) {
        let _ = expected_seconds;
    }

    /// The experiment with this title begins and is expected to take so long.
    fn begin(&self, title: &str, expected_seconds: f64) {
        let _ = (title, expected_seconds);
    }

    /// Shows the fraction of the current experiment that is done, and the next step.
    fn within(&self, done: f64, what: &str) {
        let _ = (done, what);
    }

    /// The current experiment is over.
    fn end(&self) {}

    /// A line for a person to read.
    fn say(&self, line: &str) {
        let _ = line;
    }
}
