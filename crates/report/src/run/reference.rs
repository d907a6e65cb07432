//! The committed reference values that `--check` compares with.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use crate::model::compare::differences;
use crate::model::json;
use crate::model::results::{Record, Results};

/// The folder of the committed report, from the root.
pub const REPORT: &str = "docs/report";

/// The file with the reference values of quick or of full runs. Those of a full
/// run are the numbers of the committed report, so that neither can drift from
/// the other.
pub fn path(root: &Path, quick: bool) -> PathBuf {
    if quick {
        root.join("docs/reference/quick.json")
    } else {
        root.join(REPORT).join("results.json")
    }
}

/// Makes the tables and verdicts of a quick run the reference.
pub fn accept(root: &Path, results: &Results) -> Result<()> {
    let path = path(root, results.provenance.quick);
    let experiments = results.experiments.iter().map(bare).collect();
    let reference = Results { experiments, ..results.clone() };
    fs::create_dir_all(path.parent().unwrap_or(root))?;
    fs::write(&path, json::readable(&reference)?)
        .with_context(|| format!("writing {}", path.display()))
}

/// Returns the differences from the reference values.
pub fn check(root: &Path, results: &Results, partial: bool) -> Result<Vec<String>> {
    let reference = Results::read(&path(root, results.provenance.quick))?;
    Ok(differences(&reference, results, partial))
}

/// The time of each experiment when the reference values were made, in seconds; empty if there are
/// no reference values.
pub fn seconds(root: &Path, quick: bool) -> HashMap<String, f64> {
    let reference = Results::read(&path(root, quick)).ok();
    let records = reference.into_iter().flat_map(|r| r.experiments);
    records.map(|r| (r.id, r.seconds)).collect()
}

/// Numbers and verdicts only.
fn bare(record: &Record) -> Record {
    Record {
        method: String::new(),
        formulas: vec![],
        figures: vec![],
        files: vec![],
        notes: vec![],
        views: vec![],
        ..record.clone()
    }
}
