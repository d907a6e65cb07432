//! Packed views as files.

use anyhow::Result;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A view in the form in which the page reads it.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Packed {
    /// Description of the arrays.
    pub(crate) about: Value,
    /// The arrays, compressed, in digits to the base 85.
    pub(crate) data: String,
}

impl Packed {
    /// The contents of the file.
    pub(crate) fn write(&self) -> Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads what [`Self::write`] has written.
    pub(crate) fn read(text: &str) -> Result<Self> {
        Ok(serde_json::from_str(text)?)
    }
}
