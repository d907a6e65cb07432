//! Consistency of the README with the repository.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::tasks::TASKS;

/// Finds tasks in the README that do not exist, broken links, and Rust examples that no doc test
/// compiles.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let path = root.join("README.md");
    if !path.exists() {
        return Ok(vec!["there is no README.md".into()]);
    }
    let text = fs::read_to_string(path).context("reading README.md")?;
    let mut broken = unknown_tasks(&text);
    broken.extend(broken_links(root, &text));
    // The tests include the README in their documentation, which makes its examples doc tests.
    let tests = fs::read_to_string(root.join("tests/src/lib.rs"))?;
    if text.contains("```rust") && !tests.contains("README.md") {
        broken.push("the tests do not run the README's example as a doc test".into());
    }
    Ok(broken)
}

/// Finds `cargo xtask NAME` without a task of that name.
fn unknown_tasks(text: &str) -> Vec<String> {
    let names = text.split("cargo xtask ").skip(1).filter_map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(rest.len());
        Some(&rest[..end]).filter(|name| !name.is_empty())
    });
    let unknown = names.filter(|name| TASKS.iter().all(|task| task.0 != *name));
    unknown.map(|name| format!("there is no `cargo xtask {name}`")).collect()
}

/// Finds relative links and pictures without a target.
fn broken_links(root: &Path, text: &str) -> Vec<String> {
    let targets = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    let relative = targets.filter(|t| !t.contains("://") && !t.starts_with('#') && !t.is_empty());
    let files = relative.map(|t| t.split('#').next().unwrap_or(t));
    files
        .filter(|t| !root.join(t).exists())
        .map(|t| format!("README.md links to {t}, which is not there"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_must_exist() {
        let unknown = |text: &str| unknown_tasks(text).len();
        assert_eq!(unknown("`cargo xtask reproduce --quick --only q1`"), 0);
        assert_eq!(unknown("`cargo xtask reprodce`"), 1);
        assert_eq!(unknown("    cargo xtask tity\n"), 1);
    }
}
