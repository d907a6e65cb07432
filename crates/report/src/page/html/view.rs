//! A view as a part of the page: its description, its data and its place.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::model::results::ViewFile;
use anyhow::{Context as _, Result};

use super::html::{escape, script_json};
use crate::page::views::Packed;

/// The view as a `<figure>` that the page's script brings to life; `id` is
/// unique on the page, `fallback` the id of the picture that takes its place
/// on paper and where there is no WebGL, `paper` that picture if it has no
/// place of its own.
pub(super) fn figure(
    view: &ViewFile,
    id: &str,
    fallback: &str,
    paper: &str,
    label: &str,
    folder: &Path,
) -> Result<String> {
    let text = fs::read_to_string(folder.join(&view.data));
    let packed = text.map_err(Into::into).and_then(|text| Packed::read(&text));
    let Packed { about, data, .. } = packed.with_context(|| format!("reading {}", view.data))?;
    let mut html = String::new();
    let _ = write!(
        html,
        "<figure class=\"view\" id=\"{id}\" data-panels=\"{panels}\" data-fallback=\"{fallback}\">\
         <div class=\"stage\"><p class=\"hint\">{alt}</p></div>{paper}\
         <noscript><style>.view .paper {{ display: block; }} .view .stage {{ display: none; }}</style></noscript>\
         <figcaption>{label}{caption}</figcaption>\
         <script class=\"about\" type=\"application/json\">{about}</script>\
         <script class=\"data\" type=\"text/plain\">{data}</script></figure>",
        id = escape(id),
        panels = about["panels"].as_array().map_or(0, Vec::len),
        fallback = escape(fallback),
        alt = escape(&view.alt),
        caption = escape(&view.caption),
        about = script_json(&about),
    );
    Ok(html)
}
