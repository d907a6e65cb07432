//! The generated meshes in `data/`, which stand in for the assignment's.

mod stand_ins;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, FloatWidth, VertexFields, WriteOptions};
use serde::{Deserialize, Serialize};

use crate::experiment::inputs::{Input, file_sha256};

/// The manifest's name.
const MANIFEST: &str = "manifest.toml";

/// The meshes that the study behind the automatic denoiser makes, and what they are.
const FROM_STUDY: [(&str, &str); 3] = [
    ("bolt.ply", "a bolt with a hexagonal head"),
    ("vase.ply", "a vase with lobes that wind around it"),
    ("fluted.ply", "a fluted column with mouldings"),
];

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
    #[serde(skip_serializing_if = "Option::is_none")]
    stands_for: Option<String>,
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
        let stands_for = Some(input.file().into());
        entries.push(entry(&path, &mesh, stands_for, stand_in.about, stand_in.made_by)?);
    }
    for (name, about) in FROM_STUDY {
        let path = folder.join(name);
        let mesh = io::read(&path)?.mesh;
        entries.push(entry(&path, &mesh, None, about, "cargo xtask study models".into())?);
    }
    let text = toml::to_string_pretty(&Manifest { mesh: entries })?;
    fs::write(folder.join(MANIFEST), HEADER.to_string() + &text).context("writing the manifest")
}

/// The entry of a mesh that is there.
fn entry(
    path: &Path,
    mesh: &TriMesh,
    stands_for: Option<String>,
    about: &str,
    made_by: String,
) -> Result<Entry> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let entry = Entry {
        file: name.into_owned(),
        stands_for,
        about: about.into(),
        made_by,
        vertices: mesh.vertex_count(),
        faces: mesh.face_count(),
        bytes: fs::metadata(path)?.len(),
        sha256: file_sha256(path)?,
    };
    println!("{:<18} {:>6} vertices {:>8} bytes", entry.file, entry.vertices, entry.bytes);
    Ok(entry)
}

/// Returns the files of the folder that differ from the manifest, or from the meshes of the
/// generators by more than a millionth of the size of the mesh.
pub(crate) fn check(folder: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(folder.join(MANIFEST)).context("reading the manifest")?;
    let manifest: Manifest = toml::from_str(&text).context("reading the manifest")?;
    let mut wrong = vec![];
    for entry in &manifest.mesh {
        match file_sha256(&folder.join(&entry.file)) {
            Err(error) => wrong.push(format!("{error:#}")),
            Ok(digest) if digest != entry.sha256 => {
                wrong.push(format!("{} has sha256 {digest}", entry.file));
            }
            Ok(_) => {}
        }
    }
    for input in Input::with_stand_in() {
        let (Some(file), Some(stand_in)) = (input.stand_in(), stand_ins::for_input(input)) else {
            continue;
        };
        let kept = io::read(folder.join(file)).with_context(|| format!("reading {file}"))?.mesh;
        if !alike(&kept, &stand_in.mesh) {
            wrong.push(format!("{file} is not what its generator makes"));
        }
    }
    let listed = manifest.mesh.iter().map(|entry| &*entry.file);
    let known: BTreeSet<&str> = listed.chain([MANIFEST]).collect();
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
        assert_eq!(check(&crate::run::cli::root().join("data")).unwrap(), Vec::<String>::new());
    }
}
