//! Folding: the parts of a section that are shown, and names for the rest.

use crate::model::results::Record;

/// The number of parts that the page for browsers unfolds: of a section with a list, the first
/// figures that are listed and then tables, two in all.
pub(crate) fn unfolded(record: &Record) -> usize {
    if is_laid_out(record) { 2 } else { usize::MAX }
}

/// Returns true if the section lists its unfolded parts and all of them are there.
fn is_laid_out(record: &Record) -> bool {
    let has = |id: &String| {
        record.views.iter().any(|v| v.id == *id) || record.figures.iter().any(|f| f.id == *id)
    };
    record.section.act.is_some() && record.section.figures.iter().all(has)
}

/// Returns true if a figure, a view or a playground is not folded. A section without a list shows
/// its playground, its first view and its plots, or its first figure if it has none of them.
pub(crate) fn shows_figure(record: &Record, id: &str) -> bool {
    if record.section.playground.as_ref().is_some_and(|own| own.id() == id) {
        return true;
    }
    if is_laid_out(record) {
        return record.section.figures.iter().any(|shown| shown == id);
    }
    record.views.first().is_some_and(|view| view.id == id)
        || record.figures.iter().any(|f| f.id == id && f.svg.is_some())
        || record.views.is_empty() && record.figures.first().is_some_and(|f| f.id == id)
}

/// Returns true if a table is not folded. A section without a list shows its first table.
pub(crate) fn shows_table(record: &Record, id: &str) -> bool {
    if is_laid_out(record) {
        record.section.tables.iter().any(|shown| shown == id)
    } else {
        record.tables.first().is_some_and(|table| table.id == id)
    }
}

/// The name of a folded figure or table: its id, if it has no other.
pub(crate) fn name(record: &Record, id: &str) -> String {
    let found = record.section.names.iter().find(|(known, _)| known == id);
    found.map_or_else(|| id.replace('-', " "), |(_, name)| name.clone())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::model::results::Results;

    use super::*;

    /// A line of a fold has words, not ids.
    #[test]
    fn what_the_committed_report_folds_has_a_name() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report/results.json");
        let results = Results::read(&path).unwrap();
        for record in &results.experiments {
            let named = |id: &str| record.section.names.iter().any(|(known, _)| known == id);
            let is_still = |id: &str| record.views.iter().any(|view| view.fallback == id);
            let figures = record.figures.iter().filter(|f| f.svg.is_some() || !is_still(&f.id));
            let figures = figures.map(|f| &f.id).chain(record.views.iter().map(|v| &v.id));
            for id in figures.filter(|id| !shows_figure(record, id)) {
                assert!(named(id), "the figure {id} of {} has no name", record.id);
            }
            for table in record.tables.iter().filter(|table| !shows_table(record, &table.id)) {
                assert!(named(&table.id), "the table {} of {}", table.id, record.id);
            }
        }
    }

    /// A section that is not listed shows its first view and its plots.
    #[test]
    fn other_sections_have_a_rule() {
        let mut record = Record { id: "other".into(), ..Record::default() };
        record.figures = ["plot", "picture"]
            .map(|id| crate::model::results::FigureFile {
                id: id.into(),
                caption: String::new(),
                alt: String::new(),
                png: String::new(),
                svg: (id == "plot").then(|| "plot.svg".into()),
                small: None,
                links: vec![],
            })
            .to_vec();
        assert!(shows_figure(&record, "plot") && !shows_figure(&record, "picture"));
        record.figures.remove(0);
        assert!(shows_figure(&record, "picture"));
        assert_eq!(name(&record, "far-away"), "far away");
    }
}
