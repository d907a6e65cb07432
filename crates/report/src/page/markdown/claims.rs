//! The claims and the verdicts on them, in Markdown.

use std::fmt::Write as _;

use super::tables::cell;
use crate::model::results::Results;
use crate::page::story;

/// The number of claims of the original report that hold, the table of them with what is true, and
/// that of our own with the numbers that decided.
pub(super) fn claims(results: &Results) -> String {
    let source = claim_table(results, false);
    let ours = claim_table(results, true);
    let mut text = String::new();
    if !source.is_empty() {
        let (tally, meaning) = (story::tally(results), story::verdicts());
        let _ =
            write!(text, "\n## The claims of the original report\n\n{tally} {meaning}\n\n{source}");
    }
    if !ours.is_empty() {
        let _ = write!(text, "\n## Our own hypotheses\n\n{ours}");
    }
    text
}

/// The name under which code hosts link to a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || [' ', '-'].contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// A table of claims with links to their sections: those of the original report with the true
/// statement in one sentence, or our own with the deciding number; nothing if there is no claim.
fn claim_table(results: &Results, ours: bool) -> String {
    let mut rows = String::new();
    for (record, claim) in results.claims().into_iter().filter(|(_, c)| c.ours == ours) {
        let number = claim.numbers.first().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(
            rows,
            "| [{}](#{}) | {} | **{}** | {} |",
            claim.id,
            anchor(&record.title),
            cell(&claim.claim),
            claim.verdict,
            cell(if ours { &number } else { &claim.finding }),
        );
    }
    if rows.is_empty() {
        return rows;
    }
    let [kind, last] =
        if ours { ["Hypothesis", "Deciding number"] } else { ["Claim", "What is true"] };
    format!("| | {kind} | Verdict | {last} |\n|---|---|---|---|\n{rows}")
}
