//! `report.md`: reads well on a code host.

use std::fmt::Write as _;

use crate::page::{bibliography, notation, numbers, snippets, story, thumbnail};

use crate::model::results::{Form, MeshCard, Record, Results};
use crate::model::table::{Column, Table, Unit};
use crate::model::verdict::Judgement;

/// The report in Markdown. Links are relative to its folder.
pub(crate) fn report(results: &Results) -> String {
    let mut text = format!("# {}\n\n{}\n\n", story::TITLE, story::about(results));
    text += &provenance(results);
    text += &found(results);
    text += &claims(results);
    text += &meshes(results);
    text += "\n## Contents\n\n";
    for record in story::in_order(results) {
        let _ = writeln!(text, "- [{}](#{})", heading(record), anchor(&heading(record)));
    }
    text += "\nFigures have the numbers of the page; the page has some more, as views to turn.\n";
    let first = numbers::first_numbers(results);
    let number = |record: &Record| {
        let found = first.iter().find(|(known, _)| std::ptr::eq(*known, record));
        found.map_or(1, |(_, number)| *number)
    };
    for act in &story::ACTS {
        let mut own = act.sections(results).peekable();
        if own.peek().is_some() {
            let _ = write!(text, "\n# {}\n\n{}\n", act.title, act.about());
        }
        for record in own {
            text += &section(record, number(record), results.form);
        }
    }
    for record in story::others(results) {
        text += &section(record, number(record), results.form);
    }
    let rules = story::rules(results);
    if !rules.is_empty() {
        text += "\n## What we would tell the student\n\n";
        for (k, rule) in rules.iter().enumerate() {
            let _ = writeln!(text, "{}. {} (claim {})", k + 1, rule.text(), rule.claim);
        }
    }
    text + &sources(results)
}

/// The bibliography, with links.
fn sources(results: &Results) -> String {
    let all = bibliography::of(results);
    let mut text = String::new();
    if !all.is_empty() {
        text += "\n## Sources\n\n";
    }
    for (entry, sections) in all {
        let title = if entry.url.is_empty() {
            entry.title
        } else {
            format!("[{}]({})", entry.title, entry.url)
        };
        let (authors, place, sections) = (entry.authors, entry.place, sections.join(", "));
        let _ = writeln!(text, "- {authors}: {title}. {place} ({sections})");
    }
    text
}

fn section(record: &Record, first: usize, form: Form) -> String {
    let mut text = format!("\n## {}\n", heading(record));
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
    if let Some(reference) = notation::reference(record) {
        let _ = write!(text, "\n{reference}\n");
    }
    let sources = bibliography::cited(&record.section.sources);
    let sources: Vec<String> = sources.into_iter().map(|entry| entry.short).collect();
    if !sources.is_empty() {
        let _ = write!(text, "\nSources: {}.\n", sources.join("; "));
    }
    if let Some(lines) = snippets::for_section(&record.id) {
        let _ = write!(text, "\n```rust\n{lines}\n```\n");
    }
    let commands = &record.section.commands;
    if !commands.is_empty() {
        let _ = write!(text, "\n```sh\n{}\n```\n", commands.join("\n"));
    }
    text + &body(record, first, form)
}

/// The heading of an experiment's section.
fn heading(record: &Record) -> String {
    format!("{}: {}", record.id, record.title)
}

/// The name under which code hosts link to a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || [' ', '-'].contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn provenance(results: &Results) -> String {
    let p = &results.provenance;
    let stand_ins: Vec<String> = stand_ins(results);
    let mut text = format!(
        "Written by `cargo xtask reproduce{}` ({}, commit {}{}) on {}, {} threads of {}, seed {}.\n",
        if p.quick { " --quick" } else { "" },
        p.program,
        p.commit.get(..12).unwrap_or(&p.commit),
        if p.dirty { " with changes" } else { "" },
        p.date,
        p.threads,
        p.processor,
        p.seed,
    );
    if !stand_ins.is_empty() {
        let _ = write!(
            text,
            "\nGenerated meshes took the place of the assignment's: {}. \
             With `--meshes FOLDER` the real ones are used.\n",
            stand_ins.join(", ")
        );
    }
    text
}

