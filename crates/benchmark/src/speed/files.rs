//! Reading and writing meshes.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint};

/// Reads a file into positions and faces; the page cache is warm.
pub(super) struct Load {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
}

impl Task for Load {
    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        fs::read(&job.input).with_context(|| format!("reading {}", job.input.display()))?;
        Ok(Box::new(Loading { path: job.input.clone(), mesh: None }))
    }
}

struct Loading {
    path: PathBuf,
    mesh: Option<TriMesh>,
}

impl Work for Loading {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.mesh = None;
        self.mesh = Some(watch.phase("load", || io::read(&self.path))?.mesh);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        Ok(mesh_fingerprint(self.mesh.as_ref().context("nothing was read")?))
    }
}

/// Writes a mesh as binary PLY in double precision.
pub(super) struct SavePly;

impl Task for SavePly {
    fn name(&self) -> &'static str {
        "save_ply"
    }

    fn about(&self) -> &'static str {
        "positions and faces to a binary PLY, doubles"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        let path = job.out.clone().context("missing output file: --out FILE")?;
        Ok(Box::new(Saving { mesh, path }))
    }
}

struct Saving {
    mesh: TriMesh,
    path: PathBuf,
}

impl Work for Saving {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        watch.phase("save", || io::write(&self.path, &self.mesh))?;
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let mut found = mesh_fingerprint(&io::read(&self.path)?.mesh);
        found.insert("bytes".into(), fs::metadata(&self.path)?.len().into());
        Ok(found)
    }
}

/// Counts and the sum of absolute coordinates.
fn mesh_fingerprint(mesh: &TriMesh) -> Fingerprint {
    let sum: f64 = mesh.positions().as_flattened().iter().map(|x| x.abs()).sum();
    fingerprint! { vertices: mesh.vertex_count(), faces: mesh.face_count(), sum_abs: sum }
}
