//! Repeated passages of code.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use anyhow::Result;

use super::sources::{in_report, texts};

/// The number of equal lines that make a passage.
const PASSAGE: usize = 10;

/// A line with folded white space, and its number.
type Line<'a> = (usize, Vec<&'a str>);

/// Finds passages of [`PASSAGE`] or more lines of code that occur twice.
///
/// Empty lines, comments, lines without a letter or digit, and `use` lines do not count, and white
/// space is folded. Passages that differ in a name are not found.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let texts = texts(root)?;
    let files: Vec<(&PathBuf, Vec<Line<'_>>)> = texts
        .iter()
        .filter(|(path, _)| {
            path.extension().is_some_and(|e| e == "rs" || e == "mjs" || e == "py")
                && !in_report(path)
        })
        .map(|(path, text)| (path, lines(text)))
        .collect();
    let mut first: HashMap<Vec<&[&str]>, (&Path, usize)> = HashMap::new();
    let mut broken = vec![];
    for (path, lines) in &files {
        let mut inside = false;
        for window in lines.windows(PASSAGE) {
            let here = window[0].0;
            let words = window.iter().map(|(_, words)| &words[..]).collect();
            match first.entry(words) {
                Entry::Vacant(entry) => {
                    entry.insert((path, here));
                    inside = false;
                }
                Entry::Occupied(_) if inside => {}
                Entry::Occupied(entry) => {
                    let (other, there) = entry.get();
                    let (path, other) = (path.display(), other.display());
                    broken.push(format!("{path}:{here} repeats {other}:{there}"));
                    inside = true;
                }
            }
        }
    }
    Ok(broken)
}

/// The lines that count.
fn lines(text: &str) -> Vec<Line<'_>> {
    let passed_over =
        ["//", "#", "/*", "*", "use ", "pub use ", "mod ", "pub mod ", "import ", "from "];
    let counts = |line: &&str| {
        let line = line.trim_start();
        line.contains(char::is_alphanumeric) && !passed_over.iter().any(|p| line.starts_with(p))
    };
    let numbered = (1..).zip(text.lines()).filter(|(_, line)| counts(line));
    numbered.map(|(number, line)| (number, line.split_whitespace().collect())).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::process::Command;

    use super::*;

    /// The result of `check` for two files, `b.rs` after `a.rs`.
    fn found(a: &str, b: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.rs"), a).unwrap();
        fs::write(folder.path().join("b.rs"), b).unwrap();
        let git = Command::new("git").arg("init").arg("-q").current_dir(folder.path()).status();
        assert!(git.unwrap().success());
        check(folder.path()).unwrap()
    }

    fn passage(lines: usize, indent: &str) -> String {
        (0..lines).map(|i| format!("{indent}let x{i} = {i};\n")).collect()
    }

    #[test]
    fn ten_lines_twice_are_found_once() {
        let (a, b) = (passage(14, ""), format!("// b\n\nfn f() {{\n{}", passage(14, "    ")));
        assert_eq!(found(&a, &b), ["b.rs:4 repeats a.rs:1"]);
    }

    /// Comments, empty lines and brackets neither count nor break a passage.
    #[test]
    fn what_does_not_count_neither_makes_a_passage_nor_breaks_one() {
        let nine = format!("{}}}\n\n// The end.\nuse a;\n", passage(9, ""));
        assert_eq!(found(&nine, &nine), [""; 0]);
        let broken = format!("{}\n// A comment.\n}}\nlet last = 1;\n", passage(9, ""));
        let whole = format!("{}let last = 1;\n", passage(9, ""));
        assert_eq!(found(&broken, &whole), ["b.rs:1 repeats a.rs:1"]);
    }
}
