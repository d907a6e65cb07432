//! The tables of a section.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use base64::Engine as _;

use super::escape::escape;
use crate::model::results::Record;
use crate::model::table::{Cell, Table, Unit};
use crate::page::numbers::parts;
use crate::page::{layout, markdown};

/// Tables with deciding rows, and the others, folded.
///
/// Folded tables are in a `<noscript>`, which the page's script opens with the fold, so that
/// thousands of cells are no elements until they are asked for.
pub(super) fn tables(record: &Record, folder: &Path) -> Result<[String; 2]> {
    let one = |t: &Table, folded: bool| {
        let csv = format!("{}/{}.csv", record.id, t.id);
        let bytes = fs::read(folder.join(&csv)).with_context(|| format!("reading {csv}"))?;
        Ok(table(t, &csv, &bytes, folded))
    };
    let left = layout::unfolded(record).saturating_sub(parts(record).1);
    let (mut seen, mut folded): (Vec<&Table>, Vec<&Table>) =
        record.tables.iter().partition(|t| layout::shows_table(record, &t.id));
    folded.splice(0..0, seen.split_off(left.min(seen.len())));
    let mut text = String::new();
    for table in seen {
        text += &one(table, false)?;
    }
    let mut rest = String::new();
    if !folded.is_empty() {
        let names: Vec<String> = folded.iter().map(|t| layout::name(record, &t.id)).collect();
        let _ = write!(
            rest,
            "<details><summary>{}: {}</summary><noscript>{}</noscript></details>",
            counted("Table", folded.len()),
            escape(&names.join("; ")),
            folded.into_iter().map(|table| one(table, true)).collect::<Result<String>>()?
        );
    }
    Ok([text, rest])
}

/// `Table`, or `3 tables`.
pub(super) fn counted(what: &str, count: usize) -> String {
    match count {
        1 => what.to_string(),
        n => format!("{n} {}s", what.to_lowercase()),
    }
}

/// `bytes` are those of the file `csv`, which the page brings along for when it travels alone.
/// `folded` tables are within a `<noscript>` already.
fn table(table: &Table, csv: &str, bytes: &[u8], folded: bool) -> String {
    let caption = format!(
        "{} <span class=\"soft\">(<a download=\"{}\" href=\"data:text/csv;base64,{}\">CSV{}</a>)</span>",
        escape(&table.caption),
        escape(&csv.replace('/', "-")),
        base64::engine::general_purpose::STANDARD.encode(bytes),
        markdown::left_out(table)
    );
    let rows = table.rows.len();
    // Hundreds of rows are not for paper: they stay folded there, and the line says how many there
    // are.
    let (before, caption, after) = if rows > markdown::LONG {
        (
            format!(
                "<p class=\"caption\">{caption}</p><details class=\"rows\"><summary>{rows} rows</summary>{}",
                if folded { "" } else { "<noscript>" }
            ),
            String::new(),
            if folded { "</details>" } else { "</noscript></details>" },
        )
    } else {
        (String::new(), format!("<caption><span>{caption}</span></caption>"), "")
    };
    let mut text = format!(
        "{before}<div class=\"wide\"><table id=\"table-{}\">{caption}<thead><tr>",
        escape(csv.trim_end_matches(".csv")).replace('/', "-"),
    );
    let columns = markdown::columns(table);
    for &c in &columns {
        let c = &table.columns[c];
        let unit = match c.unit {
            Unit::Label | Unit::One | Unit::Count | Unit::Order => String::new(),
            unit => format!(" ({unit})"),
        };
        let class = class(c.unit);
        let _ = write!(
            text,
            "<th scope=\"col\"{class}>{}{}</th>",
            escape(&markdown::named(c)),
            escape(&unit)
        );
    }
    text += "</tr></thead><tbody>";
    for row in &table.rows {
        text += "<tr>";
        for &c in &columns {
            let class = class(table.columns[c].unit);
            let _ = write!(text, "<td{class}>{}</td>", escape(&Cell::to_string(&row[c])));
        }
        text += "</tr>";
    }
    text + "</tbody></table></div>" + after
}

/// Numbers are set flush right.
fn class(unit: Unit) -> &'static str {
    if unit == Unit::Label { "" } else { " class=\"n\"" }
}
