//! Heat and Poisson problems, factorised once.

use std::sync::Arc;

use fairing_operators::{LaplacianKind, MassKind};
use fairing_spectral::{HeatDiffusion, Poisson};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{column, values};
use crate::mesh::Mesh;
use crate::operators::assemble;
use crate::options::named;
use crate::run::Call;

/// Implicit heat steps of fixed length.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Heat {
    inner: Arc<HeatDiffusion>,
    /// A note if a face too thin for cotangents made the Laplacian robust.
    #[pyo3(get)]
    note: Option<String>,
}

#[pymethods]
impl Heat {
    #[new]
    fn new(
        py: Python<'_>,
        mesh: &Mesh,
        time: f64,
        kind: &str,
        mass: &str,
        call: Call,
    ) -> PyResult<Self> {
        let (kind, mass) = (named::<LaplacianKind>(kind)?, named::<MassKind>(mass)?);
        let mesh = mesh.share();
        let (inner, note) = call.run(py, move || {
            let (laplacian, note) = assemble(&mesh, kind, mass)?;
            Ok((HeatDiffusion::new(&laplacian, time)?, note))
        })?;
        Ok(Self { inner: Arc::new(inner), note })
    }

    fn step<'py>(
        &self,
        py: Python<'py>,
        temperatures: PyReadonlyArray1<'_, f64>,
        steps: usize,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (inner, mut heat) = (Arc::clone(&self.inner), values(&temperatures));
        let found = call.run(py, move || {
            fairing_watch::stage("steps of heat", steps as u64);
            for _ in 0..steps {
                heat = inner.step(&heat)?;
                fairing_watch::advance(1);
            }
            Ok(heat)
        })?;
        Ok(column(py, found))
    }
}

/// Solves −Δu = f with u prescribed at some vertices; with a note as in [`assemble`].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn poisson<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    f: PyReadonlyArray1<'_, f64>,
    fixed: Vec<u32>,
    at_fixed: PyReadonlyArray1<'_, f64>,
    kind: &str,
    mass: &str,
    call: Call,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Option<String>)> {
    let (kind, mass) = (named::<LaplacianKind>(kind)?, named::<MassKind>(mass)?);
    let (mesh, f, at_fixed) = (mesh.share(), values(&f), values(&at_fixed));
    let (found, note) = call.run(py, move || {
        let (laplacian, note) = assemble(&mesh, kind, mass)?;
        Ok((Poisson::new(&laplacian, &fixed)?.solve(&f, &at_fixed)?, note))
    })?;
    Ok((column(py, found), note))
}
