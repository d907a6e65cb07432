//! Laplacians, gradients and curvature.

use std::sync::Arc;

use fairing_denoising::{NoiseEstimate, noise_level};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{CurvatureField, Estimator, laplacian_curvature};
use fairing_operators::{
    Laplacian, LaplacianKind, MassKind, MassMatrix, Reason, divergence, gradient,
};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pythonize::pythonize;
use serde::Serialize;

use crate::arrays::{Csr, column, csr, rows, triples, values};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, polygons};
use crate::options::{Named, borrowed, named};
use crate::run::Call;

/// The Laplacian, and a note if a face too thin for cotangents made it robust.
pub(crate) fn assemble(
    mesh: &TriMesh,
    kind: LaplacianKind,
    mass: MassKind,
) -> Result<(Laplacian, Option<String>)> {
    let laplacian = Laplacian::new(mesh, kind, mass)?;
    let note = match laplacian.reason() {
        reason @ Reason::ThinFace { .. } => Some(format!("{reason}; the robust Laplacian is used")),
        _ => None,
    };
    Ok((laplacian, note))
}

/// A mass for Python: a diagonal or a matrix.
#[derive(IntoPyObject)]
pub(crate) enum PyMass<'py> {
    Lumped(Bound<'py, PyArray1<f64>>),
    Consistent(Csr<'py>),
}

pub(crate) fn mass(py: Python<'_>, mass: MassMatrix) -> PyMass<'_> {
    match mass {
        MassMatrix::Lumped(diagonal) => PyMass::Lumped(column(py, diagonal)),
        MassMatrix::Consistent(matrix) => PyMass::Consistent(csr(py, matrix)),
    }
}

#[pyfunction]
pub(crate) fn laplacian<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    kind: &str,
    mass_kind: &str,
    call: Call,
) -> PyResult<(Csr<'py>, PyMass<'py>, &'static str, String, Option<String>)> {
    let (kind, mass_kind) = (named::<LaplacianKind>(kind)?, named::<MassKind>(mass_kind)?);
    let mesh = mesh.share();
    let (found, note) = call.run(py, move || assemble(&mesh, kind, mass_kind))?;
    let (taken, reason) = (found.kind().name(), found.reason().to_string());
    let (stiffness, matrix) = found.into_parts();
    Ok((csr(py, stiffness), mass(py, matrix), taken, reason, note))
}

/// S and M of the polygons, without splitting them into triangles.
#[pyfunction]
pub(crate) fn polygon_laplacian<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'_, f64>,
    corners: PyReadonlyArray1<'_, u32>,
    sizes: PyReadonlyArray1<'_, u32>,
    mass_kind: &str,
    call: Call,
) -> PyResult<(Csr<'py>, PyMass<'py>)> {
    let mass_kind = named::<MassKind>(mass_kind)?;
    let positions = triples(&vertices)?;
    let (corners, sizes) = (values(&corners), values(&sizes));
    let found = call.run(py, move || {
        Ok(Laplacian::from_polygons(&polygons(positions, &corners, &sizes)?, mass_kind)?)
    })?;
    let (stiffness, matrix) = found.into_parts();
    Ok((csr(py, stiffness), mass(py, matrix)))
}

#[pyfunction(name = "gradient")]
pub(crate) fn gradient_of<'py>(py: Python<'py>, mesh: &Mesh, call: Call) -> PyResult<Csr<'py>> {
    let mesh = mesh.share();
    Ok(csr(py, call.run(py, move || Ok(gradient(&mesh)?))?))
}

#[pyfunction(name = "divergence")]
pub(crate) fn divergence_of<'py>(py: Python<'py>, mesh: &Mesh, call: Call) -> PyResult<Csr<'py>> {
    let mesh = mesh.share();
    Ok(csr(py, call.run(py, move || Ok(divergence(&mesh)?))?))
}

fn estimate(
    mesh: &TriMesh,
    estimator: Estimator,
    kind: Option<LaplacianKind>,
) -> Result<CurvatureField> {
    let Some(kind) = kind else { return Ok(estimator.estimate(mesh)?) };
    if !matches!(estimator, Estimator::Cotangent(_)) {
        return Err(Error::option(format!("{estimator} takes no kind of Laplacian")));
    }
    Ok(laplacian_curvature(mesh, &Laplacian::new(mesh, kind, MassKind::Barycentric)?)?)
}

/// A curvature as arrays.
#[derive(IntoPyObject)]
pub(crate) struct Curvature<'py> {
    mean: Bound<'py, PyArray1<f64>>,
    gaussian: Bound<'py, PyArray1<f64>>,
    kappa1: Bound<'py, PyArray1<f64>>,
    kappa2: Bound<'py, PyArray1<f64>>,
    defined: Bound<'py, PyArray1<bool>>,
    boundary: Bound<'py, PyArray1<bool>>,
    too_thin: Option<u32>,
    narrowed: usize,
    directions: Option<[Bound<'py, PyArray2<f64>>; 2]>,
    accuracy: Option<[Bound<'py, PyArray1<f64>>; 3]>,
}

#[pyfunction]
pub(crate) fn curvature<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    estimator: &str,
    given: Named,
    kind: Option<&str>,
    call: Call,
) -> PyResult<Curvature<'py>> {
    let estimator = Estimator::with(estimator, &borrowed(&given)).map_err(Error::option)?;
    let kind = kind.map(named::<LaplacianKind>).transpose()?;
    let mesh: Arc<TriMesh> = mesh.share();
    let (field, defined) = call.run(py, move || {
        let field = estimate(&mesh, estimator, kind)?;
        let defined: Vec<bool> = field.status.iter().map(|s| s.is_defined()).collect();
        Ok((field, defined))
    })?;
    let directions = match field.directions {
        Some([first, second]) => Some([rows(py, first)?, rows(py, second)?]),
        None => None,
    };
    let accuracy = field.accuracy.map(|found| {
        [found.mean_error, found.gaussian_error, found.scale].map(|values| column(py, values))
    });
    Ok(Curvature {
        mean: column(py, field.mean),
        gaussian: column(py, field.gaussian),
        kappa1: column(py, field.kappa1),
        kappa2: column(py, field.kappa2),
        defined: column(py, defined),
        boundary: column(py, field.boundary),
        too_thin: field.too_thin,
        narrowed: field.narrowed,
        directions,
        accuracy,
    })
}

/// The fields of `NoiseLevel`.
#[derive(Serialize)]
struct NoiseLevel {
    #[serde(flatten)]
    level: NoiseEstimate,
    impulsive: bool,
}

/// The noise level; `None` if it is undefined.
#[pyfunction(name = "noise_level")]
pub(crate) fn noise_level_of<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<Bound<'py, PyAny>> {
    let mesh = mesh.share();
    let level = call.run(py, move || Ok(noise_level(&mesh)))?;
    let level = level.map(|level| NoiseLevel { level, impulsive: level.is_impulsive() });
    Ok(pythonize(py, &level)?)
}
