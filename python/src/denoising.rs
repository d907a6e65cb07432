//! Denoising.

use fairing_denoising::{Approach, Denoiser, Masked, automatic};
use pyo3::prelude::*;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::options::{Named, borrowed};
use crate::run::Call;

/// The report of the automatic method: σ̂, correlation length and level at that length, if
/// measured; the kind of surface, the approach, the expected error of normals in degrees, the level
/// that may be relief, and the numbers of spikes, of flipped faces and of vertices on uneven parts.
type Found = (Option<[f64; 3]>, &'static str, Option<&'static str>, Option<f64>, f64, [usize; 3]);

/// The mesh, and the report of the automatic method. Vertices of `pinned` do not move.
#[pyfunction]
fn denoise(
    py: Python<'_>,
    mesh: &Mesh,
    method: &str,
    given: Named,
    pinned: Vec<u32>,
    call: Call,
) -> PyResult<(Mesh, Option<Found>)> {
    let method = Denoiser::with(method, &borrowed(&given)).map_err(Error::option)?;
    let mesh = mesh.share();
    let (mesh, found) = call.run(py, move || {
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
        let noise = found.noise.map(|n| [n.sigma, n.correlation_length, n.wide_sigma]);
        Ok((
            found.mesh,
            Some((
                noise,
                found.kind.name(),
                found.approach.map(Approach::name),
                found.expected_error,
                found.undecided,
                [found.spikes, found.flipped_faces, found.uneven_vertices],
            )),
        ))
    })?;
    Ok((mesh.into(), found))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(denoise, module)?)
}
