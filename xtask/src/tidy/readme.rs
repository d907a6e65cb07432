//! Consistency of the README and the guide with the repository.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::tasks::TASKS;

const GUIDE: &str = "docs/guide/src";

/// Finds tasks in the README and the guide that do not exist, broken links, Rust examples that no
/// doc test compiles, and pages that the guide's summary does not name.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let mut pages = vec!["README.md".to_owned()];
    for entry in fs::read_dir(root.join(GUIDE)).with_context(|| format!("reading {GUIDE}"))? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            pages.push(format!("{GUIDE}/{name}"));
        }
    }
    pages.sort();
    // The tests include these pages in their documentation, which makes their examples doc tests.
    let tests = fs::read_to_string(root.join("tests/src/lib.rs"))?;
    let summary = fs::read_to_string(root.join(GUIDE).join("SUMMARY.md"))?;
    let mut broken = vec![];
    for page in &pages {
        let path = root.join(page);
        let text = fs::read_to_string(&path).with_context(|| format!("reading {page}"))?;
        let (folder, name) = page.rsplit_once('/').unwrap_or(("", page));
        let mut found = unknown_tasks(&text);
        found.extend(broken_links(&root.join(folder), &text));
        if text.contains("```rust") && !tests.contains(&format!("/{page}\")")) {
            found.push("tests/src/lib.rs does not run its examples as doc tests".into());
        }
        if folder == GUIDE && name != "SUMMARY.md" && !summary.contains(&format!("]({name})")) {
            found.push("SUMMARY.md does not name it".into());
        }
        broken.extend(found.into_iter().map(|what| format!("{page}: {what}")));
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

/// Finds relative links and pictures of a page in a folder without a target.
fn broken_links(folder: &Path, text: &str) -> Vec<String> {
    let targets = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    let relative = targets.filter(|t| !t.contains("://") && !t.starts_with('#') && !t.is_empty());
    let files = relative.map(|t| t.split('#').next().unwrap_or(t));
    files
        .filter(|t| !folder.join(t).exists())
        .map(|t| format!("links to {t}, which is not there"))
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
