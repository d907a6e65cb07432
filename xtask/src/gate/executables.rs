//! Builds the tests, runs them, and takes the time of each.

use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use serde_json::Value;

use crate::programs::cargo;

/// Names a file to which tests with a harness of their own add a line each: the name and the
/// seconds.
const TIMES: &str = "FAIRING_TEST_TIMES";

/// The test programs of the workspace, and the results of their tests.
#[derive(Default)]
pub(super) struct Tests {
    programs: BTreeSet<Program>,
    /// The name and the seconds of each test, the slowest first.
    pub(super) times: Vec<(String, f64)>,
    /// The names of the tests that failed.
    pub(super) failed: Vec<String>,
}

#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Program {
    /// The folder of the package, where its tests run.
    folder: PathBuf,
    /// The package and the target.
    name: String,
    executable: PathBuf,
}

impl Program {
    /// The test program in a message of cargo.
    fn new(root: &Path, message: &Value) -> Option<Self> {
        if message["reason"] != "compiler-artifact" || message["profile"]["test"] != true {
            return None;
        }
        let executable = message["executable"].as_str()?.into();
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?.to_path_buf();
        let package = folder.strip_prefix(root).unwrap_or(&folder).display();
        let name = format!("{package} {}", message["target"]["name"].as_str()?);
        Some(Self { folder, name, executable })
    }
}

impl Tests {
    /// Compiles all tests of the workspace; returns `true` on success.
    pub(super) fn build(&mut self, root: &Path) -> Result<bool> {
        let mut cargo = cargo(root);
        // Not all targets: that would compile the library for Python again, which has no tests.
        cargo.args(["test", "--workspace", "--tests", "--examples", "--locked", "--no-run"]);
        cargo.arg("--message-format=json-render-diagnostics").stdout(Stdio::piped());
        let mut child = cargo.spawn().context("running cargo")?;
        for line in BufReader::new(child.stdout.take().context("cargo has no output")?).lines() {
            // Other programs may print between cargo's messages.
            let Ok(message) = serde_json::from_str(&line?) else { continue };
            self.programs.extend(Program::new(root, &message));
        }
        Ok(child.wait()?.success())
    }

    /// Runs every test program, even after a failure; returns `true` if none failed.
    pub(super) fn run(&mut self, root: &Path) -> Result<bool> {
        let mut passed = true;
        let times = root.join("target/test-times.txt");
        fs::write(&times, "").context("making a file for the times")?;
        for program in &self.programs {
            println!("== {}", program.name);
            std::io::stdout().flush()?;
            let mut command = Command::new(&program.executable);
            command.current_dir(&program.folder).env("CARGO_MANIFEST_DIR", &program.folder);
            command.env(TIMES, &times);
            // The standard harness reports times only where unstable options are allowed; nothing
            // is compiled under this setting.
            let timed = ["-Zunstable-options", "--report-time"];
            let mut probe = Command::new(&program.executable);
            probe.env("RUSTC_BOOTSTRAP", "1").args(timed).arg("--list");
            if probe.output().is_ok_and(|output| output.status.success()) {
                command.env("RUSTC_BOOTSTRAP", "1").args(timed);
            }
            let mut child = command.stdout(Stdio::piped()).spawn()?;
            let output = BufReader::new(child.stdout.take().context("a test has no output")?);
            for line in output.split(b'\n') {
                let line = String::from_utf8_lossy(&line?).into_owned();
                println!("{line}");
                if let Some((test, result)) = result(&line) {
                    let name = format!("{} {test}", program.name);
                    self.failed.extend(result.starts_with("FAILED").then(|| name.clone()));
                    self.times.extend(seconds(result).map(|seconds| (name, seconds)));
                }
            }
            passed &= child.wait()?.success();
        }
        let written = fs::read_to_string(&times).unwrap_or_default();
        self.times.extend(written.lines().filter_map(|line| {
            let (name, seconds) = line.rsplit_once(' ')?;
            Some((name.to_owned(), seconds.parse().ok()?))
        }));
        self.times.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(passed)
    }
}

/// The test and its result from a line such as `test name ... ok <1.234s>`.
fn result(line: &str) -> Option<(&str, &str)> {
    line.strip_prefix("test ")?.split_once(" ... ")
}

/// The seconds in a result.
fn seconds(result: &str) -> Option<f64> {
    result.split_once('<')?.1.strip_suffix("s>")?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_read_from_the_lines_of_the_harness() {
        let (test, outcome) = result("test io::obj ... FAILED <1.250s>").unwrap();
        assert_eq!((test, outcome, seconds(outcome)), ("io::obj", "FAILED <1.250s>", Some(1.25)));
        assert_eq!(result("test io::obj ... ok").and_then(|(_, result)| seconds(result)), None);
        assert_eq!(result("running 3 tests"), None);
    }
}
