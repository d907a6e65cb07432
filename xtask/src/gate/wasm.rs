//! The library crates compile for WebAssembly without their default features.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::programs::cargo;
use crate::web::TARGET;

/// Crates that draw or are programs. All others are libraries for anywhere.
const EXCLUDED: [&str; 11] = [
    "fairing",
    "fairing-figure",
    "pyfairing",
    "fairing-bench",
    "fairing-experiments",
    "fairing-report",
    "fairing-reproduce",
    "fairing-results",
    "fairing-tests",
    "fairing-web",
    "xtask",
];

/// Dependencies that do not compile or work there: blocking threads, random numbers of the
/// operating system, files, C.
const HOSTILE: [&str; 9] = [
    "atomic-wait",
    "cc",
    "flate2",
    "getrandom",
    "mimalloc",
    "openblas-src",
    "tempfile",
    "wasm-bindgen",
    "zip",
];

/// `cargo NAME` of the library crates without their default features.
fn on_libraries(root: &Path, name: &str) -> Command {
    let mut command = cargo(root);
    command.args([name, "--workspace", "--no-default-features", "--locked", "--target", TARGET]);
    for package in EXCLUDED {
        command.args(["--exclude", package]);
    }
    command
}

/// Checks that no library crate depends on a package hostile to WebAssembly; needs no installed
/// target.
pub(super) fn is_free_of_hostile(root: &Path) -> Result<bool> {
    println!("== dependencies for WebAssembly");
    let mut tree = on_libraries(root, "tree");
    let output = tree.args(["--edges=normal,build", "--prefix=none", "--format={p}"]).output();
    let output = output.context("running cargo tree")?;
    if !output.status.success() {
        eprintln!("{}", String::from_utf8_lossy(&output.stderr));
        return Ok(false);
    }
    let found = hostile(&String::from_utf8_lossy(&output.stdout));
    for name in &found {
        eprintln!("{name} does not belong into a library: cargo tree --target {TARGET} -i {name}");
    }
    Ok(found.is_empty())
}

/// The hostile packages of a list, a package a line.
fn hostile(packages: &str) -> Vec<&'static str> {
    let names = || packages.lines().filter_map(|line| line.split_whitespace().next());
    HOSTILE.into_iter().filter(|hostile| names().any(|name| name == *hostile)).collect()
}

/// Checks that the library crates compile.
pub(super) fn compiles(root: &Path) -> Result<bool> {
    println!("== libraries for WebAssembly: cargo check --target {TARGET}");
    let status = on_libraries(root, "check").arg("--lib").status();
    Ok(status.context("running cargo")?.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_packages_are_found_by_their_whole_names() {
        assert_eq!(hostile("rand v0.10.3\ngetrandom v0.4.3\nzip-like v1.0.0\n"), ["getrandom"]);
        assert!(hostile("rand v0.10.3\nrayon v1.0.0 (*)\n").is_empty());
    }
}
