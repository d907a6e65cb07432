//! The test command: everything that guards a merge.

mod executables;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::Result;

use crate::programs::{REPRODUCE, cargo, on_path, succeeds};
use crate::python::Extent;
use crate::{python, tidy};
use executables::Tests;

/// Workspaces of their own, whose format is checked too.
const OTHER_WORKSPACES: [&str; 2] = ["fuzz", "study"];

/// Checks by programs that need not be installed: the name, the program, and its arguments.
const TOOLS: [(&str, &str, &[&str]); 3] = [
    ("dependencies", "cargo-deny", &["--offline", "check", "licenses", "bans", "sources"]),
    ("the guide as a book", "mdbook", &["build", "docs/guide"]),
    ("workflows", "actionlint", &[]),
];

/// Tests that need a program, by any of its names; they skip themselves where it is absent.
const NEEDED: [(&str, &[&str]); 4] = [
    ("emulation", &["qemu-x86_64"]),
    ("the module for browsers", &["node"]),
    ("instructions", &["valgrind"]),
    ("browser", &["chromium", "chromium-browser", "google-chrome"]),
];

/// The number of slowest tests that are listed.
const NAMED: usize = 10;

/// The steps run so far, those that failed, and what was skipped.
#[derive(Default)]
struct Log {
    steps: Vec<(String, f64)>,
    failed: Vec<String>,
    skipped: Vec<(String, String)>,
}

impl Log {
    /// Runs a step and takes its time; it has failed unless it returns `true`.
    fn step(&mut self, name: &str, run: impl FnOnce() -> Result<bool>) {
        println!("== {name}");
        let start = Instant::now();
        let passed = run().unwrap_or_else(|error| {
            eprintln!("error: {error:#}");
            false
        });
        if !passed {
            self.failed.push(name.to_owned());
        }
        self.steps.push((name.to_owned(), start.elapsed().as_secs_f64()));
    }

    /// Runs a command as a step.
    fn command(&mut self, name: &str, command: &mut Command) {
        self.step(name, || {
            let program = Path::new(command.get_program()).file_name().unwrap_or_default();
            let words = [program].into_iter().chain(command.get_args());
            println!("{}", words.map(|word| format!("{} ", word.display())).collect::<String>());
            succeeds(command)
        });
    }

    fn skip(&mut self, what: impl Into<String>, reason: impl Into<String>) {
        self.skipped.push((what.into(), reason.into()));
    }

    /// Prints times, skips and failures; returns `true` if nothing failed.
    fn close(self, tests: &Tests) -> bool {
        let list = |title: &str, times: &[(String, f64)]| {
            println!("== {title}");
            times.iter().for_each(|(name, seconds)| println!("{seconds:8.1} s  {name}"));
        };
        list("times", &self.steps);
        list("the slowest tests", &tests.times[..NAMED.min(tests.times.len())]);
        for (what, why) in &self.skipped {
            println!("skipped: {what} ({why})");
        }
        for name in &tests.failed {
            eprintln!("FAILED: {name}");
        }
        if self.failed.is_empty() {
            println!("All of it passed.");
        } else {
            eprintln!("FAILED: {}", self.failed.join(", "));
        }
        self.failed.is_empty()
    }
}

/// Runs all steps, even after a failure; returns `true` if none failed. Prints the time of each
/// step, the slowest tests, the skipped tests with the reason, and the tests that failed.
pub(crate) fn run(root: &Path, extent: Extent) -> Result<bool> {
    let mut log = Log::default();
    let mut tests = Tests::default();
    log.step("tidy", || tidy::run(root));
    check(&mut log, root);
    log.step("building the tests", || tests.build(root));
    // The tests of the command line run the programs, those of the Python package load its library.
    let programs = ["build", "--workspace", "--bins", "--lib", "--locked"];
    log.command("building the programs", cargo(root).args(programs));
    // Tests in the browser open the page of this run.
    log.command("reference values", reproduce(root)?.arg("--check"));
    log.command("a second report, from what the first has kept", &mut reproduce(root)?);
    log.step("tests", || tests.run(root));
    let examples = ["test", "--workspace", "--doc", "--locked", "--no-fail-fast"];
    log.command("examples in the documentation", cargo(root).args(examples));
    optional_features(&mut log, root);
    let mut skipped = vec![];
    log.step("the Python package", || python::test(root, extent, &mut skipped));
    log.skipped.append(&mut skipped);
    for (name, program, arguments) in TOOLS {
        if !on_path(program) {
            log.skip(name, format!("there is no {program} on the path"));
            continue;
        }
        log.command(name, Command::new(program).args(arguments).current_dir(root));
    }
    if std::env::var_os("FAIRING_MESHES").is_none_or(|name| name.is_empty()) {
        log.skip("corpus: every test", "FAIRING_MESHES names no folder of meshes");
    }
    for (name, programs) in NEEDED {
        if !programs.iter().any(|program| on_path(program)) {
            let reason = format!("there is no {} on the path", programs[0]);
            log.skip(format!("{name}: every test"), reason);
        }
    }
    Ok(log.close(&tests))
}

/// Format, lints and documentation.
fn check(log: &mut Log, root: &Path) {
    log.command("format", cargo(root).args(["fmt", "--all", "--", "--check"]));
    for folder in OTHER_WORKSPACES {
        let manifest = format!("{folder}/Cargo.toml");
        let format = ["fmt", "--manifest-path", &manifest, "--", "--check"];
        log.command(&format!("format of {folder}"), cargo(root).args(format));
    }
    let lints = ["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"];
    log.command("lints", cargo(root).args(lints));
    let documentation = ["doc", "--workspace", "--no-deps", "--locked"];
    let mut cargo_doc = cargo(root);
    cargo_doc.args(documentation).env("RUSTDOCFLAGS", "-D warnings");
    log.command("documentation", &mut cargo_doc);
}

/// Quick experiments on the generated meshes, which the reference values are of.
fn reproduce(root: &Path) -> Result<Command> {
    let mut reproduce = Command::new(REPRODUCE.path()?);
    reproduce.current_dir(root).env_remove("FAIRING_MESHES");
    reproduce.args(["reproduce", "--quick", "--out"]).arg(root.join("target/quick-report"));
    Ok(reproduce)
}

/// Tests what is behind features that are off: meshes and matrices of other crates, and, where the
/// system has one, LAPACK as an oracle of eigenpairs.
fn optional_features(log: &mut Log, root: &Path) {
    let mut features = "--features=nalgebra,parry3d,ply-rs,tobj,faer".to_owned();
    let openblas = Command::new("pkg-config").args(["--exists", "openblas"]).status();
    if openblas.is_ok_and(|status| status.success()) {
        features += ",lapack";
    } else {
        log.skip("eigenpairs against LAPACK", "pkg-config finds no openblas");
    }
    let mut cargo = cargo(root);
    cargo.args(["test", "--package=fairing-mesh", "--package=fairing-sparse", "--locked"]);
    cargo.args(["--profile=oracles", &features, "--", "conver", "lapack::"]);
    log.command("features that are off", &mut cargo);
}
