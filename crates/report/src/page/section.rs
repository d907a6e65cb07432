//! One experiment as a section of the page.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use base64::Engine as _;
use rayon::prelude::*;

use super::html::escape;
use super::view;
use crate::{markdown, mathml};
use fairing_results::results::{FigureFile, Form, Record};
use fairing_results::table::{Cell, Table, Unit};
use fairing_results::verdict::{Judgement, Verdict};

/// Question, method, verdicts, views, figures, tables and how to make it
/// again.
pub(super) fn experiment(record: &Record, folder: &Path, form: Form) -> Result<String> {
    let mut text = format!(
        "<section id=\"{0}\"><h2><span class=\"id\">{0}</span> {1}</h2>\
         <p class=\"question\">{2}</p>",
        escape(&record.id),
        escape(&record.title),
        escape(&record.question)
    );
    if let Some(error) = &record.error {
        let _ = write!(
            text,
            "<p class=\"error\">This experiment failed: {}</p></section>",
            escape(error)
        );
        return Ok(text);
    }
    for claim in &record.claims {
        text += &judgement(claim);
    }
    if !record.method.is_empty() {
        text += "<details open><summary>Method</summary>";
        for paragraph in record.method.split("\n\n") {
            let _ = write!(text, "<p>{}</p>", escape(paragraph));
        }
        for formula in &record.formulas {
            let _ = write!(text, "<p>{}</p>", mathml::displayed(formula)?);
        }
        text += &parameters(record);
        text += "</details>";
    }
    let views = record.views.par_iter().map(|v| {
        let id = format!("{}-{}", record.id, v.id);
        view::figure(v, &id, &figure_id(record, &v.fallback), folder, form)
    });
    text += &views.collect::<Result<String>>()?;
    let pictures = record.figures.par_iter().map(|f| picture(record, f, folder, form));
    text += &pictures.collect::<Result<String>>()?;
    for t in &record.tables {
        let link = format!("{}/{}.csv", record.id, t.id);
        text += &table(t, &link, form);
    }
    for note in &record.notes {
        let _ = write!(text, "<p>{}</p>", escape(note));
    }
    text += &files(record);
    Ok(text + "</section>")
}

fn figure_id(record: &Record, figure: &str) -> String {
    format!("figure-{}-{figure}", record.id)
}

/// A verdict as a coloured word.
pub(super) fn verdict(verdict: Verdict) -> String {
    format!("<span class=\"verdict {verdict}\">{verdict}</span>")
}

fn judgement(claim: &Judgement) -> String {
    let mut text = format!(
        "<div class=\"claim {2}\" id=\"claim-{0}\"><p><b>Claim {0}.</b> {1}</p><p>{3} {4}</p>",
        escape(&claim.id),
        escape(&claim.claim),
        claim.verdict,
        verdict(claim.verdict),
        escape(&claim.reason)
    );
    if !claim.numbers.is_empty() {
        text += "<ul class=\"numbers\">";
        for number in &claim.numbers {
            let _ = write!(text, "<li>{}</li>", escape(&number.to_string()));
        }
        text += "</ul>";
    }
    text + "</div>"
}

fn parameters(record: &Record) -> String {
    let mut rows = String::new();
    let mut row = |name: &str, value: String| {
        let _ = write!(rows, "<tr><th scope=\"row\">{}</th><td>{value}</td></tr>", escape(name));
    };
    for parameter in &record.parameters {
        row(&parameter.name, escape(&parameter.value));
    }
    for source in &record.inputs {
        let role = match source.stand_in {
            true => format!(", standing in for <code>{}</code>", escape(&source.stands_for)),
            false => String::new(),
        };
        let digest = source.sha256.get(..12).unwrap_or(&source.sha256);
        row(
            "input",
            format!("<code>{}</code>{role} (sha256 <code>{digest}…</code>)", escape(&source.file)),
        );
    }
    match rows.is_empty() {
        true => rows,
        false => format!(
            "<div class=\"wide\"><table class=\"facts\"><tbody>{rows}</tbody></table></div>"
        ),
    }
}

