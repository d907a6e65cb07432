//! The report in a size to be committed.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use rayon::prelude::*;

use crate::palette;
use crate::results::Record;

/// Pictures are scaled down to this width, in pixels: what a code host shows.
const WIDTH: usize = 960;

/// Leaves out meshes and spectra, which the command of each section makes
/// again, and scales pictures down.
pub(super) fn records(records: &mut [Record], work: &Path) -> Result<()> {
    for record in records.iter_mut() {
        for file in record.files.iter().filter(|f| !f.path.ends_with(".csv")) {
            let path = work.join(&file.path);
            fs::remove_file(&path).with_context(|| format!("removing {}", path.display()))?;
        }
        record.files.retain(|f| f.path.ends_with(".csv"));
    }
    let figures: Vec<&str> =
        records.iter().flat_map(|r| &r.figures).map(|f| f.png.as_str()).collect();
    figures.par_iter().try_for_each(|png| {
        let path = work.join(png);
        let full = fs::read(&path).with_context(|| format!("reading {png}"))?;
        fs::write(&path, palette::narrow(&full, WIDTH)?).with_context(|| format!("writing {png}"))
    })
}
