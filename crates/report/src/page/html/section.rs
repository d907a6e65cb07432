//! One experiment as a section of the page.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Result;

use super::escape::{escape, paragraphs, with_code};
use super::{figures, tables};
use crate::model::results::Record;
use crate::model::verdict::{Deciding, Judgement, Shown, Verdict};
use crate::page::{bibliography, mathml, notation, numbers, snippets};

/// Question, method, verdicts, views, figures, tables and how to make it
/// again.
///
/// `first` is the number of its first figure.
pub(super) fn experiment(
    all: &[Record],
    record: &Record,
    first: usize,
    folder: &Path,
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
    if !record.claims.is_empty() {
        let claims: String = record.claims.iter().map(|claim| judgement(all, claim)).collect();
        let _ = write!(text, "<div class=\"judged\">{claims}</div>");
    }
    text += &method(record)?;
    let [figures, folded_figures] = figures::shown(record, first, folder)?;
    let [tables, folded_tables] = tables::tables(record, folder)?;
    text += &(figures + &tables);
    let folded = folded_figures + &folded_tables;
    if !folded.is_empty() {
        let _ = write!(text, "<div class=\"folds\">{folded}</div>");
    }
    let notes: Vec<String> =
        record.notes.iter().map(|note| format!("<p>{}</p>", with_code(note))).collect();
    // The first note of a section without claims is its answer.
    let answers = notes.len().min(usize::from(record.claims.is_empty()));
    let (answer, others) = notes.split_at(answers);
    text += &answer.concat();
    if !others.is_empty() {
        let _ = write!(text, "<details><summary>Remarks</summary>{}</details>", others.concat());
    }
    Ok(text + "</section>")
}

/// The first paragraph of the method and the formulas; then, folded, the rest and the code.
fn method(record: &Record) -> Result<String> {
    let mut text = String::new();
    let mut paragraphs = record.method.split("\n\n").filter(|p| !p.is_empty());
    if let Some(first) = paragraphs.next() {
        let _ = write!(text, "<p>{}</p>", with_code(first));
    }
    // Side by side; where the screen is narrow, parts go below one another.
    let parts = record.formulas.iter().flat_map(|formula| formula.split(r"\qquad"));
    let parts = parts.flat_map(|part| part.split(r"\quad")).map(mathml::displayed);
    let parts: Vec<String> = parts.collect::<Result<_>>()?;
    if !parts.is_empty() {
        let _ = write!(text, "<p class=\"formula\">{}</p>", parts.concat());
    }
    let asides: Vec<String> = notation::reference(record)
        .map(|reference| escape(&reference))
        .into_iter()
        .chain(sources(record))
        .collect();
    if !asides.is_empty() {
        let _ = write!(text, "<p class=\"soft\">{}</p>", asides.join(" "));
    }
    let rest: String = paragraphs.map(|p| format!("<p>{}</p>", with_code(p))).collect();
    let (rows, files) = (parameters(record), files(record));
    text += "<div class=\"folds\">";
    if !(rest.is_empty() && rows.is_empty()) {
        let words = match (rest.is_empty(), rows.is_empty()) {
            (false, false) => "Method in full, parameters and inputs",
            (false, true) => "Method in full",
            _ => "Parameters and inputs",
        };
        let _ = write!(text, "<details><summary>{words}</summary>{rest}{rows}</details>");
    }
    text += &same(record);
    if !files.is_empty() {
        let _ = write!(text, "<details class=\"rows\"><summary>Files</summary>{files}</details>");
    }
    Ok(text + "</div>")
}

/// Links to the sources; `None` without any.
fn sources(record: &Record) -> Option<String> {
    let entries = bibliography::cited(&record.section.sources);
    let links: Vec<String> = entries
        .iter()
        .map(|e| format!("<a href=\"#source-{}\">{}</a>", escape(&e.key), escape(&e.short)))
        .collect();
    (!links.is_empty()).then(|| format!("Sources: {}.", links.join("; ")))
}

