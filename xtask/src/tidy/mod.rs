//! Checks of the tree against its own rules.

mod circles;
mod citations;
mod documents;
mod text;
mod tree;

use std::path::Path;

use anyhow::Result;
use tree::Tree;

/// Prints everything in the tree that breaks a rule; returns true if there is nothing.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let tree = Tree::read(root)?;
    let checks = [text::check, documents::check, citations::check, circles::check];
    let faults: Vec<String> = checks.iter().flat_map(|check| check(&tree)).collect();
    for fault in &faults {
        eprintln!("tidy: {fault}");
    }
    if faults.is_empty() {
        println!("tidy: {} files keep the rules", tree.texts.len());
    }
    Ok(faults.is_empty())
}
