//! The figures of a section: playgrounds, views, plots and pictures.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use base64::Engine as _;
use rayon::prelude::*;

use super::escape::escape;
use super::tables::counted;
use super::view;
use crate::model::results::{FigureFile, Record};
use crate::model::section::Playground;
use crate::page::layout;
use crate::page::numbers::{Item, is_paper, parts, place};

/// The unfolded parts, and the rest folded under a line of their names. Numbered from `first`.
pub(super) fn shown(record: &Record, first: usize, folder: &Path) -> Result<[String; 2]> {
    let (items, seen) = parts(record);
    let seen = seen.min(layout::unfolded(record));
    let one = |(k, item): (usize, &Item<'_>)| {
        item.html(record, first, &format!("<b>Figure {}.</b> ", first + k), folder)
    };
    let drawn: Vec<String> = items.par_iter().enumerate().map(one).collect::<Result<_>>()?;
    let mut folded = String::new();
    if seen < drawn.len() {
        let names: Vec<String> =
            items[seen..].iter().map(|item| layout::name(record, &item.id())).collect();
        let _ = write!(
            folded,
            "<details><summary>{}: {}</summary>{}</details>",
            counted("Figure", names.len()),
            escape(&names.join("; ")),
            drawn[seen..].concat()
        );
    }
    Ok([drawn[..seen].concat(), folded])
}

impl Item<'_> {
    /// `first` is the number of the first part of the section.
    fn html(&self, record: &Record, first: usize, label: &str, folder: &Path) -> Result<String> {
        match self {
            Self::Play(play) => Ok(playground(play, label)),
            Self::Picture(figure) => picture(record, figure, label, folder),
            &Self::View(k, v) => {
                let id = format!("{}-{}", record.id, v.id);
                let fallback = figure_id(record, &v.fallback);
                let earlier = record.views[..k].iter().any(|other| other.fallback == v.fallback);
                let is_still =
                    |f: &&FigureFile| f.id == v.fallback && !earlier && is_paper(record, f);
                let figure = record.figures.iter().find(is_still);
                let paper = match figure {
                    Some(figure) => format!(
                        "<div class=\"paper\" id=\"{}\">{}<p>{label}{}</p></div>",
                        escape(&fallback),
                        image(figure, folder)?,
                        escape(&figure.caption)
                    ),
                    None => paper_note(record, first, &v.fallback),
                };
                view::figure(v, &id, &fallback, &paper, label, folder)
            }
        }
    }
}

/// The note printed in place of a view without a picture of its own, which says where to find its
/// numbers.
fn paper_note(record: &Record, first: usize, fallback: &str) -> String {
    match place(record, fallback) {
        Some(k) => format!(
            "<p class=\"paper-note\">This view is interactive and not printed; see Figure {}.</p>",
            first + k
        ),
        None => String::new(),
    }
}

/// A place in which the page's script builds a playground.
pub(super) fn playground(play: &Playground, label: &str) -> String {
    format!(
        "<figure class=\"play\" id=\"{}\" data-play=\"{}\"><div class=\"stage\"><p class=\"hint\">{} \
         It is computed in the page.</p></div><p class=\"paper-note\">This figure is interactive; it is \
         printed once it has been on the screen.</p><figcaption>{label}{}</figcaption></figure>",
        play.id(),
        play.kind,
        escape(&play.alt),
        escape(&play.caption)
    )
}

pub(super) fn figure_id(record: &Record, figure: &str) -> String {
    format!("figure-{}-{figure}", record.id)
}

/// A picture as the page shows it: a plot as SVG in the page itself, which follows the theme; any
/// other as an image with its size, so that the page does not jump when it loads.
pub(super) fn image(figure: &FigureFile, folder: &Path) -> Result<String> {
    if let Some(path) = &figure.svg {
        let read = fs::read_to_string(folder.join(path));
        let svg = read.with_context(|| format!("reading {path}"))?;
        let links = if figure.links.is_empty() {
            String::new()
        } else {
            format!("data-links=\"{}\" ", escape(&serde_json::to_string(&figure.links)?))
        };
        let section = path.split('/').next().unwrap_or_default();
        let open = format!(
            "<svg class=\"figure\" role=\"img\" tabindex=\"0\" data-section=\"{}\" {links}aria-label=\"{}\" ",
            escape(section),
            escape(&figure.alt)
        );
        return Ok(svg.replacen("<svg ", &open, 1));
    }
    png(figure.small.as_ref().unwrap_or(&figure.png), &figure.alt, folder)
}

/// A PNG file as an image.
pub(super) fn png(path: &str, alt: &str, folder: &Path) -> Result<String> {
    let bytes = fs::read(folder.join(path)).with_context(|| format!("reading {path}"))?;
    let [width, height] = png_size(&bytes).with_context(|| format!("{path} is no PNG file"))?;
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    Ok(format!(
        "<img width=\"{width}\" height=\"{height}\" src=\"data:image/png;base64,{data}\" alt=\"{}\">",
        escape(alt)
    ))
}

/// Width and height, from the first block of a PNG file.
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let is_png = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.get(12..16)? == b"IHDR";
    let number = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    is_png.then_some([number(16)?, number(20)?])
}

/// A figure with its caption.
fn picture(record: &Record, figure: &FigureFile, label: &str, folder: &Path) -> Result<String> {
    Ok(format!(
        "<figure class=\"picture\" id=\"{}\">{}<figcaption>{label}{}</figcaption></figure>",
        escape(&figure_id(record, &figure.id)),
        image(figure, folder)?,
        escape(&figure.caption)
    ))
}
