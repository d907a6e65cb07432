//! Licences of dependencies, and the compilers that they need.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::packages;

/// The file with the licences that are allowed, which cargo-deny reads too.
const RULES: &str = "deny.toml";

/// Finds packages, of the workspace and of others, without a licence that `deny.toml` allows.
pub(super) fn allowed(root: &Path) -> Result<Vec<String>> {
    let rules = fs::read_to_string(root.join(RULES)).with_context(|| format!("reading {RULES}"))?;
    let allowed = allow_list(&rules);
    let mut broken = vec![];
    for package in packages::with_dependencies(root)? {
        let name = format!("{} {}", package.name, package.version);
        match &package.license {
            None => broken.push(format!("{name} names no licence")),
            Some(licence) if !is_satisfied(licence, &allowed) => {
                broken.push(format!("{name} has the licence {licence}"));
            }
            Some(_) => {}
        }
    }
    Ok(broken)
}

/// Finds dependencies that need a newer compiler than the workspace promises.
pub(super) fn compilers(root: &Path) -> Result<Vec<String>> {
    let packages = packages::with_dependencies(root)?;
    let own = packages.iter().find(|package| package.name == "xtask");
    let promised = own.and_then(|package| package.rust_version.as_deref());
    let promised = promised.context("Cargo.toml has no rust-version")?;
    let newer = packages.iter().filter_map(|package| {
        let needed = package.rust_version.as_deref()?;
        let is_newer = numbers(needed) > numbers(promised);
        is_newer.then(|| format!("{} needs Rust {needed}, not {promised}", package.name))
    });
    Ok(newer.collect())
}

/// The parts of a version, without zeros at the end: 1.90 and 1.90.0 are equal.
fn numbers(version: &str) -> Vec<u32> {
    let mut numbers: Vec<u32> = version.split('.').filter_map(|part| part.parse().ok()).collect();
    while numbers.last() == Some(&0) {
        numbers.pop();
    }
    numbers
}

/// The entries of the first list `allow`.
fn allow_list(rules: &str) -> Vec<&str> {
    let list = rules.split_once("\nallow = [").and_then(|(_, rest)| rest.split_once("\n]"));
    let lines = list.map_or("", |(list, _)| list).lines();
    let entries = lines.filter(|line| !line.trim_start().starts_with('#'));
    entries.filter_map(|line| line.split('"').nth(1)).collect()
}

/// Returns true if an SPDX expression can be satisfied with licences of the list. A slash means OR.
fn is_satisfied(expression: &str, allowed: &[&str]) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    let holds = any(&mut words, allowed);
    holds && words.next().is_none()
}

type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

fn any(words: &mut Words<'_>, allowed: &[&str]) -> bool {
    let mut holds = all(words, allowed);
    while words.next_if_eq(&"OR").is_some() {
        holds |= all(words, allowed);
    }
    holds
}

fn all(words: &mut Words<'_>, allowed: &[&str]) -> bool {
    let mut holds = one(words, allowed);
    while words.next_if_eq(&"AND").is_some() {
        holds &= one(words, allowed);
    }
    holds
}

fn one(words: &mut Words<'_>, allowed: &[&str]) -> bool {
    if words.next_if_eq(&"(").is_some() {
        let holds = any(words, allowed);
        return words.next() == Some(")") && holds;
    }
    let Some(licence) = words.next() else { return false };
    match words.next_if_eq(&"WITH").and_then(|_| words.next()) {
        Some(exception) => allowed.contains(&format!("{licence} WITH {exception}").as_str()),
        None => allowed.contains(&licence),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_read_as_spdx_does() {
        let holds = |expression| is_satisfied(expression, &["MIT", "A", "B", "A WITH x"]);
        for good in
            ["MIT", "GPL OR MIT", "GPL/MIT", "(A OR GPL) AND B", "A WITH x", "GPL OR A AND B"]
        {
            assert!(holds(good), "{good}");
        }
        for bad in ["GPL", "MIT AND GPL", "B WITH x", "A WITH y", "(A", "A B", "", "GPL AND A OR C"]
        {
            assert!(!holds(bad), "{bad}");
        }
    }

    #[test]
    fn the_list_is_read() {
        let rules =
            "x = 1\n[licenses]\nallow = [\n  \"MIT\",\n  # no \"GPL\"\n  \"A WITH x\",\n]\n";
        assert_eq!(allow_list(rules), ["MIT", "A WITH x"]);
    }

    #[test]
    fn versions_are_compared_by_their_numbers() {
        assert!(numbers("1.100") > numbers("1.90.1"));
        assert_eq!(numbers("1.90.0"), numbers("1.90"));
    }
}
