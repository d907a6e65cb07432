//! Modules that use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::packages;

/// The names of a module from the root of its crate on.
type Module = Vec<String>;

/// Circles of modules that use each other, in every crate.
///
/// A module uses another if a path in it, in a `use` or elsewhere, leads to an item of the other, through whatever
/// re-exports. A module and those inside it count as one another's: they may use each other. Unit tests do not count.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let mut found = vec![];
    for package in packages::read(root)? {
        let folder = package.manifest_path.parent().unwrap_or(root);
        let modules = read(&folder.join("src"))?;
        let names = circles(&modules).into_iter().map(|circle| {
            let names: Vec<String> = circle.iter().map(|module| module.join("::")).collect();
            format!("modules of {} use each other: {}", package.name, names.join(", "))
        });
        found.extend(names);
    }
    Ok(found)
}

/// The paths of each module with the names that they have there: none outside a `use`.
type Paths = Vec<(Vec<String>, Option<String>)>;

/// The modules below a folder, tests left out.
fn read(folder: &Path) -> Result<BTreeMap<Module, Paths>> {
    let (mut modules, mut folders) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(next) = folders.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        let paths: Result<Vec<PathBuf>, _> = entries.map(|e| e.map(|e| e.path())).collect();
        for path in paths? {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if stem == "tests" {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") && stem != "main" {
                let text = fs::read_to_string(&path);
                let text = text.with_context(|| format!("reading {}", path.display()))?;
                let relative = path.strip_prefix(folder)?.with_extension("");
                let parts = relative.iter().map(|part| part.to_string_lossy().into_owned());
                let module = parts.filter(|part| part != "mod" && part != "lib").collect();
                modules.insert(module, paths_of(&text));
            }
        }
    }
    Ok(modules)
}

/// The paths in a text: of all `use` declarations, and others that begin in the crate.
fn paths_of(text: &str) -> Paths {
    let code: Vec<&str> =
        text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
    let code = code.join("\n");
    let code = code.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut paths = vec![];
    let mut rest = String::new();
    for (number, statement) in code.split_inclusive(';').enumerate() {
        let start = statement.rfind("use ").filter(|&at| {
            let before = statement[..at].chars().next_back();
            number == 0 && before.is_none() || before.is_none_or(|c| c.is_whitespace())
        });
        match (start, statement.strip_suffix(';')) {
            (Some(at), Some(whole)) if !whole[at..].contains('(') => {
                let tree: String = whole[at + 4..].split_whitespace().collect::<Vec<_>>().join(" ");
                branches(&[], &tree, &mut paths);
                rest.push_str(&statement[..at]);
            }
            _ => rest.push_str(statement),
        }
    }
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for path in rest.split(|c| !word(c)) {
        let parts: Vec<String> = path.split("::").map(str::to_owned).collect();
        if parts.len() > 1 && ["crate", "super", "self"].contains(&&*parts[0]) {
            paths.push((parts, None));
        }
    }
    paths
}

/// The paths of a tree such as `a::{b, c::d as e}`.
fn branches(before: &[String], tree: &str, paths: &mut Paths) {
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
        let name = alias.or_else(|| path.last().cloned());
        paths.push((path, name));
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in inside.char_indices().chain([(inside.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inside[start..at].trim().is_empty() {
                    branches(&path, &inside[start..at], paths);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The module whose item a path in `from` names; `None` for one of another crate.
fn target(
    modules: &BTreeMap<Module, Paths>,
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
        let named = |(path, alias): &&(Vec<String>, Option<String>)| {
            alias.as_ref() == Some(name) && path.len() > 1
        };
        let mut exports = modules.get(&at)?.iter().filter(named);
        let inside: Module = at.iter().cloned().chain([name.clone()]).collect();
        let export = match modules.contains_key(&inside) && !others.is_empty() || depth > 20 {
            true => None,
            false => exports.find_map(|(path, _)| target(modules, &at, path, depth + 1)),
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

/// Groups of modules, each of which leads to all others of its group.
fn circles(modules: &BTreeMap<Module, Paths>) -> Vec<Vec<Module>> {
    let used = |module: &Module| -> BTreeSet<Module> {
        let paths = modules[module].iter();
        let targets = paths.filter_map(|(path, _)| target(modules, module, path, 0));
        targets.filter(|other| !other.starts_with(module) && !module.starts_with(other)).collect()
    };
    let uses: BTreeMap<&Module, BTreeSet<Module>> =
        modules.keys().map(|module| (module, used(module))).collect();
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
    let reached: BTreeMap<&Module, BTreeSet<Module>> =
        modules.keys().map(|module| (module, reached(module))).collect();
    let mut groups: Vec<Vec<Module>> = vec![];
    for (module, all) in &reached {
        let in_circle = all.contains(*module);
        if in_circle && !groups.iter().any(|group| group.contains(module)) {
            let back = |other: &&Module| reached.get(other).is_some_and(|r| r.contains(*module));
            groups.push(all.iter().filter(back).cloned().collect());
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modules(texts: &[(&str, &str)]) -> BTreeMap<Module, Paths> {
        let module = |name: &str| -> Module {
            name.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect()
        };
        texts.iter().map(|(name, text)| (module(name), paths_of(text))).collect()
    }

    fn names(texts: &[(&str, &str)]) -> Vec<String> {
        let circles = circles(&modules(texts));
        let one =
            |circle: Vec<Module>| circle.iter().map(|m| m.join("::")).collect::<Vec<_>>().join(" ");
        circles.into_iter().map(one).collect()
    }

    #[test]
    fn circles_are_found_through_exports() {
        let root = ("", "mod a;\nmod b;\nmod c;\npub use a::{A, other::X as Y};\npub use c::C;\n");
        let a = ("a", "use crate::b::{self, B};\nstruct A;\n");
        assert_eq!(names(&[root, a, ("b", "use crate::A;\n"), ("c", "use super::A;")]), ["a b"]);
        assert_eq!(names(&[root, a, ("b", "fn f() { crate::A::new(); }"), ("c", "")]), ["a b"]);
        // The other way is free, and so are tests, comments and other crates.
        let b = "use a::A;\nuse other::{crate_a, A as _};\n// use crate::A;\n";
        let tested = format!("{b}#[cfg(test)]\nmod tests {{\n    use crate::A;\n}}\n");
        assert!(names(&[root, a, ("b", &tested), ("c", "use crate::A;")]).is_empty());
    }

    #[test]
    fn a_module_and_those_inside_it_are_one() {
        let root = ("", "mod a;");
        let inside = ("a::b", "use super::{A, c::C};");
        assert!(names(&[root, ("a", "use b::B;\nstruct A;"), inside, ("a::c", "")]).is_empty());
        let both = [root, ("a", ""), inside, ("a::c", "use super::b::B;")];
        assert_eq!(names(&both), ["a::b a::c"]);
    }
}
