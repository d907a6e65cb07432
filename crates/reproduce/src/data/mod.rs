//! The generated meshes in `data/`, which stand in for the assignment's.

mod stand_ins;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, FloatWidth, VertexFields, WriteOptions};
use serde::{Deserialize, Serialize};

use fairing_experiments::inputs::{Input, file_sha256};

/// The manifest's name.
const MANIFEST: &str = "manifest.toml";

const HEADER: &str = "\
# The meshes of this folder: what they are, how they were made, and their digests.
# Written by `cargo xtask data`; `cargo xtask data --check` verifies it.

";

/// The contents of the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Manifest {
    mesh: Vec<Entry>,
}

/// One generated mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry {
    file: String,
    stands_for: String,
    about: String,
    made_by: String,
    vertices: usize,
    faces: usize,
    bytes: u64,
    sha256: String,
}

/// Generates every mesh and the manifest.
pub(crate) fn generate(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)?;
    let mut entries = vec![];
    for input in Input::with_stand_in() {
        let (Some(name), Some(stand_in)) = (input.stand_in(), stand_ins::for_input(input)) else {
            continue;
        };
        let path = folder.join(name);
        let (mesh, options) =
            (stand_in.mesh, WriteOptions::default().with_float_width(FloatWidth::Single));
        io::write_with_fields(&path, &mesh, &VertexFields::default(), &options)?;
        let entry = Entry {
            file: name.into(),
            stands_for: input.file().into(),
            about: stand_in.about.into(),
            made_by: stand_in.made_by,
            vertices: mesh.vertex_count(),
            faces: mesh.face_count(),
            bytes: fs::metadata(&path)?.len(),
            sha256: file_sha256(&path)?,
        };
        println!("{:<18} {:>6} vertices {:>8} bytes", entry.file, entry.vertices, entry.bytes);
        entries.push(entry);
    }
    let text = toml::to_string_pretty(&Manifest { mesh: entries })?;
    fs::write(folder.join(MANIFEST), HEADER.to_string() + &text).context("writing the manifest")
}

/// Returns the files of the folder that differ from the manifest, or from the meshes of the
/// generators by more than a millionth of the size of the mesh.
pub(crate) fn check(folder: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(folder.join(MANIFEST)).context("reading the manifest")?;
    let manifest: Manifest = toml::from_str(&text).context("reading the manifest")?;
    let mut wrong = vec![];
    for input in Input::with_stand_in() {
        let (Some(file), Some(stand_in)) = (input.stand_in(), stand_ins::for_input(input)) else {
            continue;
        };
        let Some(entry) = manifest.mesh.iter().find(|e| e.file == file) else {
            wrong.push(format!("{file} is not in the manifest"));
            continue;
        };
        let path = folder.join(file);
        match file_sha256(&path) {
            Err(error) => {
                wrong.push(format!("{error:#}"));
                continue;
            }
            Ok(digest) if digest != entry.sha256 => {
                wrong.push(format!("{file} has sha256 {digest}"))
            }
            Ok(_) => {}
        }
        let kept = io::read(&path).with_context(|| format!("reading {file}"))?.mesh;
        if !alike(&kept, &stand_in.mesh) {
            wrong.push(format!("{file} is not what its generator makes"));
        }
    }
    let stand_ins = Input::with_stand_in().filter_map(Input::stand_in);
    let known: BTreeSet<&str> = stand_ins.chain([MANIFEST]).collect();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !known.contains(name.as_str()) {
            wrong.push(format!("{name} is not in the manifest"));
        }
    }
    Ok(wrong)
}

/// The same faces, and positions that differ by rounding.
fn alike(a: &TriMesh, b: &TriMesh) -> bool {
    let near = |(p, q): (&[f64; 3], &[f64; 3])| {
        glam::DVec3::from(*p).distance((*q).into()) <= 1e-6 * b.diagonal()
    };
    a.faces() == b.faces() && a.positions().iter().zip(b.positions()).all(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed meshes agree with the manifest and with their generators.
    #[test]
    fn data_is_as_its_manifest_says() {
        assert_eq!(check(&crate::cli::root().join("data")).unwrap(), Vec::<String>::new());
    }
}
