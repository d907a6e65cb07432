//! Formats of standard streams.

use std::path::Path;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::mesh::io::Format;

/// The identifier of the option for the format of the standard input. A verb whose own option is
/// called `--from` has one of this identifier under another name.
pub(super) const INPUT_FORMAT: &str = "input_format";

/// The formats by the extensions of their files.
pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    let names = Format::ALL
        .into_iter()
        .map(|format| PossibleValue::new(format.extensions()[0]).help(format.name()));
    PossibleValuesParser::new(names).try_map(|name| {
        Format::from_path(Path::new(&format!("stdin.{name}"))).map(|named| named.format).ok_or(name)
    })
}
