//! All flows behind one type, for programs.

use fairing_mesh::TriMesh;

use crate::engine::diffusion::{Diffusion, Time};
use crate::engine::error::FlowError;
use crate::engine::outcome::Smoothed;
use crate::engine::step::Observer;
use crate::flows::conformal::{ConformalizedMcf, conformalized_mean_curvature_flow};
use crate::flows::explicit::{Explicit, explicit};
use crate::flows::hc::{Hc, hc};
use crate::flows::implicit::{Implicit, implicit};
use crate::flows::low_pass::{LowPass, Transfer, low_pass};
use crate::flows::region::{FairRegion, fair_region};
use crate::flows::scale_dependent::{ScaleDependent, scale_dependent};
use crate::flows::taubin::{Taubin, taubin};
use crate::flows::windowed_sinc::{WindowedSinc, windowed_sinc};

/// A flow with its options.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::Method;
///
/// let sphere = shapes::icosphere(4);
/// for method in Method::defaults() {
///     let smoothed = method.run(&sphere, None)?;
///     println!("{}: {} steps", method.name(), smoothed.report.iterations);
/// }
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// [`explicit`].
    Explicit(Explicit),
    /// [`implicit`]; mean curvature flow if the operator is updated.
    Implicit(Implicit),
    /// [`conformalized_mean_curvature_flow`].
    ConformalizedMcf(ConformalizedMcf),
    /// [`taubin`].
    Taubin(Taubin),
    /// [`windowed_sinc`].
    WindowedSinc(WindowedSinc),
    /// [`hc`].
    Hc(Hc),
    /// [`scale_dependent`].
    ScaleDependent(ScaleDependent),
    /// [`low_pass`].
    LowPass(LowPass),
    /// [`fair_region`].
    FairRegion(FairRegion),
}

impl Method {
    /// Every method once, with options that suit most meshes.
    pub fn defaults() -> Vec<Self> {
        vec![
            Self::Explicit(Explicit::new(Diffusion::uniform(0.5))),
            Self::Implicit(Implicit::new(Diffusion::uniform(5.0))),
            Self::Implicit(Implicit::mean_curvature_flow(1.0)),
            Self::ConformalizedMcf(ConformalizedMcf::default()),
            Self::Taubin(Taubin::default()),
            Self::WindowedSinc(WindowedSinc::default()),
            Self::Hc(Hc::default()),
            Self::ScaleDependent(ScaleDependent::default()),
            Self::LowPass(LowPass::new(Transfer::Heat(Time::SquaredEdges(5.0)))),
            Self::FairRegion(FairRegion::new(Vec::new())),
        ]
    }

    /// The name in programs.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Explicit(_) => "explicit",
            Self::Implicit(options) if options.update == crate::Update::Both => "mean-curvature",
            Self::Implicit(_) => "implicit",
            Self::ConformalizedMcf(_) => "conformal",
            Self::Taubin(_) => "taubin",
            Self::WindowedSinc(_) => "windowed-sinc",
            Self::Hc(_) => "hc",
            Self::ScaleDependent(_) => "scale-dependent",
            Self::LowPass(_) => "low-pass",
            Self::FairRegion(_) => "region",
        }
    }

    /// When to take it, in a line.
    pub fn description(&self) -> &'static str {
        match self.name() {
            "explicit" => {
                "small steps x + λLx; the assignment's flow; stable up to λ = 4/3 (closed)"
            }
            "implicit" => "steps of any length (I − λL)x' = x; never unstable, always shrinks",
            "mean-curvature" => {
                "implicit steps, operator taken anew each time: motion by curvature"
            }
            "conformal" => "mean curvature flow that keeps angles; takes genus 0 to the sphere",
            "taubin" => "a shrinking and a growing step in turn: removes noise, keeps the size",
            "windowed-sinc" => "a sharper low-pass filter than taubin; keeps the size best",
            "hc" => "uniform steps that give back what they took; keeps the size roughly",
            "scale-dependent" => "uniform steps that respect edge lengths; for uneven meshes",
            "low-pass" => "heat or Butterworth filter of the cotangent spectrum, in physical units",
            "region" => "replaces some vertices by the fairest surface through their surroundings",
            _ => "",
        }
    }

    /// Runs it. An observer sees every step of those methods that take steps; filters and fairing do all at once
    /// and are not observed.
    ///
    /// # Errors
    ///
    /// As the function of the method.
    pub fn run(
        &self,
        mesh: &TriMesh,
        observer: Option<&mut Observer<'_>>,
    ) -> Result<Smoothed, FlowError> {
        match self {
            Self::Explicit(options) => explicit(mesh, options, observer),
            Self::Implicit(options) => implicit(mesh, options, observer),
            Self::ConformalizedMcf(options) => {
                conformalized_mean_curvature_flow(mesh, options, observer)
            }
            Self::Taubin(options) => taubin(mesh, options, observer),
            Self::WindowedSinc(options) => windowed_sinc(mesh, options),
            Self::Hc(options) => hc(mesh, options, observer),
            Self::ScaleDependent(options) => scale_dependent(mesh, options, observer),
            Self::LowPass(options) => low_pass(mesh, options),
            Self::FairRegion(options) => fair_region(mesh, options),
        }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Sums are formed in fixed units of rows: the number of threads cannot show.
    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        // More vertices than one unit of parallel work holds.
        let mesh = shapes::bumpy_sphere(5, 0.1, 7.0);
        assert!(mesh.vertex_count() > 2 * crate::engine::laplacian::ROWS);
        for method in Method::defaults() {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let method = match method.clone() {
                    // A few steps are enough to tell.
                    Method::ConformalizedMcf(options) => {
                        Method::ConformalizedMcf(ConformalizedMcf { iterations: 3, ..options })
                    }
                    other => other,
                };
                pool.install(|| method.run(&mesh, None).unwrap().mesh)
            };
            assert_eq!(run(1), run(3), "{}", method.name());
        }
    }

    #[test]
    fn every_method_has_a_name_and_a_description_of_its_own() {
        let methods = Method::defaults();
        for (i, a) in methods.iter().enumerate() {
            assert!(!a.description().is_empty(), "{}", a.name());
            assert!(methods[i + 1..].iter().all(|b| a.name() != b.name()), "{}", a.name());
        }
    }
}
