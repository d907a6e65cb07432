//! Compares two sets of results, column by column, within each column's
//! tolerance.

use std::fmt;

use crate::results::{Record, Results};
use crate::table::{Cell, Table, Tolerance};

/// A difference between two sets of results.
#[derive(Debug, Clone, PartialEq)]
pub enum Difference {
    /// An experiment, a table, a column or a claim is there on one side only.
    Presence {
        /// The missing or new part, from the experiment inwards.
        what: String,
        /// True if the part is new, false if it is missing.
        added: bool,
    },
    /// Another mesh was read, so the numbers cannot be compared.
    Input {
        /// The experiment.
        experiment: String,
        /// The input file of the old side.
        old: String,
        /// The input file of the new side.
        new: String,
    },
    /// A table has another number of rows.
    Rows {
        /// Experiment and table.
        table: String,
        /// Rows before.
        old: usize,
        /// Rows now.
        new: usize,
    },
    /// A value moved by more than the tolerance of its column.
    Value {
        /// Experiment and table.
        table: String,
        /// The row: its number, from 1, and its labels.
        row: String,
        /// The column.
        column: String,
        /// The value before.
        old: Cell,
        /// The value now.
        new: Cell,
        /// The tolerance.
        tolerance: Tolerance,
    },
    /// The verdict on a claim has changed.
    Verdict {
        /// The claim.
        claim: String,
        /// The verdict before.
        old: String,
        /// The verdict now.
        new: String,
    },
    /// An experiment fails on one side.
    Failure {
        /// The experiment.
        experiment: String,
        /// Why.
        error: String,
    },
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Presence { what, added: true } => write!(f, "{what}: new"),
            Self::Presence { what, added: false } => write!(f, "{what}: gone"),
            Self::Input { experiment, old, new } => {
                write!(f, "{experiment}: read {old} before, {new} now")
            }
            Self::Rows { table, old, new } => write!(f, "{table}: {old} rows before, {new} now"),
            Self::Value { table, row, column, old, new, tolerance } => {
                let (old, new) = (exact(old), exact(new));
                write!(f, "{table}, row {row}, {column}: {old} before, {new} now")?;
                match *tolerance {
                    Tolerance::EXACT => Ok(()),
                    t => write!(f, " (tolerance {:e} + {:e} of the value)", t.absolute, t.relative),
                }
            }
            Self::Verdict { claim, old, new } => {
                write!(f, "claim {claim}: {old} before, {new} now")
            }
            Self::Failure { experiment, error } => write!(f, "{experiment} fails: {error}"),
        }
    }
}

/// A cell with every digit.
fn exact(cell: &Cell) -> String {
    match cell {
        Cell::Number(x) => format!("{x:?}"),
        other => other.to_string(),
    }
}

/// All differences between the experiments that both sides ran, and those that
/// only the old side has unless `partial` says that the new side left some out
/// on purpose. Times are not compared; columns and tolerances are those of the
/// old side.
pub fn differences(old: &Results, new: &Results, partial: bool) -> Vec<Difference> {
    let mut found = vec![];
    for record in &old.experiments {
        match new.experiments.iter().find(|r| r.id == record.id) {
            Some(other) => compare_records(record, other, &mut found),
            None if partial => {}
            None => found.push(Difference::Presence { what: record.id.clone(), added: false }),
        }
    }
    for record in &new.experiments {
        if !old.experiments.iter().any(|r| r.id == record.id) {
            found.push(Difference::Presence { what: record.id.clone(), added: true });
        }
    }
    found
}

fn compare_records(old: &Record, new: &Record, found: &mut Vec<Difference>) {
    let experiment = old.id.clone();
    for error in [&old.error, &new.error].into_iter().flatten() {
        found.push(Difference::Failure { experiment: experiment.clone(), error: error.clone() });
    }
    for (a, b) in old.inputs.iter().zip(&new.inputs).filter(|(a, b)| a.sha256 != b.sha256) {
        let name = |s: &crate::results::Source| format!("{} ({})", s.file, &s.sha256[..12]);
        found.push(Difference::Input {
            experiment: experiment.clone(),
            old: name(a),
            new: name(b),
        });
    }
    for table in &old.tables {
        let name = format!("{experiment}, table {}", table.id);
        match new.tables.iter().find(|t| t.id == table.id) {
            Some(other) => compare_tables(&name, table, other, found),
            None => found.push(Difference::Presence { what: name, added: false }),
        }
    }
    for table in new.tables.iter().filter(|t| !old.tables.iter().any(|o| o.id == t.id)) {
        let what = format!("{experiment}, table {}", table.id);
        found.push(Difference::Presence { what, added: true });
    }
    for claim in &old.claims {
        match new.claims.iter().find(|c| c.id == claim.id) {
            Some(other) if other.verdict == claim.verdict => {}
            Some(other) => found.push(Difference::Verdict {
                claim: claim.id.clone(),
                old: claim.verdict.to_string(),
                new: other.verdict.to_string(),
            }),
            None => {
                let what = format!("{experiment}, claim {}", claim.id);
                found.push(Difference::Presence { what, added: false });
            }
        }
    }
}

