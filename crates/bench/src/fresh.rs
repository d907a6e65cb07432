//! Tasks in processes of their own.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

/// A task in a process that does nothing else.
#[derive(Debug, Clone)]
pub(crate) struct Fresh {
    arguments: Vec<OsString>,
}

/// Times of a process.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Times {
    /// Seconds of the task, which touches every page for the first time.
    pub(crate) first: f64,
    /// The peak memory of the process in megabytes, if the system reports it.
    pub(crate) megabytes: Option<f64>,
}

impl Fresh {
    /// The task on a mesh, with more arguments of `bench`.
    pub(crate) fn new(task: &str, input: &Path, more: &[&str]) -> Self {
        let mut arguments: Vec<OsString> = vec![task.into(), "--json".into()];
        arguments.extend(["--in".into(), input.into()]);
        arguments.extend(more.iter().map(OsString::from));
        Self { arguments }
    }

    /// Runs the task once in a new process.
    pub(crate) fn run(&self) -> Result<Times> {
        let result = self.result()?;
        let runs = result["runs"].as_array().context("the process printed no times")?;
        Ok(Times {
            first: runs.first().map(total).context("the process printed no times")?,
            megabytes: result["rss_mb"].as_f64(),
        })
    }

    /// All that a new process prints about one run.
    pub(crate) fn result(&self) -> Result<Value> {
        let mut command = Command::new(std::env::current_exe()?);
        let output = command.args(&self.arguments).stderr(Stdio::inherit()).output()?;
        ensure!(output.status.success(), "{:?} failed: {}", self.arguments, output.status);
        let text = String::from_utf8(output.stdout)?;
        let line = text.lines().last().context("the process printed nothing")?;
        Ok(serde_json::from_str(line)?)
    }
}

/// Seconds of the phases that count.
pub(crate) fn total(run: &Value) -> f64 {
    let phases = run.as_object().into_iter().flatten();
    phases
        .filter(|(name, _)| *name != crate::task::PREPARE && !name.starts_with('_'))
        .filter_map(|(_, seconds)| seconds.as_f64())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preparation_and_processor_time_do_not_count() {
        let run = serde_json::json!({"prepare": 4.0, "assemble": 1.0, "solve": 2.0, "_cpu": 8.0});
        assert_eq!(total(&run), 3.0);
    }
}
