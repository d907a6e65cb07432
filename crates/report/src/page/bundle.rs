//! ES modules as one script.

use anyhow::{Result, bail};

/// The modules in one scope, one after the other. Each comes after those that it imports, so that
/// none imports itself through others.
///
/// A module imports by name, a line for each file, and marks exports with the word `export` at the
/// beginning of a line; names of the top level differ between modules.
pub(super) fn bundled(modules: &[(&str, &str)]) -> Result<String> {
    let mut script = String::new();
    for (i, (name, text)) in modules.iter().enumerate() {
        for line in text.lines() {
            if let Some(file) = imported(line) {
                if !modules[..i].iter().any(|(before, _)| *before == file) {
                    bail!("{name} imports {file}, which does not come before it");
                }
                continue;
            }
            script += line.strip_prefix("export ").unwrap_or(line);
            script.push('\n');
        }
    }
    Ok(script)
}

/// A script or style sheet without indentation, empty lines and lines that are comments.
pub(super) fn compact(text: &str) -> String {
    let lines = text.lines().map(str::trim_start);
    lines.filter(|l| !l.is_empty() && !l.starts_with("//")).flat_map(|l| [l, "\n"]).collect()
}

/// The name of the file that a line imports from.
fn imported(line: &str) -> Option<&str> {
    let (_, from) = line.strip_prefix("import ")?.split_once(" from '")?;
    from.strip_suffix("';")?.rsplit('/').next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_and_exports_are_gone() {
        let one = ("a.mjs", "export const a = 1;\n");
        let two = ("b.mjs", "import {a} from '../x/a.mjs';\n\nshow(a);\n");
        assert_eq!(bundled(&[one, two]).unwrap(), "const a = 1;\n\nshow(a);\n");
        let error = bundled(&[two, one]).unwrap_err().to_string();
        assert_eq!(error, "b.mjs imports a.mjs, which does not come before it");
    }
}
