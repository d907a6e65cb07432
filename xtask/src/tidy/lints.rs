//! Every crate has the lints of the workspace, including the one on the length of functions.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use super::manifest::entries;
use crate::packages;

/// Finds lints of the workspace that a crate lacks.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let workspace = read(&root.join("Cargo.toml"))?;
    let wanted: Vec<&str> =
        entries(&workspace, "workspace.lints.clippy").map(|(name, _)| name).collect();
    if wanted.is_empty() {
        return Ok(vec!["Cargo.toml has no workspace.lints.clippy".into()]);
    }
    let mut found = vec![];
    for package in packages::read(root)? {
        let manifest = read(&package.manifest_path)?;
        let missing = missing(&manifest, &wanted);
        found.extend(missing.map(|lint| format!("{} without {lint}", package.name)));
    }
    Ok(found)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))
}

/// The lints that a manifest neither inherits nor lists.
fn missing<'a>(manifest: &'a str, wanted: &'a [&str]) -> impl Iterator<Item = &'a str> {
    let inherits = entries(manifest, "lints").any(|entry| entry == ("workspace", "true"));
    let has = move |name: &str| inherits || entries(manifest, "lints.clippy").any(|e| e.0 == name);
    wanted.iter().copied().filter(move |name| !has(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lints_are_inherited_or_listed() {
        let found = |manifest: &str| missing(manifest, &["all", "too_many_lines"]).count();
        assert_eq!(found("[lints]\nworkspace = true\n"), 0);
        assert_eq!(found("[lints.clippy]\nall = 1\ntoo_many_lines = 1\n"), 0);
        assert_eq!(found("[lints.clippy]\nall = 1\n"), 1);
        assert_eq!(found("[package]\nname = 1\n"), 2);
    }
}
