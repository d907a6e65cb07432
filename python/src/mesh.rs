//! The mesh and its properties.

use std::path::PathBuf;
use std::sync::Arc;

use fairing::task;
use fairing_mesh::io::{
    self, Encoding, FaceFields, FloatWidth, Format, MeshFile, Reader, Statements,
    UnsupportedFields, VertexFields, WriteOptions,
};
use fairing_mesh::{
    BuildError, Diagnosis, PolygonMesh, TriMesh, Welded, subdivide_loop, subdivide_midpoint,
};
use fairing_operators::{NormalWeight, face_normals, weighted_vertex_normals};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use pythonize::pythonize;

use crate::arrays::{column, rows, triples, values, view};
use crate::error::{Error, Result};
use crate::options::{choose, named};
use crate::run::Call;

/// An immutable triangle mesh.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Mesh {
    inner: Arc<TriMesh>,
    statements: Arc<Statements>,
}

impl From<TriMesh> for Mesh {
    fn from(mesh: TriMesh) -> Self {
        Self { inner: Arc::new(mesh), statements: Arc::default() }
    }
}

impl Mesh {
    /// A shared handle for another thread.
    pub(crate) fn share(&self) -> Arc<TriMesh> {
        Arc::clone(&self.inner)
    }
}

/// Fields of vertices or of faces by name: numbers, vectors, and colours.
type Named<'py> = (
    Vec<(String, PyReadonlyArray1<'py, f64>)>,
    Vec<(String, PyReadonlyArray2<'py, f64>)>,
    Option<PyReadonlyArray2<'py, u8>>,
);

/// Fields of vertices, fields of faces, and texture coordinates of corners.
type Fields<'py> = (Named<'py>, Named<'py>, Option<PyReadonlyArray2<'py, f64>>);

