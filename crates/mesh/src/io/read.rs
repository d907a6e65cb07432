//! Reading files, bytes and streams.

use std::borrow::Cow;
use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::path::Path;

use crate::build::check_positions;
use crate::io::error::Fault;
use crate::io::finish::Finished;
use crate::io::parsed::Broken;
use crate::io::surface::triangulate;
use crate::io::{
    Format, ReadError, ReadProblem, ReadReport, Reader, Strictness, VertexFields, glb,
};
use crate::polygon::{PolygonMesh, Polygons};
use crate::trimesh::TriMesh;

/// A mesh from a file, with its fields.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MeshFile {
    /// The mesh, its polygons split into triangles; it [keeps](TriMesh::polygons) them.
    pub mesh: TriMesh,
    /// Fields and colours of vertices and faces.
    pub fields: VertexFields,
    /// The format, counts, and content that was changed or left out.
    pub report: ReadReport,
}

/// Reads a mesh with [`Reader::default`]; polygons are split as in [`PolygonMesh::triangulate`].
///
/// # Errors
///
/// [`ReadError`] names the file, the line or byte, the expected content and the
/// content found.
pub fn read(path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
    Reader::default().read(path)
}

impl Reader {
    /// Reads a file, as [`read`] does.
    ///
    /// # Errors
    ///
    /// As for [`read`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
        let path = path.as_ref();
        let parse = |bytes: Vec<u8>| self.named(path, &bytes, path.parent());
        self.load(path).and_then(parse).map_err(|fault| fault.in_file(path))
    }

    /// Reads a mesh from the bytes of a file. The extension of `name` counts as
    /// that of the file, and errors contain `name`; it may be empty.
    ///
    /// # Errors
    ///
    /// As for [`read`].
    pub fn read_bytes(&self, name: impl AsRef<Path>, bytes: &[u8]) -> Result<MeshFile, ReadError> {
        let name = name.as_ref();
        self.named(name, bytes, None).map_err(|fault| fault.in_file(name))
    }

    /// Reads a mesh from a stream up to its end: a file, a response, an
    /// archive member, standard input. Gzip is recognised by content, and so is
    /// the format if none is given.
    ///
    /// # Errors
    ///
    /// As for [`read`]; the file name in the error is empty.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::io::{self, Format, Reader};
    ///
    /// let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    /// let file = Reader::strict().read_from(text.as_bytes(), Some(Format::Obj))?;
    /// assert_eq!(file.mesh.face_count(), 1);
    /// # Ok::<(), io::ReadError>(())
    /// ```
    pub fn read_from(
        &self,
        stream: impl Read,
        format: Option<Format>,
    ) -> Result<MeshFile, ReadError> {
        self.drained(stream, 0)
            .and_then(|bytes| self.parsed(format, &bytes, None))
            .map_err(|fault| fault.in_file(Path::new("")))
    }

    /// The bytes of a file, all from the same state of the file.
    fn load(&self, path: &Path) -> Result<Vec<u8>, Fault> {
        let file = File::open(path)?;
        let before = file.metadata()?;
        if before.is_file() && before.len() > self.max_bytes {
            return Err(Fault::whole(ReadProblem::TooLong { limit: self.max_bytes }));
        }
        let bytes = self.drained(&file, before.len())?;
        let after = file.metadata()?;
        // Clocks of file systems tick in milliseconds: a size that differs is a change, too.
        let state = |about: &Metadata| (about.len(), about.modified().ok());
        if before.is_file() && state(&before) != state(&after) {
            return Err(io::Error::other("the file has changed while it was read").into());
        }
        Ok(bytes)
    }

    /// The mesh in the bytes of a file of this name. Fails if the name ends in `.gz` and the
    /// content is not compressed.
    fn named(&self, path: &Path, bytes: &[u8], folder: Option<&Path>) -> Result<MeshFile, Fault> {
        let named = Format::from_path(path);
        if named.is_some_and(|named| named.gzip) && !is_gzip(bytes) && !bytes.is_empty() {
            return Err(Fault::whole(ReadProblem::OtherKind {
                extension: "gzip-compressed".to_owned(),
                content: "not".to_owned(),
            }));
        }
        self.parsed(named.map(|named| named.format), bytes, folder)
    }

    /// The bytes of a stream, up to the limit, with their expected number.
    fn drained(&self, stream: impl Read, expected: u64) -> Result<Vec<u8>, Fault> {
        let limit = self.max_bytes;
        let mut bytes = Vec::new();
        // One more shows the end without another allocation.
        let room = usize::try_from(expected.saturating_add(1)).map_err(io::Error::other)?;
        bytes.try_reserve_exact(room).map_err(io::Error::from)?;
        stream.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > limit {
            return Err(Fault::whole(ReadProblem::TooLong { limit }));
        }
        Ok(bytes)
    }

    /// Parses and checks a file; `folder` holds the files that it names.
    fn parsed(
        &self,
        named: Option<Format>,
        bytes: &[u8],
        folder: Option<&Path>,
    ) -> Result<MeshFile, Fault> {
        fairing_watch::stage("reading", 0);
        let compressed = is_gzip(bytes);
        let bytes = if compressed { unpack(bytes, self)? } else { bytes.into() };
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Err(Fault::whole(ReadProblem::Empty));
        }
        let body = after_mark(&bytes);
        let format = Format::decide(named, body)?;
        let broken = match self.strictness {
            Strictness::DropBroken => Broken::Kept,
            Strictness::Lenient | Strictness::Strict => Broken::Refused,
        };
        let parsed = match format {
            Format::Glb => {
                let beside = glb::Beside { folder, max_bytes: self.max_bytes };
                glb::parse(body, broken, beside)
            }
            _ => (format.row().parse)(body, broken),
        };
        let mark = bytes.len() - body.len();
        let mut parsed = parsed.map_err(|fault| fault.moved(mark))?;
        if mark > 0 {
            parsed.notes.push("the byte-order mark at the beginning is ignored".to_owned());
        }
        let Finished { positions, polygons, fields, mut report } =
            parsed.finish(format, compressed, self)?;
        check_positions(&positions).map_err(|error| Fault::whole(ReadProblem::Mesh(error)))?;
        let (mesh, fields, note) = match polygons {
            Polygons::Triangles(faces) => (TriMesh::from_checked(positions, faces), fields, None),
            mixed => triangulate(PolygonMesh::from_checked(positions, mixed), fields),
        };
        report.notes.extend(note);
        Ok(MeshFile { mesh, fields, report })
    }
}

/// The content after the byte-order mark that some editors put before UTF-8 text. The first three
/// bytes of a binary STL are content, whatever they are.
fn after_mark(bytes: &[u8]) -> &[u8] {
    match bytes.strip_prefix(b"\xef\xbb\xbf") {
        Some(body) if Format::from_content(bytes).is_none() => body,
        _ => bytes,
    }
}

/// Returns true if the bytes begin like a gzip member.
fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

#[cfg(feature = "gzip")]
fn unpack<'a>(bytes: &[u8], reader: &Reader) -> Result<Cow<'a, [u8]>, Fault> {
    crate::io::gzip::unpack(bytes, reader).map(Cow::Owned)
}

#[cfg(not(feature = "gzip"))]
fn unpack<'a>(_: &[u8], _: &Reader) -> Result<Cow<'a, [u8]>, Fault> {
    let reason = "this program was built without the feature gzip";
    Err(Fault::whole(ReadProblem::Compression(std::io::Error::other(reason))))
}
