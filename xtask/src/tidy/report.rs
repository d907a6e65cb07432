//! The committed report.

use std::fs;
use std::path::Path;

use anyhow::Result;

/// The folder of the committed report, from the root.
const REPORT: &str = "docs/report";

/// The largest size of the report in a clone, in bytes.
const MAX_BYTES: u64 = 9_000_000;

/// Finds a report larger than [`MAX_BYTES`].
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let folder = root.join(REPORT);
    let bytes = if folder.is_dir() { size(&folder)? } else { 0 };
    let large = bytes >= MAX_BYTES;
    Ok(if large { vec![format!("{REPORT} has {bytes} bytes")] } else { vec![] })
}

fn size(folder: &Path) -> Result<u64> {
    let mut sum = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        sum += if entry.file_type()?.is_dir() {
            size(&entry.path())?
        } else {
            entry.metadata()?.len()
        };
    }
    Ok(sum)
}
