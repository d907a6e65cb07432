//! Files that use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::tree::Tree;

/// The names of a module from the root of its crate on; each module is one file.
type Module<'a> = Vec<&'a str>;

/// The paths in the code of each module of a crate.
type Modules<'a> = BTreeMap<Module<'a>, BTreeSet<Vec<&'a str>>>;

/// Finds circles of files that use each other, in every crate.
///
/// A file uses the file of the longest module in each path of its code, its unit tests left out. A
/// declaration `mod x;` is no use, and neither is a re-export: a parent may collect children that
/// use its items.
pub(super) fn check(tree: &Tree) -> Vec<String> {
    let codes: Vec<_> = tree.rust().map(|(path, text)| (path, code(text))).collect();
    let mut crates: BTreeMap<&Path, Modules<'_>> = BTreeMap::new();
    for (path, code) in &codes {
        let Some(folder) = path.ancestors().find(|folder| folder.ends_with("src")) else {
            continue;
        };
        let inside = path.strip_prefix(folder).unwrap_or(path);
        let module = module(inside);
        if !module.contains(&"tests") {
            crates.entry(folder).or_default().insert(module, paths(code));
        }
    }
    let mut faults = vec![];
    for (folder, modules) in &crates {
        for (module, used) in circles(modules) {
            let used: Vec<String> = used.iter().map(shown).collect();
            let (folder, module) = (folder.display(), shown(&module));
            faults.push(format!("{folder}: a circle: {module} uses {}", used.join(", ")));
        }
    }
    faults
}

/// The module of a file in `src`.
fn module(file: &Path) -> Module<'_> {
    let names = file.iter().filter_map(|name| name.to_str());
    let names = names.map(|name| name.strip_suffix(".rs").unwrap_or(name));
    names.filter(|name| !["mod", "lib"].contains(name)).collect()
}

/// The code of a text without comments, text in quotes and unit tests, with spaces between words,
/// `::` and other characters.
fn code(text: &str) -> String {
    let is_tests =
        |at: &usize| text[at + 1..].lines().nth(1).is_some_and(|l| l.starts_with("mod "));
    let tests = text.match_indices("\n#[cfg(test").map(|(at, _)| at).find(is_tests);
    let lines = text[..tests.unwrap_or(text.len())].lines();
    let lines = lines.map(|line| line.split("//").next().unwrap_or_default());
    let mut code = String::new();
    for c in lines.flat_map(|line| line.split('"').step_by(2).chain([" "])).flat_map(str::chars) {
        if c.is_alphanumeric() || "_:".contains(c) {
            code.push(c);
        } else {
            code.extend([' ', c, ' ']);
        }
    }
    code.replace("::", " :: ")
}

/// The paths of more than one name in a code, except for re-exports.
fn paths(code: &str) -> BTreeSet<Vec<&str>> {
    let (mut paths, mut path, mut stems) = (BTreeSet::new(), vec![], vec![]);
    let (mut before, mut is_export) = ("", false);
    for token in code.split_whitespace().chain([";"]) {
        if before != "::" && token != "::" {
            let ended = std::mem::take(&mut path);
            paths.extend(Some(ended).filter(|path| path.len() > 1 && !is_export));
        }
        let is_word = token.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        match token {
            "use" => is_export = ["pub", ")"].contains(&before),
            ";" => is_export = false,
            "{" if before == "::" => stems.push(std::mem::take(&mut path)),
            "}" => drop(stems.pop()),
            _ if is_word && before == "::" => path.push(token),
            _ if is_word && token != "as" && before != "as" => {
                path = [stems.last().cloned().unwrap_or_default(), vec![token]].concat();
            }
            _ => {}
        }
        before = token;
    }
    paths
}

/// The longest module in a path of the code of `from`; `None` if it is of another crate.
fn target<'a>(modules: &Modules<'a>, from: &Module<'a>, path: &[&'a str]) -> Option<Module<'a>> {
    let (mut at, mut rest) = (from.clone(), path);
    let is_ours = ["crate", "self", "super"].contains(&path[0]);
    while let [name @ ("crate" | "self" | "super"), after @ ..] = rest {
        match *name {
            "crate" => at.clear(),
            "super" => drop(at.pop()),
            _ => {}
        }
        rest = after;
    }
    let depth = at.len();
    for name in rest {
        let inside = [&at[..], &[*name]].concat();
        if !modules.contains_key(&inside) {
            break;
        }
        at = inside;
    }
    (is_ours || at.len() > depth).then_some(at)
}

/// The modules in circles and between circles, each with those that it uses among them.
fn circles<'a>(modules: &Modules<'a>) -> BTreeMap<Module<'a>, BTreeSet<Module<'a>>> {
    let used = |(module, paths): (&Module<'a>, &BTreeSet<Vec<&'a str>>)| {
        let targets = paths.iter().filter_map(|path| target(modules, module, path));
        (module.clone(), targets.filter(|other| other != module).collect())
    };
    let mut uses: BTreeMap<Module<'a>, BTreeSet<Module<'a>>> = modules.iter().map(used).collect();
    loop {
        // Modules that use no other, or that no other uses, are in no circle.
        let count = uses.len();
        let all: BTreeSet<_> = uses.values().flatten().cloned().collect();
        uses.retain(|module, used| !used.is_empty() && all.contains(module));
        let left: BTreeSet<_> = uses.keys().cloned().collect();
        uses.values_mut().for_each(|used| used.retain(|module| left.contains(module)));
        if uses.len() == count {
            return uses;
        }
    }
}

/// The name of a module in messages.
fn shown(module: &Module<'_>) -> String {
    if module.is_empty() { "the root".to_owned() } else { module.join("::") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The modules in circles of files with these texts.
    fn found(texts: &[(&str, &str)]) -> Vec<String> {
        let codes: Vec<_> = texts.iter().map(|(file, text)| (*file, code(text))).collect();
        let modules = codes.iter().map(|(file, code)| (module(Path::new(file)), paths(code)));
        circles(&modules.collect()).keys().map(shown).collect()
    }

    #[test]
    fn circles_are_found() {
        let root = ("lib.rs", "mod a;\nmod b;\npub use a::{A, other::X as Y};\n");
        let a = ("a.rs", "use crate::{c, b::{self, B}};\nstruct A;\n");
        let circle = ["a", "b"];
        assert_eq!(found(&[root, a, ("b.rs", "use crate::a::A;\n")]), circle);
        assert_eq!(found(&[root, a, ("b.rs", "fn f() { super::a::A::new(); }")]), circle);
        // The other way is free, and so are tests, comments, text and other crates.
        let b = "use other::{crate_a, a::A as _};\n// use crate::a;\nlet s = \"crate::a::A\";\n";
        let tested = format!("{b}#[cfg(test)]\nmod tests {{\n    use crate::a::A;\n}}\n");
        assert!(found(&[root, a, ("b.rs", &tested)]).is_empty());
    }

    #[test]
    fn a_parent_may_collect_children_that_use_it() {
        let child = ("a/b.rs", "use super::A;\npub struct B;");
        let found = |parent: &str| found(&[("lib.rs", "mod a;"), ("a/mod.rs", parent), child]);
        assert!(found("mod b;\npub(crate) use b::B;\npub struct A;").is_empty());
        assert_eq!(found("mod b;\nuse b::B;\npub struct A(B);"), ["a", "a::b"]);
        assert_eq!(found("mod b;\npub struct A(b::B);"), ["a", "a::b"]);
    }
}
