//! Algorithms and their parameters, for signatures, panels and help.

use std::ops::{Bound, RangeBounds as _};

use fairing_parameters::{Algorithm, Kind, Parameter};
use serde_json::{Value, json};

/// An algorithm: its `name`, one line `about` it, the keys of its `sources` in the bibliography,
/// and its `parameters`.
///
/// A parameter has a `name`, one line `about` it, a `unit`, a `kind` (`number`, `count`, `choice`,
/// `vertices`, `weighted` or `text`) with the `choices` among names, the ends `low` and `high` of
/// its `range`, a `default` as text, names of others that it `excludes`, and the flag `required`.
pub fn method(algorithm: &Algorithm) -> Value {
    let parameters: Vec<Value> = algorithm.parameters.iter().map(parameter).collect();
    json!({
        "name": algorithm.name,
        "about": algorithm.description,
        "sources": algorithm.sources,
        "parameters": parameters,
    })
}

fn parameter(parameter: &Parameter) -> Value {
    let (kind, choices) = match parameter.kind {
        Kind::Number => ("number", &[][..]),
        Kind::Count => ("count", &[][..]),
        Kind::Choice(choices) => ("choice", choices),
        Kind::Vertices => ("vertices", &[][..]),
        Kind::Weighted => ("weighted", &[][..]),
        _ => ("text", &[][..]),
    };
    let choices = choices.iter().map(|c| json!({ "name": c.name, "about": c.about }));
    let end = |bound: Bound<&f64>| match bound {
        Bound::Included(x) | Bound::Excluded(x) => Some(*x),
        Bound::Unbounded => None,
    };
    json!({
        "name": parameter.name,
        "about": parameter.about,
        "unit": parameter.unit,
        "kind": kind,
        "choices": choices.collect::<Vec<_>>(),
        "low": end(parameter.range.start_bound()),
        "high": end(parameter.range.end_bound()),
        "range": parameter.range.to_string(),
        "default": parameter.default_text(),
        "excludes": parameter.excludes,
        "required": parameter.required,
    })
}
