//! The programs that do the work of tasks.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context as _, Result};

/// A program of the workspace.
pub(crate) struct Program {
    name: &'static str,
    /// The options of cargo that choose the profile.
    options: &'static [&'static str],
    /// The folder of the profile below the target folder.
    folder: &'static str,
}

/// The profile of what is compiled only to be checked.
pub(crate) const UNOPTIMISED: &str = "unoptimised";

/// The experiments and their report, in the profile of the tests, so nothing is compiled twice.
pub(crate) const REPRODUCE: Program = Program { name: "reproduce", options: &[], folder: "debug" };

/// Times of tasks, in the profile release: what users install is measured.
pub(crate) const BENCH: Program =
    Program { name: "bench", options: &["--workspace", "--release"], folder: "release" };

impl Program {
    /// The place of the program: in the folder of its profile, beside the folder of this program.
    pub(crate) fn path(&self) -> Result<PathBuf> {
        let own = std::env::current_exe().context("finding our own program")?;
        let folder = own.parent().context("our own program is in no folder")?;
        let file = format!("{}{}", self.name, std::env::consts::EXE_SUFFIX);
        Ok(folder.with_file_name(self.folder).join(file))
    }

    /// Builds the program with the features that its dependencies have in all tests; returns
    /// `true` on success.
    pub(crate) fn build(&self, root: &Path) -> Result<bool> {
        succeeds(cargo(root).args(["build", "--bin", self.name]).args(self.options))
    }

    /// Builds the program, and runs it in the place of this one.
    pub(crate) fn start(&self, root: &Path, arguments: &[OsString]) -> Result<ExitCode> {
        if !self.build(root)? {
            return Ok(ExitCode::FAILURE);
        }
        let mut command = Command::new(self.path()?);
        command.args(arguments);
        become_program(command).with_context(|| format!("running {}", self.name))
    }
}

/// Runs the program of the study, a workspace of its own.
pub(crate) fn study(root: &Path, arguments: &[OsString]) -> Result<ExitCode> {
    let mut run = cargo(root);
    run.args(["run", "--release", "--manifest-path", "study/Cargo.toml"]);
    run.args(["--target-dir", "target/study", "--"]).args(arguments);
    become_program(run).context("running cargo")
}

/// The cargo that started this program, in the root of the repository.
pub(crate) fn cargo(root: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root);
    cargo
}

/// Runs a command; returns true if it succeeds.
pub(crate) fn succeeds(command: &mut Command) -> Result<bool> {
    let status = command.status();
    Ok(status.with_context(|| format!("running {}", command.get_program().display()))?.success())
}

/// Returns true if a folder of the path has a program of this name.
pub(crate) fn on_path(name: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&folders).any(|folder| folder.join(&file).is_file())
}

/// Prints the name of a skipped check, with the reason.
pub(crate) fn skip(what: &str, reason: &str) {
    println!("skipped: {what} ({reason})");
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