#[pymethods]
impl Mesh {
    #[new]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
    ) -> PyResult<Self> {
        let (positions, faces) = (triples(&vertices)?, triples(&faces)?);
        let mesh = py.detach(|| TriMesh::new(positions, faces)).map_err(Error::from)?;
        Ok(mesh.into())
    }

    /// The mesh with the same faces at other positions.
    fn with_vertices(&self, py: Python<'_>, vertices: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let positions = triples(&vertices)?;
        let moved = py.detach(|| self.inner.with_positions(positions)).map_err(Error::from)?;
        Ok(moved.into())
    }

    /// The corners of all polygons and the number of corners of each.
    fn polygons<'py>(&self, py: Python<'py>) -> Option<[Bound<'py, PyArray1<u32>>; 2]> {
        let polygons = self.inner.polygons()?;
        let sizes = polygons.iter().map(|face| face.len() as u32).collect();
        Some([column(py, polygons.corners().to_vec()), column(py, sizes)])
    }

    /// The mesh as parts of polygons.
    fn with_polygons(
        &self,
        corners: PyReadonlyArray1<'_, u32>,
        sizes: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<Self> {
        let positions = self.inner.positions().to_vec();
        let faces = polygons(positions, &values(&corners), &values(&sizes))?.faces().clone();
        let mesh = TriMesh::clone(&self.inner).with_polygons(faces);
        let mesh = mesh.ok_or_else(|| Error::option("the faces are no parts of the polygons"))?;
        Ok(Self { inner: Arc::new(mesh), statements: Arc::clone(&self.statements) })
    }

    /// Objects, groups and materials of an OBJ file: the face that each statement stands before,
    /// its keyword and its text.
    fn statements<'py>(&self, py: Python<'py>) -> Vec<(usize, &'static str, Bound<'py, PyBytes>)> {
        let runs = self.statements.runs().into_iter();
        runs.map(|(face, keyword, text)| (face, keyword, PyBytes::new(py, text))).collect()
    }

    /// The mesh with other statements.
    fn with_statements(&self, runs: Vec<(usize, String, Vec<u8>)>) -> Self {
        let runs = runs.iter().map(|(face, keyword, text)| (*face, &keyword[..], &text[..]));
        let statements = Arc::new(Statements::from_runs(self.inner.face_count(), runs));
        Self { inner: self.share(), statements }
    }

    /// The mesh with the statements of another one of the same faces.
    fn with_statements_of(&self, other: &Self) -> Self {
        Self { inner: self.share(), statements: Arc::clone(&other.statements) }
    }

    /// `n × 3`, a view that keeps the mesh alive.
    #[getter]
    fn vertices<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view(slf.get().inner.positions_view(), slf.clone().into_any())
    }

    /// `m × 3`, a view that keeps the mesh alive.
    #[getter]
    fn faces<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<u32>> {
        view(slf.get().inner.faces_view(), slf.clone().into_any())
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.inner.face_count()
    }

    #[getter]
    fn mean_edge_length(&self) -> f64 {
        self.inner.mean_edge_length()
    }

    #[getter]
    fn area(&self) -> f64 {
        self.inner.area()
    }

    #[getter]
    fn diagonal(&self) -> f64 {
        self.inner.diagonal()
    }

    fn same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner == other.inner
    }

    /// `e × 2`, the lower number first.
    fn edges<'py>(&self, py: Python<'py>, call: Call) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let mesh = self.share();
        let edges = call.run(py, move || Ok(mesh.topology().edges().to_vec()))?;
        let n = edges.len();
        use numpy::PyArrayMethods;
        PyArray1::from_vec(py, edges.into_flattened()).reshape([n, 2])
    }

    fn boundary_vertices<'py>(
        &self,
        py: Python<'py>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let mesh = self.share();
        let flags = call.run(py, move || Ok(mesh.topology().boundary_vertices().to_vec()))?;
        Ok(column(py, flags))
    }

    fn face_areas<'py>(&self, py: Python<'py>, call: Call) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mesh = self.share();
        let areas =
            call.run(py, move || Ok((0..mesh.face_count()).map(|f| mesh.face_area(f)).collect()))?;
        Ok(column(py, areas))
    }

    fn face_normals<'py>(
        &self,
        py: Python<'py>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mesh = self.share();
        rows(py, call.run(py, move || Ok(face_normals(&mesh)))?)
    }

    fn vertex_normals<'py>(
        &self,
        py: Python<'py>,
        weight: &str,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let weight = named::<NormalWeight>(weight)?;
        let mesh = self.share();
        rows(py, call.run(py, move || Ok(weighted_vertex_normals(&mesh, weight)))?)
    }

    /// The numbers of turned and of one-sided faces.
    fn disagreeing_faces(&self, py: Python<'_>, call: Call) -> PyResult<(usize, usize)> {
        let mesh = self.share();
        call.run(py, move || Ok((mesh.turned_faces().len(), mesh.one_sided_faces().len())))
    }

    fn is_unwelded(&self, py: Python<'_>, call: Call) -> PyResult<bool> {
        let mesh = self.share();
        call.run(py, move || Ok(mesh.is_unwelded()))
    }

    /// The welded mesh, and the vertex in it that each vertex became.
    fn weld<'py>(
        &self,
        py: Python<'py>,
        call: Call,
    ) -> PyResult<(Self, Bound<'py, PyArray1<u32>>)> {
        let mesh = self.share();
        let Welded { mesh, vertices, .. } = call.run(py, move || Ok(mesh.welded()))?;
        Ok((mesh.into(), column(py, vertices)))
    }

    fn subdivide(&self, py: Python<'_>, scheme: &str, call: Call) -> PyResult<Self> {
        type Scheme = fn(&TriMesh) -> std::result::Result<TriMesh, BuildError>;
        let schemes: [(&str, Scheme); 2] =
            [("loop", |m| subdivide_loop(m)), ("midpoint", |m| subdivide_midpoint(m))];
        let scheme = choose("scheme", scheme, &schemes)?;
        let mesh = self.share();
        Ok(call.run(py, move || Ok(scheme(&mesh)?))?.into())
    }

    fn diagnosis<'py>(&self, py: Python<'py>, call: Call) -> PyResult<Bound<'py, PyAny>> {
        let mesh = self.share();
        let diagnosis = call.run(py, move || Ok(Diagnosis::new(&mesh)))?;
        let mut entries = task::diagnosis(&diagnosis);
        entries.insert("hints".to_owned(), diagnosis.hints().into());
        Ok(pythonize(py, &entries)?)
    }

    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        given: Fields<'_>,
        ascii: bool,
        width: &str,
        call: Call,
    ) -> PyResult<(Vec<String>, Vec<String>)> {
        let mut fields = fields(given)?;
        fields.faces.statements = Statements::clone(&self.statements);
        let options = write_options(ascii, width)?;
        let mesh = self.share();
        call.run(py, move || {
            let report = io::write_with_fields(&path, &mesh, &fields, &options)?;
            Ok((report.dropped, report.notes))
        })
    }

    fn to_bytes<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        given: Fields<'_>,
        ascii: bool,
        width: &str,
        call: Call,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let mut fields = fields(given)?;
        fields.faces.statements = Statements::clone(&self.statements);
        let options = write_options(ascii, width)?;
        let format: Format = named(format)?;
        let mesh = self.share();
        let bytes = call.run(py, move || Ok(io::to_bytes(format, &mesh, &fields, &options)?))?;
        Ok(PyBytes::new(py, &bytes))
    }
}

fn write_options(ascii: bool, width: &str) -> Result<WriteOptions> {
    let widths = [
        ("lossless", FloatWidth::Lossless),
        ("double", FloatWidth::Double),
        ("single", FloatWidth::Single),
    ];
    let mut options = WriteOptions::default().with_float_width(choose("width", width, &widths)?);
    options.encoding = if ascii { Encoding::Ascii } else { Encoding::Binary };
    options.unsupported_fields = UnsupportedFields::Drop;
    Ok(options)
}

