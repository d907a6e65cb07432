//! `report.html`: one self-contained page that opens from disk.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use base64::Engine as _;

use crate::experiment::Experiment;
use crate::results::{Record, Results};
use crate::table::{Table, Unit};

/// The page. `folder` holds the files of the report, whose pictures are put
/// into the page.
///
/// # Errors
///
/// If a picture cannot be read.
pub fn report(results: &Results, experiments: &[&dyn Experiment], folder: &Path) -> Result<String> {
    let mut body = String::new();
    for record in &results.experiments {
        let card = experiments.iter().map(|e| e.card()).find(|c| c.id == record.id);
        let _ =
            write!(body, "<section id=\"{0}\"><h2>{0}: {1}</h2>", record.id, escape(&record.title));
        let _ = write!(body, "<p><b>Question.</b> {}</p>", escape(&record.question));
        if let Some(error) = &record.error {
            let _ =
                write!(body, "<p><b>This experiment failed:</b> {}</p></section>", escape(error));
            continue;
        }
        if let Some(card) = card {
            for paragraph in card.method.split("\n\n") {
                let _ = write!(body, "<p>{}</p>", escape(paragraph));
            }
            for formula in card.formulas {
                let _ = write!(body, "<p><math display=\"block\">{}</math></p>", formula.mathml);
            }
        }
        section(record, folder, &mut body)?;
        body += "</section>";
    }
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Fairing: the experiments</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <style>{STYLE}</style></head><body><main><h1>Fairing: the experiments</h1>{body}</main></body></html>\n"
    ))
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;color-scheme:light dark}\
main{max-width:60rem;margin:auto;padding:1rem}img{max-width:100%}table{border-collapse:collapse}\
td,th{padding:.1rem .6rem;border-bottom:1px solid #8884}td.n{text-align:right}\
blockquote{border-left:4px solid #888;margin:1rem 0;padding:0 1rem}";

fn section(record: &Record, folder: &Path, body: &mut String) -> Result<()> {
    for claim in &record.claims {
        let _ = write!(
            body,
            "<blockquote><p><b>Claim {}:</b> {}</p><p><b>{}</b>: {}</p></blockquote>",
            claim.id,
            escape(&claim.claim),
            claim.verdict,
            escape(&claim.reason)
        );
    }
    for figure in &record.figures {
        let png = fs::read(folder.join(&figure.png)).with_context(|| figure.png.clone())?;
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        let _ = write!(
            body,
            "<figure><img src=\"data:image/png;base64,{data}\" alt=\"{}\"><figcaption>{}</figcaption></figure>",
            escape(&figure.alt),
            escape(&figure.caption)
        );
    }
    for t in &record.tables {
        *body += &table(t);
    }
    for note in &record.notes {
        let _ = write!(body, "<p>{}</p>", escape(note));
    }
    Ok(())
}

fn table(table: &Table) -> String {
    let mut text = format!("<table><caption>{}</caption><tr>", escape(&table.caption));
    for c in &table.columns {
        let unit = match c.unit {
            Unit::Label | Unit::One | Unit::Count => String::new(),
            unit => format!(" ({unit})"),
        };
        let _ = write!(text, "<th>{}{unit}</th>", escape(&c.name));
    }
    text += "</tr>";
    for row in &table.rows {
        text += "<tr>";
        for (cell, c) in row.iter().zip(&table.columns) {
            let class = if c.unit == Unit::Label { "" } else { " class=\"n\"" };
            let _ = write!(text, "<td{class}>{}</td>", escape(&cell.to_string()));
        }
        text += "</tr>";
    }
    text + "</table>"
}

/// Text as HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
