//! ES modules as one script, for pages that are one file.

use std::collections::HashMap;

use crate::error::FigureError;

/// A module: its path, with `/` between folders, and its text.
pub type Module<'a> = (&'a str, &'a str);

/// The module `entry` and all that it imports, as one script.
///
/// Each module is a function of its own, called once, after those that it imports: names of
/// different modules cannot clash, and a name that is used without its import is an error when the
/// script runs. Indentation, empty lines and lines that are `//` comments are left out.
///
/// A module imports and exports in lines that begin with these words: `import {name, name} from
/// 'path';`, with a path relative to its own, and `export` before a `const`, a `function`, an
/// `async function` or a `class`.
///
/// # Errors
///
/// [`FigureError::Script`] for a path that is not among `modules`, a name that is not exported, a
/// circle, and another form of import or export.
pub fn bundle(entry: &str, modules: &[Module<'_>]) -> Result<String, FigureError> {
    let mut bundle =
        Bundle { modules, exports: HashMap::new(), open: vec![], script: String::new() };
    bundle.take("the page", entry)?;
    Ok(bundle.script)
}

/// A script or style sheet without indentation, empty lines and lines that are `//` comments.
pub fn compact(text: &str) -> String {
    let lines = text.lines().map(str::trim_start);
    lines.filter(|l| !l.is_empty() && !l.starts_with("//")).flat_map(|l| [l, "\n"]).collect()
}

struct Bundle<'a> {
    modules: &'a [Module<'a>],
    /// The number of each module that is in the script, in their order, and the names it exports.
    exports: HashMap<String, (usize, Vec<String>)>,
    /// The modules whose imports are being taken.
    open: Vec<String>,
    script: String,
}

impl Bundle<'_> {
    /// Writes a module after those that it imports, unless it is there already.
    fn take(&mut self, importer: &str, path: &str) -> Result<(), FigureError> {
        if self.exports.contains_key(path) {
            return Ok(());
        }
        if let Some(first) = self.open.iter().position(|open| open == path) {
            let circle = [&self.open[first..], &[path.to_owned()]].concat();
            let circle = circle.join(", ");
            let problem = format!("modules import one another in a circle: {circle}");
            return Err(FigureError::Script(problem));
        }
        let Some((_, text)) = self.modules.iter().find(|(known, _)| *known == path) else {
            let problem = format!("{importer} imports {path}, which is not in the bundle");
            return Err(FigureError::Script(problem));
        };
        self.open.push(path.to_owned());
        let (mut body, mut exports) = (String::new(), vec![]);
        for (number, line) in (1..).zip(text.lines()) {
            let form = || {
                FigureError::Script(format!(
                    "{path}:{number}: {line}: only `import {{name}} from 'path';` and `export` \
                     before a const, function or class are read"
                ))
            };
            if let Some(rest) = after(line, "import") {
                let (names, from) = imported(rest).ok_or_else(form)?;
                let from = resolved(path, from);
                self.take(path, &from)?;
                body += &self.bound(path, &names, &from)?;
            } else if let Some(rest) = after(line, "export") {
                exports.push(declared(rest).ok_or_else(form)?.to_owned());
                body += rest.trim_start();
            } else {
                body += line;
            }
            body.push('\n');
        }
        self.open.pop();
        let number = self.exports.len();
        let names = exports.join(", ");
        let body = compact(&body);
        self.script += &format!("const ${number} = (() => {{\n{body}return {{{names}}};\n}})();\n");
        self.exports.insert(path.to_owned(), (number, exports));
        Ok(())
    }

    /// The line that binds imported names.
    fn bound(&self, path: &str, names: &[&str], from: &str) -> Result<String, FigureError> {
        let (number, exports) = &self.exports[from];
        match names.iter().find(|name| !exports.iter().any(|export| export == *name)) {
            Some(name) => Err(FigureError::Script(format!(
                "{path} imports {name} from {from}, which does not export it"
            ))),
            None => Ok(format!("const {{{}}} = ${number};", names.join(", "))),
        }
    }
}

/// The rest of a line that begins with a word.
fn after<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let rest = line.strip_prefix(word)?;
    (!rest.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$')).then_some(rest)
}

/// The names and the path of an import, after its first word.
fn imported(rest: &str) -> Option<(Vec<&str>, &str)> {
    let (names, from) = rest.trim_start().strip_prefix('{')?.split_once("} from '")?;
    let names: Vec<&str> = names.split(',').map(str::trim).collect();
    let path = from.strip_suffix("';")?;
    names.iter().all(|name| is_name(name)).then_some((names, path))
}

