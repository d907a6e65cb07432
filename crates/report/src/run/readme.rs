//! The table of claims in the README, which is written together with the committed report.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::model::results::Results;
use crate::page::{claim_table, summary};
use crate::run::reference::REPORT;

const BEGIN: &str = "<!-- The claims, written by `cargo xtask reproduce --accept`. -->\n";
const END: &str = "<!-- End of the claims. -->\n";

/// The README with the claims of these results between its marks; `None` if it
/// has no such marks.
fn with_claims(readme: &str, results: &Results) -> Option<String> {
    let (before, rest) = readme.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    let place = format!("{REPORT}/report.md");
    let [source, ours] = [false, true].map(|ours| claim_table(results, ours, &place));
    let summary = summary(results);
    Some(format!(
        "{before}{BEGIN}\n{summary}\nClaims of the original report:\n\n{source}\n\
         Claims of Fairing:\n\n{ours}\n{END}{after}"
    ))
}

/// Puts the claims into the README.
pub(crate) fn update(root: &Path, results: &Results) -> Result<()> {
    let path = root.join("README.md");
    let old = fs::read_to_string(&path).context("reading README.md")?;
    let new = with_claims(&old, results).context("README.md has no marks around its claims")?;
    fs::write(&path, new).context("writing README.md")
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::run::cli::{Cli, root};

    #[test]
    fn the_claims_are_those_of_the_committed_report() {
        let readme = fs::read_to_string(root().join("README.md")).unwrap();
        let results = Results::read(&root().join(REPORT).join("results.json")).unwrap();
        assert!(with_claims(&readme, &results).unwrap() == readme);
    }

    /// Each `cargo xtask reproduce …` of the README has options that exist.
    #[test]
    fn commands_are_understood() {
        let readme = fs::read_to_string(root().join("README.md")).unwrap();
        let mut count = 0;
        for rest in readme.split("cargo xtask ").skip(1) {
            let end = rest.find(['`', '\n', '#']).unwrap_or(rest.len());
            let words: Vec<&str> = rest[..end].split_whitespace().collect();
            if ["reproduce", "report", "data"].contains(&words[0]) {
                let parsed = Cli::try_parse_from(std::iter::once("xtask").chain(words));
                assert!(parsed.is_ok(), "cargo xtask {}: {}", &rest[..end], parsed.unwrap_err());
                count += 1;
            }
        }
        assert!(count >= 2);
    }
}
