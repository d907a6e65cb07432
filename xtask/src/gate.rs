//! The test command: everything that guards a merge.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::{reference, tidy};

/// A step that runs cargo.
struct Step {
    name: &'static str,
    arguments: &'static [&'static str],
    environment: &'static [(&'static str, &'static str)],
}

const STEPS: [Step; 5] = [
    Step { name: "format", arguments: &["fmt", "--all", "--", "--check"], environment: &[] },
    Step {
        name: "lints",
        arguments: &["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"],
        environment: &[],
    },
    Step {
        name: "documentation",
        arguments: &["doc", "--workspace", "--no-deps", "--locked"],
        environment: &[("RUSTDOCFLAGS", "-D warnings")],
    },
    Step {
        name: "tests",
        arguments: &["test", "--workspace", "--all-targets", "--locked", "--no-fail-fast"],
        environment: &[],
    },
    Step {
        name: "examples in the documentation",
        arguments: &["test", "--workspace", "--doc", "--locked"],
        environment: &[],
    },
];

/// The dense eigensolver of the system as an oracle: only where there is one.
const LAPACK_STEPS: [Step; 2] = [
    Step {
        name: "lints with LAPACK",
        arguments: &[
            "clippy",
            "--package=fairing-sparse",
            "--features=lapack",
            "--all-targets",
            "--locked",
            "--",
            "-D",
            "warnings",
        ],
        environment: &[],
    },
    Step {
        name: "eigenpairs against LAPACK",
        arguments: &[
            "test",
            "--package=fairing-sparse",
            "--features=lapack",
            "--test=all",
            "--locked",
            "lapack::",
        ],
        environment: &[],
    },
];

/// Runs all steps, also after one has failed; whether none has. Ends with what
/// was skipped and why.
///
/// # Errors
///
/// If cargo cannot be run or the tree cannot be read.
pub fn run(root: &Path) -> Result<bool> {
    let mut failed = vec![];
    if !tidy::run(root)? {
        failed.push("tidy");
    }
    let lapack: &[Step] = if has_openblas() { &LAPACK_STEPS } else { &[] };
    for step in STEPS.iter().chain(lapack) {
        println!("== {}: cargo {}", step.name, step.arguments.join(" "));
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(step.arguments).envs(step.environment.iter().copied()).current_dir(root);
        if !cargo.status().context("running cargo")?.success() {
            failed.push(step.name);
        }
    }
    if reference::path(root, true).is_file() {
        println!("== reference values: cargo xtask reproduce --quick --check");
        let program = std::env::current_exe().context("finding our own program")?;
        let check = Command::new(program).args(["reproduce", "--quick", "--check"]).status();
        if !check.context("running the experiments")?.success() {
            failed.push("reference values");
        }
    }
    for (what, why) in skipped(root) {
        println!("skipped: {what} ({why})");
    }
    match failed.as_slice() {
        [] => println!("All of it passed."),
        names => eprintln!("FAILED: {}", names.join(", ")),
    }
    Ok(failed.is_empty())
}

/// Tests that need what is not here.
fn skipped(root: &Path) -> Vec<(&'static str, &'static str)> {
    let mut skipped = vec![];
    if !reference::path(root, true).is_file() {
        skipped.push(("reference values", "none yet: cargo xtask reproduce --quick --accept"));
    }
    if std::env::var_os("FAIRING_MESHES").is_none() {
        skipped.push(("corpus: every test", "FAIRING_MESHES names no folder of meshes"));
    }
    if !has_openblas() {
        skipped.push(("eigenpairs against LAPACK", "pkg-config finds no openblas"));
    }
    let on_path = |name: &str| {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        std::env::split_paths(&folders).any(|folder| folder.join(name).is_file())
    };
    if !["chromium", "chromium-browser", "google-chrome"].into_iter().any(on_path) {
        skipped.push(("browser: every test", "there is no chromium on the path"));
    }
    skipped
}

/// Whether the feature `lapack` can be linked.
fn has_openblas() -> bool {
    Command::new("pkg-config")
        .args(["--exists", "openblas"])
        .status()
        .is_ok_and(|status| status.success())
}
