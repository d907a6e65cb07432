//! Every crate has the lints of the workspace, among them that on the length of functions.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use toml::Table;

use super::packages;

/// Lints of the workspace that a crate does not have.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let workspace = manifest(&root.join("Cargo.toml"))?;
    let Some(wanted) = table(&workspace, &["workspace", "lints", "clippy"]) else {
        return Ok(vec!["Cargo.toml has no workspace.lints.clippy".into()]);
    };
    let mut found = vec![];
    for package in packages::read(root)? {
        let manifest = manifest(&package.manifest_path)?;
        found.extend(
            missing(&manifest, wanted).map(|lint| format!("{} without {lint}", package.name)),
        );
    }
    Ok(found)
}

fn manifest(path: &Path) -> Result<Table> {
    let text = fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))?;
    text.parse().with_context(|| format!("reading {}", path.display()))
}

fn table<'a>(from: &'a Table, path: &[&str]) -> Option<&'a Table> {
    path.iter().try_fold(from, |table, name| table.get(*name)?.as_table())
}

/// The lints that a manifest neither inherits nor lists.
fn missing<'a>(manifest: &'a Table, wanted: &'a Table) -> impl Iterator<Item = &'a str> {
    let lints = table(manifest, &["lints"]);
    let inherits = lints.is_some_and(|lints| lints.get("workspace") == Some(&true.into()));
    let own = table(manifest, &["lints", "clippy"]);
    let has = move |name: &str| inherits || own.is_some_and(|own| own.contains_key(name));
    wanted.keys().map(String::as_str).filter(move |name| !has(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lints_are_inherited_or_listed() {
        let wanted: Table = "all = 1\ntoo_many_lines = 1\n".parse().unwrap();
        let found = |manifest: &str| missing(&manifest.parse().unwrap(), &wanted).count();
        assert_eq!(found("[lints]\nworkspace = true\n"), 0);
        assert_eq!(found("[lints.clippy]\nall = 1\ntoo_many_lines = 1\n"), 0);
        assert_eq!(found("[lints.clippy]\nall = 1\n"), 1);
        assert_eq!(found("[package]\nname = 1\n"), 2);
    }
}
