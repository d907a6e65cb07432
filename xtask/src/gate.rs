//! The test command: everything that guards a merge.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::tidy;

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
    for step in &STEPS {
        println!("== {}: cargo {}", step.name, step.arguments.join(" "));
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(step.arguments).envs(step.environment.iter().copied()).current_dir(root);
        if !cargo.status().context("running cargo")?.success() {
            failed.push(step.name);
        }
    }
    for (what, why) in skipped() {
        println!("skipped: {what} ({why})");
    }
    match failed.as_slice() {
        [] => println!("All of it passed."),
        names => eprintln!("FAILED: {}", names.join(", ")),
    }
    Ok(failed.is_empty())
}

/// Tests that need what is not here.
fn skipped() -> Vec<(&'static str, &'static str)> {
    let mut skipped = vec![];
    if std::env::var_os("FAIRING_MESHES").is_none() {
        skipped.push(("corpus: every test", "FAIRING_MESHES names no folder of meshes"));
    }
    skipped
}
