//! `report.md`: reads well on a code host.

use std::fmt::Write as _;

use fairing_results::results::{Form, Record, Results};
use fairing_results::table::{Column, Table, Unit};
use fairing_results::verdict::Verdict;

/// The report in Markdown. Links are relative to its folder.
pub(crate) fn report(results: &Results) -> String {
    let mut text = String::from("# Fairing: the experiments\n\n");
    text += &provenance(results);
    text += &found(results);
    text += &claims(results);
    text += "\n## Contents\n\n";
    for record in &results.experiments {
        let _ = writeln!(text, "- [{}](#{})", heading(record), anchor(&heading(record)));
    }
    for record in &results.experiments {
        let _ = write!(text, "\n## {}\n\n**Question.** {}\n", heading(record), record.question);
        if let Some(error) = &record.error {
            let _ = write!(text, "\n**This experiment failed:** {error}\n");
            continue;
        }
        let _ = write!(text, "\n{}\n", record.method);
        for formula in &record.formulas {
            let _ = write!(text, "\n$${formula}$$\n");
        }
        text += &body(record, results.form);
    }
    text
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
            "\nGenerated meshes took the place of the assignment's: {}. With `--meshes FOLDER` the real ones are used.\n",
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

/// Verdicts with the words for all claims on which they were given.
pub(crate) const GROUPS: [(Verdict, &str); 4] = [
    (Verdict::Confirmed, "Confirmed"),
    (Verdict::Qualified, "True in part"),
    (Verdict::Refuted, "Refuted"),
    (Verdict::Undecided, "Undecided"),
];

/// What was found, a line for each verdict.
fn found(results: &Results) -> String {
    let mut text = String::new();
    for (verdict, words) in GROUPS {
        let claims: Vec<String> =
            results.judged(verdict).iter().map(|c| format!("{} {}", c.id, c.claim)).collect();
        if !claims.is_empty() {
            let _ = writeln!(text, "- **{words}:** {}.", claims.join("; "));
        }
    }
    if text.is_empty() { text } else { format!("\nClaims of the source report:\n\n{text}") }
}

fn claims(results: &Results) -> String {
    let source = claim_table(results, false, "", true);
    let ours = claim_table(results, true, "", true);
    let mut text = String::new();
    if !source.is_empty() {
        let _ = write!(text, "\n## Claims of the source report\n\n{source}");
    }
    if !ours.is_empty() {
        let _ = write!(text, "\n## Claims of Fairing\n\n{ours}");
    }
    text
}

/// A table of claims, those of the source report or our own, with links into
/// the report at `place`; nothing if there is no claim.
pub fn claim_table(results: &Results, ours: bool, place: &str, numbers: bool) -> String {
    let mut rows = String::new();
    for (record, claim) in results.claims().into_iter().filter(|(_, c)| c.ours == ours) {
        let deciding: Vec<String> = claim.numbers.iter().map(ToString::to_string).collect();
        let deciding = if numbers { &deciding[..] } else { &deciding[..deciding.len().min(1)] };
        let _ = writeln!(
            rows,
            "| [{}]({place}#{}) | {} | **{}** | {} |",
            claim.id,
            anchor(&heading(record)),
            cell(&claim.claim),
            claim.verdict,
            cell(&deciding.join("; ")),
        );
    }
    let decided = if numbers { "Decided by" } else { "Deciding number" };
    if rows.is_empty() {
        rows
    } else {
        format!("| | Claim | Verdict | {decided} |\n|---|---|---|---|\n{rows}")
    }
}

fn body(record: &Record, form: Form) -> String {
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
    for claim in &record.claims {
        let _ = write!(
            text,
            "\n> **Claim {}:** {}\n>\n> **{}**: {}\n",
            claim.id, claim.claim, claim.verdict, claim.reason
        );
    }
    for figure in &record.figures {
        let _ = write!(text, "\n![{}]({})\n\n*{}*", figure.alt, figure.png, figure.caption);
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
    let _ = write!(text, "\n*{}* ([CSV]({}/{}.csv))\n", t.caption, record.id, t.id);
    text
}

/// Tables with more rows than this are folded, or left out of a small report.
pub(crate) const LONG: usize = 24;

/// Text that does not end its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A table; numbers are set flush right.
fn rows(table: &Table) -> String {
    let heading = |c: &Column| match c.unit {
        Unit::Label | Unit::One | Unit::Count => c.name.clone(),
        unit => format!("{} ({unit})", c.name),
    };
    let mut text = String::from("\n|");
    for column in &table.columns {
        let _ = write!(text, " {} |", cell(&heading(column)));
    }
    text += "\n|";
    for column in &table.columns {
        text += if column.unit == Unit::Label { "---|" } else { "--:|" };
    }
    for row in &table.rows {
        text += "\n|";
        for value in row {
            let _ = write!(text, " {} |", cell(&value.to_string()));
        }
    }
    text + "\n"
}
