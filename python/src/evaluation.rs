//! Noise and scores.

use fairing::task::{self, Unit, noise_kind};
use fairing_evaluation::{ScanOptions, ScoreOptions, Scores, add_noise};
use pyo3::prelude::*;
use pythonize::pythonize;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::options::{choose, named};
use crate::run::Call;

#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn noise(
    py: Python<'_>,
    mesh: &Mesh,
    sigma: f64,
    unit: &str,
    kind: &str,
    parameters: (Option<f64>, Option<f64>, Option<[f64; 3]>),
    seed: u64,
    call: Call,
) -> PyResult<Mesh> {
    let level = choose("unit", unit, &Unit::ALL.map(|unit| (unit.name(), unit)))?.level(sigma);
    let (fraction, length, camera) = parameters;
    let refused = |option| Error::option(format!("{kind} noise has no {option}"));
    let kind = noise_kind(named(kind)?, fraction, length, camera).map_err(refused)?;
    let mesh = mesh.share();
    Ok(call.run(py, move || Ok(add_noise(&mesh, kind, level, seed)?))?.into())
}

/// The scanned mesh, and the position of the camera.
#[pyfunction]
pub(crate) fn scan(
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

/// The scores, and a printed table.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    reference: &Mesh,
    hausdorff_tolerance: f64,
    feature_angle: f64,
    call: Call,
) -> PyResult<(Bound<'py, PyAny>, String)> {
    let (mesh, reference) = (mesh.share(), reference.share());
    let options = ScoreOptions { hausdorff_tolerance, feature_angle };
    let scores = call.run(py, move || Ok(Scores::new(&mesh, &reference, &options)?))?;
    Ok((pythonize(py, &task::scores(&scores))?, scores.to_string()))
}
