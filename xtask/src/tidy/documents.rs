//! Names in the Markdown of the repository: links, paths, items and tasks exist.

use std::path::Path;

use super::tree::Tree;
use crate::tasks::TASKS;

/// Folders of the root at which a path between backticks begins.
const ROOTS: [&str; 8] =
    ["crates/", "data/", "docs/", "fuzz/", "python/", "study/", "tests/", "xtask/"];

/// Finds names of things that do not exist, except in generated documents.
pub(super) fn check(tree: &Tree) -> Vec<String> {
    let mut broken = vec![];
    for (path, text) in &tree.texts {
        if path.extension().is_none_or(|e| e != "md") || path.starts_with("docs/report") {
            continue;
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut names = broken_links(&tree.root.join(folder), text);
        names.extend(unknown_tasks(text));
        names.extend(missing_places(tree, text));
        broken.extend(names.into_iter().map(|name| format!("{}: no {name}", path.display())));
    }
    broken
}

/// The tasks in `cargo xtask NAME` that do not exist.
fn unknown_tasks(text: &str) -> Vec<String> {
    let names = text.split("cargo xtask ").skip(1).filter_map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(rest.len());
        Some(&rest[..end]).filter(|name| !name.is_empty())
    });
    let unknown = names.filter(|name| TASKS.iter().all(|task| task.0 != *name));
    unknown.map(|name| format!("task {name}")).collect()
}

/// The relative links and pictures of a page in a folder that lead nowhere.
fn broken_links(folder: &Path, text: &str) -> Vec<String> {
    let targets = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    let relative = targets.filter(|t| !t.contains("://") && !t.starts_with('#'));
    let files = relative.filter_map(|t| t.split(['#', ' ']).next()).filter(|t| !t.is_empty());
    let missing = files.filter(|t| !folder.join(t).exists());
    missing.map(|t| format!("{t}, to which it links")).collect()
}

/// The paths between backticks that do not exist, and the items that are not in the file named
/// after them (`` `Item` in `path` ``).
fn missing_places(tree: &Tree, text: &str) -> Vec<String> {
    let mut missing = vec![];
    // Pieces between backticks have odd numbers.
    let pieces: Vec<&str> = text.split('`').collect();
    for (i, path) in pieces.iter().enumerate().skip(1).step_by(2) {
        let is_path = ROOTS.iter().any(|folder| path.starts_with(folder))
            && !path.contains(|c: char| c.is_whitespace() || c == '*');
        let has_item = pieces[i - 1].trim() == "in" && i >= 3;
        let content = tree.texts.get(Path::new(path)).filter(|_| has_item);
        if is_path && !tree.root.join(path).exists() {
            missing.push(format!("file {path}"));
        } else if let Some(content) = content.filter(|_| is_path) {
            let mut words = content.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let item = pieces[i - 2].trim_end_matches('!');
            if !words.any(|word| word == item) {
                missing.push(format!("{item} in {path}"));
            }
        }
    }
    missing
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

    #[test]
    fn places_must_exist() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let text = "pub fn present() {}".to_owned();
        let tree = Tree { root, texts: [("xtask/Cargo.toml".into(), text)].into() };
        let missing = |text: &str| missing_places(&tree, text);
        assert!(missing("`present` in `xtask/Cargo.toml`, `crates/mesh`, `xtask/*.rs`").is_empty());
        assert_eq!(missing("`absent` in `xtask/Cargo.toml`"), ["absent in xtask/Cargo.toml"]);
        assert_eq!(missing("see `crates/absent.rs`"), ["file crates/absent.rs"]);
        let links = |text: &str| broken_links(&tree.root, text).len();
        assert_eq!(links("[a](README.md#a) [b](https://b.c) [c](#c) ![d](d.png)"), 1);
    }
}
