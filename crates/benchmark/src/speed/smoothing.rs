//! Flows, and one from file to file.

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};
use fairing_smoothing::{Diffusion, Explicit, Implicit, Method, Stability, Taubin};
use glam::DVec3;

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint, forgetful};

/// A flow over the mesh of the job.
pub(super) struct Flow {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) method: fn(&Job) -> Method,
}

/// `x ← x + λLx` with uniform weights.
pub(super) fn explicit_uniform(job: &Job) -> Method {
    Method::Explicit(Explicit {
        iterations: job.iterations,
        stability: Stability::Warn,
        ..Explicit::new(Diffusion::uniform(job.lambda))
    })
}

/// λ and μ in turn, as many pairs as iterations.
pub(super) fn taubin(job: &Job) -> Method {
    Method::Taubin(Taubin { pairs: job.iterations, ..Taubin::from_steps(job.lambda, job.mu) })
}

/// `(I − λL)x' = x` with uniform weights.
pub(super) fn implicit_uniform(job: &Job) -> Method {
    let options = Implicit::new(Diffusion::uniform(job.lambda));
    Method::Implicit(Implicit { iterations: job.iterations, ..options })
}

/// `(M + λh²S)x' = Mx` with the operator of the input.
pub(super) fn implicit_cotan(job: &Job) -> Method {
    let options = Implicit::new(Diffusion::cotangent(job.lambda));
    Method::Implicit(Implicit { iterations: job.iterations, ..options })
}

/// The same with the operator of the current mesh at each step.
pub(super) fn implicit_mcf(job: &Job) -> Method {
    let options = Implicit::mean_curvature_flow(job.lambda);
    Method::Implicit(Implicit { iterations: job.iterations, ..options })
}

impl Task for Flow {
    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        let (method, out) = ((self.method)(job), job.out.clone());
        Ok(Box::new(Flowing { mesh, method, out, result: None }))
    }
}

struct Flowing {
    mesh: TriMesh,
    method: Method,
    out: Option<PathBuf>,
    result: Option<TriMesh>,
}

impl Work for Flowing {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        self.result = Some(watch.phase("solve", || self.method.run(&mesh, None))?.mesh);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let result = self.result.as_ref().context("nothing was smoothed")?;
        if let Some(out) = &self.out {
            io::write(out, result)?;
        }
        Ok(displacement_fingerprint(&self.mesh, result))
    }
}

/// Reads an OBJ, takes implicit uniform steps, writes a binary PLY.
pub(super) struct EndToEnd;

impl Task for EndToEnd {
    fn name(&self) -> &'static str {
        "end_to_end"
    }

    fn about(&self) -> &'static str {
        "read an OBJ, implicit uniform steps, write a binary PLY"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let out = job.out.clone().context("where to? say --out FILE")?;
        Ok(Box::new(Travelling { input: job.input.clone(), out, method: implicit_uniform(job) }))
    }
}

struct Travelling {
    input: PathBuf,
    out: PathBuf,
    method: Method,
}

impl Work for Travelling {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        let mesh = watch.phase("load", || io::read(&self.input))?.mesh;
        let smoothed = watch.phase("solve", || self.method.run(&mesh, None))?.mesh;
        watch.phase("save", || io::write(&self.out, &smoothed))?;
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let (before, after) = (io::read(&self.input)?.mesh, io::read(&self.out)?.mesh);
        Ok(displacement_fingerprint(&before, &after))
    }
}

/// Root mean square and largest displacement, and the sum of squared coordinates.
fn displacement_fingerprint(before: &TriMesh, after: &TriMesh) -> Fingerprint {
    let squares: Vec<f64> = before
        .positions()
        .iter()
        .zip(after.positions())
        .map(|(&a, &b)| DVec3::from(b).distance_squared(a.into()))
        .collect();
    fingerprint! {
        rms_disp: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
        max_disp: squares.iter().copied().fold(0.0, f64::max).sqrt(),
        sum_sq: after.positions().iter().map(|&p| DVec3::from(p).length_squared()).sum::<f64>(),
    }
}
