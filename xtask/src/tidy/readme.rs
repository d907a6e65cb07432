//! The README holds what it promises.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use clap::CommandFactory as _;

use crate::cli::Cli;

/// Commands in code blocks of the README that do not exist, and Rust examples
/// that no doc test compiles.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let path = root.join("README.md");
    if !path.exists() {
        return Ok(vec!["there is no README.md".into()]);
    }
    let text = fs::read_to_string(path).context("reading README.md")?;
    let mut broken = unknown_tasks(&text);
    broken.extend(broken_links(root, &text));
    if !crate::readme::is_current(root, &text)? {
        broken.push("the README's claims are not those of the committed report".into());
    }
    // The tests include the README in their documentation, so that its examples
    // are doc tests.
    let tests = fs::read_to_string(root.join("tests/src/lib.rs"))?;
    if text.contains("```rust") && !tests.contains("README.md") {
        broken.push("the tests do not run the README's example as a doc test".into());
    }
    Ok(broken)
}

/// `cargo xtask NAME` where there is no such task, and options that the task
/// does not have.
fn unknown_tasks(text: &str) -> Vec<String> {
    let program = Cli::command();
    let mut broken = vec![];
    for (at, found) in text.match_indices("cargo xtask ") {
        let rest = &text[at + found.len()..];
        let end = rest.find(['`', '\n', '#']).unwrap_or(rest.len());
        let mut words = rest[..end].split_whitespace();
        let Some(name) = words.next().filter(|w| w.chars().all(|c| c.is_ascii_lowercase())) else {
            continue;
        };
        let Some(task) = program.find_subcommand(name) else {
            broken.push(format!("there is no `cargo xtask {name}`"));
            continue;
        };
        for option in words.filter_map(|w| w.strip_prefix("--")) {
            let option = option.split('=').next().unwrap_or(option);
            if !task.get_arguments().any(|a| a.get_long() == Some(option)) {
                broken.push(format!("`cargo xtask {name}` has no option --{option}"));
            }
        }
    }
    broken
}

/// Relative links and pictures that lead nowhere.
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
    fn tasks_and_options_must_exist() {
        assert!(unknown_tasks("`cargo xtask reproduce --quick --only q1`").is_empty());
        assert_eq!(unknown_tasks("`cargo xtask reprodce`").len(), 1);
        assert_eq!(unknown_tasks("    cargo xtask reproduce --fast\n").len(), 1);
    }
}
