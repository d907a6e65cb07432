//! `fairing.html`: the laboratory, one self-contained page that opens from disk.
//!
//! The module of `crates/web` computes, the viewer of the report draws. Nothing is requested from
//! anywhere.

use anyhow::Result;

use fairing_figure::bundle::compact;
use fairing_figure::{ColorMap, color_maps};

use super::computing;
use super::scripts::script;
use super::style::STYLE;

const OWN_STYLE: &str = include_str!("../../../assets/laboratory/style.css");
const BODY: &str = include_str!("../../../assets/laboratory/body.html");

/// The laboratory with a gzip-compressed module.
pub fn laboratory(module: &[u8]) -> Result<String> {
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Fairing laboratory</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\
         <link rel=\"icon\" href=\"data:,\"><style>{style}</style></head><body>{BODY}\
         <script id=\"colour-maps\" type=\"application/json\">{maps}</script>\n\
         {module}\
         <script type=\"module\">{page}</script></body></html>\n",
        style = compact(&[STYLE, OWN_STYLE].concat()),
        maps = color_maps(&[ColorMap::Viridis, ColorMap::CoolWarm]),
        module = computing::elements(module)?,
        page = script("report/assets/laboratory/lab.mjs")?,
    ))
}

#[cfg(test)]
mod tests {
    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD as BASE64;

    use super::*;

    /// With the module that is committed.
    #[test]
    fn the_page_is_small() {
        let module = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/assets/fairing.wasm.gz");
        let page = laboratory(&std::fs::read(module).unwrap()).unwrap();
        assert!(page.len() < 3_300_000, "{} bytes", page.len());
    }

    /// The page holds the module, and nothing from elsewhere.
    #[test]
    fn the_page_is_complete() {
        let page = laboratory(b"module").unwrap();
        assert!(page.contains(&BASE64.encode(b"module")));
        let lines = || page.lines().map(str::trim_start);
        assert!(!lines().any(|line| line.starts_with("import ") || line.starts_with("export ")));
        for outside in ["src=", "https://", "XMLHttpRequest"] {
            assert!(!page.contains(outside), "{outside}");
        }
        // Only an address that was pasted is requested, which the browser tests try.
        assert_eq!(page.matches("fetch(").count(), 1);
    }
}
