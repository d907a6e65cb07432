//! Writes what an experiment returned.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::outcome::Outcome;
use crate::results::{FigureFile, File, Record};

/// Writes tables, figures and meshes into `work/id`, and enters them into the
/// record with paths relative to `work`.
pub(super) fn outcome(outcome: Outcome, work: &Path, record: &mut Record) -> Result<()> {
    let id = record.id.clone();
    fs::create_dir_all(work.join(&id))?;
    let keep = |name: String, bytes: &[u8], about: &str| -> Result<File> {
        let path = format!("{id}/{name}");
        fs::write(work.join(&path), bytes).with_context(|| format!("writing {path}"))?;
        Ok(File { path, about: about.into(), bytes: bytes.len() as u64 })
    };
    for table in &outcome.tables {
        let csv = table.to_csv();
        record.files.push(keep(format!("{}.csv", table.id), csv.as_bytes(), &table.caption)?);
    }
    for picture in outcome.figures {
        let png = keep(format!("{}.png", picture.id), &picture.png, &picture.caption)?.path;
        let svg = picture.svg.map(|svg| {
            anyhow::Ok(keep(format!("{}.svg", picture.id), svg.as_bytes(), &picture.caption)?.path)
        });
        record.figures.push(FigureFile {
            id: picture.id,
            caption: picture.caption,
            alt: picture.alt,
            png,
            svg: svg.transpose()?,
        });
    }
    record.tables = outcome.tables;
    record.notes = outcome.notes;
    record.views = outcome.views;
    Ok(())
}

/// Writes a text file.
pub(super) fn text(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}
