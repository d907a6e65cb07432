//! Methods that remove noise, and the distance of their results from the truth, for question 7 and
//! the comparison of denoisers.

use std::fmt;

use anyhow::{Context as _, Result};
use fairing_denoising::Denoiser;
use fairing_evaluation::{
    NoiseKind, NoiseLevel, SurfaceTree, add_noise, drift, flipped_faces, normal_error,
};
use fairing_mesh::TriMesh;
use fairing_smoothing::{Diffusion, Explicit, Implicit, Taubin, explicit, implicit, taubin};
use fairing_spectral::{EigenOptions, Spectrum, graph_spectrum, reconstruct};
use rayon::prelude::*;

use super::gap;

/// A method, with the same parameters at every level of noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Method {
    /// The noisy mesh as it is, for comparison.
    Nothing,
    /// Uniform weights, λ = ½, ten steps.
    Explicit,
    /// Uniform weights, λ = 5, one step: the same diffusion time.
    Implicit,
    /// Uniform weights, λ = 0.05, fifty steps: the best of the original report.
    ReportExplicit,
    /// Uniform weights, λ = 5, ten steps: likewise.
    ReportImplicit,
    /// λ = ½, a pass band of 0.1, ten pairs.
    Taubin,
    /// Projection onto the smoothest modes of the edge graph.
    Spectral,
    /// A denoiser with its defaults.
    Denoiser(Denoiser),
}

impl Method {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nothing => "noisy input",
            Self::Explicit => "explicit",
            Self::Implicit => "implicit",
            Self::ReportExplicit => "explicit, 0.05 × 50",
            Self::ReportImplicit => "implicit, 5 × 10",
            Self::Taubin => "Taubin",
            Self::Spectral => "spectral",
            Self::Denoiser(denoiser) => denoiser.name(),
        }
    }

    /// The flows: two that cover the same diffusion time, as chosen here, and two as the original
    /// report recommends.
    pub(super) const FLOWS: [Self; 4] =
        [Self::Explicit, Self::Implicit, Self::ReportExplicit, Self::ReportImplicit];

    /// Returns true for the denoiser whose networks are trained on generated bodies.
    pub(super) fn is_trained(self) -> bool {
        matches!(self, Self::Denoiser(Denoiser::Automatic(_)))
    }

    /// Returns true for a flow or filter that ignores creases.
    pub(super) fn is_linear(self) -> bool {
        Self::FLOWS.contains(&self) || matches!(self, Self::Taubin | Self::Spectral)
    }
}

/// Steps of a flow with uniform weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    /// The length of each.
    pub(super) lambda: f64,
    /// The number of modes.
    pub(super) count: usize,
}

impl fmt::Display for Steps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.count == 1 { "" } else { "s" };
        write!(f, "λ = {}, {} step{plural}", self.lambda, self.count)
    }
}

/// Steps of [`Method::Explicit`].
pub(super) const EXPLICIT: Steps = Steps { lambda: 0.5, count: 10 };

/// Steps of [`Method::Implicit`], with the same diffusion time.
pub(super) const IMPLICIT: Steps = Steps { lambda: 5.0, count: 1 };

/// Steps of [`Method::ReportExplicit`], the best of the original report.
pub(super) const REPORT_EXPLICIT: Steps = Steps { lambda: 0.05, count: 50 };

/// Steps of [`Method::ReportImplicit`], likewise.
pub(super) const REPORT_IMPLICIT: Steps = Steps { lambda: 5.0, count: 10 };

/// The spectral method keeps one mode in this many, and more up to the next gap between
/// eigenvalues.
pub(super) const MODES: usize = 20;

/// A mesh without noise, with the data that methods and scores need.
pub(super) struct Body {
    pub(super) name: &'static str,
    pub(super) truth: TriMesh,
    surface: SurfaceTree,
    /// Modes of the edge graph, which noise does not change.
    modes: Option<Modes>,
    /// True if the networks of the automatic denoiser were trained on bodies of this kind.
    pub(super) is_trained_on: bool,
}

/// The modes that the spectral method keeps.
struct Modes {
    /// One more than are kept, to show the gap.
    spectrum: Spectrum,
    kept: Kept,
}

/// Number of modes kept by the spectral method.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    /// One in [`MODES`], rounded down.
    pub(super) wanted: usize,
    /// The number kept.
    pub(super) modes: usize,
    /// The gap after them, over the eigenvalue that follows it.
    pub(super) gap: f64,
}

impl Body {
    pub(super) fn new(name: &'static str, truth: TriMesh) -> Result<Self> {
        let surface = SurfaceTree::new(&truth)?;
        Ok(Self { name, truth, surface, modes: None, is_trained_on: false })
    }

