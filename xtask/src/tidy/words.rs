//! Rules on comments.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::sources;

/// The most columns of a line of comment.
const MAX_COLUMNS: usize = 100;

/// Words that do not open documentation: a noun phrase or a verb says more.
const OPENINGS: [&str; 8] = ["What", "Which", "How", "Whether", "Who", "Whoever", "Whose", "That"];

/// Finds lines of comments longer than [`MAX_COLUMNS`].
pub(super) fn columns(root: &Path) -> Result<Vec<String>> {
    let mut broken = vec![];
    for (path, text) in rust(root)? {
        for (number, line) in text.lines().enumerate() {
            let columns = line.chars().count();
            // The address of a link cannot be broken.
            let is_link = line.contains("]: http");
            if line.trim_start().starts_with("//") && columns > MAX_COLUMNS && !is_link {
                broken.push(format!("{}:{}: {columns} columns", path.display(), number + 1));
            }
        }
    }
    Ok(broken)
}

/// Finds documentation that opens with one of [`OPENINGS`].
pub(super) fn openings(root: &Path) -> Result<Vec<String>> {
    let mut broken = vec![];
    for (path, text) in rust(root)? {
        let found = opened(&text);
        broken.extend(found.map(|(line, word)| format!("{}:{line}: {word} …", path.display())));
    }
    Ok(broken)
}

/// All Rust files, with their content.
pub(super) fn rust(root: &Path) -> Result<impl Iterator<Item = (PathBuf, String)>> {
    let texts = sources::texts(root)?.into_iter();
    Ok(texts.filter(|(path, _)| path.extension().is_some_and(|e| e == "rs")))
}

/// The line, from 1, and the first word of each documentation that opens with one of [`OPENINGS`].
fn opened(text: &str) -> impl Iterator<Item = (usize, &'static str)> {
    let mut before = None;
    text.lines().enumerate().filter_map(move |(number, line)| {
        let line = line.trim_start();
        let kind = ["///", "//!"].into_iter().find(|kind| line.starts_with(kind));
        let is_first = kind != before;
        before = kind;
        let body = &line[kind.filter(|_| is_first)?.len()..];
        let mut words = body.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
        let first = words.next()?;
        OPENINGS.into_iter().find(|word| *word == first).map(|word| (number + 1, word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_word_of_a_documentation_counts() {
        let found = |text: &str| opened(text).collect::<Vec<_>>();
        assert_eq!(
            found("//! What it is.\n//! How so.\n\n/// Whether.\nfn f() {}"),
            [(1, "What"), (4, "Whether")]
        );
        assert!(found("/// A thing.\n///\n/// What it is.\n// What.\nfn f() {}").is_empty());
        assert_eq!(
            found("struct S {\n    /// A.\n    a: u8,\n    /// How.\n    b: u8\n}"),
            [(4, "How")]
        );
    }
}
