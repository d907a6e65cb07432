//! Smoothing and denoising.

use fairing::{ErrorKind, task};
use fairing_denoising::{Denoiser, Masked, automatic};
use fairing_smoothing::{FlowError, Method, Report, Smoothed};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;

use crate::error::{Error, FlowError_, chain};
use crate::mesh::Mesh;
use crate::options::{Named, borrowed};
use crate::run::Call;

fn report_dict<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("iterations", report.iterations)?;
    dict.set_item("stable_limit", report.stable_limit)?;
    dict.set_item("unstable", report.unstable)?;
    dict.set_item("too_thin", report.too_thin)?;
    dict.set_item("degenerate_faces", report.degenerate_faces)?;
    dict.set_item("worst_residual", report.worst_residual)?;
    dict.set_item("approach", report.approach.to_string())?;
    dict.set_item("split", report.split.map(|s| (s.below, s.above)))?;
    Ok(dict)
}

/// The exception of a flow: an option error, or a flow error with the step and the last good mesh.
fn exception(py: Python<'_>, error: FlowError) -> PyErr {
    let text = chain(&error);
    let error = fairing::Error::from(error);
    let is_option = error.kind() == ErrorKind::Option;
    let error = match error {
        fairing::Error::Flow(error) if !is_option => error,
        other => return Error::from(other).into(),
    };
    let exception = FlowError_::new_err(text);
    let value = exception.value(py);
    let set = || -> PyResult<()> {
        value.setattr("iteration", error.iteration)?;
        value.setattr("last_good", Bound::new(py, Mesh::from(*error.last_good))?)
    };
    match set() {
        Ok(()) => exception,
        Err(other) => other,
    }
}

/// The mesh, and the report of the flow.
#[pyfunction]
pub(crate) fn smooth<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    method: &str,
    given: Named,
    call: Call,
) -> PyResult<(Mesh, Bound<'py, PyDict>)> {
    let mesh = mesh.share();
    let method = Method::with(method, &borrowed(&given)).map_err(Error::option)?;
    let result = call.run(py, move || Ok(method.run(&mesh, None)))?;
    let Smoothed { mesh, report, .. } = result.map_err(|error| exception(py, error))?;
    Ok((mesh.into(), report_dict(py, &report)?))
}

/// The mesh, and the report of the automatic method. Vertices of `pinned` do not move.
#[pyfunction]
pub(crate) fn denoise<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    method: &str,
    given: Named,
    pinned: Vec<u32>,
    call: Call,
) -> PyResult<(Mesh, Bound<'py, PyAny>)> {
    let method = Denoiser::with(method, &borrowed(&given)).map_err(Error::option)?;
    let mesh = mesh.share();
    let (mesh, report) = call.run(py, move || {
        let mut fixed = vec![false; mesh.vertex_count()];
        for v in pinned {
            if let Some(fixed) = fixed.get_mut(v as usize) {
                *fixed = true;
            }
        }
        let masked = Masked::new(&mesh, &fixed).map_err(Error::option)?;
        let Denoiser::Automatic(options) = method else {
            return Ok((method.denoise(masked)?, None));
        };
        let found = automatic(masked, &options)?;
        let report = task::denoise(&found);
        Ok((found.mesh, Some(report)))
    })?;
    Ok((mesh.into(), pythonize(py, &report)?))
}
