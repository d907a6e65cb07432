//! Rules on single files and their lines.

use std::path::Path;

use super::tree::Tree;

/// The largest number of lines of a file of code.
const MAX_LINES: usize = 600;
/// The largest number of columns of a comment, as of code, which rustfmt breaks.
const MAX_COLUMNS: usize = 100;
/// Extensions of code.
const CODE: [&str; 6] = ["rs", "mjs", "css", "html", "py", "sh"];
/// Words that do not open documentation: a noun phrase or a verb says more.
const OPENINGS: [&str; 8] = ["What", "Which", "How", "Whether", "Who", "Whoever", "Whose", "That"];

/// Finds files that are too long and lines that break a rule.
pub(super) fn check(tree: &Tree) -> Vec<String> {
    let mut faults = vec![];
    for (path, text) in &tree.texts {
        let lines = text.lines().count();
        if code(path).is_some() && lines > MAX_LINES {
            faults.push(format!("{}: {lines} lines; at most {MAX_LINES}", path.display()));
        }
        let mut before = "";
        for (number, line) in (1..).zip(text.lines()) {
            let what = fault(path, before, line);
            faults.extend(what.map(|what| format!("{}:{number}: {what}", path.display())));
            before = line;
        }
    }
    faults
}

/// The extension of a file, if it is one of code. The committed report is generated.
fn code(path: &Path) -> Option<&'static str> {
    let extension = path.extension().filter(|_| !path.starts_with("docs/report"))?;
    CODE.into_iter().find(|known| extension == *known)
}

/// The fault of a line, if any, given the line before.
fn fault(path: &Path, before: &str, line: &str) -> Option<String> {
    if let Some(folder) = machine_folder(line).filter(|_| !path.ends_with("Cargo.lock")) {
        return Some(format!("{folder} is a folder of one machine"));
    }
    if path.ends_with("Cargo.toml") {
        let may_name = path == Path::new("Cargo.toml") || path.starts_with("crates/sparse");
        let names = line.starts_with("faer") && !may_name;
        return names.then(|| "only crates/sparse depends on faer".to_owned());
    }
    let start = line.trim_start();
    if code(path)? != "rs" || !start.starts_with("//") {
        return None;
    }
    let columns = line.chars().count();
    // The address of a link cannot be broken.
    if columns > MAX_COLUMNS && !line.contains("]: http") {
        return Some(format!("{columns} columns; at most {MAX_COLUMNS}"));
    }
    let kind = ["///", "//!"].into_iter().find(|kind| start.starts_with(kind))?;
    let opens = !before.trim_start().starts_with(kind);
    let first =
        start[kind.len()..].split(|c: char| !c.is_alphanumeric()).find(|w| !w.is_empty())?;
    (opens && OPENINGS.contains(&first)).then(|| format!("opens with {first:?}"))
}

/// The folder of homes, or another of one machine, at which an absolute path in a line begins.
fn machine_folder(line: &str) -> Option<String> {
    // Built from parts, so that this file does not break the rule.
    let folders = ["home", "Users", "root", "work", "mnt"].map(|name| format!("/{name}/"));
    let stands_alone = |(at, _): (usize, &str)| {
        let before = line[..at].chars().next_back();
        before.is_none_or(|c| !(c.is_alphanumeric() || "./_-~}".contains(c)))
    };
    folders.into_iter().find(|folder| line.match_indices(folder.as_str()).any(stands_alone))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_are_no_machine_paths() {
        let folder = format!("/{}/", "home");
        assert!(machine_folder(&format!("{folder}me/x")).is_some());
        assert!(machine_folder(&format!("see \"{folder}me\"")).is_some());
        assert!(machine_folder(&format!("docs{folder}x")).is_none());
    }

    #[test]
    fn lines_have_their_rules() {
        let found = |path: &str, before: &str, line: &str| fault(Path::new(path), before, line);
        assert!(found("a.rs", "", "/// What it is.").is_some());
        assert!(found("a.rs", "/// A thing.", "/// What it is.").is_none());
        assert!(found("a.rs", "", "    // What it is.").is_none());
        assert!(found("a.rs", "", &format!("// {}", "x".repeat(100))).is_some());
        assert!(found("a.rs", "", &format!("f(\"{}\")", "x".repeat(100))).is_none());
        assert!(found("crates/mesh/Cargo.toml", "", "faer.workspace = true").is_some());
        assert!(found("crates/sparse/Cargo.toml", "", "faer.workspace = true").is_none());
    }
}
