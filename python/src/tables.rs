//! The tables behind the help of the program, for docstrings.

use fairing_denoising::Denoiser;
use fairing_figure::ColorMap;
use fairing_operators::curvature::Estimator;
use fairing_operators::{LaplacianKind, MassKind};
use fairing_parameters::Family;
use fairing_smoothing::Method;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Rows of a table: a name and its use.
#[pyfunction]
fn tables(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let estimators: Vec<_> = Estimator::all().iter().map(|e| (e.name(), e.description())).collect();
    let methods: Vec<_> = Method::all().iter().map(|m| (m.name(), m.description())).collect();
    let denoisers: Vec<_> = Denoiser::all().iter().map(|d| (d.name(), d.description())).collect();
    dict.set_item("estimators", estimators)?;
    dict.set_item("recommended_estimator", Estimator::RECOMMENDED.name())?;
    dict.set_item("methods", methods)?;
    let parameters: Vec<(&str, Vec<&str>)> = Method::algorithms()
        .iter()
        .map(|of| (of.name, of.parameters.iter().map(|p| p.name).collect()))
        .collect();
    dict.set_item("parameters_of_methods", parameters)?;
    dict.set_item("denoisers", denoisers)?;
    dict.set_item("laplacians", LaplacianKind::ALL.map(LaplacianKind::name))?;
    dict.set_item("masses", MassKind::ALL.map(MassKind::name))?;
    dict.set_item("color_maps", ColorMap::ALL.map(ColorMap::name))?;
    Ok(dict)
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(tables, module)?)
}
