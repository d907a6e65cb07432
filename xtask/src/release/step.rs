//! A result of a step, and programs that steps run.

use std::process::Command;

use anyhow::{Context as _, Result, ensure};

/// A step that passed.
pub(super) enum Passed {
    /// A remark on the result.
    Done(String),
    /// The reason for which the step cannot run on this machine.
    Skipped(String),
}

/// The standard output of a program.
pub(super) fn output(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().with_context(|| format!("running {name}"))?;
    ensure!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Runs a program that shows its own progress.
pub(super) fn succeed(command: &mut Command) -> Result<()> {
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.status().with_context(|| format!("running {name}"))?;
    let arguments: Vec<_> = command.get_args().map(|a| a.to_string_lossy()).collect();
    ensure!(status.success(), "{name} {} failed", arguments.join(" "));
    Ok(())
}
