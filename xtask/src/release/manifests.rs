//! Versions, the changelog, and descriptions of the packages.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, ensure};

use super::step::Passed;
use crate::packages::Package;

/// The version of all packages.
pub(super) fn version(packages: &[Package]) -> Result<&str> {
    let versions: BTreeSet<&str> = packages.iter().map(|package| &*package.version).collect();
    let mut versions = versions.into_iter();
    let version = versions.next().context("the workspace has no packages")?;
    let others: Vec<&str> = versions.collect();
    ensure!(others.is_empty(), "packages have the versions {version} and {}", others.join(", "));
    Ok(version)
}

/// Checks that all packages and the recipe of conda have one version, that published ones ask for
/// it in each other, and that they need no package that is not published.
pub(super) fn versions(root: &Path, packages: &[Package]) -> Result<Passed> {
    let version = version(packages)?;
    let recipe =
        fs::read_to_string(root.join("python/recipe.yaml")).context("reading the recipe")?;
    let same = recipe.contains(&format!("\n  version: \"{version}\"\n"));
    ensure!(same, "python/recipe.yaml has another version than {version}");
    let problems = unpublishable(packages, version);
    ensure!(problems.is_empty(), "{}", problems.join("\n"));
    Ok(Passed::Done(version.to_owned()))
}

/// Finds dependencies with which a package cannot be uploaded.
fn unpublishable(packages: &[Package], version: &str) -> Vec<String> {
    let own = |name: &str| packages.iter().find(|package| package.name == name);
    let mut problems = vec![];
    for package in packages.iter().filter(|package| package.is_published) {
        for dependency in &package.dependencies {
            let Some(other) = own(&dependency.name) else { continue };
            let (name, requirement) = (&dependency.name, &dependency.requirement);
            // Without a version, cargo leaves dependencies of tests out of the package.
            let is_left_out = dependency.kind.as_deref() == Some("dev") && requirement == "*";
            if is_left_out {
                continue;
            }
            if !other.is_published {
                problems.push(format!("{} needs {name}, which is not published", package.name));
            }
            if *requirement != format!("^{version}") {
                problems.push(format!(
                    "{} asks for {name} {requirement}, not {version}: see Cargo.toml",
                    package.name
                ));
            }
        }
    }
    problems
}

/// Checks that the changelog has a section on the version.
pub(super) fn changelog(root: &Path, packages: &[Package]) -> Result<Passed> {
    let version = version(packages)?;
    let text = fs::read_to_string(root.join("CHANGELOG.md")).context("reading CHANGELOG.md")?;
    let heading = section(&text, version)
        .with_context(|| format!("CHANGELOG.md has no text under a heading \"## {version}\""))?;
    Ok(Passed::Done(format!("section \"{heading}\"")))
}

/// The heading of a version, `## 1.2.3 …` or `## [1.2.3] …`, if text follows.
fn section<'a>(changelog: &'a str, version: &str) -> Option<&'a str> {
    changelog.split("\n## ").skip(1).find_map(|section| {
        let (heading, text) = section.split_once('\n')?;
        let first = heading.split_whitespace().next()?;
        let found = first.trim_start_matches('[').split(']').next()? == version;
        (found && !text.trim().is_empty()).then_some(heading)
    })
}

/// Checks that each published package says what the registry and its readers need.
pub(super) fn metadata(_: &Path, packages: &[Package]) -> Result<Passed> {
    let published: Vec<&Package> = packages.iter().filter(|p| p.is_published).collect();
    let problems: Vec<String> = published.iter().flat_map(|package| missing(package)).collect();
    ensure!(problems.is_empty(), "{}", problems.join("\n"));
    Ok(Passed::Done(format!("{} packages", published.len())))
}

/// The parts of a package that are missing or not as the registry takes them.
fn missing(package: &Package) -> Vec<String> {
    let mut problems = vec![];
    let mut require = |holds: bool, what: &str| {
        if !holds {
            problems.push(format!("{}: {what}", package.name));
        }
    };
    let entry = &package.entry;
    let words = |name: &str| entry[name].as_array().map_or(0, Vec::len);
    require(entry["description"].is_string(), "no description");
    require(package.license.is_some(), "no license");
    require(package.rust_version.is_some(), "no rust-version");
    require(entry["documentation"].is_string(), "no documentation");
    require((1..=5).contains(&words("keywords")), "needs one to five keywords");
    require((1..=5).contains(&words("categories")), "needs one to five categories");
    for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
        require(package.folder().join(file).is_file(), &format!("no {file}"));
    }
    let read = |path: &str| fs::read_to_string(package.folder().join(path)).unwrap_or_default();
    require(
        entry["readme"].is_string() && example(&read("README.md")).is_some(),
        "no example in its README",
    );
    require(read("src/lib.rs").contains("../README.md"), "the README is not its front page");
    problems
}

/// The first Rust program of a README.
pub(super) fn example(readme: &str) -> Option<&str> {
    let (_, rest) = readme.split_once("```rust\n")?;
    rest.split_once("```").map(|(code, _)| code)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, publish: &str, dependency: &str, requirement: &str) -> Package {
        let entry = format!(
            r#"{{"name": "{name}", "version": "0.1.0", "manifest_path": "{name}/Cargo.toml",
            "publish": {publish}, "dependencies": [{{"name": "{dependency}", "req": "{requirement}"}}]}}"#
        );
        Package::new(&serde_json::from_str(&entry).unwrap()).unwrap()
    }

    #[test]
    fn packages_need_published_ones_of_their_version() {
        let problems = |publish: &str, requirement: &str| {
            let packages =
                [package("a", "null", "b", requirement), package("b", publish, "serde", "^1")];
            unpublishable(&packages, "0.1.0")
        };
        assert!(problems("null", "^0.1.0").is_empty());
        assert_eq!(problems("[]", "^0.1.0"), ["a needs b, which is not published"]);
        assert_eq!(problems("null", "^0.0.9"), ["a asks for b ^0.0.9, not 0.1.0: see Cargo.toml"]);
    }

    #[test]
    fn sections_need_text() {
        let log = "# Changelog\n\n## 0.2.0\n\n## [0.1.1] - 2026-01-01\n\nText.\n\n## 0.1.0 (first)\n\nText.\n";
        assert_eq!(section(log, "0.1.0"), Some("0.1.0 (first)"));
        assert_eq!(section(log, "0.1.1"), Some("[0.1.1] - 2026-01-01"));
        assert_eq!((section(log, "0.2.0"), section(log, "0.1")), (None, None));
    }
}
