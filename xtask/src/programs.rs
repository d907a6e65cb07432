//! The programs that do the work of a task.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context as _, Result};

/// A program of the workspace.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Program {
    /// Experiments and their report, in the profile of the tests, so nothing is compiled twice.
    Reproduce,
    /// Times of tasks, in the profile release: what users install is measured.
    Bench,
}

impl Program {
    fn name(self) -> &'static str {
        match self {
            Self::Reproduce => "reproduce",
            Self::Bench => "bench",
        }
    }

    /// The place of the program: beside this one, in the folder of its profile.
    fn path(self) -> Result<PathBuf> {
        let own = std::env::current_exe().context("finding our own program")?;
        let folder = own.parent().context("our own program is in no folder")?;
        let file = format!("{}{}", self.name(), std::env::consts::EXE_SUFFIX);
        Ok(match self {
            Self::Reproduce => folder.with_file_name("debug").join(file),
            Self::Bench => folder.with_file_name("release").join(file),
        })
    }

    /// The program as a command; it has to be built.
    pub(crate) fn command(self) -> Result<Command> {
        Ok(Command::new(self.path()?))
    }

    /// Builds the program with the features that its dependencies have in the whole workspace, so
    /// that the tests and the Python package share them, and runs it in the place of this one.
    pub(crate) fn start(self, root: &Path, arguments: &[OsString]) -> Result<ExitCode> {
        let mut build = cargo(root);
        build.args(["build", "--workspace", "--bin", self.name()]);
        if let Self::Bench = self {
            build.arg("--release");
        }
        if !build.status().context("running cargo")?.success() {
            return Ok(ExitCode::FAILURE);
        }
        let mut command = self.command()?;
        command.args(arguments);
        become_program(command).with_context(|| format!("running {}", self.name()))
    }
}

/// Runs the program of the study, a workspace of its own.
pub(crate) fn study(root: &Path, arguments: &[OsString]) -> Result<ExitCode> {
    let mut run = cargo(root);
    run.args(["run", "--release", "--manifest-path", "study/Cargo.toml"]);
    run.args(["--target-dir", "target/study", "--"]).args(arguments);
    become_program(run).context("running cargo")
}

/// The cargo that runs us, in the root of the repository.
pub(crate) fn cargo(root: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root);
    cargo
}

/// Signals, the terminal and the exit code are those of the program.
#[cfg(unix)]
fn become_program(mut command: Command) -> Result<ExitCode> {
    use std::os::unix::process::CommandExt as _;
    Err(command.exec().into())
}

#[cfg(not(unix))]
fn become_program(mut command: Command) -> Result<ExitCode> {
    let code = command.status()?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}
