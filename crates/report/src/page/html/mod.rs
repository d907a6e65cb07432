//! `report.html`: one self-contained page that opens from disk.
//!
//! Text, tables and figures are plain HTML and readable without scripts; the
//! interactive views are brought to life by the modules of `assets/` and of
//! `crates/figure/viewer`, which are bundled into one script. Nothing is requested from anywhere.
//!
//! The committed module of `crates/web` computes in the page, so that a machine with nothing but
//! cargo makes the same report.

mod computing;
mod escape;
mod figures;
mod laboratory;
mod scripts;
mod section;
mod style;
mod tables;
mod view;

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Result;
use base64::Engine as _;
use rayon::prelude::*;

use crate::model::results::{Record, Results};
use crate::model::verdict::Verdict;
use crate::page::{bibliography, markdown, notation, numbers, story, thumbnail};
use escape::escape;
use fairing_figure::{ColorMap, color_maps};
pub use laboratory::laboratory;
use scripts::script;
use style::STYLE;

/// The module for browsers that computes in the page.
const MODULE: &[u8] = include_bytes!("../../../../web/assets/fairing.wasm.gz");

/// A font for formulas: DejaVu Math TeX Gyre, cut down to ASCII, Greek, italics and operators. Its
/// licence is that of `crates/figure/fonts`, and its extensions are in the public domain.
const MATH: &[u8] = include_bytes!("../../../assets/math.woff2");

/// The page. `folder` holds the files of the report, whose pictures are put
/// into the page, or linked if the report is small.
pub(crate) fn report(results: &Results, folder: &Path) -> Result<String> {
    let mut main = opening(results);
    main += &rules(results);
    main += &claims(results);
    main += &meshes(results, folder)?;
    let numbered = numbers::first_numbers(results);
    let section = |(record, first): &(&Record, usize)| {
        section::experiment(&results.experiments, record, *first, folder)
    };
    let bodies: Vec<String> = numbered.par_iter().map(section).collect::<Result<_>>()?;
    let sections: Vec<(&str, String)> =
        numbered.iter().map(|(record, _)| record.id.as_str()).zip(bodies).collect();
    main += &acts(results, &sections);
    main += &sources(results);
    main += &provenance(results);
    document(story::TITLE, &contents(results), &main)
}

/// A whole page around `main`, with styles, scripts and colour maps.
fn document(title: &str, contents: &str, main: &str) -> Result<String> {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\
         <link rel=\"icon\" href=\"data:,\"><style>{font}{STYLE}</style></head><body>\
         <a class=\"skip\" href=\"#main\">Skip to content</a>\
         <header><h1>{title}</h1><button id=\"theme\" type=\"button\" hidden>dark</button></header>\
         {contents}<main id=\"main\">{main}</main>\
         <script id=\"colour-maps\" type=\"application/json\">{maps}</script>\n",
        title = escape(title),
        maps = color_maps(&[ColorMap::Viridis, ColorMap::CoolWarm]),
        font = math_font(),
    );
    page += &computing::elements(MODULE)?;
    let script = script("report/assets/page.mjs")?;
    let _ = writeln!(page, "<script type=\"module\">{script}</script></body></html>");
    Ok(page)
}

fn math_font() -> String {
    format!(
        "@font-face {{ font-family: \"Fairing Math\"; src: url(data:font/woff2;base64,{}) format(\"woff2\"); }}\n",
        base64::engine::general_purpose::STANDARD.encode(MATH)
    )
}

fn contents(results: &Results) -> String {
    let mut list = String::new();
    if !story::rules(results).is_empty() {
        list += "<li><a href=\"#rules\">What we would tell the student</a></li>";
    }
    if results.experiments.iter().any(|r| !r.claims.is_empty()) {
        list += "<li><a href=\"#claims\">The claims</a></li>";
    }
    if !thumbnail::all(results).is_empty() {
        list += "<li><a href=\"#meshes\">The meshes</a></li>";
    }
    let mut link = |record: &Record| {
        let _ = write!(
            list,
            "<li><a href=\"#{0}\"><span class=\"id\">{0}</span> {1}</a></li>",
            escape(&record.id),
            escape(&record.title)
        );
    };
    for act in &story::ACTS {
        act.sections(results).for_each(&mut link);
    }
    story::others(results).for_each(link);
    if !bibliography::of(results).is_empty() {
        list += "<li><a href=\"#sources\">Sources</a></li>";
    }
    format!(
        "<nav aria-label=\"contents\"><details open><summary>Contents</summary><ol>{list}\
         <li><a href=\"#provenance\">Where the numbers come from</a></li></ol></details></nav>"
    )
}

