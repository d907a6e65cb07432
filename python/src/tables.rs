//! The tables behind the help of the program, for signatures and docstrings.

use fairing::task::method;
use fairing_denoising::Denoiser;
use fairing_evaluation::NoiseKind;
use fairing_figure::ColorMap;
use fairing_operators::curvature::Estimator;
use fairing_operators::{LaplacianKind, MassKind};
use fairing_parameters::Family;
use fairing_smoothing::Method;
use pyo3::prelude::*;
use pythonize::pythonize;
use serde::Serialize;
use serde_json::Value;

/// Families of algorithms, and names.
#[derive(Serialize)]
struct Tables {
    estimator: Vec<Value>,
    method: Vec<Value>,
    denoiser: Vec<Value>,
    recommended_estimator: &'static str,
    laplacians: Vec<&'static str>,
    masses: Vec<&'static str>,
    color_maps: Vec<&'static str>,
    noise_kinds: Vec<&'static str>,
}

fn family<F: Family>() -> Vec<Value> {
    F::algorithms().iter().map(method).collect()
}

/// Algorithms with their parameters, and names.
#[pyfunction]
pub(crate) fn tables(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let tables = Tables {
        estimator: family::<Estimator>(),
        method: family::<Method>(),
        denoiser: family::<Denoiser>(),
        recommended_estimator: Estimator::RECOMMENDED.name(),
        laplacians: LaplacianKind::ALL.map(LaplacianKind::name).into(),
        masses: MassKind::ALL.map(MassKind::name).into(),
        color_maps: ColorMap::ALL.map(ColorMap::name).into(),
        noise_kinds: NoiseKind::ALL.map(NoiseKind::name).into(),
    };
    Ok(pythonize(py, &tables)?)
}