/// What the page shows of a figure: the smaller of PNG and SVG, or its file if
/// the report is small.
pub(super) fn source(figure: &FigureFile, folder: &Path, form: Form) -> Result<String> {
    let read = |path: &str| fs::read(folder.join(path)).with_context(|| format!("reading {path}"));
    let png = read(&figure.png)?;
    let svg = figure.svg.as_deref().map(read).transpose()?;
    let (kind, bytes, path) = match (svg, &figure.svg) {
        (Some(svg), Some(path)) if svg.len() <= png.len() => ("svg+xml", svg, path),
        _ => ("png", png, &figure.png),
    };
    Ok(match form {
        Form::Small => escape(path),
        Form::Whole => {
            let data = base64::engine::general_purpose::STANDARD.encode(bytes);
            format!("data:image/{kind};base64,{data}")
        }
    })
}

/// A figure with its caption, and links to both of its files.
fn picture(record: &Record, figure: &FigureFile, folder: &Path, form: Form) -> Result<String> {
    let source = source(figure, folder, form)?;
    let mut links = format!("<a href=\"{}\">PNG</a>", escape(&figure.png));
    if let Some(svg) = &figure.svg {
        let _ = write!(links, ", <a href=\"{}\">SVG</a>", escape(svg));
    }
    Ok(format!(
        "<figure class=\"picture\" id=\"{}\"><img loading=\"lazy\" src=\"{source}\" \
         alt=\"{}\"><figcaption>{} <span class=\"soft\">({links})</span></figcaption></figure>",
        escape(&figure_id(record, &figure.id)),
        escape(&figure.alt),
        escape(&figure.caption)
    ))
}

fn table(table: &Table, csv: &str, form: Form) -> String {
    let caption = format!(
        "{} <span class=\"soft\">(<a href=\"{}\">CSV</a>)</span>",
        escape(&table.caption),
        escape(csv)
    );
    if table.rows.len() > markdown::LONG && form == Form::Small {
        return format!(
            "<p class=\"caption\">{caption} <span class=\"soft\">{} rows, in the CSV.</span></p>",
            table.rows.len()
        );
    }
    // What is folded is not printed either.
    let (before, caption, after) = match table.rows.len() {
        rows if rows > markdown::LONG => (
            format!("<p class=\"caption\">{caption}</p><details><summary>{rows} rows</summary>"),
            String::new(),
            "</details>",
        ),
        _ => (String::new(), format!("<caption>{caption}</caption>"), ""),
    };
    let mut text = format!(
        "{before}<div class=\"wide\"><table id=\"table-{}\">{caption}<thead><tr>",
        escape(csv.trim_end_matches(".csv")).replace('/', "-"),
    );
    for c in &table.columns {
        let unit = match c.unit {
            Unit::Label | Unit::One | Unit::Count => String::new(),
            unit => format!(" ({unit})"),
        };
        let class = class(c.unit);
        let _ = write!(text, "<th scope=\"col\"{class}>{}{}</th>", escape(&c.name), escape(&unit));
    }
    text += "</tr></thead><tbody>";
    for row in &table.rows {
        text += "<tr>";
        for (cell, c) in row.iter().zip(&table.columns) {
            let class = class(c.unit);
            let _ = write!(text, "<td{class}>{}</td>", escape(&Cell::to_string(cell)));
        }
        text += "</tr>";
    }
    text + "</tbody></table></div>" + after
}

/// Numbers are set flush right.
fn class(unit: Unit) -> &'static str {
    if unit == Unit::Label { "" } else { " class=\"n\"" }
}

fn files(record: &Record) -> String {
    let mut text = String::new();
    let others: Vec<_> = record.other_files().collect();
    if !others.is_empty() {
        text += "<details><summary>Files</summary><ul>";
        for file in others {
            let path = escape(&file.path);
            let _ = write!(text, "<li><a href=\"{path}\">{path}</a>: {}</li>", escape(&file.about));
        }
        text += "</ul></details>";
    }
    let _ = write!(
        text,
        "<p class=\"soft\">Made by <code>cargo xtask reproduce --only {}</code> in {:.1} s.</p>",
        escape(&record.id),
        record.seconds
    );
    text
}
