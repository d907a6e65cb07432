//! Rules on single files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

/// The most lines of a file of code.
const MAX_LINES: usize = 600;

/// Finds files longer than [`MAX_LINES`].
pub(super) fn lengths(root: &Path) -> Result<Vec<String>> {
    let mut broken = vec![];
    for (path, text) in texts(root)? {
        let code = path
            .extension()
            .is_some_and(|e| ["rs", "mjs", "css", "html", "py", "sh"].iter().any(|k| e == *k));
        let lines = text.lines().count();
        if code && !in_report(&path) && lines > MAX_LINES {
            broken.push(format!("{} has {lines} lines", path.display()));
        }
    }
    Ok(broken)
}

/// Finds lines that name a home folder or a temporary folder of one machine.
pub(super) fn machine_paths(root: &Path) -> Result<Vec<String>> {
    // Built from parts, so that this file does not break the rule.
    let folders = ["home", "Users", "root", "work", "mnt"].map(|f| format!("/{f}/"));
    let mut broken = vec![];
    for (path, text) in texts(root)? {
        if path.ends_with("Cargo.lock") {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            let named = |folder: &&String| {
                line.match_indices(folder.as_str()).any(|(at, _)| stands_alone(line, at))
            };
            if let Some(folder) = folders.iter().find(named) {
                broken.push(format!("{}:{}: {folder}", path.display(), number + 1));
            }
        }
    }
    Ok(broken)
}

/// Returns true if a path begins here; the rest of `a/b` is relative.
fn stands_alone(line: &str, at: usize) -> bool {
    let before = line[..at].chars().next_back();
    before.is_none_or(|c| !(c.is_alphanumeric() || "./_-~}".contains(c)))
}

/// Finds modules with meaningless names.
pub(super) fn names(root: &Path) -> Result<Vec<String>> {
    let vague = ["utils", "util", "common", "helpers", "helper", "misc"];
    let named = |p: &PathBuf| {
        let is =
            |part: Option<&std::ffi::OsStr>| part.is_some_and(|s| vague.iter().any(|v| s == *v));
        is(p.file_stem()) || is(p.parent().and_then(Path::file_name))
    };
    Ok(files(root)?.into_iter().filter(named).map(|p| p.display().to_string()).collect())
}

/// Finds code outside `crates/sparse` that uses the solver backend.
pub(super) fn backend(root: &Path) -> Result<Vec<String>> {
    let mut broken = vec![];
    for (path, text) in texts(root)? {
        let foreign =
            path.extension().is_some_and(|e| e == "rs") && !path.starts_with("crates/sparse");
        let uses = |line: &str| {
            let line = line.trim_start();
            !line.starts_with("//") && (line.contains("use faer") || line.contains("faer::"))
        };
        // This file and the oracle of the tests name the backend to look for it.
        if foreign
            && !path.starts_with("xtask/src/tidy")
            && !path.starts_with("tests")
            && text.lines().any(uses)
        {
            broken.push(path.display().to_string());
        }
    }
    Ok(broken)
}

/// Returns true for files of the committed report, which are generated and exempt from rules on
/// code.
pub(super) fn in_report(path: &Path) -> bool {
    path.starts_with("docs/report")
}

/// The files under version control and untracked files that are not ignored, relative to the root.
fn files(root: &Path) -> Result<Vec<PathBuf>> {
    let arguments = ["ls-files", "--cached", "--others", "--exclude-standard", "-z"];
    let output =
        Command::new("git").args(arguments).current_dir(root).output().context("running git")?;
    ensure!(output.status.success(), "git ls-files: {}", String::from_utf8_lossy(&output.stderr));
    let list = String::from_utf8(output.stdout).context("a file name is not UTF-8")?;
    let paths = list.split('\0').filter(|name| !name.is_empty()).map(PathBuf::from);
    Ok(paths.filter(|p| root.join(p).is_file()).collect())
}

/// All text files, with their content.
pub(super) fn texts(root: &Path) -> Result<Vec<(PathBuf, String)>> {
    let mut texts = vec![];
    for path in files(root)? {
        let bytes =
            fs::read(root.join(&path)).with_context(|| format!("reading {}", path.display()))?;
        if let Ok(text) = String::from_utf8(bytes) {
            texts.push((path, text));
        }
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_are_no_machine_paths() {
        let folder = format!("/{}/", "home");
        for (line, absolute) in [
            (format!("{folder}me/x"), true),
            (format!("see \"{folder}me\""), true),
            (format!("docs{folder}x"), false),
        ] {
            let at = line.find(&folder).unwrap();
            assert_eq!(stands_alone(&line, at), absolute, "{line}");
        }
    }
}
