//! Checks by programs that need not be installed: the oldest compiler, the guide, the workflows,
//! dependencies, changes that break users. Nothing is downloaded.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};

/// A check that can run here, or the reason for which it cannot.
pub(super) struct Check {
    pub(super) name: &'static str,
    pub(super) command: Result<Command, String>,
}

/// All checks.
pub(super) fn checks(root: &Path) -> Result<Vec<Check>> {
    let oldest = oldest_compiler(root)?;
    let cargo_plugin = |name: &str, arguments: &[&str]| {
        let program = format!("cargo-{name}");
        let installed = on_path(&program).then(|| {
            let mut command = command(root, "cargo", &[name]);
            command.args(arguments);
            command
        });
        installed.ok_or_else(|| format!("there is no {program} on the path"))
    };
    let program = |name: &str, arguments: &[&str]| {
        let installed = on_path(name).then(|| command(root, name, arguments));
        installed.ok_or_else(|| format!("there is no {name} on the path"))
    };
    let dependencies = ["--offline", "check", "licenses", "bans", "sources"];
    let public = match last_release(root) {
        Some(tag) => cargo_plugin("semver-checks", &["--workspace", "--baseline-rev", &tag]),
        None => Err("there is no release to compare with".to_owned()),
    };
    Ok(vec![
        Check { name: "the oldest compiler", command: with_compiler(root, &oldest) },
        Check { name: "the guide as a book", command: program("mdbook", &["build", "docs/guide"]) },
        Check { name: "workflows", command: program("actionlint", &[]) },
        Check { name: "dependencies", command: cargo_plugin("deny", &dependencies) },
        Check { name: "changes that break users", command: public },
    ])
}

/// Returns true if a folder of the path has a program of this name.
pub(super) fn on_path(name: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&folders).any(|folder| folder.join(&file).is_file())
}

fn command(root: &Path, program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root);
    command
}

/// The version of the oldest compiler that the workspace promises.
fn oldest_compiler(root: &Path) -> Result<String> {
    let text = fs::read_to_string(root.join("Cargo.toml")).context("reading Cargo.toml")?;
    let line = text.lines().find_map(|line| line.trim().strip_prefix("rust-version = "));
    Ok(line.context("Cargo.toml names no rust-version")?.trim_matches('"').to_owned())
}

/// The check of the workspace by the compiler of a version, which is not installed for it.
fn with_compiler(root: &Path, version: &str) -> Result<Command, String> {
    let missing = || format!("not installed: rustup toolchain install {version}");
    let listed = Command::new("rustup").args(["toolchain", "list"]).output();
    let listed = listed.map_err(|_| missing())?.stdout;
    let listed = String::from_utf8_lossy(&listed);
    let names = [format!("{version}-"), format!("{version}.")];
    let found = listed.split_whitespace().find(|line| names.iter().any(|n| line.starts_with(n)));
    let toolchain = found.ok_or_else(missing)?;
    let mut check = command(root, "rustup", &["run", toolchain, "cargo", "check", "--workspace"]);
    check.args(["--locked", "--target-dir", "target/oldest"]);
    Ok(check)
}

/// The tag of the last release.
fn last_release(root: &Path) -> Option<String> {
    let describe = ["describe", "--tags", "--abbrev=0", "--match", "v*"];
    let output = Command::new("git").args(describe).current_dir(root).output().ok()?;
    let tag = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| tag.trim().to_owned())
}
