//! Files that use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use crate::packages;

/// The names of a module from the root of its crate on; each module is one file.
type Module = Vec<String>;

/// Finds circles of files that use each other, in every crate.
///
/// A file uses another if a path in its code leads to an item that the other defines, through any
/// number of re-exports. A declaration `mod x;` is not a use, and neither is a re-export
/// `pub use x::Y` unless the rest of the file names `Y`: a parent may collect children that use
/// its items. Unit tests are left out.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let mut found = vec![];
    for package in packages::read(root)? {
        let folder = package.manifest_path.parent().unwrap_or(root);
        let modules = read(&folder.join("src"))?;
        let lines = circles(&modules).into_iter().map(|circle| {
            let uses = circle.iter().map(|(module, used)| {
                let used: Vec<String> = used.iter().map(shown).collect();
                format!("{} uses {}", shown(module), used.join(", "))
            });
            let uses: Vec<String> = uses.collect();
            format!("files of {} use each other: {}", package.name, uses.join("; "))
        });
        found.extend(lines);
    }
    Ok(found)
}

fn shown(module: &Module) -> String {
    if module.is_empty() { "the root".to_owned() } else { module.join("::") }
}

/// A path in the code of a module.
struct Name {
    parts: Vec<String>,
    /// The name in this module, if a `use` declares the path.
    alias: Option<String>,
    /// Only re-exported.
    passed_on: bool,
}

type Names = Vec<Name>;

/// The modules below a folder, tests left out.
fn read(folder: &Path) -> Result<BTreeMap<Module, Names>> {
    let (mut modules, mut folders) = (BTreeMap::new(), vec![folder.to_owned()]);
    let is_library = folder.join("lib.rs").exists();
    while let Some(next) = folders.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        let paths: Result<Vec<PathBuf>, _> = entries.map(|e| e.map(|e| e.path())).collect();
        for path in paths? {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if stem == "tests" || stem == "bin" || (stem == "main" && is_library) {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path);
                let text = text.with_context(|| format!("reading {}", path.display()))?;
                let relative = path.strip_prefix(folder)?.with_extension("");
                let parts = relative.iter().map(|part| part.to_string_lossy().into_owned());
                let is_root = |part: &str| ["mod", "lib", "main"].contains(&part);
                let module = parts.filter(|part| !is_root(part)).collect();
                modules.insert(module, names_of(&text));
            }
        }
    }
    Ok(modules)
}

/// The code of a text without comments, text in quotes and unit tests.
fn code_of(text: &str) -> String {
    let mut code = String::new();
    let mut lines = text.lines().map(|line| line.split("//").next().unwrap_or_default()).peekable();
    while let Some(line) = lines.next() {
        let is_test = line.starts_with("#[cfg(") && line.contains("test") && !line.contains("not(");
        if is_test && lines.peek().is_some_and(|next| next.starts_with("mod ")) {
            break;
        }
        for (k, part) in line.split('"').enumerate() {
            code.push_str(if k % 2 == 0 { part } else { "\"\"" });
        }
        code.push('\n');
    }
    code
}

/// The paths in a text: of all `use` declarations, and all others of more than one name.
fn names_of(text: &str) -> Names {
    let code = code_of(text);
    let (mut names, mut rest) = (vec![], String::new());
    for statement in code.split_inclusive(';') {
        let start = statement.rfind("use ").filter(|&at| {
            statement[..at].chars().next_back().is_none_or(|c: char| c.is_whitespace())
        });
        match (start, statement.strip_suffix(';')) {
            (Some(at), Some(whole)) if !whole[at..].contains('(') => {
                let tree: String = whole[at + 4..].split_whitespace().collect::<Vec<_>>().join(" ");
                let before = statement[..at].trim_end();
                let passed_on = before.ends_with("pub") || before.ends_with(')');
                branches(&[], &tree, passed_on, &mut names);
                rest.push_str(&statement[..at]);
            }
            _ => rest.push_str(statement),
        }
    }
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut words = BTreeSet::new();
    for path in rest.split(|c| !is_word(c)) {
        let parts: Vec<String> = path.split("::").map(str::to_owned).collect();
        words.extend(parts.first().cloned());
        if parts.len() > 1 && !parts[0].is_empty() {
            names.push(Name { parts, alias: None, passed_on: false });
        }
    }
    for name in &mut names {
        name.passed_on &= !name.alias.as_ref().is_some_and(|alias| words.contains(alias));
    }
    names
}

