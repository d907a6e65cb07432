//! Progress on a terminal, silence elsewhere.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over all experiments, weighted by how long each took the last time.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    current: std::sync::Mutex<(u64, u64, String)>,
}

/// Ticks for each second of expected work.
const RESOLUTION: f64 = 100.0;

impl Progress {
    /// A bar over this many expected seconds; hidden where standard error is
    /// not a terminal.
    pub fn new(expected_seconds: f64) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::hidden();
        }
        let bar = ProgressBar::new((expected_seconds * RESOLUTION) as u64);
        let style = ProgressStyle::with_template(
            "{bar:30.cyan/blue} {percent:>3} % {elapsed} elapsed, about {eta} left  {msg}",
        );
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(Duration::from_millis(250));
        Self { bar, current: Default::default() }
    }

    /// A bar that nobody sees.
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), current: Default::default() }
    }

    /// The experiment with this title begins and is expected to take so long.
    pub fn begin(&self, title: &str, expected_seconds: f64) {
        let span = (expected_seconds * RESOLUTION) as u64;
        if let Ok(mut current) = self.current.lock() {
            *current = (self.bar.position(), span, title.to_string());
        }
        self.bar.set_message(title.to_string());
    }

    /// How much of the current experiment is done, 0 to 1.
    pub fn within(&self, done: f64, what: &str) {
        if let Ok(current) = self.current.lock() {
            let (start, span, title) = &*current;
            self.bar.set_position(start + (done.clamp(0.0, 1.0) * *span as f64) as u64);
            self.bar.set_message(format!("{title}: {what}"));
        }
    }

    /// The current experiment is over.
    pub fn end(&self) {
        if let Ok(current) = self.current.lock() {
            self.bar.set_position(current.0 + current.1);
        }
    }

    /// A line above the bar, or on standard error where there is none.
    pub fn say(&self, line: &str) {
        if self.bar.is_hidden() {
            eprintln!("{line}");
        } else {
            self.bar.println(line);
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
