//! One experiment as a section of the page.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use base64::Engine as _;
use rayon::prelude::*;

use super::html::escape;
use super::view;
use crate::play::Play;
use crate::{markdown, mathml, play, snippets};
use fairing_results::results::{FigureFile, Form, Record, ViewFile};
use fairing_results::table::{Cell, Table, Unit};
use fairing_results::verdict::{Judgement, Shown, Verdict};

/// Question, method, verdicts, views, figures, tables and how to make it
/// again.
///
/// `first` is the number of its first figure.
pub(super) fn experiment(
    all: &[Record],
    record: &Record,
    first: usize,
    folder: &Path,
    form: Form,
) -> Result<String> {
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
        text += &judgement(all, claim);
    }
    if !record.method.is_empty() {
        text += "<details open><summary>Method</summary>";
        for paragraph in record.method.split("\n\n") {
            let _ = write!(text, "<p>{}</p>", escape(paragraph));
        }
        for formula in &record.formulas {
            let _ = write!(text, "<p class=\"formula\">{}</p>", mathml::displayed(formula)?);
        }
        text += "</details>";
        let rows = parameters(record);
        if !rows.is_empty() {
            let _ =
                write!(text, "<details><summary>Parameters and inputs</summary>{rows}</details>");
        }
    }
    if let Some(lines) = snippets::of(&record.id) {
        let _ = write!(
            text,
            "<details><summary>In Rust</summary><pre><code>{}</code></pre><p class=\"soft\">All figures and tables of this section: \
             <code>cargo xtask reproduce --only {}</code></p></details>",
            escape(&lines),
            escape(&record.id)
        );
    }
    text += &shown(record, first, folder, form)?;
    text += &tables(record, form);
    for note in &record.notes {
        let _ = write!(text, "<p>{}</p>", escape(note));
    }
    text += &files(record);
    Ok(text + "</section>")
}

/// Whether a picture is shown as the still of a view rather than by itself: a picture or a view, not both.
fn is_paper(record: &Record, figure: &FigureFile) -> bool {
    figure.svg.is_none() && record.views.iter().any(|view| view.fallback == figure.id)
}

/// How many numbered figures an experiment has.
pub(super) fn count(record: &Record) -> usize {
    play::of(&record.id).count()
        + record.views.len()
        + record.figures.iter().filter(|f| !is_paper(record, f)).count()
}

/// So many views are seen at once, the others are folded.
const UNFOLDED: usize = 2;

/// Playgrounds, the first views, each with the picture that is printed in its place, and plots; then, folded, the other
/// views and pictures. Numbered from `first`.
fn shown(record: &Record, first: usize, folder: &Path, form: Form) -> Result<String> {
    let others = || record.figures.iter().filter(|f| !is_paper(record, f));
    let views = |range: &dyn Fn(usize) -> bool| -> Vec<Item<'_>> {
        let kept = record.views.iter().enumerate().filter(|(k, _)| range(*k));
        kept.map(|(k, view)| Item::View(k, view)).collect()
    };
    let mut seen: Vec<Item<'_>> = play::of(&record.id).map(Item::Play).collect();
    seen.extend(views(&|k| k < UNFOLDED));
    seen.extend(others().filter(|f| f.svg.is_some()).map(Item::Picture));
    let mut folded = views(&|k| k >= UNFOLDED);
    folded.extend(others().filter(|f| f.svg.is_none()).map(Item::Picture));
    if seen.is_empty() {
        std::mem::swap(&mut seen, &mut folded);
    }
    let draw = |items: &[Item<'_>], from: usize| -> Result<String> {
        let one = |(k, item): (usize, &Item<'_>)| {
            item.html(record, &format!("<b>Figure {}.</b> ", from + k), folder, form)
        };
        items.par_iter().enumerate().map(one).collect()
    };
    let mut text = draw(&seen, first)?;
    if !folded.is_empty() {
        let more = draw(&folded, first + seen.len())?;
        let count = folded.len();
        let word = if count == 1 { "figure" } else { "figures" };
        let _ = write!(text, "<details><summary>{count} more {word}</summary>{more}</details>");
    }
    Ok(text)
}

