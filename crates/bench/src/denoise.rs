//! The denoiser without parameters.

use anyhow::Result;
use fairing_denoising::{AutomaticOptions, automatic};
use fairing_mesh::io;

use crate::task::{Job, Work, fingerprint, forgetful, work};

/// Denoising without parameters.
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
