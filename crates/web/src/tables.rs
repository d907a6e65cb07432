//! The tables of all tasks, from which a page makes its panels.

use std::ops::{Bound, RangeBounds as _};

use fairing_denoising::Denoiser;
use fairing_mesh::io::Format;
use fairing_operators::curvature::Estimator;
use fairing_parameters::{Algorithm, Family, Kind, Options, Parameter};
use fairing_smoothing::Method;
use serde_json::{Value, json};

use crate::sample::SAMPLES;
use crate::tasks::{CompareOptions, DistanceOptions, NoiseOptions, RepairTask, SpectrumTask};

/// Tasks with their methods and parameters, samples and formats.
pub(crate) fn all() -> Value {
    let one = |all: Vec<Algorithm>, name: &str| {
        let named = all.into_iter().filter(|algorithm| algorithm.name == name);
        task(named.collect(), name)
    };
    let format = |format: Format| {
        let extensions = format.extensions();
        json!({ "name": format.name(), "extensions": extensions, "fields": format.holds().fields })
    };
    json!({
        "tasks": {
            "curvature": task(Estimator::algorithms(), Estimator::RECOMMENDED.name()),
            "smooth": task(Method::algorithms(), "taubin"),
            "denoise": task(Denoiser::algorithms(), "automatic"),
            "noise": task(NoiseOptions::algorithms(), "normal"),
            "spectrum": one(entries::<SpectrumTask>(), "spectrum"),
            "reconstruct": one(entries::<SpectrumTask>(), "reconstruct"),
            "distance": task(entries::<DistanceOptions>(), "distance"),
            "repair": task(entries::<RepairTask>(), "repair"),
            "compare": task(entries::<CompareOptions>(), "compare"),
        },
        "samples": SAMPLES.map(|sample| json!({ "name": sample.name, "about": sample.about })),
        "formats": Format::ALL.map(format),
    })
}

fn entries<O: Options>() -> Vec<Algorithm> {
    O::entries().iter().map(|entry| entry.algorithm()).collect()
}

fn task(methods: Vec<Algorithm>, default: &str) -> Value {
    let methods: Vec<Value> = methods.iter().map(method).collect();
    json!({ "default": default, "methods": methods })
}

fn method(algorithm: &Algorithm) -> Value {
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
        Kind::Number => ("number", vec![]),
        Kind::Count => ("count", vec![]),
        Kind::Choice(choices) => {
            let choice =
                |c: &fairing_parameters::Choice| json!({ "name": c.name, "about": c.about });
            ("choice", choices.iter().map(choice).collect())
        }
        Kind::Vertices => ("vertices", vec![]),
        Kind::Weighted => ("weighted", vec![]),
        _ => ("text", vec![]),
    };
    let end = |bound: Bound<&f64>| match bound {
        Bound::Included(x) | Bound::Excluded(x) => Some(*x),
        Bound::Unbounded => None,
    };
    json!({
        "name": parameter.name,
        "about": parameter.about,
        "unit": parameter.unit,
        "kind": kind,
        "choices": choices,
        "low": end(parameter.range.start_bound()),
        "high": end(parameter.range.end_bound()),
        "range": parameter.range.to_string(),
        "default": parameter.default_text(),
        "excludes": parameter.excludes,
        "required": parameter.required,
    })
}
