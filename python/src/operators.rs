//! Laplacians, gradients and curvature.

use std::sync::Arc;

use fairing_denoising::noise_level;
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{CurvatureField, Estimator, laplacian_curvature};
use fairing_operators::{
    Laplacian, LaplacianKind, MassKind, MassMatrix, Reason, divergence, gradient,
};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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
fn laplacian<'py>(
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
fn polygon_laplacian<'py>(
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
fn gradient_of<'py>(py: Python<'py>, mesh: &Mesh, call: Call) -> PyResult<Csr<'py>> {
    let mesh = mesh.share();
    Ok(csr(py, call.run(py, move || Ok(gradient(&mesh)?))?))
}

#[pyfunction(name = "divergence")]
fn divergence_of<'py>(py: Python<'py>, mesh: &Mesh, call: Call) -> PyResult<Csr<'py>> {
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

type Directions<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

#[pyfunction]
fn curvature<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    estimator: &str,
    given: Named,
    kind: Option<&str>,
    call: Call,
) -> PyResult<Bound<'py, PyDict>> {
    let estimator = Estimator::with(estimator, &borrowed(&given)).map_err(Error::option)?;
    let kind = kind.map(named::<LaplacianKind>).transpose()?;
    let mesh: Arc<TriMesh> = mesh.share();
    let (field, defined) = call.run(py, move || {
        let field = estimate(&mesh, estimator, kind)?;
        let defined: Vec<bool> = field.status.iter().map(|s| s.is_defined()).collect();
        Ok((field, defined))
    })?;
    let dict = PyDict::new(py);
    dict.set_item("mean", column(py, field.mean))?;
    dict.set_item("gaussian", column(py, field.gaussian))?;
    dict.set_item("kappa1", column(py, field.kappa1))?;
    dict.set_item("kappa2", column(py, field.kappa2))?;
    dict.set_item("defined", column(py, defined))?;
    dict.set_item("boundary", column(py, field.boundary))?;
    dict.set_item("too_thin", field.too_thin)?;
    dict.set_item("narrowed", field.narrowed)?;
    let directions: Option<Directions<'_>> = match field.directions {
        Some([first, second]) => Some((rows(py, first)?, rows(py, second)?)),
        None => None,
    };
    dict.set_item("directions", directions)?;
    let accuracy = field.accuracy.map(|found| {
        [found.mean_error, found.gaussian_error, found.scale].map(|values| column(py, values))
    });
    dict.set_item("accuracy", accuracy)?;
    Ok(dict)
}

/// The fields of `NoiseLevel`, in order.
type NoiseNumbers = (f64, f64, bool, usize, f64, f64, f64, f64, f64);

/// The noise level; `None` if it is undefined.
#[pyfunction(name = "noise_level")]
fn noise_level_of(py: Python<'_>, mesh: &Mesh, call: Call) -> PyResult<Option<NoiseNumbers>> {
    let mesh = mesh.share();
    call.run(py, move || {
        Ok(noise_level(&mesh).map(|n| {
            let (low, two_ring) = (n.low_ratio, n.two_ring_ratio);
            let (tail, impulsive) = (n.tail_ratio, n.is_impulsive());
            let (length, wide) = (n.correlation_length, n.wide_sigma);
            (n.sigma, tail, impulsive, n.samples, low, n.correlation, two_ring, length, wide)
        }))
    })
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(laplacian, module)?)?;
    module.add_function(wrap_pyfunction!(polygon_laplacian, module)?)?;
    module.add_function(wrap_pyfunction!(gradient_of, module)?)?;
    module.add_function(wrap_pyfunction!(divergence_of, module)?)?;
    module.add_function(wrap_pyfunction!(curvature, module)?)?;
    module.add_function(wrap_pyfunction!(noise_level_of, module)?)
}
