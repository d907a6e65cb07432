//! Repair, and closest points.

use fairing::task::Unit;
use fairing_evaluation::{SurfaceTree, inside};
use fairing_mesh::{RepairOptions, Repaired, Tolerance};
use fairing_smoothing::repair_fair;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::arrays::{column, rows, triples};
use crate::mesh::Mesh;
use crate::options::choose;
use crate::run::Call;

/// The steps of a repair and their limits, from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Steps {
    merge: bool,
    tolerance: Option<f64>,
    unit: String,
    duplicates: bool,
    orient: bool,
    cavities: bool,
    split: bool,
    smallest_component: usize,
    thin: f64,
    isolated: bool,
    holes: usize,
}

impl Steps {
    fn options(self) -> PyResult<RepairOptions> {
        let Self { merge, tolerance, unit, duplicates, orient, cavities, split, .. } = self;
        let Self { smallest_component, thin, isolated, holes, .. } = self;
        let unit = choose("unit", &unit, &Unit::ALL.map(|unit| (unit.name(), unit)))?;
        Ok(RepairOptions {
            merge,
            tolerance: tolerance.map_or(Tolerance::Rounding, |length| unit.tolerance(length)),
            duplicates,
            orient,
            cavities,
            split,
            smallest_component,
            thin,
            isolated,
            holes,
        })
    }
}

/// Element numbers, -1 for none.
fn numbers<'py>(py: Python<'py>, elements: &[Option<u32>]) -> Bound<'py, PyArray1<i64>> {
    column(py, elements.iter().map(|e| e.map_or(-1, i64::from)).collect())
}

/// Report of a repair; elements as arrays.
#[derive(IntoPyObject)]
pub(crate) struct Report<'py> {
    unchanged: bool,
    changes: Bound<'py, PyDict>,
    open_holes: Vec<(u32, usize, &'static str)>,
    vertices: Bound<'py, PyArray1<i64>>,
    vertex_sources: Bound<'py, PyArray1<i64>>,
    face_sources: Bound<'py, PyArray1<i64>>,
    flat_patches: Option<String>,
}

/// The mesh with fair patches, the report, the vertex whose fields each vertex takes, and whether
/// normals still fit.
type PyRepaired<'py> =
    (Mesh, Report<'py>, (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<usize>>), bool);

#[pyfunction(name = "repair")]
pub(crate) fn repair_mesh<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    steps: Steps,
    call: Call,
) -> PyResult<PyRepaired<'py>> {
    let (mesh, options) = (mesh.share(), steps.options()?);
    let (repaired, flat, nearest, corners) = call.run(py, move || {
        let (repaired, flat) = repair_fair(&mesh, &options)?;
        let nearest = repaired.nearest_sources();
        let corners = repaired.nearest_corners(&mesh);
        Ok((repaired, flat, nearest, corners))
    })?;
    let keeps_normals = !repaired.changes_normals();
    let unchanged = repaired.is_unchanged();
    let Repaired { mesh, vertex_sources, face_sources, vertices, changes, open_holes, .. } =
        repaired;
    let changes = changes.into_iter().map(|(step, changed)| (step.name(), column(py, changed)));
    let holes = open_holes.iter().map(|hole| (hole.vertex, hole.edges, hole.reason.name()));
    let report = Report {
        unchanged,
        changes: changes.into_py_dict(py)?,
        open_holes: holes.collect(),
        vertices: numbers(py, &vertices),
        vertex_sources: numbers(py, &vertex_sources),
        face_sources: numbers(py, &face_sources),
        flat_patches: flat.map(|error| error.to_string()),
    };
    let sources = (column(py, nearest), column(py, corners));
    Ok((mesh.into(), report, sources, keeps_normals))
}

/// Labels of vertices, -1 for isolated ones, and of faces.
type Labels<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

#[pyfunction]
pub(crate) fn components<'py>(py: Python<'py>, mesh: &Mesh, call: Call) -> PyResult<Labels<'py>> {
    let mesh = mesh.share();
    let (vertices, faces) = call.run(py, move || {
        let components = mesh.topology().components();
        let vertices = (0..mesh.vertex_count() as u32).map(|v| components.label(v));
        let faces = mesh.faces().iter().map(|face| components.label(face[0]));
        Ok((vertices.collect::<Vec<_>>(), faces.collect::<Vec<_>>()))
    })?;
    Ok((numbers(py, &vertices), numbers(py, &faces)))
}

/// Distances, points and faces.
type PyClosest<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<u32>>);

/// Closest points; with a sign distances are negative inside.
#[pyfunction]
pub(crate) fn closest<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    points: PyReadonlyArray2<'_, f64>,
    signed: bool,
    call: Call,
) -> PyResult<PyClosest<'py>> {
    let (mesh, points) = (mesh.share(), triples(&points)?);
    let (distances, found) = call.run(py, move || {
        let found = SurfaceTree::new(&mesh)?.closest_to_all(&points);
        let mut distances: Vec<f64> = found.iter().map(|closest| closest.distance).collect();
        if signed {
            let sides = inside(&mesh, &points, &found);
            let within = distances.iter_mut().zip(sides).filter(|(_, inside)| *inside);
            within.for_each(|(distance, _)| *distance = -*distance);
        }
        Ok((distances, found))
    })?;
    let at = found.iter().map(|closest| closest.point).collect();
    let faces = found.iter().map(|closest| closest.face).collect();
    Ok((column(py, distances), rows(py, at)?, column(py, faces)))
}
