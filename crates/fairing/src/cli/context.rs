//! Options of all verbs, notes and results, and failures with their exit codes.

use std::fmt::Display;
use std::io::{Write, stdout};
use std::process::ExitCode;

use indicatif::ProgressBar;

/// Options of all verbs, and the terminal.
pub(crate) struct Context {
    /// Print only results and errors.
    pub(crate) quiet: bool,
    /// Leave out faces with broken vertices when reading.
    pub(crate) drop_broken: bool,
    /// Progress of the verb, hidden at first.
    pub(crate) bar: ProgressBar,
}

impl Context {
    /// Prints a note to the error stream, unless the program is quiet.
    pub(crate) fn note(&self, text: impl Display) {
        if !self.quiet {
            self.bar.suspend(|| eprintln!("{text}"));
        }
    }

    /// Prints a result to the standard output.
    pub(crate) fn print(&self, text: impl Display) -> Result<(), Failure> {
        self.bar.suspend(|| {
            let mut out = stdout().lock();
            write!(out, "{text}")?;
            Ok(out.flush()?)
        })
    }
}

/// Error of a verb, with its exit code.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    error: anyhow::Error,
}

impl Failure {
    /// An input that cannot be read (exit code 3).
    pub(crate) fn input(error: impl Into<anyhow::Error>) -> Self {
        Self { code: 3, error: error.into() }
    }

    /// An output that cannot be written (exit code 4).
    pub(crate) fn output(error: impl Into<anyhow::Error>) -> Self {
        Self { code: 4, error: error.into() }
    }

    /// Invalid or contradictory arguments (exit code 2).
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { code: 2, error: anyhow::anyhow!("{message}") }
    }

    /// Prints the failure with its causes and returns its exit code.
    pub(crate) fn report(&self) -> ExitCode {
        // A closed pipe, as in `fairing … | head`, is not an error.
        let broken_pipe = self.error.chain().any(|cause| {
            cause
                .downcast_ref::<std::io::Error>()
                .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
        });
        if broken_pipe {
            return ExitCode::SUCCESS;
        }
        eprintln!("error: {:#}", self.error);
        ExitCode::from(self.code)
    }
}

/// A failed computation (exit code 1).
impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { code: 1, error: error.into() }
    }
}
