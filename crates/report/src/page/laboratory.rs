//! `fairing.html`: the laboratory, one self-contained page that opens from disk.
//!
//! The module of `crates/web` computes, the viewer of the report draws. Nothing is requested from
//! anywhere.

use anyhow::Result;

use fairing_figure::ColorMap;

use super::bundle::{bundled, compact};
use super::style::STYLE;
use super::{computing, view};

/// The scripts of the report that draw, in the order in which they use one another.
const DRAWING: [&str; 5] = [
    include_str!("../../../figure/viewer/dom.js"),
    include_str!("../../../figure/viewer/renderer.js"),
    include_str!("../../../figure/viewer/camera.js"),
    include_str!("../../../figure/viewer/steer.js"),
    include_str!("../../../figure/viewer/bar.js"),
];

const PAGE: [(&str, &str); 7] = [
    computing::CLIENT[0],
    computing::CLIENT[1],
    ("viewer.mjs", include_str!("../../../figure/viewer/viewer.mjs")),
    ("panel.mjs", include_str!("../../assets/laboratory/panel.mjs")),
    ("programs.mjs", include_str!("../../assets/laboratory/programs.mjs")),
    ("words.mjs", include_str!("../../assets/laboratory/words.mjs")),
    ("lab.mjs", include_str!("../../assets/laboratory/lab.mjs")),
];

const OWN_STYLE: &str = include_str!("../../assets/laboratory/style.css");
const BODY: &str = include_str!("../../assets/laboratory/body.html");

/// The laboratory with a gzip-compressed module.
pub fn laboratory(module: &[u8]) -> Result<String> {
    let drawing = DRAWING.map(|text| format!("<script>{}</script>\n", compact(text))).concat();
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Fairing laboratory</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\
         <link rel=\"icon\" href=\"data:,\"><style>{style}</style></head><body>{BODY}\
         <script id=\"colour-maps\" type=\"application/json\">{maps}</script>\n\
         {module}\
         {drawing}<script type=\"module\">{page}</script></body></html>\n",
        style = compact(&[STYLE, OWN_STYLE].concat()),
        maps = view::color_maps(&[ColorMap::Viridis, ColorMap::CoolWarm]),
        module = computing::elements(module)?,
        page = compact(&bundled(&PAGE)?),
    ))
}

#[cfg(test)]
mod tests {
    use super::super::base85;
    use super::*;

    /// With the module that is committed.
    #[test]
    fn the_page_is_small() {
        let module = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/assets/fairing.wasm.gz");
        let page = laboratory(&std::fs::read(module).unwrap()).unwrap();
        assert!(page.len() < 3_000_000, "{} bytes", page.len());
    }

    /// Scripts of one page share a scope, and the page holds the module and nothing from elsewhere.
    #[test]
    fn the_page_is_complete() {
        let page = laboratory(b"module").unwrap();
        assert!(page.contains(&base85::encode(b"module")));
        let lines = || page.lines().map(str::trim_start);
        assert!(!lines().any(|line| line.starts_with("import ") || line.starts_with("export ")));
        for outside in ["src=", "https://", "XMLHttpRequest"] {
            assert!(!page.contains(outside), "{outside}");
        }
        // Only an address that was pasted is requested, which the browser tests try.
        assert_eq!(page.matches("fetch(").count(), 1);
        let mut names: Vec<&str> = lines().filter_map(|l| l.strip_prefix("class ")).collect();
        let all = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
