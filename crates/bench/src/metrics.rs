//! Distances and normals between a mesh and its reference.

use anyhow::{Context as _, Result};
use fairing_evaluation::{normal_error, surface_distance};
use fairing_mesh::io;

use crate::task::{Job, Work, fingerprint, forgetful, work};

/// Distances between vertices and surfaces both ways, and the angles between
/// matching faces; the trees are built again each time.
pub(crate) fn metrics(job: &Job) -> Result<Work> {
    let path = job.reference.as_ref().context("missing reference mesh: --reference FILE")?;
    let (mesh, reference) = (io::read(&job.input)?.mesh, io::read(path)?.mesh);
    work(move |watch| {
        let (mesh, reference) = (forgetful(&mesh, watch)?, forgetful(&reference, watch)?);
        let distance = watch.phase("distance", || surface_distance(&mesh, &reference))?;
        let normals = watch.phase("normals", || normal_error(&mesh, &reference))?;
        Ok(move || {
            Ok(fingerprint! {
                hausdorff: distance.max(),
                chamfer: distance.chamfer(),
                normal_dev_deg: normals.mean,
            })
        })
    })
}
