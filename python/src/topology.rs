//! Edges, loops, neighbours and angles of a mesh, and its moments.

use fairing_mesh::Moments;
use fairing_operators::{corner_angles as corners, dihedral_angles as dihedrals};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{column, rows};
use crate::mesh::Mesh;
use crate::run::Call;

/// The boundary edges and the non-manifold edges, ascending.
#[pyfunction]
pub(crate) fn special_edges<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<[Bound<'py, PyArray1<u32>>; 2]> {
    let mesh = mesh.share();
    let found = call.run(py, move || {
        let topology = mesh.topology();
        Ok([topology.boundary_edges().collect(), topology.nonmanifold_edges().collect()])
    })?;
    Ok(found.map(|edges| column(py, edges)))
}

/// The vertices of each boundary loop.
#[pyfunction]
pub(crate) fn boundary_loops<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<Vec<Bound<'py, PyArray1<u32>>>> {
    let mesh = mesh.share();
    let loops = call.run(py, move || Ok(mesh.topology().boundary_loops().to_vec()))?;
    Ok(loops.into_iter().map(|vertices| column(py, vertices)).collect())
}

/// `m × 3`, the face beside each edge of a face; −1 for none.
#[pyfunction]
pub(crate) fn face_neighbors<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let mesh = mesh.share();
    let found = call.run(py, move || Ok(mesh.topology().face_neighbors()))?;
    rows(py, found.into_iter().map(|faces| faces.map(|f| f.map_or(-1, i64::from))).collect())
}

/// `m × 3`, in radians.
#[pyfunction]
pub(crate) fn corner_angles<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mesh = mesh.share();
    rows(py, call.run(py, move || Ok(corners(&mesh)))?)
}

/// In radians, one for each edge; NaN for none.
#[pyfunction]
pub(crate) fn dihedral_angles<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: Call,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let mesh = mesh.share();
    let found = call.run(py, move || Ok(dihedrals(&mesh)))?;
    Ok(column(py, found.into_iter().map(|angle| angle.unwrap_or(f64::NAN)).collect()))
}

/// Measure, centroid and inertia.
type PyMoments<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// The moments of the surface or of the solid.
#[pyfunction]
pub(crate) fn moments<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    solid: bool,
    call: Call,
) -> PyResult<Option<PyMoments<'py>>> {
    let mesh = mesh.share();
    let found = call
        .run(py, move || Ok(if solid { mesh.volume_moments() } else { mesh.surface_moments() }))?;
    let Some(Moments { measure, centroid, inertia, .. }) = found else { return Ok(None) };
    Ok(Some((measure, column(py, centroid.to_vec()), rows(py, inertia.to_vec())?)))
}