fn compare_tables(name: &str, old: &Table, new: &Table, found: &mut Vec<Difference>) {
    if old.rows.len() != new.rows.len() {
        let (old, new) = (old.rows.len(), new.rows.len());
        found.push(Difference::Rows { table: name.into(), old, new });
        return;
    }
    for (c, column) in old.columns.iter().enumerate() {
        let Some(tolerance) = column.tolerance else { continue };
        let Ok(other) = new.index(&column.name) else {
            let what = format!("{name}, column {}", column.name);
            found.push(Difference::Presence { what, added: false });
            continue;
        };
        for (r, (a, b)) in old.rows.iter().zip(&new.rows).enumerate() {
            let (a, b) = (&a[c], &b[other]);
            let same = match (a.number(), b.number()) {
                (Some(x), Some(y)) => tolerance.admits(x, y),
                _ => a == b,
            };
            if !same {
                found.push(Difference::Value {
                    table: name.into(),
                    row: row_name(old, r),
                    column: column.name.clone(),
                    old: a.clone(),
                    new: b.clone(),
                    tolerance,
                });
            }
        }
    }
}

/// The number of a row, from 1, and what its labels say.
fn row_name(table: &Table, r: usize) -> String {
    let labels: Vec<&str> = table.rows[r]
        .iter()
        .filter_map(|cell| match cell {
            Cell::Text(t) => Some(t.as_str()),
            _ => None,
        })
        .collect();
    if labels.is_empty() {
        format!("{}", r + 1)
    } else {
        format!("{} ({})", r + 1, labels.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provenance::Provenance;
    use crate::results::Form;
    use crate::row;
    use crate::table::Unit;
    use crate::verdict::{Judgement, Verdict};

    fn results(error: f64, seconds: f64, verdict: Verdict) -> Results {
        let columns = [("mesh", Unit::Label), ("error", Unit::Relative), ("time", Unit::Seconds)];
        let mut table = Table::new("errors", "Errors.", &columns);
        table.push(row!["sphere", error, seconds]);
        let record = Record {
            id: "q1".into(),
            tables: vec![table],
            claims: vec![Judgement::new("1a", "", verdict, "")],
            seconds,
            ..Record::default()
        };
        let provenance = Provenance::default();
        Results { provenance, form: Form::Whole, experiments: vec![record] }
    }

    #[test]
    fn times_and_rounding_pass() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let new = results(0.5 * (1.0 + 1e-9), 9.0, Verdict::Refuted);
        assert_eq!(differences(&old, &new, false), []);
    }

    #[test]
    fn a_moved_number_is_named_with_old_and_new() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let found = differences(&old, &results(0.501, 1.0, Verdict::Refuted), false);
        assert_eq!(found.len(), 1);
        let text = found[0].to_string();
        assert!(
            text.starts_with("q1, table errors, row 1 (sphere), error: 0.5 before, 0.501 now"),
            "{text}"
        );
    }

    #[test]
    fn a_number_that_is_none_any_more_is_a_difference() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        assert_eq!(differences(&old, &results(f64::NAN, 1.0, Verdict::Refuted), false).len(), 1);
        assert_eq!(
            differences(&old, &results(f64::INFINITY, 1.0, Verdict::Refuted), false).len(),
            1
        );
    }

    #[test]
    fn another_verdict_is_a_difference() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let found = differences(&old, &results(0.5, 1.0, Verdict::Confirmed), false);
        assert_eq!(found[0].to_string(), "claim 1a: wrong before, right now");
    }

    #[test]
    fn what_is_missing_is_a_difference_unless_left_out_on_purpose() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let none = Results { experiments: vec![], ..old.clone() };
        assert_eq!(differences(&old, &none, true), []);
        assert_eq!(differences(&old, &none, false).len(), 1);
        assert_eq!(differences(&none, &old, true).len(), 1);
    }
}
