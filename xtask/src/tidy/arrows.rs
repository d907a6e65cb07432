//! Which crate may use which.

use std::path::Path;

use anyhow::{Context as _, Result};
use cargo_metadata::{DependencyKind, MetadataCommand};

/// For each library crate, the crates of ours that it may use. The façade,
/// `xtask` and the tests may use everything.
const ARROWS: [(&str, &[&str]); 7] = [
    ("fairing-mesh", &[]),
    ("fairing-sparse", &[]),
    ("fairing-operators", &["fairing-mesh", "fairing-sparse"]),
    ("fairing-spectral", &["fairing-mesh", "fairing-sparse", "fairing-operators"]),
    (
        "fairing-smoothing",
        &["fairing-mesh", "fairing-sparse", "fairing-operators", "fairing-spectral"],
    ),
    ("fairing-evaluation", &["fairing-mesh", "fairing-operators"]),
    ("fairing-figure", &["fairing-mesh"]),
];

/// Crates that see everything.
const FREE: [&str; 3] = ["fairing", "xtask", "fairing-tests"];

/// Dependencies that no arrow allows. What only tests of a crate use is free.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let mut command = MetadataCommand::new();
    command.manifest_path(root.join("Cargo.toml")).no_deps();
    let metadata = command.exec().context("asking cargo for the dependencies")?;
    let ours: Vec<&str> = metadata.packages.iter().map(|p| p.name.as_str()).collect();
    let mut broken = vec![];
    for package in &metadata.packages {
        let name = package.name.as_str();
        if FREE.contains(&name) {
            continue;
        }
        let Some((_, allowed)) = ARROWS.iter().find(|(n, _)| *n == name) else {
            broken.push(format!("{name} has no place among the arrows"));
            continue;
        };
        for dependency in
            package.dependencies.iter().filter(|d| d.kind != DependencyKind::Development)
        {
            let used = dependency.name.as_str();
            if ours.contains(&used) && !allowed.contains(&used) {
                broken.push(format!("{name} uses {used}"));
            }
        }
    }
    Ok(broken)
}