/// The idea with its playground, then the subject and the number of claims that hold; the table of
/// claims follows.
fn opening(results: &Results) -> String {
    let failed = results.experiments.iter().filter(|r| r.error.is_some()).count();
    let mut text = format!(
        "<section class=\"opening\"><p>{}</p>{}<p>{}</p><p>{} {}</p>",
        story::idea(),
        figures::playground(&story::first_playground(), ""),
        story::question(),
        story::about(results),
        story::tally(results)
    );
    if failed > 0 {
        let s = if failed == 1 { "" } else { "s" };
        let _ = write!(text, "<p class=\"error\">{failed} experiment{s} failed.</p>");
    }
    let symbols: String = notation::SYMBOLS
        .iter()
        .map(|symbol| format!("<dt>{}</dt><dd>{}</dd>", symbol.sign, symbol.meaning))
        .collect();
    let _ = write!(text, "<details><summary>Notation</summary><dl>{symbols}</dl></details>");
    let p = &results.provenance;
    let _ = write!(
        text,
        "<p class=\"soft\">{}, commit <code>{}</code>{}, {}, seed {}. Every number \
         below comes from the measurements.</p></section>",
        escape(&p.program),
        escape(p.commit.get(..12).unwrap_or(&p.commit)),
        if p.dirty { " with changes" } else { "" },
        escape(&p.date),
        p.seed,
    );
    text
}

/// The sections in three acts, with bridges between them.
fn acts(results: &Results, sections: &[(&str, String)]) -> String {
    let body = |record: &Record| {
        let found = sections.iter().find(|(id, _)| *id == record.id);
        found.map_or("", |(_, body)| body.as_str())
    };
    let mut text = String::new();
    for act in &story::ACTS {
        let mut own = act.sections(results).peekable();
        if own.peek().is_none() {
            continue;
        }
        let _ = write!(
            text,
            "<header class=\"act\" id=\"{}\"><h2>{}</h2><p>{}</p></header>",
            act.id,
            act.title,
            act.about()
        );
        for record in own {
            let bridge = &record.section.bridge;
            let _ = write!(text, "<p class=\"bridge\">{bridge}</p>{}", body(record));
        }
    }
    for record in story::others(results) {
        text += body(record);
    }
    text
}

/// The rules for a student, each with the claim behind it.
fn rules(results: &Results) -> String {
    let rules = story::rules(results);
    if rules.is_empty() {
        return String::new();
    }
    let items: String = rules
        .iter()
        .map(|rule| {
            format!("<li>{} (<a href=\"#claim-{1}\">claim {1}</a>)</li>", rule.text(), rule.claim)
        })
        .collect();
    format!(
        "<section id=\"rules\"><h2>What we would tell the student</h2><ol class=\"rules\">{items}</ol></section>"
    )
}

/// The bibliography, with links; folded, and unfolded by a link to an entry.
fn sources(results: &Results) -> String {
    let all = bibliography::of(results);
    let items: String = all
        .iter()
        .map(|(entry, sections)| {
            let links: Vec<String> =
                sections.iter().map(|id| format!("<a href=\"#{0}\">{0}</a>", escape(id))).collect();
            let title = if entry.url.is_empty() {
                escape(&entry.title)
            } else {
                format!("<a href=\"{}\">{}</a>", escape(&entry.url), escape(&entry.title))
            };
            format!(
                "<li id=\"source-{}\">{}: {title}. {} ({})</li>",
                escape(&entry.key),
                escape(&entry.authors),
                escape(&entry.place),
                links.join(", ")
            )
        })
        .collect();
    if items.is_empty() {
        items
    } else {
        format!(
            "<section id=\"sources\"><h2>Sources</h2><details><summary>{} papers and books, with links</summary>\
             <ul>{items}</ul></details></section>",
            all.len()
        )
    }
}

