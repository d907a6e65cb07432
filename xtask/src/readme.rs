//! The table of claims in the README, which is written together with the committed report.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::reference::REPORT;
use fairing_report::{claim_table, summary};
use fairing_results::results::Results;

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
        "{before}{BEGIN}\n{summary}\nClaims of the original report:\n\n{source}\nClaims of Fairing:\n\n{ours}\n{END}{after}"
    ))
}

/// Puts the claims into the README.
///
/// # Errors
///
/// If it cannot be read or written, or has no place for them.
pub(crate) fn update(root: &Path, results: &Results) -> Result<()> {
    let path = root.join("README.md");
    let old = fs::read_to_string(&path).context("reading README.md")?;
    let new = with_claims(&old, results).context("README.md has no marks around its claims")?;
    fs::write(&path, new).context("writing README.md")
}

/// Whether the README says what the committed report says; also if there is no
/// report.
///
/// # Errors
///
/// If either cannot be read.
pub(crate) fn is_current(root: &Path, readme: &str) -> Result<bool> {
    let path = root.join(REPORT).join("results.json");
    if !path.is_file() {
        return Ok(true);
    }
    Ok(with_claims(readme, &Results::read(&path)?).is_some_and(|new| new == readme))
}
