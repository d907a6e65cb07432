//! Citations in documentation: `[key]`, with a line `[key]: URL` that makes it a link.

use std::collections::BTreeMap;
use std::path::Path;

use super::tree::Tree;

const BIBLIOGRAPHY: &str = "docs/bibliography.bib";

/// Finds keys that the bibliography does not have, and citations that do not link to the address
/// in the bibliography. Rustdoc reports links without such a line.
pub(super) fn check(tree: &Tree) -> Vec<String> {
    let bibliography = tree.texts.get(Path::new(BIBLIOGRAPHY)).map_or("", String::as_str);
    let addresses = addresses(bibliography);
    let mut broken = vec![];
    for (path, text) in tree.rust() {
        for (number, line) in (1..).zip(text.lines()) {
            let fault = fault(line.trim_start(), &addresses);
            broken.extend(fault.map(|what| format!("{}:{number}: {what}", path.display())));
        }
    }
    broken
}

/// The keys of a bibliography, each with the address of the source if it has one.
fn addresses(bibliography: &str) -> BTreeMap<&str, Option<String>> {
    let entries = bibliography.split("\n@").skip(1);
    let keyed = entries.filter_map(|entry| {
        let (_, rest) = entry.split_once('{')?;
        let (key, fields) = rest.split_once(',')?;
        let value = |name: &str| {
            let line = fields.lines().find(|line| line.trim_start().starts_with(name))?;
            let (_, value) = line.split_once("= {")?;
            Some(value.trim_end_matches(',').trim_end_matches('}').to_owned())
        };
        let doi = value("doi ").map(|doi| format!("https://doi.org/{doi}"));
        Some((key, doi.or_else(|| value("url "))))
    });
    keyed.collect()
}

/// The fault of the citations in a line, if any.
fn fault(line: &str, addresses: &BTreeMap<&str, Option<String>>) -> Option<String> {
    let documentation = ["///", "//!"].iter().find_map(|mark| line.strip_prefix(mark))?.trim();
    for piece in documentation.split('[').skip(1) {
        let (key, rest) = piece.split_at(piece.find([']', '\\']).unwrap_or(piece.len()));
        if !is_key(key) {
            continue;
        }
        let Some(address) = addresses.get(key) else {
            return Some(format!("{BIBLIOGRAPHY} has no {key}"));
        };
        let is_escaped = rest.starts_with('\\');
        match (address, rest.strip_prefix("]: ")) {
            (None, _) if !is_escaped => return Some(format!("{key} has no address: \\[{key}\\]")),
            (Some(address), None) if is_escaped => {
                return Some(format!("write [{key}], and at the end [{key}]: {address}"));
            }
            (Some(address), Some(link)) if link != address => {
                return Some(format!("the address of {key} is {address}"));
            }
            _ => {}
        }
    }
    None
}

/// Letters, a year, and maybe more letters.
fn is_key(key: &str) -> bool {
    let name = key.trim_end_matches(|c: char| c.is_ascii_lowercase());
    let author = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let is_author = !author.is_empty() && author.chars().all(|c| c.is_ascii_lowercase());
    is_author && name.len() == author.len() + 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn citations_link_to_the_bibliography() {
        let bibliography = "% All.\n\n@article{a2001,\n  year = {2001},\n  doi  = {10.1/x(2)}\n}\n\n\
            @misc{b1999two,\n  url = {https://b.c/}\n}\n\n@book{old1900,\n  title = {T}\n}\n";
        let addresses = addresses(bibliography);
        let found = |line: &str| fault(line, &addresses).is_some();
        for good in [
            "/// See [a2001].",
            "/// [a2001]: https://doi.org/10.1/x(2)",
            "//! [b1999two]: https://b.c/",
            "/// See \\[old1900\\] and [`code`].",
            "// \\[a2001\\], `x[a2001]`",
        ] {
            assert!(!found(good), "{good}");
        }
        for bad in [
            "/// See \\[a2001\\].",
            "/// See [none2000].",
            "/// See [old1900].",
            "/// [b1999two]: https://b.d/",
        ] {
            assert!(found(bad), "{bad}");
        }
    }
}
