//! The report in a size to be committed.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use rayon::prelude::*;

use crate::palette;
use crate::results::Record;

/// Pictures are scaled down to this width, in pixels: what a code host shows.
const WIDTH: usize = 740;

/// Leaves out everything but tables and pictures, which the command of each
/// section makes again, and scales pictures down.
pub(super) fn records(records: &mut [Record], work: &Path) -> Result<()> {
    let remove = |path: &str| {
        let path = work.join(path);
        fs::remove_file(&path).with_context(|| format!("removing {}", path.display()))
    };
    for record in records.iter_mut() {
        let others: Vec<String> = record.other_files().map(|file| file.path.clone()).collect();
        others.iter().try_for_each(|path| remove(path))?;
        record.files.retain(|file| !others.contains(&file.path));
        for figure in &mut record.figures {
            figure.svg.take().map_or(Ok(()), |svg| remove(&svg))?;
        }
    }
    let figures: Vec<&str> =
        records.iter().flat_map(|r| &r.figures).map(|f| f.png.as_str()).collect();
    figures.par_iter().try_for_each(|png| {
        let path = work.join(png);
        let full = fs::read(&path).with_context(|| format!("reading {png}"))?;
        fs::write(&path, palette::narrow(&full, WIDTH)?).with_context(|| format!("writing {png}"))
    })
}
