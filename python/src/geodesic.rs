//! Geodesic distances, paths and isolines, and heat and Poisson problems.

use std::sync::Arc;

use fairing_evaluation::SurfaceTree;
use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, MassKind};
use fairing_spectral::{
    HeatDiffusion, HeatGeodesics, Isoline, Poisson, SurfacePoint, geodesic_path,
    isolines as pieces_of,
};
use ndarray::ArrayView1;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{column, matrix, rows, values};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::operators::assemble;
use crate::options::named;
use crate::run::Call;

/// Sources: vertices, points in space, or faces with barycentric coordinates.
#[derive(FromPyObject)]
enum Sources {
    Vertices(Vec<u32>),
    Points(Vec<[f64; 3]>),
    OnFaces(Vec<(u32, [f64; 3])>),
}

impl Sources {
    fn on(self, mesh: &TriMesh) -> Result<Vec<SurfacePoint>> {
        match self {
            Self::Vertices(vertices) => {
                Ok(vertices.into_iter().map(SurfacePoint::vertex).collect())
            }
            Self::Points(points) => {
                let closest = SurfaceTree::new(mesh)?.closest_to_all(&points);
                let points = closest.into_iter();
                points.map(|at| Ok(SurfacePoint::projected(mesh, at.face, at.point)?)).collect()
            }
            Self::OnFaces(points) => {
                let points = points.into_iter();
                points
                    .map(|(face, weights)| Ok(SurfacePoint::on_face(mesh, face, weights)?))
                    .collect()
            }
        }
    }
}

/// Factorised heat method for any sources.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Geodesics {
    mesh: Arc<TriMesh>,
    inner: Arc<HeatGeodesics>,
    /// A note if a face too thin for cotangents made the Laplacian robust.
    #[pyo3(get)]
    note: Option<String>,
}

#[pymethods]
impl Geodesics {
    #[new]
    fn new(
        py: Python<'_>,
        mesh: &Mesh,
        kind: &str,
        time: Option<f64>,
        call: Call,
    ) -> PyResult<Self> {
        let kind = named::<LaplacianKind>(kind)?;
        let mesh = mesh.share();
        let of = Arc::clone(&mesh);
        let (inner, note) = call.run(py, move || {
            fairing_watch::stage("factorising", 2);
            let (laplacian, note) = assemble(&of, kind, MassKind::Barycentric)?;
            Ok((HeatGeodesics::with(&of, &laplacian, time)?, note))
        })?;
        Ok(Self { mesh, inner: Arc::new(inner), note })
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.kind().name()
    }

    /// Distances, infinite on components without a source.
    fn distance<'py>(
        &self,
        py: Python<'py>,
        sources: Sources,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (inner, mesh) = (Arc::clone(&self.inner), Arc::clone(&self.mesh));
        let found = call.run(py, move || {
            let distance = inner.distance_from(&sources.on(&mesh)?)?;
            Ok(distance.into_iter().map(|d| d.unwrap_or(f64::INFINITY)).collect())
        })?;
        Ok(column(py, found))
    }

    /// The path from a vertex to the nearest source, and true if it arrives there.
    fn path<'py>(
        &self,
        py: Python<'py>,
        start: u32,
        sources: Sources,
        call: Call,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, bool)> {
        let (inner, mesh) = (Arc::clone(&self.inner), Arc::clone(&self.mesh));
        let (path, arrives) = call.run(py, move || {
            let sources = sources.on(&mesh)?;
            let distance = inner.distance_from(&sources)?;
            let path = geodesic_path(&mesh, &distance, &sources, start)?;
            // At a vertex that is no source the path has ended in another minimum.
            let arrives = path.end.is_none_or(|v| sources.contains(&SurfacePoint::vertex(v)));
            Ok((path, arrives))
        })?;
        Ok((rows(py, path.points)?, arrives))
    }
}

/// A piece of an isoline: points `p × 3`, the edge of each `p × 2`, and true if it is closed.
type Polyline<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>, bool);

/// The pieces of each isoline; infinite values count as none.
#[pyfunction]
pub(crate) fn isolines<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    field: PyReadonlyArray1<'_, f64>,
    levels: Vec<f64>,
    call: Call,
) -> PyResult<Vec<Vec<Polyline<'py>>>> {
    let mesh = mesh.share();
    let field: Vec<Option<f64>> = values(&field).into_iter().map(Some).collect();
    let found = call.run(py, move || {
        let lines = levels.iter().map(|&level| Ok(pieces_of(&mesh, &field, level)?));
        lines.collect::<Result<Vec<_>>>()
    })?;
    let polyline = |line: Isoline| Ok((rows(py, line.points)?, rows(py, line.edges)?, line.closed));
    found.into_iter().map(|lines| lines.into_iter().map(polyline).collect()).collect()
}

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
        temperatures: PyReadonlyArray2<'_, f64>,
        steps: usize,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (inner, mut heat) = (Arc::clone(&self.inner), temperatures.as_array().to_owned());
        let found = call.run(py, move || {
            fairing_watch::stage("steps of heat", (steps * heat.ncols()) as u64);
            for mut column in heat.columns_mut() {
                let mut one = column.to_vec();
                for _ in 0..steps {
                    one = inner.step(&one)?;
                    fairing_watch::advance(1);
                }
                column.assign(&ArrayView1::from(&one));
            }
            Ok(heat)
        })?;
        Ok(matrix(py, found))
    }
}

/// Solves −Δu = f with u prescribed at some vertices, for each column; with a note as in
/// [`assemble`].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn poisson<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    f: PyReadonlyArray2<'_, f64>,
    fixed: Vec<u32>,
    at_fixed: PyReadonlyArray2<'_, f64>,
    kind: &str,
    mass: &str,
    call: Call,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Option<String>)> {
    let (kind, mass) = (named::<LaplacianKind>(kind)?, named::<MassKind>(mass)?);
    let mesh = mesh.share();
    let [mut u, at_fixed] = [f, at_fixed].map(|columns| columns.as_array().to_owned());
    let (found, note) = call.run(py, move || {
        let (laplacian, note) = assemble(&mesh, kind, mass)?;
        let problem = Poisson::new(&laplacian, &fixed)?;
        for (mut u, at_fixed) in u.columns_mut().into_iter().zip(at_fixed.columns()) {
            let found = problem.solve(&u.to_vec(), &at_fixed.to_vec())?;
            u.assign(&ArrayView1::from(&found));
        }
        Ok((u, note))
    })?;
    Ok((matrix(py, found), note))
}
