//! Denoising.

use fairing_denoising::{Denoiser, SurfaceKind, automatic};
use pyo3::prelude::*;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::run::Call;

/// The mesh; for the automatic method also σ, if measured, and the kind of surface.
#[pyfunction]
fn denoise(
    py: Python<'_>,
    mesh: &Mesh,
    method: &str,
    call: Call,
) -> PyResult<(Mesh, Option<f64>, Option<&'static str>, usize)> {
    let method = Denoiser::by_name(method).map_err(Error::option)?;
    let mesh = mesh.share();
    let (mesh, sigma, kind, uneven) = call.run(py, move || {
        if !matches!(method, Denoiser::Automatic(_)) {
            return Ok((method.denoise(&mesh)?, None, None, 0));
        }
        let found = automatic(&mesh)?;
        let kind = match found.kind {
            SurfaceKind::Creased => "creased",
            SurfaceKind::Smooth => "smooth",
            SurfaceKind::Uneven => "uneven",
            _ => "clean",
        };
        Ok((found.mesh, found.noise.map(|n| n.sigma), Some(kind), found.uneven_vertices))
    })?;
    Ok((mesh.into(), sigma, kind, uneven))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(denoise, module)?)
}
