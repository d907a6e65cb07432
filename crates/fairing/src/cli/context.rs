//! Options of all verbs, notes and results, and failures with their exit codes.

use std::fmt::{self, Display};
use std::io::{ErrorKind, Write, stdout};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Mutex;

use fairing::mesh::io::{Format, WriteError, WriteProblem};
use fairing::watch::Watch;
use indicatif::ProgressBar;

/// Names of the standard streams in errors.
pub(crate) const STDIN: &str = "standard input";
pub(crate) const STDOUT: &str = "standard output";

/// Options of all verbs, and the terminal.
pub(crate) struct Context {
    /// Print only results and errors.
    pub(crate) quiet: bool,
    /// Leave out faces with broken vertices when reading.
    pub(crate) drop_broken: bool,
    /// The format of the standard input, if it is given.
    pub(crate) from: Option<Format>,
    /// The format of the standard output.
    pub(crate) to: Option<Format>,
    /// Progress of the verb, hidden at first.
    pub(crate) bar: ProgressBar,
    /// The watch that Ctrl-C cancels.
    pub(crate) watch: Watch,
    /// The current file, if there are several.
    pub(crate) file: Option<OneOfSeveral>,
}

/// One of several files, whose results are printed together.
pub(crate) struct OneOfSeveral {
    name: String,
    results: Mutex<String>,
}

impl Context {
    /// Prints a note to the error stream, unless the program is quiet.
    pub(crate) fn note(&self, text: impl Display) {
        if !self.quiet {
            self.bar.suspend(|| eprintln!("{}", self.named(text)));
        }
    }

    /// Prints the failure of one of several files.
    pub(crate) fn error(&self, failure: &Failure) {
        self.bar.suspend(|| eprintln!("error: {}", self.named(failure)));
    }

    /// The text with the name of the current file, if there are several.
    fn named(&self, text: impl Display) -> String {
        let text = text.to_string();
        match &self.file {
            Some(OneOfSeveral { name, .. }) if !text.starts_with(name) => format!("{name}: {text}"),
            _ => text,
        }
    }

    /// The context of one of several files.
    pub(crate) fn for_file(&self, path: &Path) -> Self {
        let name = path.display().to_string();
        Self {
            bar: self.bar.clone(),
            watch: self.watch.clone(),
            file: Some(OneOfSeveral { name, results: Mutex::default() }),
            ..*self
        }
    }

    /// Prints the results of the current file, below its name.
    pub(crate) fn flush(&self) {
        let Some(OneOfSeveral { name, results }) = &self.file else { return };
        let results = results.lock().map(|results| results.clone()).unwrap_or_default();
        if !results.is_empty() {
            // A closed pipe ends the program at the end.
            let _ = self.write(format_args!("{name}:\n{results}\n"));
        }
    }

    /// Prints a result to the standard output.
    pub(crate) fn print(&self, text: impl Display) -> Result<(), Failure> {
        match self.file.as_ref().map(|file| file.results.lock()) {
            Some(Ok(mut results)) => {
                results.push_str(&text.to_string());
                Ok(())
            }
            _ => self.write(text),
        }
    }

    fn write(&self, text: impl Display) -> Result<(), Failure> {
        self.bar.suspend(|| {
            let mut out = stdout().lock();
            let written = write!(out, "{text}").and_then(|()| out.flush());
            written.map_err(|error| Failure::output(anyhow::Error::new(error).context(STDOUT)))
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

    /// The failure of several files, with the exit code of this one.
    pub(crate) fn among(&self, failed: usize, all: usize) -> Self {
        Self { code: self.code, error: anyhow::anyhow!("{failed} of {all} files failed") }
    }

    /// Prints the failure with its causes and returns its exit code.
    pub(crate) fn report(&self) -> ExitCode {
        // A closed pipe, as in `fairing … | head`, is not an error.
        let of_file = |cause: &'_ WriteError| match &cause.problem {
            WriteProblem::Io(error) => Some(error.kind()),
            _ => None,
        };
        let broken_pipe = self.error.chain().any(|cause| {
            let kind = cause.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
            kind.or_else(|| cause.downcast_ref().and_then(of_file)) == Some(ErrorKind::BrokenPipe)
        });
        if broken_pipe {
            return ExitCode::SUCCESS;
        }
        eprintln!("error: {self}");
        ExitCode::from(self.code)
    }
}

/// The error with its causes.
impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#}", self.error)
    }
}

/// A failed computation (exit code 1).
impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { code: 1, error: error.into() }
    }
}
