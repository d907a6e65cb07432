//! The module of `crates/web` as a part of a page.

use anyhow::Result;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;

use super::scripts::script;

/// The elements of a page that hold a gzip-compressed module and the script of its worker.
pub(super) fn elements(module: &[u8]) -> Result<String> {
    Ok(format!(
        "<script id=\"module\" type=\"text/plain\">{}</script>\n\
         <script id=\"worker\" type=\"text/plain\">{}</script>\n",
        BASE64.encode(module),
        script("web/assets/worker.mjs")?,
    ))
}
