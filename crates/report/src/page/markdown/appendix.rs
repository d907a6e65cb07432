//! The end of the report in Markdown: meshes, files, and where the numbers come from; and the table
//! of symbols.

use std::fmt::Write as _;

use super::tables::{self, cell};
use crate::model::results::{MeshCard, Record, Results};
use crate::page::{layout, notation, numbers, story, thumbnail};

/// The symbols and their meanings.
pub(super) fn symbols() -> String {
    let mut text = String::from("\n## Notation\n\n| | |\n|---|---|\n");
    for symbol in &notation::SYMBOLS {
        let _ = writeln!(text, "|{}|{}|", cell(symbol.sign), cell(symbol.meaning));
    }
    text
}

/// Pictures of meshes beside one another.
const ROW: usize = 5;

/// The meshes by name.
pub(super) fn meshes(results: &Results) -> String {
    let all = thumbnail::all(results);
    if all.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "\n## The meshes\n\n{}\n\n{}|\n{}|\n",
        story::meshes(),
        "| ".repeat(ROW),
        "|---".repeat(ROW)
    );
    for row in all.chunks(ROW) {
        for (MeshCard { name, vertices, picture, .. }, _) in row {
            let _ = write!(
                text,
                "| <img src=\"{picture}\" alt=\"\" width=\"120\"><br>{name}, {vertices} "
            );
        }
        text += "|\n";
    }
    text
}

/// The files of each section that the text does not show: tables, and stills of views.
pub(super) fn data(results: &Results) -> String {
    let mut text = format!("\n## Data files\n\n{}\n\n", story::files());
    for record in story::in_order(results) {
        let mut links = files(record);
        let others = record.other_files().count();
        if others > 0 {
            links.push(format!("{others} more in its folder"));
        }
        if !links.is_empty() {
            let _ = writeln!(text, "- `{}`: {}", record.id, links.join(", "));
        }
    }
    text
}

/// Links to the tables and pictures of a section that the text leaves out.
fn files(record: &Record) -> Vec<String> {
    let tables = record.tables.iter().filter(|table| !tables::is_shown(record, table));
    let tables = tables.map(|table| {
        format!("[{}]({}/{}.csv)", layout::name(record, &table.id), record.id, table.id)
    });
    let shown = numbers::pictures(record);
    let is_left_out = |id: &str| !shown.iter().any(|figure| figure.id == id);
    let pictures = record.figures.iter().filter(|figure| is_left_out(&figure.id));
    let pictures = pictures.map(|figure| {
        // The name is that of the view.
        let view = record.views.iter().find(|view| view.fallback == figure.id);
        let id = view.map_or(&figure.id, |view| &view.id);
        let name = layout::name(record, id);
        format!("[{name}]({})", figure.png)
    });
    tables.chain(pictures).collect()
}

/// The program, the machine, the day and the meshes.
pub(super) fn provenance(results: &Results) -> String {
    let p = &results.provenance;
    let mut text = format!(
        "\n## Where the numbers come from\n\nWritten by `cargo xtask reproduce{}` ({}, commit {}{}) on {}, \
         {} threads of {}, seed {}.\n",
        if p.quick { " --quick" } else { "" },
        p.program,
        p.commit.get(..12).unwrap_or(&p.commit),
        if p.dirty { " with changes" } else { "" },
        p.date,
        p.threads,
        p.processor,
        p.seed,
    );
    let stand_ins = stand_ins(results);
    if !stand_ins.is_empty() {
        let _ = write!(text, "\n{}\n", story::replaced(&stand_ins.join(", ")));
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
