//! The programs that `cargo xtask` starts and the tests share one build.
//!
//! Cargo unifies the features requested by the packages of one build. If one build requests fewer
//! than another, a dependency and everything that depends on it are compiled twice.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context as _, Result, ensure};

use crate::programs::cargo;

/// Crates that need matrices but no factorisation, and must not compile the solver backend.
const WITHOUT_SOLVERS: [&str; 4] =
    ["fairing-denoising", "fairing-evaluation", "fairing-operators", "fairing-shapes"];

/// Finds packages that have other features in the programs started by `cargo xtask` than in the
/// tests.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let programs = tree(root, &["--workspace", "--edges=normal,build"])?;
    let tests = tree(root, &["--workspace", "--edges=normal,build,dev"])?;
    Ok(differences(&programs, &tests))
}

/// Finds crates that compile the solver backend without need.
pub(super) fn solvers(root: &Path) -> Result<Vec<String>> {
    let mut found = vec![];
    for package in WITHOUT_SOLVERS {
        if has_backend(&tree(root, &["--package", package, "--edges=normal"])?) {
            found.push(format!(
                "{package} compiles faer: cargo tree --package {package} --invert faer"
            ));
        }
    }
    Ok(found)
}

/// Returns true if the solver backend is in a list of packages.
fn has_backend(tree: &str) -> bool {
    features(tree).keys().any(|package| package.starts_with("faer "))
}

/// The output of `cargo tree`: a package and its features in each line.
fn tree(root: &Path, choice: &[&str]) -> Result<String> {
    let mut cargo = cargo(root);
    cargo.args(["tree", "--locked", "--prefix=none", "--format={p}|{f}"]).args(choice);
    let output = cargo.output().context("asking cargo for features")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The features of each package; several sets if build scripts and programs need different ones.
fn features(tree: &str) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut features: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for line in tree.lines() {
        let line = line.strip_suffix(" (*)").unwrap_or(line);
        if let Some((package, set)) = line.split_once('|') {
            features.entry(package).or_default().insert(set);
        }
    }
    features
}

/// Finds packages in both lists with features in the first that the second does not have.
fn differences(own: &str, all: &str) -> Vec<String> {
    let all = features(all);
    let mut found = vec![];
    for (package, sets) in features(own) {
        let Some(known) = all.get(package) else { continue };
        for set in sets.difference(known) {
            let others: Vec<String> = known.iter().map(|set| format!("[{set}]")).collect();
            found.push(format!(
                "{package} has the features [{set}] in the programs, {} in the tests",
                others.join(" and ")
            ));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_features_are_found() {
        let all = "rand v0.10.0|std,sys_rng\nsyn v2.0.0|full\nsyn v2.0.0|\npyo3 v0.1.0|\n";
        assert!(
            differences("rand v0.10.0|std,sys_rng (*)\nsyn v2.0.0|\nclap v4|x\n", all).is_empty()
        );
        let found = differences("rand v0.10.0|std\nsyn v2.0.0|full (*)\n", all);
        let [only] = &found[..] else { panic!("{found:?}") };
        assert!(only.contains("rand v0.10.0") && only.contains("[std,sys_rng]"), "{only}");
    }

    #[test]
    fn the_backend_is_found_by_its_whole_name() {
        assert!(has_backend("sprs v0.11.6|\nfaer v0.24.0|std (*)\n"));
        assert!(!has_backend("faer-traits v0.24.0|\nfairing-sparse v0.1.0|\n"));
    }
}
