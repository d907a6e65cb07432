//! Unused dependencies.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::packages;

/// Finds dependencies that no source file of their package names: `src` counts for dependencies of
/// the library and the programs; tests, examples, benches and the README, whose example is a doc
/// test, also for dev-dependencies; `build.rs` for build dependencies.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let mut unused = vec![];
    for package in packages::read(root)? {
        let folder = package.manifest_path.parent().unwrap_or(root);
        let mut own = String::new();
        append(&folder.join("src"), &mut own)?;
        let mut all = own.clone();
        for more in ["tests", "examples", "benches"] {
            append(&folder.join(more), &mut all)?;
        }
        all.push_str(&fs::read_to_string(folder.join("README.md")).unwrap_or_default());
        let script = fs::read_to_string(folder.join("build.rs")).unwrap_or_default();
        for dependency in package.dependencies {
            let text = match dependency.kind.as_deref() {
                Some("dev") => &all,
                Some("build") => &script,
                _ => &own,
            };
            let name = dependency.rename.as_ref().unwrap_or(&dependency.name).replace('-', "_");
            if !mentions(text, &name) {
                unused.push(format!("{} does not use {}", package.name, dependency.name));
            }
        }
    }
    Ok(unused)
}

/// Appends the text of all Rust files below a folder, if it exists.
fn append(folder: &Path, text: &mut String) -> Result<()> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            append(&path, text)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            let file = fs::read_to_string(&path);
            text.push_str(&file.with_context(|| format!("reading {}", path.display()))?);
        }
    }
    Ok(())
}

/// Returns true if the text contains the name as a separate word.
fn mentions(text: &str, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(name)
        .any(|(at, _)| !text[..at].ends_with(word) && !text[at + name.len()..].starts_with(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_a_whole_word() {
        assert!(mentions("use serde::Deserialize;", "serde"));
        assert!(mentions("#[derive(serde::Serialize)]", "serde"));
        assert!(!mentions("use serde_json::Value;", "serde"));
        assert!(!mentions("use my_serde::Value;", "serde"));
    }
}
