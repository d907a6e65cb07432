//! Builds the tests, runs them, and takes the time of each.

use std::collections::BTreeSet;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use serde_json::Value;

/// The test programs of the workspace, and the time of each test.
#[derive(Default)]
pub(super) struct Tests {
    programs: Vec<Program>,
    times: Vec<(String, f64)>,
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
        let text = |value: &Value| value.as_str().map(str::to_owned);
        if message["reason"] != "compiler-artifact" || message["profile"]["test"] != true {
            return None;
        }
        let executable = text(&message["executable"])?.into();
        let manifest = PathBuf::from(text(&message["manifest_path"])?);
        let folder = manifest.parent().unwrap_or(root).to_path_buf();
        let package = folder.strip_prefix(root).unwrap_or(&folder).display();
        let name = format!("{package} {}", text(&message["target"]["name"])?);
        Some(Self { folder, name, executable })
    }
}

impl Tests {
    /// Compiles all tests of the workspace; returns `true` on success.
    pub(super) fn build(&mut self, root: &Path) -> Result<bool> {
        // Not all targets: that would compile the library for Python again, which has no tests.
        let targets = ["--tests", "--examples"];
        let arguments =
            [&["test", "--workspace"][..], &targets, &["--locked", "--no-run"]].concat();
        println!("== tests: cargo {}", arguments.join(" "));
        let mut cargo = crate::programs::cargo(root);
        cargo.args(arguments).arg("--message-format=json-render-diagnostics");
        let mut child = cargo.stdout(Stdio::piped()).spawn().context("running cargo")?;
        let mut programs = BTreeSet::new();
        for line in BufReader::new(child.stdout.take().context("cargo has no output")?).lines() {
            // Other programs may print between cargo's messages.
            let Ok(message) = serde_json::from_str(&line?) else { continue };
            programs.extend(Program::new(root, &message));
        }
        self.programs = programs.into_iter().collect();
        Ok(child.wait()?.success())
    }

    /// Runs every test program, even after a failure; returns `true` if none failed.
    pub(super) fn run(&mut self, root: &Path) -> Result<bool> {
        let mut passed = true;
        let times = root.join("target/test-times.txt");
        std::fs::write(&times, "").context("making a file for the times")?;
        for program in &self.programs {
            println!("== {}", program.name);
            std::io::stdout().flush()?;
            let mut command = Command::new(&program.executable);
            command.current_dir(&program.folder).env("CARGO_MANIFEST_DIR", &program.folder);
            command.env(TIMES, &times);
            // The standard test harness reports times only where unstable options
            // are allowed; nothing is compiled under this setting.
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
                if let Some((test, seconds)) = timed_line(&line) {
                    self.times.push((format!("{} {test}", program.name), seconds));
                }
            }
            passed &= child.wait()?.success();
        }
        let written = std::fs::read_to_string(&times).unwrap_or_default();
        self.times.extend(written.lines().filter_map(|line| {
            let (name, seconds) = line.rsplit_once(' ')?;
            Some((name.to_string(), seconds.parse().ok()?))
        }));
        self.times.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(passed)
    }

    /// The slowest tests and their seconds.
    pub(super) fn slowest(&self, count: usize) -> &[(String, f64)] {
        &self.times[..count.min(self.times.len())]
    }
}

/// Names a file to which tests with a harness of their own add a line each:
/// the name and the seconds.
const TIMES: &str = "FAIRING_TEST_TIMES";

/// The test and its seconds from `test name ... ok <1.234s>`.
fn timed_line(line: &str) -> Option<(&str, f64)> {
    let (name, rest) = line.strip_prefix("test ")?.split_once(" ... ")?;
    let (_, time) = rest.split_once('<')?;
    Some((name, time.strip_suffix("s>")?.parse().ok()?))
}

#[cfg(test)]
mod checks {
    use super::*;

    #[test]
    fn times_are_read_from_the_lines_of_the_harness() {
        assert_eq!(timed_line("test io::obj ... ok <1.250s>"), Some(("io::obj", 1.25)));
        assert_eq!(timed_line("test io::obj ... FAILED <0.001s>"), Some(("io::obj", 0.001)));
        assert_eq!(timed_line("test io::obj ... ok"), None);
        assert_eq!(timed_line("running 3 tests"), None);
    }
}