/// The paths of a tree such as `a::{b, c::d as e}`.
fn branches(before: &[String], tree: &str, passed_on: bool, names: &mut Names) {
    let tree = tree.trim();
    let (stem, inside) = match tree.split_once('{') {
        Some((stem, inside)) => (stem, inside.strip_suffix('}')),
        None => (tree, None),
    };
    let (stem, alias) = match stem.split_once(" as ") {
        Some((stem, alias)) => (stem, Some(alias.trim().to_owned())),
        None => (stem, None),
    };
    let parts = stem.split("::").map(str::trim).filter(|part| !part.is_empty());
    let mut path: Vec<String> = before.iter().cloned().chain(parts.map(str::to_owned)).collect();
    let Some(inside) = inside else {
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let alias = alias.or_else(|| path.last().cloned());
        names.push(Name { parts: path, alias, passed_on });
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in inside.char_indices().chain([(inside.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inside[start..at].trim().is_empty() {
                    branches(&path, &inside[start..at], passed_on, names);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The module whose item a path in `from` names; `None` for one of another crate.
fn target(
    modules: &BTreeMap<Module, Names>,
    from: &Module,
    path: &[String],
    depth: usize,
) -> Option<Module> {
    let (first, mut rest) = path.split_first()?;
    let mut at = from.clone();
    match first.as_str() {
        "crate" => at.clear(),
        "self" => {}
        "super" => {
            at.pop();
            while let Some((next, others)) = rest.split_first().filter(|(next, _)| *next == "super")
            {
                debug_assert_eq!(next, "super");
                at.pop();
                rest = others;
            }
        }
        name => {
            at.push(name.to_owned());
            if !modules.contains_key(&at) {
                return None;
            }
        }
    }
    while let Some((name, others)) = rest.split_first() {
        let named = |export: &&Name| export.alias.as_ref() == Some(name) && export.parts.len() > 1;
        let mut exports = modules.get(&at)?.iter().filter(named);
        let inside: Module = at.iter().cloned().chain([name.clone()]).collect();
        let export = match modules.contains_key(&inside) && !others.is_empty() || depth > 20 {
            true => None,
            false => exports.find_map(|export| target(modules, &at, &export.parts, depth + 1)),
        };
        if export.is_some() {
            return export;
        }
        if !modules.contains_key(&inside) {
            return Some(at);
        }
        at = inside;
        rest = others;
    }
    Some(at)
}

/// Files that lead back to themselves, each with those of its circle that it uses.
type Circle = BTreeMap<Module, BTreeSet<Module>>;

/// Groups of files, each of which leads to all others of its group.
fn circles(modules: &BTreeMap<Module, Names>) -> Vec<Circle> {
    let used = |module: &Module| -> BTreeSet<Module> {
        let names = modules[module].iter().filter(|name| !name.passed_on);
        let targets = names.filter_map(|name| target(modules, module, &name.parts, 0));
        targets.filter(|other| other != module).collect()
    };
    let uses: Circle = modules.keys().map(|module| (module.clone(), used(module))).collect();
    let reached = |module: &Module| {
        let (mut all, mut open) = (BTreeSet::new(), vec![module.clone()]);
        while let Some(next) = open.pop() {
            for other in uses.get(&next).into_iter().flatten() {
                if all.insert(other.clone()) {
                    open.push(other.clone());
                }
            }
        }
        all
    };
    let reached: Circle = modules.keys().map(|module| (module.clone(), reached(module))).collect();
    let mut groups: Vec<Circle> = vec![];
    for (module, all) in &reached {
        if !all.contains(module) || groups.iter().any(|group| group.contains_key(module)) {
            continue;
        }
        let back = |other: &&Module| reached.get(*other).is_some_and(|r| r.contains(module));
        let group: BTreeSet<Module> = all.iter().filter(back).cloned().collect();
        let within = |module: &Module| uses[module].intersection(&group).cloned().collect();
        groups.push(group.iter().map(|module| (module.clone(), within(module))).collect());
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modules(texts: &[(&str, &str)]) -> BTreeMap<Module, Names> {
        let module = |name: &str| -> Module {
            name.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect()
        };
        texts.iter().map(|(name, text)| (module(name), names_of(text))).collect()
    }

    fn names(texts: &[(&str, &str)]) -> Vec<String> {
        let circles = circles(&modules(texts));
        let one = |circle: Circle| circle.keys().map(shown).collect::<Vec<_>>().join(" ");
        circles.into_iter().map(one).collect()
    }

    #[test]
    fn circles_are_found_through_exports() {
        let root = ("", "mod a;\nmod b;\nmod c;\npub use a::{A, other::X as Y};\npub use c::C;\n");
        let a = ("a", "use crate::b::{self, B};\nstruct A;\n");
        assert_eq!(names(&[root, a, ("b", "use crate::A;\n"), ("c", "use super::A;")]), ["a b"]);
        assert_eq!(names(&[root, a, ("b", "fn f() { crate::A::new(); }"), ("c", "")]), ["a b"]);
        // The other way is free, and so are tests, comments, text and other crates.
        let b =
            "use a::A;\nuse other::{crate_a, A as _};\n// use crate::A;\nlet s = \"crate::A\";\n";
        let tested = format!("{b}#[cfg(test)]\nmod tests {{\n    use crate::A;\n}}\n");
        assert!(names(&[root, a, ("b", &tested), ("c", "use crate::A;")]).is_empty());
    }

    #[test]
    fn a_parent_may_collect_children_that_use_it() {
        let root = ("", "mod a;");
        let child = ("a::b", "use super::A;\npub struct B;");
        let found = |parent: &str| names(&[root, ("a", parent), child]);
        assert!(found("mod b;\npub use b::B;\npub struct A;").is_empty());
        assert_eq!(found("mod b;\npub use b::B;\npub fn f(_: B) {}"), ["a a::b"]);
        assert_eq!(found("mod b;\nuse b::B;\npub struct A(B);"), ["a a::b"]);
        assert_eq!(found("mod b;\npub struct A(b::B);"), ["a a::b"]);
        let both = [root, ("a", ""), ("a::b", "use super::c::C;"), ("a::c", "use super::b::B;")];
        assert_eq!(names(&both), ["a::b a::c"]);
    }
}