/// The name that an export declares, after its first word.
fn declared(rest: &str) -> Option<&str> {
    let rest = rest.trim_start();
    let rest = rest.strip_prefix("async ").unwrap_or(rest);
    let (kind, rest) = rest.split_once(' ')?;
    let end = rest.find(|c: char| !is_letter(c)).unwrap_or(rest.len());
    let fits = matches!(kind, "const" | "function" | "class") && is_name(&rest[..end]);
    fits.then_some(&rest[..end])
}

fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_letter) && !text.starts_with(char::is_numeric)
}

/// The path that `import` in the module at `path` refers to.
fn resolved(path: &str, import: &str) -> String {
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in import.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: Module<'_> = (
        "a/page.mjs",
        "import {b} from './b.mjs';\nimport {c} from '../c/c.mjs';\n\nshow(b, c);\n",
    );
    const B: Module<'_> =
        ("a/b.mjs", "import {c} from '../c/c.mjs';\n\n// Twice.\nexport const b = 2 * c;\n");
    const C: Module<'_> = ("c/c.mjs", "const own = 3;\nexport const c = own;\n");

    fn error(modules: &[Module<'_>]) -> String {
        bundle("a/page.mjs", modules).unwrap_err().to_string()
    }

    /// Modules may be listed in any order; one that two import is written once, and unused ones are
    /// left out.
    #[test]
    fn modules_come_after_those_that_they_import() {
        let unused = ("c/d.mjs", "export const d = 4;\n");
        let script = bundle("a/page.mjs", &[PAGE, unused, B, C]).unwrap();
        assert_eq!(
            script,
            "const $0 = (() => {\nconst own = 3;\nconst c = own;\nreturn {c};\n})();\n\
             const $1 = (() => {\nconst {c} = $0;\nconst b = 2 * c;\nreturn {b};\n})();\n\
             const $2 = (() => {\nconst {b} = $1;\nconst {c} = $0;\nshow(b, c);\nreturn {};\n})();\n"
        );
        assert_eq!(bundle("a/page.mjs", &[C, B, unused, PAGE]).unwrap(), script);
    }

    #[test]
    fn circles_are_named() {
        let c = ("c/c.mjs", "import {b} from '../a/b.mjs';\nexport const c = b;\n");
        let circle = "modules import one another in a circle: a/b.mjs, c/c.mjs, a/b.mjs";
        assert_eq!(error(&[PAGE, B, c]), circle);
        let own = ("a/page.mjs", "import {b} from './page.mjs';\n");
        assert_eq!(error(&[own]), "modules import one another in a circle: a/page.mjs, a/page.mjs");
    }

    #[test]
    fn unknown_paths_and_names_are_refused() {
        assert_eq!(error(&[PAGE, B]), "a/b.mjs imports c/c.mjs, which is not in the bundle");
        assert_eq!(error(&[]), "the page imports a/page.mjs, which is not in the bundle");
        let hidden = ("c/c.mjs", "export const own = 3;\nconst c = own;\n");
        let expected = "a/b.mjs imports c from c/c.mjs, which does not export it";
        assert_eq!(error(&[PAGE, B, hidden]), expected);
    }

    #[test]
    fn other_forms_are_refused() {
        for line in [
            "import './b.mjs';",
            "import b from './b.mjs';",
            "import {b as c} from './b.mjs';",
            "import {b} from './b.mjs'",
            "import {",
            "export default 3;",
            "export {b};",
            "export let b = 3;",
            "export const {b} = c;",
            "export * from './b.mjs';",
        ] {
            let text = format!("const a = 1;\n{line}\n");
            let found = error(&[("a/page.mjs", &text), B, C]);
            assert!(found.starts_with(&format!("a/page.mjs:2: {line}: only")), "{found}");
        }
        let names = ("a/page.mjs", "important();\nexported();\n  import b\n");
        assert!(bundle("a/page.mjs", &[names]).is_ok());
    }

    #[test]
    fn all_kinds_of_exports_are_read() {
        let text =
            "export async function a() {}\nexport class B extends C {}\nexport function d(x) {}\n";
        let script = bundle("a.mjs", &[("a.mjs", text)]).unwrap();
        assert!(script.contains("\nreturn {a, B, d};\n"), "{script}");
    }
}
