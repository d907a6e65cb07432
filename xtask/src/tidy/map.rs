//! Consistency of `docs/architecture.md`: named places exist, and all dependencies are named.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use super::manifest::entries;

const MAP: &str = "docs/architecture.md";

/// Top-level folders; a path in the map begins with one of them.
const ROOTS: [&str; 6] = ["crates/", "xtask/", "tests/", "docs/", "data/", "fuzz/"];

fn read(root: &Path) -> Result<String> {
    fs::read_to_string(root.join(MAP)).with_context(|| format!("reading {MAP}"))
}

/// Finds paths that do not exist, and items that are not in the file named after them (`` `Item` in
/// `path` ``).
pub(super) fn places(root: &Path) -> Result<Vec<String>> {
    let map = read(root)?;
    let mut broken = vec![];
    // Pieces between backticks have odd numbers.
    let pieces: Vec<&str> = map.split('`').collect();
    for (i, path) in pieces.iter().enumerate().skip(1).step_by(2) {
        let named = ROOTS.iter().any(|folder| path.starts_with(folder));
        if !named || path.contains(char::is_whitespace) {
            continue;
        }
        if !root.join(path).exists() {
            broken.push(format!("{MAP} names {path}, which is not there"));
            continue;
        }
        let before = pieces[i - 1].split_whitespace().collect::<Vec<_>>();
        if i >= 3 && before == ["in"] && root.join(path).is_file() {
            let item = pieces[i - 2];
            let text = fs::read_to_string(root.join(path))?;
            let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            if !words.into_iter().any(|word| word == item) {
                broken.push(format!("{MAP} names {item} in {path}, which has no such word"));
            }
        }
    }
    Ok(broken)
}

/// Finds dependencies of the workspace that the map does not name.
pub(super) fn dependencies(root: &Path) -> Result<Vec<String>> {
    let manifest = fs::read_to_string(root.join("Cargo.toml")).context("reading Cargo.toml")?;
    let map = read(root)?;
    let section = map.split("\n## ").find(|s| s.starts_with("Dependencies"));
    let section = section.with_context(|| format!("{MAP} has no section on dependencies"))?;
    let foreign =
        entries(&manifest, "workspace.dependencies").filter(|(_, value)| !value.contains("path ="));
    let missing = foreign.filter(|(name, _)| !section.contains(&format!("`{name}`")));
    Ok(missing.map(|(name, _)| format!("{MAP} does not say what {name} is for")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_maps_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir_all(root.join("docs")).unwrap();
        fs::create_dir_all(root.join("crates/a")).unwrap();
        fs::write(root.join("crates/a/b.rs"), "pub fn present() {}").unwrap();
        let check = |text: &str| {
            fs::write(root.join(MAP), text).unwrap();
            places(root).unwrap()
        };
        assert!(check("`present` in `crates/a/b.rs`, `crates/a`").is_empty());
        assert_eq!(check("`absent` in `crates/a/b.rs`").len(), 1);
        assert_eq!(check("see `crates/c.rs`").len(), 1);
        fs::write(root.join("Cargo.toml"), "[workspace.dependencies]\nfoo = \"1\"\nbar = \"1\"\n")
            .unwrap();
        fs::write(root.join(MAP), "# Map\n\n## Dependencies\n\n`foo` is for x.\n").unwrap();
        assert_eq!(dependencies(root).unwrap().len(), 1);
    }
}
