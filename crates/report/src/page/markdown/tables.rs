//! Tables in Markdown.

use std::fmt::Write as _;

use crate::model::results::Record;
use crate::model::table::{Column, Table, Unit};
use crate::page::layout;

/// Tables with more rows than this are folded in the page.
pub(crate) const LONG: usize = 24;

/// Tables with more rows than this are left to their files.
const MOST: usize = 12;

/// The largest number of columns of a table.
const WIDE: usize = 7;

/// Returns true if a table is in the text: if it is not folded in the page, and short.
pub(super) fn is_shown(record: &Record, table: &Table) -> bool {
    layout::shows_table(record, &table.id) && table.rows.len() <= MOST
}

/// A table over its caption.
pub(super) fn captioned(t: &Table, record: &Record) -> String {
    let place = format!("{}/{}.csv", record.id, t.id);
    format!("{}\n*{}* ([CSV]({place}){})\n", rows(t), t.caption, left_out(t))
}

/// Text with `|` escaped, so that it does not end its cell.
pub(super) fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

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
        let _ = write!(text, "{}|", cell(&heading(&table.columns[c])));
    }
    text += "\n|";
    for &c in &columns {
        text += if table.columns[c].unit == Unit::Label { "---|" } else { "--:|" };
    }
    for row in &table.rows {
        text += "\n|";
        for &c in &columns {
            let _ = write!(text, "{}|", cell(&row[c].to_string()));
        }
    }
    text + "\n"
}