/// A small picture of each mesh, with its name and where it is used.
fn meshes(results: &Results, folder: &Path) -> Result<String> {
    let mut items = String::new();
    for (card, sections) in thumbnail::all(results) {
        let links: Vec<String> =
            sections.iter().map(|id| format!("<a href=\"#{0}\">{0}</a>", escape(id))).collect();
        let _ = write!(
            items,
            "<li>{}<b>{}</b><br>{} vertices, {} faces; {}</li>",
            figures::png(&card.picture, &format!("The {}.", card.name), folder)?,
            escape(&card.name),
            card.vertices,
            card.faces,
            links.join(", ")
        );
    }
    if items.is_empty() {
        return Ok(items);
    }
    let count = thumbnail::all(results).len();
    let stand_ins = markdown::stand_ins(results);
    let origin = if stand_ins.is_empty() {
        "They are those of the assignment, or made here.".to_string()
    } else {
        escape::with_code(&story::replaced(&stand_ins.join(", ")))
    };
    Ok(format!(
        "<section id=\"meshes\"><h2>The meshes</h2><details><summary>{count} meshes with their pictures</summary>\
         <p>Each mesh has one name in all sections. {origin}</p><ul class=\"meshes\">{items}</ul></details></section>"
    ))
}

/// A row for each claim: its verdict and the true statement. Our own are folded.
fn claims(results: &Results) -> String {
    let source = claim_table(results, false, "The original report claims");
    let ours = claim_table(results, true, "Our own hypothesis");
    if source.is_empty() && ours.is_empty() {
        return source;
    }
    let own = results.claims().into_iter().filter(|(_, c)| c.ours).map(|(_, c)| c.verdict);
    let own: Vec<Verdict> = own.collect();
    let counts: Vec<String> = story::VERDICTS
        .iter()
        .map(|verdict| (own.iter().filter(|v| *v == verdict).count(), verdict))
        .filter(|(count, _)| *count > 0)
        .map(|(count, verdict)| format!("{count} {verdict}"))
        .collect();
    let ours = if ours.is_empty() {
        ours
    } else {
        format!(
            "<details><summary>Our own hypotheses: {}</summary>{ours}</details>",
            counts.join(", ")
        )
    };
    let meaning = escape(&story::verdicts());
    format!("<section id=\"claims\"><h2>The claims</h2><p>{meaning}</p>{source}{ours}</section>")
}

/// The claims of the original report, or ours.
fn claim_table(results: &Results, ours: bool, heading: &str) -> String {
    let mut rows = String::new();
    for (_, claim) in results.claims().into_iter().filter(|(_, c)| c.ours == ours) {
        let _ = write!(
            rows,
            "<tr><td><a href=\"#claim-{0}\">{0}</a></td><td>{1}</td><td>{2}</td><td>{3}</td></tr>",
            escape(&claim.id),
            escape(&claim.claim),
            section::verdict(claim.verdict) + &section::link(&results.experiments, claim),
            escape(&claim.finding),
        );
    }
    if rows.is_empty() {
        rows
    } else {
        format!(
            "<div class=\"wide\"><table class=\"claims\"><tbody><tr><th scope=\"col\">Id</th>\
             <th scope=\"colgroup\">{heading}</th>\
             <th>Verdict</th><th>What is true</th></tr>{rows}</tbody></table></div>"
        )
    }
}

fn provenance(results: &Results) -> String {
    let p = &results.provenance;
    let row = |name: &str, value: &str| {
        format!("<tr><th scope=\"row\">{name}</th><td>{}</td></tr>", escape(value))
    };
    let mut rows = String::new();
    rows += &row("program", &p.program);
    rows += &row("commit", &format!("{}{}", p.commit, if p.dirty { ", with changes" } else { "" }));
    rows += &row("compiler", &p.compiler);
    rows += &row("libraries", &p.libraries.join(", "));
    rows += &row("system", &p.system);
    rows += &row("processor", &format!("{}, {} threads", p.processor, p.threads));
    rows += &row("seed", &p.seed.to_string());
    rows += &row("sizes", if p.quick { "reduced (--quick)" } else { "full" });
    rows += &row("date", &p.date);
    format!(
        "<section id=\"provenance\"><h2>Where the numbers come from</h2>\
         <p>Made by <code>cargo xtask reproduce{}</code>. All numbers are in \
         <code>results.json</code> beside this page.</p>\
         <details><summary>Commit, compiler, libraries, system and seed</summary><div class=\"wide\">\
         <table class=\"facts\"><tbody>{rows}</tbody></table></div></details></section>",
        if p.quick { " --quick" } else { "" },
    )
}
