//! Contents of the folder of a report.

use std::fs;
use std::path::Path;

use crate::model::json;
use crate::model::results::{Form, Record, Results};
use anyhow::{Context as _, Result};

use crate::page::render::{render, write};
use crate::page::thumbnail;

/// Makes a report of `folder`, which holds the files of experiments that have just run: keeps the
/// files of this form of the report, writes `results.json`, and renders it. Returns what is in
/// `results.json`.
pub fn publish(mut results: Results, folder: &Path, form: Form) -> Result<Results> {
    results.form = form;
    for record in &mut results.experiments {
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
    for view in &mut record.views {
        remove(folder, &std::mem::take(&mut view.data))?;
    }
    let others: Vec<String> = record.other_files().map(|file| file.path.clone()).collect();
    others.iter().try_for_each(|path| remove(folder, path))?;
    record.files.retain(|file| !others.contains(&file.path));
    Ok(())
}

fn remove(folder: &Path, path: &str) -> Result<()> {
    fs::remove_file(folder.join(path)).with_context(|| format!("removing {path}"))
}