    /// The same model, of a kind that the networks of the automatic denoiser were trained on.
    pub(super) fn trained_on(self) -> Self {
        Self { is_trained_on: true, ..self }
    }

    /// The same model, ready for [`Method::Spectral`].
    pub(super) fn with_modes(mut self) -> Result<Self> {
        let n = self.truth.vertex_count();
        let wanted = (n / MODES).max(4);
        let options = EigenOptions::default();
        let spectrum = gap::modes(n, wanted, |k| {
            graph_spectrum(&self.truth, k, fairing_operators::MassKind::Degree, &options)
        })?;
        let modes = gap::next(&spectrum, wanted).context("modes without a gap")?;
        let kept = Kept { wanted, modes, gap: gap::behind(&spectrum, modes) };
        self.modes = Some(Modes { spectrum, kept });
        Ok(self)
    }

    /// Number of modes kept by [`Method::Spectral`]; `None` if the model has none.
    pub(super) fn kept_modes(&self) -> Option<Kept> {
        self.modes.as_ref().map(|m| m.kept)
    }

    /// The noisy mesh after the method.
    pub(super) fn restore(&self, method: Method, noisy: &TriMesh) -> Result<TriMesh> {
        Ok(match method {
            Method::Nothing => noisy.clone(),
            Method::Explicit => explicit_steps(noisy, EXPLICIT)?,
            Method::Implicit => implicit_steps(noisy, IMPLICIT)?,
            Method::ReportExplicit => explicit_steps(noisy, REPORT_EXPLICIT)?,
            Method::ReportImplicit => implicit_steps(noisy, REPORT_IMPLICIT)?,
            Method::Taubin => taubin(noisy, &Taubin::default(), None)?.mesh,
            Method::Spectral => {
                let modes = self.modes.as_ref().context("this model has no modes")?;
                reconstruct(noisy, &modes.spectrum, modes.kept.modes)?.mesh
            }
            Method::Denoiser(denoiser) => denoiser.denoise(noisy)?,
        })
    }

    /// Scores a mesh against the truth.
    pub(super) fn score(&self, mesh: &TriMesh) -> Result<Score> {
        let distances = self.surface.distances(mesh.positions());
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        Ok(Score {
            angle: normal_error(mesh, &self.truth)?.mean,
            distance: mean / self.truth.mean_edge_length(),
            flipped: flipped_faces(mesh, &self.truth)? as f64,
            volume: drift(mesh, &self.truth).volume.map(|v| 100.0 * v),
        })
    }

    /// The model under Gaussian noise along each axis.
    pub(super) fn noisy(&self, level: NoiseLevel, seed: u64) -> Result<TriMesh> {
        Ok(add_noise(&self.truth, NoiseKind::GaussianPerAxis, level, seed)?)
    }

    /// Each method on as many seeds as it is given, from `first` on; the result of the first seed
    /// is kept.
    pub(super) fn trials(
        &self,
        level: NoiseLevel,
        first: u64,
        methods: &[(Method, usize)],
    ) -> Result<Vec<Trials>> {
        let most = methods.iter().map(|m| m.1).max().unwrap_or(0);
        let noisy: Vec<TriMesh> = (0..most as u64)
            .into_par_iter()
            .map(|k| self.noisy(level, first.wrapping_add(k)))
            .collect::<Result<_>>()?;
        let pairs: Vec<(Method, usize)> = methods
            .iter()
            .flat_map(|&(method, seeds)| (0..seeds).map(move |k| (method, k)))
            .collect();
        let scored: Vec<(Score, Option<TriMesh>)> = pairs
            .into_par_iter()
            .with_max_len(1)
            .map(|(method, k)| {
                let mesh = self.restore(method, &noisy[k])?;
                Ok((self.score(&mesh)?, (k == 0).then_some(mesh)))
            })
            .collect::<Result<_>>()?;
        let mut rest = scored.into_iter();
        let of =
            |&(method, seeds): &(Method, usize)| Trials::new(method, rest.by_ref().take(seeds));
        methods.iter().map(of).collect()
    }
}

fn explicit_steps(mesh: &TriMesh, steps: Steps) -> Result<TriMesh> {
    let Steps { lambda, count: iterations } = steps;
    let options = Explicit { iterations, ..Explicit::new(Diffusion::uniform(lambda)) };
    Ok(explicit(mesh, &options, None)?.mesh)
}

