//! The computation of each section of the report in a few lines, which the report shows.
//!
//! `cargo run --example report`

use anyhow::{Context as _, Result};
use fairing::denoising::Denoiser;
use fairing::evaluation::{NoiseKind, NoiseLevel, add_noise, normal_error};
use fairing::mesh::TriMesh;
use fairing::operators::curvature::{
    Estimator, gaussian_curvature, mean_and_gaussian_curvature, mean_curvature,
    scaled_umbrella_mean_curvature, umbrella_mean_curvature,
};
use fairing::operators::surface::{Ellipsoid, ParametricSurface as _};
use fairing::operators::{Laplacian, LumpedArea};
use fairing::shapes;
use fairing::smoothing::{Diffusion, Explicit, Implicit, Taubin, explicit, implicit, taubin};
use fairing::spectral::{SpectrumOptions, reconstruct, spectrum};

fn main() -> Result<()> {
    for (section, number) in run(&shapes::bumpy_sphere(3, 0.1, 3.0))? {
        println!("{section}: {number}");
    }
    Ok(())
}

/// A number of each section.
pub(crate) fn run(mesh: &TriMesh) -> Result<Vec<(&'static str, f64)>> {
    Ok(vec![
        ("q1", uniform(mesh)?),
        ("q2", ellipsoid()?),
        ("q3", cotangent(mesh)?),
        ("noise", noise(mesh)?),
        ("estimators", jets(mesh)?),
        ("q4", modes(mesh)?),
        ("q5", steps(mesh)?),
        ("q6", long_steps(mesh)?),
        ("flows", volume(mesh)?),
        ("q7", restored(mesh)?),
        ("denoisers", compared(mesh)?),
    ])
}

fn uniform(mesh: &TriMesh) -> Result<f64> {
    // [q1]
    let mean = umbrella_mean_curvature(mesh); // ‖Δx‖/2, a length
    let scaled = scaled_umbrella_mean_curvature(mesh); // 1/length, with sign
    let gaussian = gaussian_curvature(mesh, LumpedArea::Barycentric)?; // angle defect over area
    // [end]
    Ok(mean.norms()[0] + scaled.signed[0] + gaussian.values[0])
}

fn ellipsoid() -> Result<f64> {
    // [q2]
    let surface = Ellipsoid { a: 2.0, b: 1.0, c: 0.7 };
    let forms = surface.forms(0.0, std::f64::consts::FRAC_PI_2)?; // at (a, 0, 0)
    let along_y = forms.normal_curvature([1.0, 0.0]); // du runs along y: a/b²
    // [end]
    along_y.context("no direction")
}

fn cotangent(mesh: &TriMesh) -> Result<f64> {
    // [q3]
    let area = LumpedArea::Mixed; // Voronoi where no angle is obtuse
    let mean = mean_curvature(mesh, area)?;
    let (h, vector) = (&mean.signed, &mean.vectors); // H at each vertex, and Δx = −2Hn
    // [end]
    Ok(h[0] + vector[0][0])
}

fn noise(mesh: &TriMesh) -> Result<f64> {
    // [noise]
    let level = NoiseLevel::EdgeLengths(0.1); // σ in mean edge lengths
    let noisy = add_noise(mesh, NoiseKind::GaussianPerAxis, level, 2021)?;
    let (mean, gaussian) = mean_and_gaussian_curvature(&noisy, LumpedArea::Mixed)?;
    // [end]
    Ok(mean.signed[0] + gaussian.values[0])
}

fn jets(mesh: &TriMesh) -> Result<f64> {
    // [estimators]
    let field = Estimator::RECOMMENDED.estimate(mesh)?; // at a scale of its own
    let (mean, gaussian) = (&field.mean, &field.gaussian);
    let (first, second) = (&field.kappa1, &field.kappa2); // with directions: field.directions
    // [end]
    Ok(mean[0] + gaussian[0] + first[0] + second[0])
}

fn modes(mesh: &TriMesh) -> Result<f64> {
    // [q4]
    let laplacian = Laplacian::cotangent(mesh)?; // S and M
    let modes = spectrum(&laplacian, 50, &SpectrumOptions::default())?;
    let rebuilt = reconstruct(mesh, &modes, 15)?.mesh; // from the 15 smoothest
    // [end]
    Ok(normal_error(&rebuilt, mesh)?.mean)
}

fn steps(mesh: &TriMesh) -> Result<f64> {
    // [q5]
    let flow = Diffusion::uniform(0.05); // λ
    let options = Explicit { iterations: 50, ..Explicit::new(flow) };
    let smooth = explicit(mesh, &options, None)?.mesh; // an error where λ is unstable
    // [end]
    Ok(normal_error(&smooth, mesh)?.mean)
}

fn long_steps(mesh: &TriMesh) -> Result<f64> {
    // [q6]
    let flow = Diffusion::uniform(5.0); // every step is stable
    let options = Implicit { iterations: 10, ..Implicit::new(flow) };
    let smooth = implicit(mesh, &options, None)?.mesh;
    // [end]
    Ok(normal_error(&smooth, mesh)?.mean)
}

fn volume(mesh: &TriMesh) -> Result<f64> {
    // [flows]
    let options = Implicit::new(Diffusion::cotangent(1.0)); // squared mean edge lengths
    let shrunk = implicit(mesh, &options, None)?.mesh;
    let kept = taubin(mesh, &Taubin::default(), None)?.mesh; // keeps the volume
    // [end]
    Ok(normal_error(&shrunk, &kept)?.mean)
}

fn restored(mesh: &TriMesh) -> Result<f64> {
    let noisy = mesh;
    // [q7]
    let flow = Explicit { iterations: 10, ..Explicit::new(Diffusion::uniform(0.5)) };
    let smooth = explicit(noisy, &flow, None)?.mesh;
    let error = normal_error(&smooth, mesh)?.mean; // E_a in degrees
    // [end]
    Ok(error)
}

fn compared(mesh: &TriMesh) -> Result<f64> {
    let (noisy, truth) = (mesh, mesh);
    let mut least = f64::INFINITY;
    // [denoisers]
    for denoiser in Denoiser::all() {
        let restored = denoiser.denoise(noisy)?;
        least = least.min(normal_error(&restored, truth)?.mean); // E_a in degrees
    }
    // [end]
    Ok(least)
}
