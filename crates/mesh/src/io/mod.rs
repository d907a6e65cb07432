//! Reading and writing OBJ, PLY, OFF, STL, VTP and GLB, plain or gzip-compressed.
//!
//! The order of vertices is kept exactly, isolated ones included; coordinates
//! go from text to `f64` with correct rounding. Content and file extension decide the
//! format together: content that contradicts the name is an error.
//!
//! Rules for content that a mesh cannot hold:
//!
//! - Polygons are split by [`PolygonMesh::triangulate`](crate::PolygonMesh::triangulate)
//!   and counted in the [report](ReadReport). The mesh [keeps](crate::TriMesh::polygons) them, and
//!   formats that hold polygons get them back.
//! - Faces that repeat a corner, common in exported quads, are reduced to
//!   their distinct corners; faces with fewer than three of these have no area
//!   and are left out. The report lists both; [strict](Strictness::Strict)
//!   reading refuses them.
//! - A position that is not finite or an index without a vertex is an error;
//!   [`Reader::dropping_broken`] leaves out the faces concerned.
//! - STL stores corners, not vertices: corners at exactly equal positions
//!   (−0 = 0) become one vertex, in order of first appearance.
//! - Vertex and face properties of PLY, VTP and GLB, colours and normals of vertices and
//!   texture coordinates of corners of OBJ, and colours and normals of OFF become [`VertexFields`];
//!   objects, groups and materials of OBJ become [`Statements`]. All other content (materials of
//!   GLB, cameras, …) is ignored and named in the report.
//! - Names of properties have a meaning in PLY (`x`, `red`, `normal_x`, …), so a field of such a
//!   name is written under another name, which the report gives.
//! - GLB is one mesh: the meshes of its scene, transformed by their nodes. glTF in JSON is read
//!   too, with its buffers in it or beside it.
//!
//! No count in a file is trusted: memory grows with the bytes present,
//! and [`Reader`] bounds the size of decompressed files.
//!
//! Features of the crate: `io` reads files and bytes and encodes bytes, `gzip`
//! reads compressed files, `files` (on by default) writes files.
//!
//! # Examples
//!
//! ```
//! use fairing_mesh::{TriMesh, io};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("triangle.ply.gz");
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0]];
//! let mesh = TriMesh::new(corners, vec![[0, 1, 2]])?;
//! let fields = io::VertexFields::default().with_scalar("height", vec![1.0, 2.0, 0.1]);
//! io::write_with_fields(&path, &mesh, &fields, &io::WriteOptions::default())?;
//!
//! let file = io::read(&path)?;
//! assert_eq!(file.mesh, mesh);
//! assert_eq!(file.fields, fields);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod columns;
mod error;
mod fields;
mod finish;
mod foreign;
mod format;
mod glb;
#[cfg(feature = "gzip")]
mod gzip;
mod number;
mod number_type;
mod obj;
mod off;
mod options;
mod parsed;
mod ply;
mod read;
mod report;
mod row;
mod stl;
mod surface;
mod text;
mod vtp;
#[cfg(feature = "files")]
mod whole;
mod write;

pub use error::{Place, ReadError, ReadProblem, WriteError, WriteProblem};
pub use fields::{FaceFields, VertexFields};
pub use format::{Format, NamedFormat};
pub use number_type::NumberType;
pub use obj::Statements;
pub use options::{Encoding, FloatWidth, Reader, Strictness, UnsupportedFields, WriteOptions};
pub use read::{MeshFile, read};
pub use report::{ReadReport, WriteReport};
pub use row::Holds;
#[cfg(feature = "files")]
pub use whole::{check_writable, discard_unfinished, write_whole};
pub use write::{to_bytes, unsupported, write_to};
#[cfg(feature = "files")]
pub use write::{write, write_with_fields};

#[cfg(all(test, feature = "files"))]
mod tests;