/// `stand-in for original`, once each.
pub(crate) fn stand_ins(results: &Results) -> Vec<String> {
    let mut pairs = vec![];
    for source in results.experiments.iter().flat_map(|r| &r.inputs).filter(|s| s.stand_in) {
        let pair = format!("{} for {}", source.file, source.stands_for);
        if !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    pairs
}

/// The id of a claim and the true statement.
fn found_in(claim: &Judgement) -> String {
    let finding = if claim.finding.is_empty() { &claim.claim } else { &claim.finding };
    format!("{} {}", claim.id, finding.trim_end_matches('.'))
}

/// The findings, a line for each verdict.
fn found(results: &Results) -> String {
    let mut text = String::new();
    for (verdict, words) in story::GROUPS {
        let claims: Vec<String> = results.judged(verdict).iter().map(|c| found_in(c)).collect();
        if !claims.is_empty() {
            let _ = writeln!(text, "- **{words}:** {}.", claims.join("; "));
        }
    }
    if text.is_empty() {
        return text;
    }
    let lessons = story::lessons(results);
    if !lessons.is_empty() {
        let _ = writeln!(text, "- **To remember:** {lessons}.");
    }
    format!("\n{}\n\n{text}", story::tally(results))
}

fn claims(results: &Results) -> String {
    let source = claim_table(results, false, "");
    let ours = claim_table(results, true, "");
    let mut text = String::new();
    if !source.is_empty() {
        let _ = write!(text, "\n## Claims of the original report\n\n{source}");
    }
    if !ours.is_empty() {
        let _ = write!(text, "\n## Claims of Fairing\n\n{ours}");
    }
    text
}

/// The meshes by name.
fn meshes(results: &Results) -> String {
    let all = thumbnail::all(results);
    if all.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n## The meshes\n\n| | Mesh | Vertices | Faces | Sections |\n|---|---|--:|--:|---|\n",
    );
    for (card, sections) in all {
        let MeshCard { name, vertices, faces, picture } = card;
        let sections = sections.join(", ");
        let _ = writeln!(
            text,
            "| <img src=\"{picture}\" alt=\"The {name}.\" width=\"120\"> | {name} | {vertices} | {faces} | {sections} |"
        );
    }
    text
}

/// The number of claims of the original report that hold, and the lessons for a student: two
/// paragraphs.
pub fn summary(results: &Results) -> String {
    let lessons = story::lessons(results);
    if lessons.is_empty() {
        format!("{}\n", story::tally(results))
    } else {
        format!("{}\n\nTo remember: {lessons}.\n", story::tally(results))
    }
}

/// A table of claims, those of the original report or our own, with links into the report at
/// `place`: for each the verdict, the true statement in one sentence, and the deciding number;
/// nothing if there is no claim.
pub fn claim_table(results: &Results, ours: bool, place: &str) -> String {
    let mut rows = String::new();
    for (record, claim) in results.claims().into_iter().filter(|(_, c)| c.ours == ours) {
        let number = claim.numbers.first().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(
            rows,
            "| [{}]({place}#{}) | {} | **{}** | {} | {} |",
            claim.id,
            anchor(&heading(record)),
            cell(&claim.claim),
            claim.verdict,
            cell(&claim.finding),
            cell(&number),
        );
    }
    if rows.is_empty() {
        rows
    } else {
        format!(
            "| | Claim | Verdict | What is true | Deciding number |\n|---|---|---|---|---|\n{rows}"
        )
    }
}

/// The parameters and the meshes of an experiment.
fn inputs(record: &Record) -> String {
    let mut text = String::new();
    if !record.parameters.is_empty() {
        text += "\n";
        for p in &record.parameters {
            let _ = writeln!(text, "- {}: {}", p.name, p.value);
        }
    }
    for source in &record.inputs {
        let role = if source.stand_in {
            format!(", standing in for `{}`", source.stands_for)
        } else {
            String::new()
        };
        let _ = write!(
            text,
            "\nInput: `{}`{role} (sha256 `{}…`).\n",
            source.file,
            &source.sha256[..12]
        );
    }
    text
}

