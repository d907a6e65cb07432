//! Reading and writing meshes.

use std::fs;

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};

use crate::task::{Fingerprint, Job, Work, fingerprint, work};

/// Reads a file into positions and faces; the page cache is warm.
pub(crate) fn load(job: &Job) -> Result<Work> {
    let path = job.input.clone();
    fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
    work(move |watch| {
        let mesh = watch.phase("load", || io::read(&path))?.mesh;
        Ok(move || Ok(mesh_fingerprint(&mesh)))
    })
}

/// Writes a mesh as binary PLY in double precision.
pub(crate) fn save_ply(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    let path = job.out.clone().context("missing output file: --out FILE")?;
    work(move |watch| {
        watch.phase("save", || io::write(&path, &mesh))?;
        let path = path.clone();
        Ok(move || {
            let mut found = mesh_fingerprint(&io::read(&path)?.mesh);
            found.insert("bytes".into(), fs::metadata(&path)?.len().into());
            Ok(found)
        })
    })
}

/// Counts and the sum of absolute coordinates.
fn mesh_fingerprint(mesh: &TriMesh) -> Fingerprint {
    let sum: f64 = mesh.positions().as_flattened().iter().map(|x| x.abs()).sum();
    fingerprint! { vertices: mesh.vertex_count(), faces: mesh.face_count(), sum_abs: sum }
}
