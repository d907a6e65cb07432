//! The pages of a report, from its files.

use std::fs;
use std::path::{Path, PathBuf};

use crate::model::results::{Form, Results};
use anyhow::{Context as _, Result, ensure};

use crate::page::{html, markdown};

/// Writes `report.md`, and `report.html` unless the report is small, into the folder of a report,
/// from its `results.json` and the pictures and views named there.
pub fn render(folder: &Path) -> Result<()> {
    let results = Results::read(&folder.join("results.json"))?;
    for record in results.experiments.iter().filter(|r| r.error.is_none()) {
        let id = &record.id;
        ensure!(
            !record.method.is_empty(),
            "results.json does not say how {id} was answered: it is of an older version, or holds reference values"
        );
    }
    if results.form == Form::Whole {
        write(&folder.join("report.html"), &html::report(&results, folder)?)?;
    }
    write(&folder.join("report.md"), &markdown::report(&results))
}

/// Writes a file whole or not at all.
pub(crate) fn write(path: &Path, text: &str) -> Result<()> {
    let mut unfinished = path.to_owned().into_os_string();
    unfinished.push(".part");
    let unfinished = PathBuf::from(unfinished);
    fs::write(&unfinished, text).with_context(|| format!("writing {}", unfinished.display()))?;
    fs::rename(&unfinished, path).with_context(|| format!("writing {}", path.display()))
}
