//! The tables of all tasks, from which a page makes its panels.

use fairing::task::method;
use fairing_denoising::Denoiser;
use fairing_mesh::io::Format;
use fairing_operators::curvature::Estimator;
use fairing_parameters::{Algorithm, Family, Options};
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
