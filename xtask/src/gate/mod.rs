//! The test command: everything that guards a merge.

mod executables;
mod tools;
mod wasm;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context as _, Result};

use crate::programs::{Program, cargo};
use crate::python::Extent;
use crate::web::is_installed;
use crate::{python, tidy};
use executables::Tests;
use tools::on_path;

/// The reference values of quick runs, from the root.
const REFERENCE: &str = "docs/reference/quick.json";

/// A step that runs cargo.
struct Step {
    name: &'static str,
    arguments: &'static [&'static str],
    environment: &'static [(&'static str, &'static str)],
}

const FORMAT: Step =
    Step { name: "format", arguments: &["fmt", "--all", "--", "--check"], environment: &[] };
const LINTS: Step = Step {
    name: "lints",
    arguments: &["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"],
    environment: &[],
};
const DOCUMENTATION: Step = Step {
    name: "documentation",
    arguments: &["doc", "--workspace", "--no-deps", "--locked"],
    environment: &[("RUSTDOCFLAGS", "-D warnings")],
};
/// The tests of the command line run the programs, those of the Python package load its library.
const PROGRAMS: Step = Step {
    name: "building the programs",
    arguments: &["build", "--workspace", "--bins", "--lib", "--locked"],
    environment: &[],
};
const EXAMPLES: Step = Step {
    name: "examples in the documentation",
    arguments: &["test", "--workspace", "--doc", "--locked", "--no-fail-fast"],
    environment: &[],
};

/// The number of slowest tests that are listed.
const NAMED: usize = 10;

/// The steps run so far, and those that failed.
#[derive(Default)]
struct Log {
    steps: Vec<(&'static str, f64)>,
    failed: Vec<&'static str>,
}

impl Log {
    /// Runs a step and takes its time; it has failed unless it says `true`.
    fn step(&mut self, name: &'static str, run: impl FnOnce() -> Result<bool>) -> Result<()> {
        let start = Instant::now();
        if !run()? {
            self.failed.push(name);
        }
        self.steps.push((name, start.elapsed().as_secs_f64()));
        Ok(())
    }

