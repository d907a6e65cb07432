//! Code shared by the tests in `tests/tests`.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Builds the program `fairing` with the features with which the tests have built its crates, and
/// returns its path.
///
/// # Panics
///
/// If cargo cannot build it.
pub fn program() -> PathBuf {
    let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build.args(["build", "--quiet", "--bin=fairing", "--message-format=json"]);
    // The root's default members, for the same features.
    build.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    let output = build.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let messages = String::from_utf8_lossy(&output.stdout);
    let executable = messages.lines().find_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        let named = message["target"]["name"] == "fairing";
        message["executable"].as_str().filter(|_| named).map(PathBuf::from)
    });
    executable.expect("cargo names the program")
}

/// The examples of the README, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The programs of the guide, likewise.
#[cfg(doctest)]
#[doc = include_str!("../../docs/guide/src/choosing.md")]
#[doc = include_str!("../../docs/guide/src/coming.md")]
#[doc = include_str!("../../docs/guide/src/curvature.md")]
#[doc = include_str!("../../docs/guide/src/denoising.md")]
#[doc = include_str!("../../docs/guide/src/distances.md")]
#[doc = include_str!("../../docs/guide/src/repair.md")]
#[doc = include_str!("../../docs/guide/src/laplacian.md")]
#[doc = include_str!("../../docs/guide/src/mesh.md")]
#[doc = include_str!("../../docs/guide/src/smoothing.md")]
#[doc = include_str!("../../docs/guide/src/spectrum.md")]
#[doc = include_str!("../../docs/guide/src/start.md")]
#[doc = include_str!("../../docs/guide/src/troubleshooting.md")]
pub struct Guide;
