//! `report.md`: reads well on a code host.

mod appendix;
mod claims;
mod tables;

use std::fmt::Write as _;

use crate::model::results::{Record, Results};
use crate::model::verdict::Judgement;
use crate::page::prose::Paragraph;
use crate::page::{bibliography, notation, numbers, prose, story};

pub(crate) use appendix::stand_ins;
pub(crate) use tables::{LONG, columns, left_out, named};

/// The report in Markdown. Links are relative to its folder.
pub(crate) fn report(results: &Results) -> String {
    let mut text = format!("# {}\n\n{}\n", story::TITLE, story::about(results));
    let _ = write!(text, "\n{}\n", story::forms());
    text += &rules(results);
    text += &claims::claims(results);
    text += &appendix::symbols();
    let mut next = 1;
    for act in &story::ACTS {
        let mut own = act.sections(results).peekable();
        if own.peek().is_some() {
            let _ = write!(text, "\n## {}\n\n{}\n", act.title, act.about());
        }
        for record in own {
            text += &section(record, &mut next);
        }
    }
    for record in story::others(results) {
        text += &section(record, &mut next);
    }
    text += &appendix::meshes(results);
    text += &appendix::data(results);
    text + &appendix::provenance(results)
}

/// The advice to the student.
fn rules(results: &Results) -> String {
    let rules = story::rules(results);
    if rules.is_empty() {
        return String::new();
    }
    let mut text = String::from("\n## What we would tell the student\n\n");
    for (k, rule) in rules.iter().enumerate() {
        let _ = writeln!(text, "{}. {} (claim {})", k + 1, rule.text(), rule.claim);
    }
    text
}

/// A section; `next` is the number of the next figure.
fn section(record: &Record, next: &mut usize) -> String {
    let mut text = format!("\n### {}\n", record.title);
    if !record.section.bridge.is_empty() {
        let _ = write!(text, "\n{}\n", record.section.bridge);
    }
    let _ = write!(text, "\n**Question.** {}\n", record.question);
    if let Some(error) = &record.error {
        let _ = write!(text, "\n**This experiment failed:** {error}\n");
        return text;
    }
    let _ = write!(text, "\n{}\n", record.method);
    for formula in &record.formulas {
        let _ = write!(text, "\n$${formula}$$\n");
    }
    let sources: Vec<String> =
        bibliography::cited(&record.section.sources).iter().map(source).collect();
    let sources = (!sources.is_empty()).then(|| format!("Sources: {}.", sources.join("; ")));
    // The table of symbols covers the case of each mesh.
    let reference =
        notation::reference(record).filter(|_| record.section.edge_lengths_of != "each mesh");
    let asides: Vec<String> = reference.into_iter().chain(sources).collect();
    if !asides.is_empty() {
        let _ = write!(text, "\n{}\n", asides.join(" "));
    }
    let commands = &record.section.commands;
    if !commands.is_empty() {
        let _ = write!(text, "\n```sh\n{}\n```\n", commands.join("\n"));
    }
    text + &found(record, next)
}

/// A source as in text, with a link.
fn source(entry: &bibliography::Entry) -> String {
    if entry.url.is_empty() {
        return entry.short.clone();
    }
    format!("[{}]({})", entry.short, entry.url)
}

/// More parameters than these are left to `results.json`.
const MANY: usize = 6;

/// The parameters, verdicts, figures and tables of a section, and its remarks.
fn found(record: &Record, next: &mut usize) -> String {
    let mut text = String::new();
    if (1..=MANY).contains(&record.parameters.len()) {
        text += "\n";
        for p in &record.parameters {
            let _ = writeln!(text, "- {}: {}", p.name, p.value);
        }
    }
    text += &record.claims.iter().map(judgement).collect::<String>();
    // The first note of a section without claims is its answer.
    let answers = record.notes.len().min(usize::from(record.claims.is_empty()));
    let (answer, remarks) = record.notes.split_at(answers);
    text += &answer.iter().map(|note| format!("\n**Answer.** {note}\n")).collect::<String>();
    for figure in numbers::pictures(record) {
        let (alt, png, caption) = (&figure.alt, &figure.png, &figure.caption);
        let _ = write!(text, "\n![{alt}]({png})\n\n*Figure {next}. {caption}*\n");
        *next += 1;
    }
    text += &record
        .tables
        .iter()
        .filter(|t| tables::is_shown(record, t))
        .map(|t| tables::captioned(t, record))
        .collect::<String>();
    text + &remarks.iter().map(|note| format!("\n{note}\n")).collect::<String>()
}

/// A claim, the verdict and the reasons.
fn judgement(claim: &Judgement) -> String {
    let Judgement { id, verdict, reason, .. } = claim;
    let mut text = format!("\n> **{} {id}, {verdict}:** {}\n", claim.kind(), claim.claim);
    let mut in_list = false;
    for paragraph in prose::paragraphs(reason) {
        let (gap, line) = match paragraph {
            Paragraph::Item(words) => (!in_list, format!("- {words}")),
            Paragraph::Plain(words) => (true, words.to_string()),
        };
        in_list = matches!(paragraph, Paragraph::Item(_));
        if gap {
            text += ">\n";
        }
        let _ = writeln!(text, "> {line}");
    }
    text
}
