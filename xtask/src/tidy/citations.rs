//! Citations in documentation: `[key]`, with a line `[key]: URL` that makes it a link.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use super::words;

const BIBLIOGRAPHY: &str = "docs/bibliography.bib";

/// Finds keys that the bibliography does not have, and citations that do not link to the address
/// in the bibliography.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(root.join(BIBLIOGRAPHY))
        .with_context(|| format!("reading {BIBLIOGRAPHY}"))?;
    let addresses = addresses(&text);
    let mut broken = vec![];
    for (path, text) in words::rust(root)? {
        let problems = problems(&text, &addresses);
        broken.extend(
            problems.into_iter().map(|(line, what)| format!("{}:{line}: {what}", path.display())),
        );
    }
    Ok(broken)
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

/// The wrong citations of a source file, each with its line, from 1.
fn problems(text: &str, addresses: &BTreeMap<&str, Option<String>>) -> Vec<(usize, String)> {
    let mut found = vec![];
    // Lines of documentation up to the next line of code, and the number of the first.
    let mut block: Vec<&str> = vec![];
    for (number, line) in text.lines().chain([""]).enumerate() {
        let line = line.trim_start();
        if let Some(body) = ["///", "//!"].iter().find_map(|kind| line.strip_prefix(kind)) {
            block.push(body.trim());
            continue;
        }
        let first = number + 1 - block.len();
        for (i, body) in block.iter().enumerate() {
            let wrong = cited(body).filter_map(|key| wrong(key, body, &block, addresses));
            found.extend(wrong.map(|what| (first + i, what)));
        }
        block.clear();
    }
    found
}

/// The keys in brackets, escaped or not: letters, a year, and maybe more letters.
fn cited(line: &str) -> impl Iterator<Item = &str> {
    let pieces = line.split('[').skip(1);
    pieces.filter_map(|rest| {
        let key = rest.split([']', '\\']).next()?;
        let name = key.trim_end_matches(|c: char| c.is_ascii_lowercase());
        let author = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_author = !author.is_empty() && author.chars().all(|c| c.is_ascii_lowercase());
        (is_author && name.len() == author.len() + 4).then_some(key)
    })
}

/// The fault of a citation in a line of a block, if any.
fn wrong(
    key: &str,
    line: &str,
    block: &[&str],
    addresses: &BTreeMap<&str, Option<String>>,
) -> Option<String> {
    let Some(address) = addresses.get(key) else {
        return Some(format!("{BIBLIOGRAPHY} has no {key}"));
    };
    let is_escaped = line.contains(&format!("\\[{key}\\]"));
    match address {
        None => (!is_escaped).then(|| format!("{key} has no address: write \\[{key}\\]")),
        Some(address) => {
            let link = format!("[{key}]: {address}");
            let is_linked = !is_escaped && block.contains(&link.as_str());
            (!is_linked).then(|| format!("write [{key}], and at the end of the comment {link}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn citations_link_to_the_bibliography() {
        let bibliography = "% All.\n\n@article{a2001,\n  year = {2001},\n  doi  = {10.1/x(2)}\n}\n\n\
            @misc{b1999two,\n  url = {https://b.c/}\n}\n\n@book{old1900,\n  title = {T}\n}\n";
        let addresses = addresses(bibliography);
        let found = |text: &str| problems(text, &addresses).len();
        for good in [
            "/// See [a2001].\n///\n/// [a2001]: https://doi.org/10.1/x(2)\nfn f() {}",
            "//! See [b1999two].\n//! [b1999two]: https://b.c/",
            "/// See \\[old1900\\] and [`code`].\nfn f() {}",
            "// \\[a2001\\], `x[a2001]`",
        ] {
            assert_eq!(found(good), 0, "{good}");
        }
        for bad in [
            "/// See [a2001].\nfn f() {}",
            "/// See \\[a2001\\].\nfn f() {}",
            "/// See [none2000].",
            "/// See [old1900].",
            "/// See [a2001].\nfn f() {}\n/// [b1999two]: https://b.c/",
            "/// [b1999two]: https://b.d/",
        ] {
            assert_eq!(found(bad), 1, "{bad}");
        }
    }
}
