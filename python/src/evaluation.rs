//! Noise and scores.

use fairing_evaluation::{NoiseKind, NoiseLevel, ScanOptions, ScoreOptions, Scores, add_noise};
use pyo3::prelude::*;

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::{choose, named};
use crate::run::Call;

/// The kind of noise of a name, with the fraction, length and camera that are given.
fn noise_kind(
    name: &str,
    (fraction, length, camera): (Option<f64>, Option<f64>, Option<[f64; 3]>),
) -> Result<NoiseKind> {
    let mut kind: NoiseKind = named(name)?;
    let refused = |option: &str| Error::option(format!("{name} noise has no {option}"));
    if let Some(fraction) = fraction {
        kind = kind.with_fraction(fraction).ok_or_else(|| refused("fraction"))?;
    }
    if let Some(length) = length {
        kind = kind.with_length(length).ok_or_else(|| refused("length"))?;
    }
    if let Some(camera) = camera {
        kind = kind.with_camera(camera).ok_or_else(|| refused("camera"))?;
    }
    Ok(kind)
}

#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
fn noise(
    py: Python<'_>,
    mesh: &Mesh,
    sigma: f64,
    unit: &str,
    kind: &str,
    parameters: (Option<f64>, Option<f64>, Option<[f64; 3]>),
    seed: u64,
    call: Call,
) -> PyResult<Mesh> {
    type Level = fn(f64) -> NoiseLevel;
    let levels: [(&str, Level); 3] = [
        ("edge", NoiseLevel::EdgeLengths),
        ("model", NoiseLevel::Model),
        ("diagonal", NoiseLevel::Diagonals),
    ];
    let level = choose("unit", unit, &levels)?(sigma);
    let kind = noise_kind(kind, parameters)?;
    let mesh = mesh.share();
    Ok(call.run(py, move || Ok(add_noise(&mesh, kind, level, seed)?))?.into())
}

/// The scanned mesh, and the position of the camera.
#[pyfunction]
fn scan(
    py: Python<'_>,
    mesh: &Mesh,
    views: (Option<[f64; 3]>, Option<[f64; 3]>),
    size: [u32; 2],
    field_of_view: Option<f64>,
    jump: f64,
    call: Call,
) -> PyResult<(Mesh, [f64; 3])> {
    let mesh = mesh.share();
    let (camera, look_at) = views;
    let options = ScanOptions { camera, look_at, size, field_of_view, jump };
    let scan = call.run(py, move || Ok(fairing_evaluation::scan(&mesh, &options)?))?;
    Ok((scan.mesh.into(), scan.camera))
}

/// Name, label, unit, value, and the reason if there is no value.
type Entry = (&'static str, &'static str, String, Option<f64>, Option<String>);

/// The diagonal of the reference, the scores, and a printed table.
#[pyfunction]
fn compare(
    py: Python<'_>,
    mesh: &Mesh,
    reference: &Mesh,
    hausdorff_tolerance: f64,
    feature_angle: f64,
    call: Call,
) -> PyResult<(f64, Vec<Entry>, String)> {
    let (mesh, reference) = (mesh.share(), reference.share());
    let options = ScoreOptions { hausdorff_tolerance, feature_angle };
    let scores = call.run(py, move || Ok(Scores::new(&mesh, &reference, &options)?))?;
    let entry = |score: fairing_evaluation::Score| match score.value {
        Ok(value) => (score.name, score.label, score.unit.to_string(), Some(value), None),
        Err(reason) => (score.name, score.label, score.unit.to_string(), None, Some(reason)),
    };
    let entries = scores.entries().into_iter().map(entry).collect();
    Ok((scores.diagonal, entries, scores.to_string()))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(noise, module)?)?;
    module.add_function(wrap_pyfunction!(scan, module)?)?;
    module.add_function(wrap_pyfunction!(compare, module)?)
}
