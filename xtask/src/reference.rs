//! The committed reference values that `--check` compares with.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use crate::compare::{Difference, differences};
use crate::json;
use crate::results::{Record, Results};

/// The file with the reference values of quick or of full runs.
pub fn path(root: &Path, quick: bool) -> PathBuf {
    root.join("docs/reference").join(if quick { "quick.json" } else { "full.json" })
}

/// Makes the tables and verdicts of these results the reference. With
/// `partial`, experiments that were not run keep their old values.
///
/// # Errors
///
/// If the file cannot be read or written.
pub fn accept(root: &Path, results: &Results, partial: bool) -> Result<PathBuf> {
    let path = path(root, results.provenance.quick);
    let mut experiments: Vec<Record> = results.experiments.iter().map(bare).collect();
    if partial && path.exists() {
        let mut old = Results::read(&path)?.experiments;
        for record in experiments {
            match old.iter_mut().find(|r| r.id == record.id) {
                Some(place) => *place = record,
                None => old.push(record),
            }
        }
        experiments = old;
    }
    let reference = Results { provenance: results.provenance.clone(), experiments };
    fs::create_dir_all(path.parent().unwrap_or(root))?;
    fs::write(&path, json::readable(&reference)?)
        .with_context(|| format!("writing {}", path.display()))?;
    Ok(path)
}

/// What differs from the reference values.
///
/// # Errors
///
/// If there are none or they cannot be read.
pub fn check(root: &Path, results: &Results, partial: bool) -> Result<Vec<Difference>> {
    let reference = Results::read(&path(root, results.provenance.quick))?;
    Ok(differences(&reference, results, partial))
}

/// Numbers and verdicts only.
fn bare(record: &Record) -> Record {
    Record {
        figures: vec![],
        files: vec![],
        notes: vec![],
        views: vec![],
        seconds: 0.0,
        ..record.clone()
    }
}
