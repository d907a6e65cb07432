//! Packed views as files.
//!
//! A page that is opened from disk may read no file but scripts, so that the
//! file is one: a call of `keepView` of `assets/data.js`, with everything on its
//! second line.

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;

const BEGIN: &str = "keepView(\n";
const END: &str = "\n);\n";

/// A view in the form in which the page reads it.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Packed {
    /// Its id on the page.
    pub(crate) id: String,
    /// What the arrays are.
    pub(crate) about: Value,
    /// The arrays, compressed, in base64.
    pub(crate) data: String,
}

impl Packed {
    /// The contents of the file.
    pub(crate) fn to_script(&self) -> Result<String> {
        Ok(format!("{BEGIN}{}{END}", serde_json::to_string(self)?))
    }

    /// Reads what [`Self::to_script`] has written.
    pub(crate) fn from_script(text: &str) -> Result<Self> {
        let inner = text.strip_prefix(BEGIN).and_then(|t| t.strip_suffix(END));
        Ok(serde_json::from_str(inner.context("this is no view")?)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_read_as_it_was_written() {
        let about = serde_json::json!({"alt": "a \"b\"\n</script>", "x": 0.1});
        let view = Packed { id: "q1-v".into(), about, data: "AAAA".into() };
        let text = view.to_script().unwrap();
        assert_eq!(text.lines().count(), 3);
        assert_eq!(Packed::from_script(&text).unwrap(), view);
        assert!(Packed::from_script("keepView({})").is_err());
    }
}
