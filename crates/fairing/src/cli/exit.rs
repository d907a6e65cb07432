//! Failures and the exit codes they end in.

use std::fmt::Display;
use std::process::ExitCode;

/// Why a verb did not do its work.
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

    /// Arguments that do not fit together (exit code 2).
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { code: 2, error: anyhow::anyhow!("{message}") }
    }

    /// Prints the failure with its causes and gives its exit code.
    pub(crate) fn report(&self) -> ExitCode {
        // A reader that went away, as in `fairing … | head`, is not an error.
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

/// Work that failed (exit code 1).
impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { code: 1, error: error.into() }
    }
}
