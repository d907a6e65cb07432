//! Contents of the folder of a report.

use std::fs;
use std::path::Path;

use crate::model::json;
use crate::model::results::{Form, Record, Results};
use crate::model::view::View;
use anyhow::{Context as _, Result};
use rayon::prelude::*;

use crate::page::render::{render, write};
use crate::page::{thumbnail, views};

/// Makes a report of `folder`, which holds the files of experiments that have just run: packs the
/// data of views, keeps the files of this form of the report, writes `results.json`, and renders
/// it. Returns what is in `results.json`.
pub fn publish(mut results: Results, folder: &Path, form: Form) -> Result<Results> {
    results.form = form;
    for record in &mut results.experiments {
        pack(record, folder, form)?;
        choose_pictures(record, folder, form)?;
        if form == Form::Small {
            leave_out(record, folder)?;
        }
    }
    thumbnail::tell_apart(&mut results);
    let mut written = results.clone();
    if form == Form::Small {
        // The CSV files have them.
        let tables = written.experiments.iter_mut().flat_map(|record| &mut record.tables);
        tables.for_each(|table| table.rows.clear());
    }
    write(&folder.join("results.json"), &json::readable(&written)?)?;
    render(folder)?;
    Ok(results)
}

/// Packs the data of views for the page; a small report has no page, and keeps a small picture of
/// the mesh.
fn pack(record: &mut Record, folder: &Path, form: Form) -> Result<()> {
    let id = record.id.clone();
    record.views.par_iter_mut().try_for_each(|entry| {
        let bytes = fs::read(folder.join(&entry.data));
        let view = bytes.map_err(Into::into).and_then(|b| View::from_bytes(&b));
        let view = view.with_context(|| format!("reading {}", entry.data))?;
        remove(folder, &std::mem::take(&mut entry.data))?;
        if form == Form::Whole {
            let packed = views::pack(&view, &format!("{id}-{}", entry.id))?;
            entry.data = format!("{id}/{}.view.json", entry.id);
            write(&folder.join(&entry.data), &packed.write()?)?;
        }
        entry.mesh = thumbnail::mesh_card(&view, &format!("{id}/{}-mesh.png", entry.id), folder)?;
        Ok(())
    })
}

/// A small report has pictures in one size only, the smaller; a whole one has both, and its page
/// holds the smaller and links the larger. Plots are in the page as lines.
fn choose_pictures(record: &mut Record, folder: &Path, form: Form) -> Result<()> {
    for figure in &mut record.figures {
        if figure.svg.is_none() && form == Form::Whole {
            continue;
        }
        let Some(small) = figure.small.take() else { continue };
        match form {
            Form::Whole => remove(folder, &small)?,
            Form::Small => fs::rename(folder.join(&small), folder.join(&figure.png))
                .with_context(|| format!("moving {small}"))?,
        }
    }
    Ok(())
}

/// Leaves out everything but tables, pictures and plots, which the command of
/// each section makes again.
fn leave_out(record: &mut Record, folder: &Path) -> Result<()> {
    let others: Vec<String> = record.other_files().map(|file| file.path.clone()).collect();
    others.iter().try_for_each(|path| remove(folder, path))?;
    record.files.retain(|file| !others.contains(&file.path));
    Ok(())
}

fn remove(folder: &Path, path: &str) -> Result<()> {
    fs::remove_file(folder.join(path)).with_context(|| format!("removing {path}"))
}
