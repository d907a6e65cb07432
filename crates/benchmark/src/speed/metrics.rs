//! Distances and normals between a mesh and its reference.

use anyhow::{Context as _, Result};
use fairing_evaluation::{NormalAngles, SurfaceDistance, normal_error, surface_distance};
use fairing_mesh::{TriMesh, io};

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint, forgetful};

/// Distances between vertices and surfaces both ways, and the angles between
/// matching faces; the trees are built again each time.
pub(super) struct Metrics;

impl Task for Metrics {
    fn name(&self) -> &'static str {
        "metrics"
    }

    fn about(&self) -> &'static str {
        "vertex-to-surface distances both ways and normal angles, against --reference"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let path = job.reference.as_ref().context("missing reference mesh: --reference FILE")?;
        let (mesh, reference) = (io::read(&job.input)?.mesh, io::read(path)?.mesh);
        Ok(Box::new(Comparing { mesh, reference, found: None }))
    }
}

struct Comparing {
    mesh: TriMesh,
    reference: TriMesh,
    found: Option<(SurfaceDistance, NormalAngles)>,
}

impl Work for Comparing {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        let (mesh, reference) = (forgetful(&self.mesh, watch)?, forgetful(&self.reference, watch)?);
        let distance = watch.phase("distance", || surface_distance(&mesh, &reference))?;
        let normals = watch.phase("normals", || normal_error(&mesh, &reference))?;
        self.found = Some((distance, normals));
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let (distance, normals) = self.found.as_ref().context("nothing was compared")?;
        Ok(fingerprint! {
            hausdorff: distance.max(),
            chamfer: distance.chamfer(),
            normal_dev_deg: normals.mean,
        })
    }
}