    fn cargo(&mut self, root: &Path, step: &Step) -> Result<()> {
        self.step(step.name, || {
            println!("== {}: cargo {}", step.name, step.arguments.join(" "));
            let mut cargo = cargo(root);
            cargo.args(step.arguments).envs(step.environment.iter().copied());
            Ok(cargo.status().context("running cargo")?.success())
        })
    }
}

/// Runs all steps, even after a failure; returns `true` if none failed. Prints the time of each
/// step, the slowest tests, and the skipped tests with the reason.
pub(crate) fn run(root: &Path, whole_python: bool) -> Result<bool> {
    let mut log = Log::default();
    log.step("tidy", || tidy::run(root))?;
    log.cargo(root, &FORMAT)?;
    log.cargo(root, &LINTS)?;
    log.cargo(root, &DOCUMENTATION)?;
    log.step("dependencies for WebAssembly", || wasm::is_free_of_hostile(root))?;
    if is_installed() {
        log.step("libraries for WebAssembly", || wasm::compiles(root))?;
    }
    let mut tests = Tests::default();
    log.step("building the tests", || tests.build(root))?;
    log.cargo(root, &PROGRAMS)?;
    // Tests in the browser open the page of this run.
    if root.join(REFERENCE).is_file() {
        log.step("reference values", || reproduces(root, &["--quick", "--check"]))?;
        log.step("a second report, from what the first has kept", || {
            reproduces(root, &["--quick"])
        })?;
    }
    log.step("tests", || tests.run(root))?;
    log.cargo(root, &EXAMPLES)?;
    log.step("features that are off", || optional_features(root))?;
    let mut without_python = vec![];
    log.step("the Python package", || {
        let extent = if whole_python { Extent::Whole } else { Extent::Quick };
        println!("== the Python package: pytest in target/python");
        let tested = python::test(root, extent)?;
        without_python = tested.skipped;
        Ok(tested.passed)
    })?;
    let mut missing = vec![];
    for tools::Check { name, command } in tools::checks(root)? {
        match command {
            Ok(mut command) => log.step(name, || {
                println!("== {name}: {command:?}");
                Ok(command.status().with_context(|| format!("running {command:?}"))?.success())
            })?,
            Err(reason) => missing.push((name, reason)),
        }
    }
    print_times("== times", log.steps.iter().copied());
    print_times("== the slowest tests", tests.slowest(NAMED).iter().map(|(name, s)| (name, *s)));
    for (what, why) in skipped(root) {
        println!("skipped: {what} ({why})");
    }
    for (what, why) in missing {
        println!("skipped: {what} ({why})");
    }
    for (what, why) in without_python {
        println!("skipped: {what} ({why})");
    }
    match log.failed.as_slice() {
        [] => println!("All of it passed."),
        names => eprintln!("FAILED: {}", names.join(", ")),
    }
    Ok(log.failed.is_empty())
}

/// Tests what is behind features that are off: meshes and matrices of other crates, and, where the
/// system has one, LAPACK as an oracle of eigenpairs.
fn optional_features(root: &Path) -> Result<bool> {
    let mut features = "nalgebra,parry3d,ply-rs,tobj,faer".to_owned();
    if has_openblas() {
        features += ",lapack";
    }
    println!("== features that are off: {features}");
    let mut cargo = cargo(root);
    cargo.args(["test", "--package=fairing-mesh", "--package=fairing-sparse", "--locked"]);
    cargo
        .arg("--profile=oracles")
        .arg(format!("--features={features}"))
        .args(["--", "conver", "lapack::"]);
    Ok(cargo.status().context("running cargo")?.success())
}

fn print_times<Name: std::fmt::Display>(title: &str, times: impl IntoIterator<Item = (Name, f64)>) {
    println!("{title}");
    for (name, seconds) in times {
        println!("{seconds:8.1} s  {name}");
    }
}

/// Returns true if `cargo xtask reproduce` with these options writes a report.
fn reproduces(root: &Path, options: &[&str]) -> Result<bool> {
    let out = root.join("target/quick-report");
    println!("== cargo xtask reproduce {} --out {}", options.join(" "), out.display());
    let mut reproduce = Program::Reproduce.command()?;
    // The generated meshes, which the reference values are of.
    reproduce.env_remove("FAIRING_MESHES").current_dir(root);
    reproduce.arg("reproduce").args(options).arg("--out").arg(&out);
    Ok(reproduce.status().context("running the experiments")?.success())
}

/// Tests that are skipped, with the reason.
fn skipped(root: &Path) -> Vec<(&'static str, &'static str)> {
    let mut skipped = vec![];
    if !root.join(REFERENCE).is_file() {
        skipped.push(("reference values", "none yet: cargo xtask reproduce --quick --accept"));
    }
    if std::env::var_os("FAIRING_MESHES").is_none_or(|name| name.is_empty()) {
        skipped.push(("corpus: every test", "FAIRING_MESHES names no folder of meshes"));
    }
    if !has_openblas() {
        skipped.push(("eigenpairs against LAPACK", "pkg-config finds no openblas"));
    }
    if !is_installed() {
        skipped.push((
            "libraries for WebAssembly",
            "not installed: rustup target add wasm32-unknown-unknown",
        ));
    }
    if !on_path("qemu-x86_64") {
        skipped.push(("emulation: every test", "there is no qemu-x86_64 on the path"));
    }
    if !on_path("node") {
        skipped.push(("the module for browsers: every test", "there is no node on the path"));
    }
    if !on_path("valgrind") {
        skipped.push(("instructions: every test", "there is no valgrind on the path"));
    }
    if !["chromium", "chromium-browser", "google-chrome"].into_iter().any(on_path) {
        skipped.push(("browser: every test", "there is no chromium on the path"));
    }
    skipped
}

/// Returns true if the feature `lapack` can be linked.
fn has_openblas() -> bool {
    Command::new("pkg-config")
        .args(["--exists", "openblas"])
        .status()
        .is_ok_and(|status| status.success())
}