/// `first` is the number of its first figure.
fn body(record: &Record, first: usize, form: Form) -> String {
    let mut text = inputs(record);
    let numbered = |id: &str| match numbers::place(record, id) {
        Some(place) => format!("Figure {}. ", first + place),
        None => String::new(),
    };
    for claim in &record.claims {
        let _ = write!(
            text,
            "\n> **Claim {}:** {}\n>\n> **{}**: {}\n",
            claim.id, claim.claim, claim.verdict, claim.reason
        );
    }
    if let Some(play) = &record.section.playground {
        let number = numbered(&play.id());
        let _ = write!(text, "\n*{number}In the page, to play with.* {}\n", play.caption);
    }
    let mut figures: Vec<_> = record.figures.iter().collect();
    figures.sort_by_key(|figure| numbers::place(record, &figure.id));
    for figure in figures {
        let caption = numbered(&figure.id) + &figure.caption;
        let _ = write!(text, "\n![{}]({})\n\n*{caption}*", figure.alt, figure.png);
        if let Some(svg) = &figure.svg {
            let _ = write!(text, " ([SVG]({svg}))");
        }
        text += "\n";
    }
    for table in &record.tables {
        text += &captioned(table, record, form);
    }
    for note in &record.notes {
        let _ = write!(text, "\n{note}\n");
    }
    let others: Vec<_> = record.other_files().collect();
    if !others.is_empty() {
        text += "\nFiles:\n\n";
        for f in others {
            let _ = writeln!(text, "- [{}]({}): {}", f.path, f.path, f.about);
        }
    }
    let _ = write!(
        text,
        "\nMade by `cargo xtask reproduce --only {}` in {:.1} s.\n",
        record.id, record.seconds
    );
    text
}

/// A table over its caption.
fn captioned(t: &Table, record: &Record, form: Form) -> String {
    let mut text = String::new();
    if t.rows.len() > LONG && form == Form::Small {
        let _ = write!(text, "\n{} rows, in the CSV.\n", t.rows.len());
    } else if t.rows.len() > LONG {
        let _ = write!(
            text,
            "\n<details><summary>{} rows</summary>\n{}\n</details>\n",
            t.rows.len(),
            rows(t)
        );
    } else {
        text += &rows(t);
    }
    let _ = write!(text, "\n*{}* ([CSV]({}/{}.csv){})\n", t.caption, record.id, t.id, left_out(t));
    text
}

/// Tables with more rows than this are folded, or left out of a small report.
pub(crate) const LONG: usize = 24;

/// Text with `|` escaped, so that it does not end its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The largest number of columns of a table.
const WIDE: usize = 7;

/// The name of a column for readers.
pub(crate) fn named(column: &Column) -> String {
    column.name.replace("lambda", "λ")
}

/// The columns that are shown: those that are not meant for the CSV alone, the first [`WIDE`] of
/// them.
pub(crate) fn columns(table: &Table) -> Vec<usize> {
    let shown = (0..table.columns.len()).filter(|&c| !table.columns[c].aside);
    shown.take(WIDE).collect()
}

/// A remark on the columns that are not shown.
pub(crate) fn left_out(table: &Table) -> String {
    match table.columns.len() - columns(table).len() {
        0 => String::new(),
        1 => ", with one more column".into(),
        n => format!(", with {n} more columns"),
    }
}

/// A table; numbers are set flush right.
fn rows(table: &Table) -> String {
    let heading = |c: &Column| match c.unit {
        Unit::Label | Unit::One | Unit::Count | Unit::Order => named(c),
        unit => format!("{} ({unit})", named(c)),
    };
    let mut text = String::from("\n|");
    let columns = columns(table);
    for &c in &columns {
        let _ = write!(text, " {} |", cell(&heading(&table.columns[c])));
    }
    text += "\n|";
    for &c in &columns {
        text += if table.columns[c].unit == Unit::Label { "---|" } else { "--:|" };
    }
    for row in &table.rows {
        text += "\n|";
        for &c in &columns {
            let _ = write!(text, " {} |", cell(&row[c].to_string()));
        }
    }
    text + "\n"
}
