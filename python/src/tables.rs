//! The tables behind the help of the program, for signatures and docstrings.

use fairing_denoising::Denoiser;
use fairing_evaluation::NoiseKind;
use fairing_figure::ColorMap;
use fairing_operators::curvature::Estimator;
use fairing_operators::{LaplacianKind, MassKind};
use fairing_parameters::{Algorithm, Family, Kind, Parameter, Range, Value};
use fairing_smoothing::Method;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The name of a parameter in Python, where `lambda` is a word of the language and `kind` is that
/// of every Laplacian.
fn python_name(name: &str) -> String {
    match name {
        "lambda" => "lam".to_owned(),
        "operator" => "kind".to_owned(),
        other => other.replace('-', "_"),
    }
}

fn parameter<'py>(py: Python<'py>, of: &Parameter) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", python_name(of.name))?;
    dict.set_item("key", of.name)?;
    dict.set_item("about", of.about)?;
    dict.set_item("unit", of.unit)?;
    let (kind, choices) = match of.kind {
        Kind::Number => ("number", vec![]),
        Kind::Count => ("count", vec![]),
        Kind::Choice(choices) => ("choice", choices.iter().map(|c| (c.name, c.about)).collect()),
        Kind::Vertices => ("vertices", vec![]),
        _ => ("weighted", vec![]),
    };
    dict.set_item("kind", kind)?;
    dict.set_item("choices", choices)?;
    let plain = [Range::FINITE, Range::POSITIVE, Range::NOT_NEGATIVE].contains(&of.range);
    let range = (!plain).then(|| of.range.to_string());
    dict.set_item("range", range)?;
    dict.set_item("default", of.default.as_ref().map(Value::to_string))?;
    let excludes: Vec<String> = of.excludes.iter().map(|name| python_name(name)).collect();
    dict.set_item("excludes", excludes)?;
    Ok(dict)
}

/// Name, description and parameters of each algorithm.
type Rows<'py> = Vec<(&'static str, &'static str, Vec<Bound<'py, PyDict>>)>;

fn family<F: Family>(py: Python<'_>) -> PyResult<Rows<'_>> {
    let row = |Algorithm { name, description, parameters, .. }: &Algorithm| {
        let parameters = parameters.iter().map(|p| parameter(py, p));
        Ok((*name, *description, parameters.collect::<PyResult<_>>()?))
    };
    F::algorithms().iter().map(row).collect()
}

/// Algorithms with their parameters, and names.
#[pyfunction]
fn tables(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("estimator", family::<Estimator>(py)?)?;
    dict.set_item("method", family::<Method>(py)?)?;
    dict.set_item("denoiser", family::<Denoiser>(py)?)?;
    dict.set_item("recommended_estimator", Estimator::RECOMMENDED.name())?;
    dict.set_item("laplacians", LaplacianKind::ALL.map(LaplacianKind::name))?;
    dict.set_item("masses", MassKind::ALL.map(MassKind::name))?;
    dict.set_item("color_maps", ColorMap::ALL.map(ColorMap::name))?;
    dict.set_item("noise_kinds", NoiseKind::ALL.map(NoiseKind::name))?;
    Ok(dict)
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(tables, module)?)
}
