//! Progress on a terminal, lines on standard error elsewhere.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;

use crate::experiment::progress::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// Ticks for each second of expected work.
const RESOLUTION: f64 = 100.0;

/// A bar over all experiments, weighted by how long each took the last time;
/// hidden where standard error is not a terminal.
#[derive(Debug)]
pub(super) struct Bar {
    bar: ProgressBar,
    current: Mutex<Current>,
}

/// The current experiment: its start and length on the bar, and its title.
#[derive(Debug, Default)]
struct Current {
    start: u64,
    span: u64,
    title: String,
}

impl Bar {
    pub(super) fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden(), current: Mutex::default() };
        }
        let bar = ProgressBar::new(0);
        let style = ProgressStyle::with_template(
            "{bar:30.cyan/blue} {percent:>3} % {elapsed} elapsed, about {eta} left  {msg}",
        );
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(Duration::from_millis(250));
        Self { bar, current: Mutex::default() }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn start(&self, expected_seconds: f64) {
        self.bar.set_length((expected_seconds * RESOLUTION) as u64);
    }

    fn begin(&self, title: &str, expected_seconds: f64) {
        let span = (expected_seconds * RESOLUTION) as u64;
        if let Ok(mut current) = self.current.lock() {
            *current = Current { start: self.bar.position(), span, title: title.to_string() };
        }
        self.bar.set_message(title.to_string());
    }

    fn within(&self, done: f64, what: &str) {
        if let Ok(current) = self.current.lock() {
            let moved = (done.clamp(0.0, 1.0) * current.span as f64) as u64;
            self.bar.set_position(current.start + moved);
            self.bar.set_message(format!("{}: {what}", current.title));
        }
    }

    fn end(&self) {
        if let Ok(current) = self.current.lock() {
            self.bar.set_position(current.start + current.span);
        }
    }

    /// Prints a line above the bar, or on standard error if the bar is hidden.
    fn say(&self, line: &str) {
        if self.bar.is_hidden() {
            eprintln!("{line}");
        } else {
            self.bar.println(line);
        }
    }
}
