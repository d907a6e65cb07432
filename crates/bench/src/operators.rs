//! Assembling operators, estimating curvature, and distances and normals between two meshes.
//!
//! Each repetition starts from a mesh of its own, made under the phase
//! `prepare`: what a mesh remembers about its faces must be found again.

use anyhow::{Context as _, Result};
use fairing_evaluation::{normal_error, surface_distance};
use fairing_mesh::io;
use fairing_operators::curvature::{Estimator, mean_and_gaussian_curvature};
use fairing_operators::{Laplacian, LumpedArea, cotan_stiffness, lumped_mass};
use glam::DVec3;

use crate::task::{Job, Work, fingerprint, forgetful, work};

/// The cotangent stiffness and the lumped barycentric mass.
pub(crate) fn laplacian(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let (s, m) = watch.phase("assemble", || {
            anyhow::Ok((cotan_stiffness(&mesh)?, lumped_mass(&mesh, LumpedArea::Barycentric)?))
        })?;
        Ok(move || {
            let position = |i: usize| DVec3::from(mesh.positions()[i]);
            let energy: f64 = s
                .iter()
                .map(|(w, (i, j))| w * position(i as usize).dot(position(j as usize)))
                .sum();
            Ok(fingerprint! {
                trace_S: s.diag().iter().map(|(_, d)| d).sum::<f64>(),
                xSx: energy,
                sum_M: m.iter().sum::<f64>(),
                sum_M2: m.iter().map(|a| a * a).sum::<f64>(),
                nnz: s.nnz(),
            })
        })
    })
}

/// The Laplacian at other positions of the same faces.
pub(crate) fn refill(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    let mut laplacian = Laplacian::cotangent(&mesh)?;
    let stretched = mesh.positions().iter().map(|&[x, y, z]| [x, y, 1.25 * z]).collect();
    // Both are used in turn; the first is the next one.
    let mut meshes = [mesh.with_positions(stretched)?, mesh];
    work(move |watch| {
        watch.phase("refill", || laplacian.refill(&meshes[0]))?;
        meshes.swap(0, 1);
        let stiffness = laplacian.stiffness();
        let numbers = fingerprint! {
            trace_S: stiffness.diag().iter().map(|(_, d)| d).sum::<f64>(),
            sum_M: laplacian.mass().lumped().iter().sum::<f64>(),
            nnz: stiffness.nnz(),
        };
        Ok(move || Ok(numbers))
    })
}

/// Mean curvature from the cotangent operator and the angle defect.
pub(crate) fn curvature(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let both = || mean_and_gaussian_curvature(&mesh, LumpedArea::Barycentric);
        let (mean, gaussian) = watch.phase("mean and gauss", both)?;
        Ok(move || {
            let m = lumped_mass(&mesh, LumpedArea::Barycentric)?;
            let defects: Vec<f64> = gaussian.values.iter().zip(&m).map(|(k, a)| k * a).collect();
            Ok(fingerprint! {
                sum_absH_area: mean.norms().iter().zip(&m).map(|(h, a)| h * a).sum::<f64>(),
                sum_K: defects.iter().sum::<f64>(),
                sum_absK: defects.iter().map(|k| k.abs()).sum::<f64>(),
            })
        })
    })
}

/// Principal curvatures and directions by the estimator of the job; by default
/// a quadric fitted over two rings, the method of libigl.
pub(crate) fn principal(job: &Job) -> Result<Work> {
    let estimator: Estimator = job.estimator.parse()?;
    let mesh = io::read(&job.input)?.mesh;
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let field = watch.phase("principal", || estimator.estimate(&mesh))?;
        Ok(move || {
            let mean = |k: &[f64]| k.iter().sum::<f64>() / k.len() as f64;
            Ok(fingerprint! { mean_k1: mean(&field.kappa1), mean_k2: mean(&field.kappa2) })
        })
    })
}

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