/// The Rust code and the commands that reproduce the section.
fn same(record: &Record) -> String {
    let code = |text: &str| format!("<pre><code>{}</code></pre>", escape(text));
    let lines = snippets::for_section(&record.id).map(|lines| code(&lines)).unwrap_or_default();
    let commands = &record.section.commands;
    let shell = if commands.is_empty() { String::new() } else { code(&commands.join("\n")) };
    format!(
        "<details><summary>In Rust and on the command line</summary>{lines}{shell}<p class=\"soft\">All figures and \
         tables of this section: <code>cargo xtask reproduce --only {}</code> ({:.1} s).</p></details>",
        escape(&record.id),
        record.seconds
    )
}

/// A verdict as a coloured word.
pub(super) fn verdict(verdict: Verdict) -> String {
    format!("<span class=\"verdict {}\">{verdict}</span>", verdict.key())
}

/// A link to the view or playground of the page in the state that decided a claim, or to the
/// figure, whose marked line is the state; nothing where the page has none.
pub(super) fn link(all: &[Record], claim: &Judgement) -> String {
    let Some(Shown { id, state }) = &claim.shown else { return String::new() };
    let is_view = |r: &Record| r.views.iter().any(|v| format!("{}-{}", r.id, v.id) == *id);
    let is_play = |r: &Record| r.section.playground.as_ref().is_some_and(|own| own.id() == *id);
    let is_figure = |r: &Record| {
        let mut own = r.figures.iter().filter(|f| !numbers::is_paper(r, f));
        own.any(|f| figures::figure_id(r, &f.id) == *id)
    };
    if !all.iter().any(|r| is_view(r) || is_play(r) || is_figure(r)) {
        return String::new();
    }
    if state.is_empty() {
        return format!(" <a class=\"shown\" href=\"#{}\">See it</a>", escape(id));
    }
    let state = state.replace('%', "%25").replace(' ', "%20").replace('&', "%26");
    format!(" <a class=\"shown\" href=\"#{}={}\">See it</a>", escape(id), escape(&state))
}

/// A claim, its verdict and the true statement; the reasons with their numbers are folded.
fn judgement(all: &[Record], claim: &Judgement) -> String {
    let said = if claim.finding.is_empty() { &claim.reason } else { &claim.finding };
    let mut text = format!(
        "<div class=\"claim {2}\" id=\"claim-{0}\"><p><b>{6} {0}.</b> {1}</p><p>{3} {4}{5}</p>",
        escape(&claim.id),
        escape(&claim.claim),
        claim.verdict.key(),
        verdict(claim.verdict),
        escape(said),
        link(all, claim),
        claim.kind()
    );
    let mut more = String::new();
    if !claim.finding.is_empty() && claim.reason != claim.finding {
        more += &paragraphs(&claim.reason);
    }
    if !claim.numbers.is_empty() {
        more += "<ul class=\"numbers\">";
        for number in &claim.numbers {
            let _ = write!(more, "<li>{}</li>", decided(number));
        }
        more += "</ul>";
    }
    if !more.is_empty() {
        let _ = write!(text, "<details><summary>Reasons</summary>{more}</details>");
    }
    text + "</div>"
}

/// A deciding number after its name.
pub(super) fn decided(number: &Deciding) -> String {
    let text = number.to_string();
    let value = text.strip_prefix(&number.name).unwrap_or_default();
    format!("{}:{}", escape(&number.name), escape(value))
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
        let role = if source.stand_in {
            format!(", standing in for <code>{}</code>", escape(&source.stands_for))
        } else {
            String::new()
        };
        let digest = source.sha256.get(..12).unwrap_or(&source.sha256);
        row(
            "input",
            format!("<code>{}</code>{role} (sha256 <code>{digest}…</code>)", escape(&source.file)),
        );
    }
    if rows.is_empty() {
        rows
    } else {
        format!("<div class=\"wide\"><table class=\"facts\"><tbody>{rows}</tbody></table></div>")
    }
}

/// The meshes of a section: names, not links, since the page may travel without its folder.
fn files(record: &Record) -> String {
    let one = |(path, about): (String, String)| format!("<li><code>{path}</code>: {about}</li>");
    let others = record.other_files().map(|f| (escape(&f.path), escape(&f.about)));
    let items: String = others.map(one).collect();
    if items.is_empty() {
        items
    } else {
        format!("<p class=\"soft\">In the folder in which this page was made:</p><ul>{items}</ul>")
    }
}
