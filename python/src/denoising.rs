//! Denoising.

use fairing::task;
use fairing_denoising::{Denoiser, Masked, automatic};
use pyo3::prelude::*;
use pythonize::pythonize;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::options::{Named, borrowed};
use crate::run::Call;

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
