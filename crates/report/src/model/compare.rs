//! Compares two sets of results, column by column, within each column's
//! tolerance.

use crate::model::results::{Record, Results, Source};
use crate::model::table::{Cell, Table, Tolerance};

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
pub fn differences(old: &Results, new: &Results, partial: bool) -> Vec<String> {
    let mut found = vec![];
    for record in &old.experiments {
        match new.experiments.iter().find(|r| r.id == record.id) {
            Some(other) => compare_records(record, other, &mut found),
            None if partial => {}
            None => found.push(format!("{}: gone", record.id)),
        }
    }
    for record in &new.experiments {
        if !old.experiments.iter().any(|r| r.id == record.id) {
            found.push(format!("{}: new", record.id));
        }
    }
    found
}

fn compare_records(old: &Record, new: &Record, found: &mut Vec<String>) {
    let experiment = &old.id;
    for error in [&old.error, &new.error].into_iter().flatten() {
        found.push(format!("{experiment} fails: {error}"));
    }
    for (a, b) in old.inputs.iter().zip(&new.inputs).filter(|(a, b)| a.sha256 != b.sha256) {
        let name = |s: &Source| format!("{} ({})", s.file, &s.sha256[..12]);
        found.push(format!("{experiment}: read {} before, {} now", name(a), name(b)));
    }
    for table in &old.tables {
        let name = format!("{experiment}, table {}", table.id);
        match new.tables.iter().find(|t| t.id == table.id) {
            Some(other) => compare_tables(&name, table, other, found),
            None => found.push(format!("{name}: gone")),
        }
    }
    for table in new.tables.iter().filter(|t| !old.tables.iter().any(|o| o.id == t.id)) {
        found.push(format!("{experiment}, table {}: new", table.id));
    }
    for claim in &old.claims {
        match new.claims.iter().find(|c| c.id == claim.id) {
            Some(other) if other.verdict == claim.verdict => {}
            Some(other) => found.push(format!(
                "claim {}: {} before, {} now",
                claim.id, claim.verdict, other.verdict
            )),
            None => found.push(format!("{experiment}, claim {}: gone", claim.id)),
        }
    }
}

fn compare_tables(name: &str, old: &Table, new: &Table, found: &mut Vec<String>) {
    if old.rows.len() != new.rows.len() {
        found.push(format!("{name}: {} rows before, {} now", old.rows.len(), new.rows.len()));
        return;
    }
    for (c, column) in old.columns.iter().enumerate() {
        let Some(tolerance) = column.tolerance else { continue };
        let Ok(other) = new.index(&column.name) else {
            found.push(format!("{name}, column {}: gone", column.name));
            continue;
        };
        for (r, (a, b)) in old.rows.iter().zip(&new.rows).enumerate() {
            let (a, b) = (&a[c], &b[other]);
            let same = match (a.number(), b.number()) {
                (Some(x), Some(y)) => tolerance.admits(x, y),
                _ => a == b,
            };
            if !same {
                let allowed = match tolerance {
                    Tolerance::EXACT => String::new(),
                    Tolerance { absolute, relative } => {
                        format!(" (tolerance {absolute:e} + {relative:e} of the value)")
                    }
                };
                let (row, old, new) = (row_name(old, r), exact(a), exact(b));
                found.push(format!(
                    "{name}, row {row}, {}: {old} before, {new} now{allowed}",
                    column.name
                ));
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
    use crate::model::provenance::Provenance;
    use crate::model::results::Form;
    use crate::model::table::Unit;
    use crate::model::verdict::{Judgement, Verdict};
    use crate::row;

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
        assert!(differences(&old, &new, false).is_empty());
    }

    #[test]
    fn a_moved_number_is_named_with_old_and_new() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let found = differences(&old, &results(0.501, 1.0, Verdict::Refuted), false);
        assert_eq!(found.len(), 1);
        assert_eq!(
            found[0],
            "q1, table errors, row 1 (sphere), error: 0.5 before, 0.501 now \
             (tolerance 1e-9 + 1e-6 of the value)"
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
        assert_eq!(found[0], "claim 1a: wrong before, right now");
    }

    #[test]
    fn what_is_missing_is_a_difference_unless_left_out_on_purpose() {
        let old = results(0.5, 1.0, Verdict::Refuted);
        let none = Results { experiments: vec![], ..old.clone() };
        assert!(differences(&old, &none, true).is_empty());
        assert_eq!(differences(&old, &none, false).len(), 1);
        assert_eq!(differences(&none, &old, true).len(), 1);
    }
}