fn implicit_steps(mesh: &TriMesh, steps: Steps) -> Result<TriMesh> {
    let Steps { lambda, count: iterations } = steps;
    let options = Implicit { iterations, ..Implicit::new(Diffusion::uniform(lambda)) };
    Ok(implicit(mesh, &options, None)?.mesh)
}

/// Distances of a mesh from the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Score {
    /// The normal error: the mean angle between matching normals, in degrees.
    pub(super) angle: f64,
    /// The vertex error: the mean distance of the vertices from the true surface, in h.
    pub(super) distance: f64,
    /// Faces that oppose the truth.
    pub(super) flipped: f64,
    /// The change of volume in percent; `None` if open.
    pub(super) volume: Option<f64>,
}

/// The scores of one method over seeds.
#[derive(Debug, Clone)]
pub(super) struct Trials {
    pub(super) method: Method,
    pub(super) seeds: usize,
    pub(super) angle: Spread,
    pub(super) distance: Spread,
    pub(super) flipped: Spread,
    pub(super) volume: Option<Spread>,
    /// The result of the first seed.
    pub(super) first: TriMesh,
}

impl Trials {
    fn new(method: Method, scored: impl Iterator<Item = (Score, Option<TriMesh>)>) -> Result<Self> {
        let (scores, meshes): (Vec<Score>, Vec<Option<TriMesh>>) = scored.unzip();
        let of = |f: fn(&Score) -> f64| Spread::new(scores.iter().map(f));
        let volumes: Option<Vec<f64>> = scores.iter().map(|s| s.volume).collect();
        Ok(Self {
            method,
            seeds: scores.len(),
            angle: of(|s| s.angle),
            distance: of(|s| s.distance),
            flipped: of(|s| s.flipped),
            volume: volumes.map(|v| Spread::new(v.into_iter())),
            first: meshes.into_iter().flatten().next().context("no seeds")?,
        })
    }
}

/// Mean and standard deviation over seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) mean: f64,
    /// From n − 1 degrees of freedom; `None` for a single value.
    pub(super) deviation: Option<f64>,
}

impl Spread {
    /// The standard error of the mean; `None` for a single value.
    pub(super) fn error(&self, seeds: usize) -> Option<f64> {
        Some(self.deviation? / (seeds as f64).sqrt())
    }

    fn new(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
        Self { mean, deviation: (count > 1.0).then(|| (squares / (count - 1.0)).sqrt()) }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// The names of two flows contain the steps that they take.
    #[test]
    fn names_say_the_steps() {
        for (method, kind, steps) in [
            (Method::ReportExplicit, "explicit", REPORT_EXPLICIT),
            (Method::ReportImplicit, "implicit", REPORT_IMPLICIT),
        ] {
            assert_eq!(method.name(), format!("{kind}, {} × {}", steps.lambda, steps.count));
        }
    }

    #[test]
    fn spread_of_three_numbers() {
        let spread = Spread::new([1.0, 2.0, 6.0].into_iter());
        assert_eq!(spread, Spread { mean: 3.0, deviation: Some(7f64.sqrt()) });
        assert_eq!(Spread::new([4.0].into_iter()).deviation, None);
    }

    /// The eigenvalues of a symmetric mesh come in clusters; none is cut.
    #[test]
    fn modes_end_at_a_gap() {
        for mesh in [shapes::icosphere(3), shapes::torus(1.0, 0.4, 48, 20), shapes::cad_block(0.3)]
        {
            let kept = Body::new("symmetric", mesh).unwrap().with_modes().unwrap().kept_modes();
            let kept = kept.unwrap();
            assert!(kept.modes >= kept.wanted && kept.gap >= 1e-4, "{kept:?}");
        }
    }

    /// Scores stay with their methods, and doing nothing leaves the noise:
    /// along three axes, so the vertex error is that of its component along the normal,
    /// √(2/π) σ, less a little where faces come closer than vertices.
    #[test]
    fn trials_keep_their_order() {
        let body = Body::new("sphere", shapes::icosphere(4)).unwrap().with_modes().unwrap();
        let methods = [(Method::Nothing, 3), (Method::Spectral, 1), (Method::Implicit, 2)];
        let trials = body.trials(NoiseLevel::EdgeLengths(0.1), 1, &methods).unwrap();
        for (trial, (method, seeds)) in trials.iter().zip(methods) {
            assert_eq!((trial.method, trial.seeds), (method, seeds));
        }
        let expected = 0.1 * (2.0 / std::f64::consts::PI).sqrt();
        assert!((trials[0].distance.mean / expected - 1.0).abs() < 0.1, "{:?}", trials[0]);
        assert!(trials[1].angle.mean < 0.5 * trials[0].angle.mean);
    }
}