/// Something with a number.
enum Item<'a> {
    Play(&'a Play),
    /// With its place among the views.
    View(usize, &'a ViewFile),
    Picture(&'a FigureFile),
}

impl Item<'_> {
    fn html(&self, record: &Record, label: &str, folder: &Path, form: Form) -> Result<String> {
        match self {
            Self::Play(play) => Ok(playground(play, label)),
            Self::Picture(figure) => picture(record, figure, label, folder, form),
            &Self::View(k, v) => {
                let id = format!("{}-{}", record.id, v.id);
                let fallback = figure_id(record, &v.fallback);
                let earlier = record.views[..k].iter().any(|other| other.fallback == v.fallback);
                let is_still =
                    |f: &&FigureFile| f.id == v.fallback && !earlier && is_paper(record, f);
                let figure = record.figures.iter().find(is_still);
                let paper = match figure {
                    Some(figure) => format!(
                        "<div class=\"paper\" id=\"{}\">{}</div>",
                        escape(&fallback),
                        image(figure, folder, form)?
                    ),
                    None => String::new(),
                };
                view::figure(v, &id, &fallback, &paper, label, folder, form)
            }
        }
    }
}

/// A place in which the page's script builds a playground.
fn playground(play: &Play, label: &str) -> String {
    format!(
        "<figure class=\"play\" id=\"{}\" data-play=\"{}\"><div class=\"stage\"><p class=\"hint\">{} \
         It is computed by the page's script.</p></div><figcaption>{label}{}</figcaption></figure>",
        play.id(),
        play.kind,
        escape(play.alt),
        escape(play.caption)
    )
}

/// Where a figure is on the page: its own place, or that of the view that it is the still of.
pub(super) fn anchor(records: &[Record], record: &str, figure: &str) -> String {
    let views = records.iter().filter(|r| r.id == record).flat_map(|r| &r.views);
    match views.into_iter().find(|view| view.fallback == figure) {
        Some(view) => format!("{record}-{}", view.id),
        None => format!("figure-{record}-{figure}"),
    }
}

fn figure_id(record: &Record, figure: &str) -> String {
    format!("figure-{}-{figure}", record.id)
}

/// A verdict as a coloured word.
pub(super) fn verdict(verdict: Verdict) -> String {
    format!("<span class=\"verdict {verdict}\">{verdict}</span>")
}

/// A link to the view or playground of the page in the state that decided a claim; nothing where the page has none.
pub(super) fn link(all: &[Record], claim: &Judgement) -> String {
    let Some(Shown { id, state }) = &claim.shown else { return String::new() };
    let is_view = |r: &Record| r.views.iter().any(|v| format!("{}-{}", r.id, v.id) == *id);
    let is_play = |r: &Record| play::of(&r.id).any(|play| play.id() == *id);
    if !all.iter().any(|r| is_view(r) || is_play(r)) {
        return String::new();
    }
    let state = state.replace('%', "%25").replace(' ', "%20").replace('&', "%26");
    format!(" <a class=\"shown\" href=\"#{}={}\">See it</a>", escape(id), escape(&state))
}

fn judgement(all: &[Record], claim: &Judgement) -> String {
    let mut text = format!(
        "<div class=\"claim {2}\" id=\"claim-{0}\"><p><b>Claim {0}.</b> {1}</p><p>{3} {4}{5}</p>",
        escape(&claim.id),
        escape(&claim.claim),
        claim.verdict,
        verdict(claim.verdict),
        escape(&claim.reason),
        link(all, claim)
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

/// A picture as the page shows it: a plot as SVG in the page itself, which follows the theme; else an image, whose
/// size is said so that the page does not jump when it is loaded.
///
/// # Errors
///
/// If a file cannot be read, or is no picture.
pub(super) fn image(figure: &FigureFile, folder: &Path, form: Form) -> Result<String> {
    if let Some(path) = &figure.svg {
        let read = fs::read_to_string(folder.join(path));
        let svg = read.with_context(|| format!("reading {path}"))?;
        let links = match figure.links.is_empty() {
            true => String::new(),
            false => format!("data-links=\"{}\" ", escape(&serde_json::to_string(&figure.links)?)),
        };
        let section = path.split('/').next().unwrap_or_default();
        let open = format!(
            "<svg class=\"figure\" role=\"img\" tabindex=\"0\" data-section=\"{}\" {links}aria-label=\"{}\" ",
            escape(section),
            escape(&figure.alt)
        );
        return Ok(svg.replacen("<svg ", &open, 1));
    }
    png(figure.small.as_ref().unwrap_or(&figure.png), &figure.alt, folder, form)
}

/// A PNG file as an image.
///
/// # Errors
///
/// If it cannot be read, or is no picture.
pub(super) fn png(path: &str, alt: &str, folder: &Path, form: Form) -> Result<String> {
    let bytes = fs::read(folder.join(path)).with_context(|| format!("reading {path}"))?;
    let [width, height] = png_size(&bytes).with_context(|| format!("{path} is no PNG file"))?;
    // What is in the page is there when it is printed; what is beside it comes as it comes near.
    let (source, when) = match form {
        Form::Small => (escape(path), "loading=\"lazy\" "),
        Form::Whole => {
            let data = base64::engine::general_purpose::STANDARD.encode(bytes);
            (format!("data:image/png;base64,{data}"), "")
        }
    };
    Ok(format!(
        "<img {when}width=\"{width}\" height=\"{height}\" src=\"{source}\" alt=\"{}\">",
        escape(alt)
    ))
}

/// Width and height, which are in the first block of a PNG file.
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let is_png = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.get(12..16)? == b"IHDR";
    let number = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    is_png.then_some([number(16)?, number(20)?])
}

/// A figure with its caption, and links to both of its files.
fn picture(
    record: &Record,
    figure: &FigureFile,
    label: &str,
    folder: &Path,
    form: Form,
) -> Result<String> {
    let mut links = format!("<a href=\"{}\">PNG</a>", escape(&figure.png));
    if let Some(svg) = &figure.svg {
        let _ = write!(links, ", <a href=\"{}\">SVG</a>", escape(svg));
    }
    Ok(format!(
        "<figure class=\"picture\" id=\"{}\">{}<figcaption>{label}{} \
         <span class=\"soft\">({links})</span></figcaption></figure>",
        escape(&figure_id(record, &figure.id)),
        image(figure, folder, form)?,
        escape(&figure.caption)
    ))
}

/// The first table of a section, and the others folded.
fn tables(record: &Record, form: Form) -> String {
    let one = |t: &Table| table(t, &format!("{}/{}.csv", record.id, t.id), form);
    let all: Vec<String> = record.tables.iter().map(one).collect();
    let Some((first, others)) = all.split_first() else { return String::new() };
    match others.len() {
        0 => first.clone(),
        n => format!(
            "{first}<details><summary>{n} more {}</summary>{}</details>",
            if n == 1 { "table" } else { "tables" },
            others.concat()
        ),
    }
}

/// Tables with more rows than this are folded.
const SEEN: usize = 12;

fn table(table: &Table, csv: &str, form: Form) -> String {
    let caption = format!(
        "{} <span class=\"soft\">(<a href=\"{}\">CSV{}</a>)</span>",
        escape(&table.caption),
        escape(csv),
        markdown::left_out(table)
    );
    if table.rows.len() > markdown::LONG && form == Form::Small {
        return format!(
            "<p class=\"caption\">{caption} <span class=\"soft\">{} rows, in the CSV.</span></p>",
            table.rows.len()
        );
    }
    // What is folded is not printed either.
    let (before, caption, after) = match table.rows.len() {
        rows if rows > SEEN => (
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
    let columns = markdown::columns(table);
    for &c in &columns {
        let c = &table.columns[c];
        let unit = match c.unit {
            Unit::Label | Unit::One | Unit::Count => String::new(),
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
