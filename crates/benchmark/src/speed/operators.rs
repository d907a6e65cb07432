//! Assembling operators and estimating curvature.
//!
//! Each repetition starts from a mesh of its own, made under the phase
//! `prepare`: what a mesh remembers about its faces must be found again.

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};
use fairing_operators::curvature::{
    CurvatureField, Estimator, MeanCurvature, ScalarCurvature, mean_and_gaussian_curvature,
};
use fairing_operators::{LumpedArea, SparseMatrix, cotan_stiffness, lumped_mass};
use glam::DVec3;

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint, forgetful};

/// The cotangent stiffness and the lumped barycentric mass.
pub(super) struct Laplacian;

impl Task for Laplacian {
    fn name(&self) -> &'static str {
        "laplacian"
    }

    fn about(&self) -> &'static str {
        "cotangent stiffness and lumped barycentric mass"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        Ok(Box::new(Assembling { mesh: io::read(&job.input)?.mesh, result: None }))
    }
}

struct Assembling {
    mesh: TriMesh,
    result: Option<(SparseMatrix, Vec<f64>)>,
}

impl Work for Assembling {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        let assemble =
            || anyhow::Ok((cotan_stiffness(&mesh)?, lumped_mass(&mesh, LumpedArea::Barycentric)?));
        self.result = Some(watch.phase("assemble", assemble)?);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let (s, m) = self.result.as_ref().context("nothing was assembled")?;
        let x = self.mesh.positions();
        let energy: f64 = s
            .outer_iterator()
            .zip(x)
            .flat_map(|(row, p)| {
                row.iter().map(|(j, w)| w * DVec3::from(*p).dot(x[j].into())).collect::<Vec<_>>()
            })
            .sum();
        Ok(fingerprint! {
            trace_S: s.diag().iter().map(|(_, d)| d).sum::<f64>(),
            xSx: energy,
            sum_M: m.iter().sum::<f64>(),
            sum_M2: m.iter().map(|a| a * a).sum::<f64>(),
            nnz: s.nnz(),
        })
    }
}

/// The Laplacian at other positions of the same faces.
pub(super) struct Refill;

impl Task for Refill {
    fn name(&self) -> &'static str {
        "laplacian_again"
    }

    fn about(&self) -> &'static str {
        "the same at other positions of the same faces"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        let laplacian = fairing_operators::Laplacian::cotangent(&mesh)?;
        let stretched = mesh.positions().iter().map(|&[x, y, z]| [x, y, 1.25 * z]).collect();
        let stretched = mesh.with_positions(stretched)?;
        Ok(Box::new(Refilling { meshes: [stretched, mesh], laplacian }))
    }
}

struct Refilling {
    /// In turn, the one that comes next first.
    meshes: [TriMesh; 2],
    laplacian: fairing_operators::Laplacian,
}

impl Work for Refilling {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        watch.phase("refill", || self.laplacian.refill(&self.meshes[0]))?;
        self.meshes.swap(0, 1);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let stiffness = self.laplacian.stiffness();
        Ok(fingerprint! {
            trace_S: stiffness.diag().iter().map(|(_, d)| d).sum::<f64>(),
            sum_M: self.laplacian.mass().lumped().iter().sum::<f64>(),
            nnz: stiffness.nnz(),
        })
    }
}

/// Mean curvature from the cotangent operator and the angle defect.
pub(super) struct Curvature;

impl Task for Curvature {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn about(&self) -> &'static str {
        "‖S x‖ / 2M and the angle defect"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        Ok(Box::new(Bending { mesh, result: None }))
    }
}

struct Bending {
    mesh: TriMesh,
    result: Option<(MeanCurvature, ScalarCurvature)>,
}

impl Work for Bending {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        let both = || mean_and_gaussian_curvature(&mesh, LumpedArea::Barycentric);
        self.result = Some(watch.phase("mean and gauss", both)?);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let (mean, gaussian) = self.result.as_ref().context("nothing was estimated")?;
        let m = lumped_mass(&self.mesh, LumpedArea::Barycentric)?;
        let defects: Vec<f64> = gaussian.values.iter().zip(&m).map(|(k, a)| k * a).collect();
        Ok(fingerprint! {
            sum_absH_area: mean.norms().iter().zip(&m).map(|(h, a)| h * a).sum::<f64>(),
            sum_K: defects.iter().sum::<f64>(),
            sum_absK: defects.iter().map(|k| k.abs()).sum::<f64>(),
        })
    }
}

/// Principal curvatures and directions by the estimator of the job; by default
/// a quadric fitted over two rings, the method of libigl.
pub(super) struct Principal;

impl Task for Principal {
    fn name(&self) -> &'static str {
        "principal"
    }

    fn about(&self) -> &'static str {
        "principal curvatures and directions by --estimator"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let estimator = job.estimator.parse()?;
        Ok(Box::new(Fitting { mesh: io::read(&job.input)?.mesh, estimator, field: None }))
    }
}

struct Fitting {
    mesh: TriMesh,
    estimator: Estimator,
    field: Option<CurvatureField>,
}

impl Work for Fitting {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.field = None;
        let mesh = forgetful(&self.mesh, watch)?;
        self.field = Some(watch.phase("principal", || self.estimator.estimate(&mesh))?);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let field = self.field.as_ref().context("nothing was fitted")?;
        let mean = |k: &[f64]| k.iter().sum::<f64>() / k.len() as f64;
        Ok(fingerprint! { mean_k1: mean(&field.kappa1), mean_k2: mean(&field.kappa2) })
    }
}
