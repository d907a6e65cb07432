//! The module of `crates/web` as a part of a page.

use anyhow::Result;

use super::base85;
use super::bundle::{bundled, compact};

/// The scripts of the page that talk to the module.
pub(super) const CLIENT: [(&str, &str); 2] = [
    ("client.mjs", include_str!("../../../web/assets/client.mjs")),
    ("page.mjs", include_str!("../../../web/assets/page.mjs")),
];

const WORKER: [(&str, &str); 2] = [
    ("engine.mjs", include_str!("../../../web/assets/engine.mjs")),
    ("worker.mjs", include_str!("../../../web/assets/worker.mjs")),
];

/// The elements of a page that hold a gzip-compressed module and the script of its worker.
pub(super) fn elements(module: &[u8]) -> Result<String> {
    Ok(format!(
        "<script id=\"module\" type=\"text/plain\">{}</script>\n\
         <script id=\"worker\" type=\"text/plain\">{}</script>\n",
        base85::encode(module),
        compact(&bundled(&WORKER)?),
    ))
}
