//! Flows, one of them from file to file, and the automatic denoiser.

use anyhow::{Context as _, Result};
use fairing_denoising::{AutomaticOptions, automatic};
use fairing_mesh::{TriMesh, io};
use fairing_smoothing::{Diffusion, Explicit, Implicit, Method, Stability, Taubin};
use fairing_sparse::larger;
use glam::DVec3;

use crate::task::{Fingerprint, Job, Work, fingerprint, forgetful, work};

/// `x ← x + λLx` with uniform weights.
pub(crate) fn explicit_uniform(job: &Job) -> Result<Work> {
    let options = Explicit::new(Diffusion::uniform(job.lambda));
    let (iterations, stability) = (job.iterations, Stability::Warn);
    flow(job, Method::Explicit(Explicit { iterations, stability, ..options }))
}

/// λ and μ in turn, as many pairs as iterations.
pub(crate) fn taubin(job: &Job) -> Result<Work> {
    let options = Taubin { pairs: job.iterations, ..Taubin::from_steps(job.lambda, job.mu) };
    flow(job, Method::Taubin(options))
}

/// `(I − λL)x' = x` with uniform weights.
pub(crate) fn implicit_uniform(job: &Job) -> Result<Work> {
    flow(job, implicit(job, Implicit::new(Diffusion::uniform(job.lambda))))
}

/// `(M + λh²S)x' = Mx` with the operator of the input.
pub(crate) fn implicit_cotan(job: &Job) -> Result<Work> {
    flow(job, implicit(job, Implicit::new(Diffusion::cotangent(job.lambda))))
}

/// The same with the operator of the current mesh at each step.
pub(crate) fn implicit_mcf(job: &Job) -> Result<Work> {
    flow(job, implicit(job, Implicit::mean_curvature_flow(job.lambda)))
}

fn implicit(job: &Job, options: Implicit) -> Method {
    Method::Implicit(Implicit { iterations: job.iterations, ..options })
}

/// A flow over the mesh of the job.
fn flow(job: &Job, method: Method) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    let out = job.out.clone();
    work(move |watch| {
        let before = forgetful(&mesh, watch)?;
        let after = watch.phase("solve", || method.run(&before, None))?.mesh;
        let out = out.clone();
        Ok(move || {
            if let Some(out) = out {
                io::write(out, &after)?;
            }
            Ok(displacement_fingerprint(&before, &after))
        })
    })
}

/// Reads an OBJ, takes implicit uniform steps, writes a binary PLY.
pub(crate) fn end_to_end(job: &Job) -> Result<Work> {
    let out = job.out.clone().context("missing output file: --out FILE")?;
    let input = job.input.clone();
    let method = implicit(job, Implicit::new(Diffusion::uniform(job.lambda)));
    work(move |watch| {
        let mesh = watch.phase("load", || io::read(&input))?.mesh;
        let smoothed = watch.phase("solve", || method.run(&mesh, None))?.mesh;
        watch.phase("save", || io::write(&out, &smoothed))?;
        let (input, out) = (input.clone(), out.clone());
        Ok(move || Ok(displacement_fingerprint(&io::read(&input)?.mesh, &io::read(&out)?.mesh)))
    })
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
        max_disp: squares.iter().copied().fold(0.0, larger).sqrt(),
        sum_sq: after.positions().iter().map(|&p| DVec3::from(p).length_squared()).sum::<f64>(),
    }
}

/// Automatic denoising.
pub(crate) fn denoise(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let result = watch.phase("solve", || automatic(&mesh, &AutomaticOptions::default()))?;
        Ok(move || {
            let positions = result.mesh.positions().as_flattened();
            Ok(fingerprint! { sum_squares: positions.iter().map(|x| x * x).sum::<f64>() })
        })
    })
}
