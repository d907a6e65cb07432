//! A view as a part of the page: its data and its place.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::model::results::ViewFile;
use anyhow::{Context as _, Result};
use serde_json::Value;

use super::escape::{escape, script_json};

/// The view as a `<figure>` that the page's script brings to life; `id` is
/// unique on the page, `fallback` the id of the picture that takes its place
/// on paper and where there is no WebGL, `paper` that picture with its caption
/// if it has no place of its own.
pub(super) fn figure(
    view: &ViewFile,
    id: &str,
    fallback: &str,
    paper: &str,
    label: &str,
    folder: &Path,
) -> Result<String> {
    let reading = || format!("reading {}", view.data);
    let text = fs::read_to_string(folder.join(&view.data)).with_context(reading)?;
    let data: Value = serde_json::from_str(&text).with_context(reading)?;
    let panels = data["panels"].as_array().with_context(reading)?.len();
    let mut html = String::new();
    let _ = write!(
        html,
        "<figure class=\"view\" id=\"{id}\" data-panels=\"{panels}\" data-fallback=\"{fallback}\">\
         <div class=\"stage\"><p class=\"hint\">{alt}</p></div>{paper}\
         <noscript><style>.view .paper {{ display: block; }} .view .stage {{ display: none; }} \
         .view:has(> .paper) > figcaption {{ display: none; }}</style></noscript>\
         <figcaption>{label}{caption}</figcaption>\
         <script class=\"data\" type=\"application/json\">{data}</script></figure>",
        id = escape(id),
        fallback = escape(fallback),
        alt = escape(&view.alt),
        caption = escape(&view.caption),
        data = script_json(&data),
    );
    Ok(html)
}