fn fields((of_vertices, of_faces, of_corners): Fields<'_>) -> Result<VertexFields> {
    let numbers = |named: &Named<'_>| named.0.iter().map(|(n, v)| (n.clone(), values(v))).collect();
    let vectors = |named: &Named<'_>| {
        named.1.iter().map(|(n, v)| Ok((n.clone(), triples(v)?))).collect::<Result<_>>()
    };
    let colors = |named: &Named<'_>| named.2.as_ref().map(triples).transpose();
    let texture = |t: &PyReadonlyArray2<'_, f64>| {
        t.as_array().rows().into_iter().map(|r| [r[0], r[1]]).collect()
    };
    let faces = FaceFields {
        scalars: numbers(&of_faces),
        vectors: vectors(&of_faces)?,
        colors: colors(&of_faces)?,
        texture: of_corners.as_ref().map(texture),
        ..FaceFields::default()
    };
    Ok(VertexFields {
        scalars: numbers(&of_vertices),
        vectors: vectors(&of_vertices)?,
        colors: colors(&of_vertices)?,
        faces,
        ..VertexFields::default()
    })
}

/// Fields of vertices or of faces, for Python.
type PyNamed<'py> = (
    Vec<(String, Bound<'py, PyArray1<f64>>)>,
    Vec<(String, Bound<'py, PyArray2<f64>>)>,
    Option<Bound<'py, PyArray2<u8>>>,
);

/// Result of a reader: the mesh, the fields of vertices and of faces, texture coordinates of
/// corners, and the report.
type FileParts<'py> =
    (Mesh, PyNamed<'py>, PyNamed<'py>, Option<Bound<'py, PyArray2<f64>>>, Bound<'py, PyAny>);

fn named_fields(
    py: Python<'_>,
    scalars: Vec<(String, Vec<f64>)>,
    vectors: Vec<(String, Vec<[f64; 3]>)>,
    colors: Option<Vec<[u8; 3]>>,
) -> PyResult<PyNamed<'_>> {
    let scalars = scalars.into_iter().map(|(n, v)| (n, column(py, v))).collect();
    let vectors = vectors.into_iter().map(|(n, v)| Ok((n, rows(py, v)?)));
    Ok((scalars, vectors.collect::<PyResult<_>>()?, colors.map(|c| rows(py, c)).transpose()?))
}

fn parts(py: Python<'_>, file: MeshFile) -> PyResult<FileParts<'_>> {
    let MeshFile { mesh, fields, report, .. } = file;
    let faces = fields.faces;
    let mesh = Mesh { inner: Arc::new(mesh), statements: Arc::new(faces.statements) };
    let of_vertices = named_fields(py, fields.scalars, fields.vectors, fields.colors)?;
    let of_faces = named_fields(py, faces.scalars, faces.vectors, faces.colors)?;
    let texture = faces.texture.map(|texture| rows(py, texture)).transpose()?;
    Ok((mesh, of_vertices, of_faces, texture, pythonize(py, &task::read(&report))?))
}

fn reader(strict: bool, drop_broken: bool) -> Result<Reader> {
    match (strict, drop_broken) {
        (true, true) => Err(Error::option("strict refuses what drop_broken leaves out")),
        (true, false) => Ok(Reader::strict()),
        (false, true) => Ok(Reader::dropping_broken()),
        (false, false) => Ok(Reader::default()),
    }
}

#[pyfunction]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    strict: bool,
    drop_broken: bool,
    call: Call,
) -> PyResult<FileParts<'_>> {
    let reader = reader(strict, drop_broken)?;
    let file = call.run(py, move || Ok(reader.read(&path)?))?;
    parts(py, file)
}

#[pyfunction]
pub(crate) fn read_bytes(
    py: Python<'_>,
    name: PathBuf,
    bytes: Vec<u8>,
    strict: bool,
    drop_broken: bool,
    call: Call,
) -> PyResult<FileParts<'_>> {
    let reader = reader(strict, drop_broken)?;
    let file = call.run(py, move || Ok(reader.read_bytes(&name, &bytes)?))?;
    parts(py, file)
}

/// Polygons from their concatenated corners and the number of corners of each.
pub(crate) fn polygons(
    positions: Vec<[f64; 3]>,
    corners: &[u32],
    sizes: &[u32],
) -> Result<PolygonMesh> {
    let mut rest = corners;
    let mut polygons = Vec::with_capacity(sizes.len());
    for &size in sizes {
        let (polygon, after) = rest
            .split_at_checked(size as usize)
            .ok_or_else(|| Error::option("fewer corners than the sizes of the polygons say"))?;
        polygons.push(polygon);
        rest = after;
    }
    Ok(PolygonMesh::new(positions, polygons)?)
}

/// A mesh from polygons, split into triangles; it keeps them.
#[pyfunction]
pub(crate) fn from_polygons(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    corners: PyReadonlyArray1<'_, u32>,
    sizes: PyReadonlyArray1<'_, u32>,
    call: Call,
) -> PyResult<Mesh> {
    let positions = triples(&vertices)?;
    let (corners, sizes) = (values(&corners), values(&sizes));
    let mesh = call.run(py, move || Ok(polygons(positions, &corners, &sizes)?.triangulate()))?;
    Ok(mesh.into())
}
