//! The denoiser without parameters.

use anyhow::{Context as _, Result};
use fairing_denoising::{Automatic, AutomaticOptions, automatic};
use fairing_mesh::{TriMesh, io};

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint, forgetful};

/// Denoising without parameters.
pub(super) struct Denoise;

impl Task for Denoise {
    fn name(&self) -> &'static str {
        "denoise"
    }

    fn about(&self) -> &'static str {
        "the denoiser without parameters"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        Ok(Box::new(Denoising { mesh: io::read(&job.input)?.mesh, result: None }))
    }
}

struct Denoising {
    mesh: TriMesh,
    result: Option<Automatic>,
}

impl Work for Denoising {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        let denoise = || automatic(&mesh, &AutomaticOptions::default());
        self.result = Some(watch.phase("solve", denoise)?);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let result = self.result.as_ref().context("nothing was denoised")?;
        let positions = result.mesh.positions().as_flattened();
        Ok(fingerprint! { sum_squares: positions.iter().map(|x| x * x).sum::<f64>() })
    }
}
