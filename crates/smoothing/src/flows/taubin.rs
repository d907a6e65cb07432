//! Taubin's λ|μ smoothing.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_parameters::{Kind, Options, Parameter, ParameterError, Range};

use crate::engine::assemble::uniform;
use crate::engine::constraints::Constraints;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::run::{Observer, Run, RunSettings};
use crate::engine::series::{at_once, explicit_steps};
use crate::flows::explicit::Stability;

const MU: &str = "mu";

fairing_parameters::options! {
    /// Options of [`taubin`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct Taubin {
        /// The shrinking step λ.
        pub lambda: f64 = 0.5, in Range::POSITIVE;
        /// The pass band: modes with a smaller −eigenvalue are preserved (0 to 2).
        pub pass_band: f64 = 0.1, in Range::POSITIVE, excludes ["mu"];
        /// The number of pairs of steps.
        pub pairs: usize = 10, name "iterations";
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
        /// The treatment of pairs that amplify a mode by more than two.
        pub stability: Stability = Stability::Refuse, name "unstable";
    }
    "taubin": "alternating shrinking and growing steps: removes noise, preserves the size of finely meshed shapes",
        ["taubin1995"];
    also [Parameter::new(MU, Kind::Number, "The growing step μ, below −λ")];
    then |options, values| {
        if let Some(mu) = values.number(MU) {
            options.pass_band = Self::from_steps(options.lambda, mu).pass_band;
        }
        Ok(())
    };
}

/// The largest growth of a mode over all pairs.
const MAX_GROWTH: f64 = 2.0;

impl Taubin {
    /// Ten pairs with the given λ and pass band.
    pub fn new(lambda: f64, pass_band: f64) -> Self {
        Self { lambda, pass_band, ..Self::DEFAULT }
    }

    /// Ten pairs of the steps λ > 0 and μ < −λ, with the pass band `1/λ + 1/μ`.
    pub fn from_steps(lambda: f64, mu: f64) -> Self {
        Self::new(lambda, 1.0 / lambda + 1.0 / mu)
    }

    /// The growing step μ < 0, with `1/μ = k − 1/λ` for the pass band k.
    pub fn mu(&self) -> f64 {
        1.0 / (self.pass_band - 1.0 / self.lambda)
    }
}

/// Smooths by pairs of steps `x ← (I + μL)(I + λL) x` with uniform weights, λ > 0 > −λ > μ.
///
/// Each pair multiplies the mode of eigenvalue −k by `(1 − λk)(1 − μk)`: 1 at k = 0 and at the pass
/// band `k = 1/λ + 1/μ`, above 1 between them, below 1 beyond. There is no shrinkage to first
/// order, but low frequencies are amplified: the largest factor, half-way to the pass band k, is
/// `1 + (λk)²/(4 (1 − λk))`, 1.0007 for the default, which is visible after hundreds of pairs, but
/// 5.5 for λ = ½ and a pass band of 1.9.
///
/// Shapes whose features are many edges across, such as scans, consist of modes of the pass band
/// and keep their size. A panel, corner or tube a few edges across consists of rougher modes and
/// shrinks like noise, and so do free boundaries: a model of 50 open parts in large triangles, with
/// half of its vertices on boundaries, lost a third of its area, and an eighth with pinned
/// boundaries. Subdivide such models first.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range, including steps with `|(1 − λk)(1 − μk)| > 1` at k =
/// 2; [`FlowFailure::Amplified`] if all pairs together would amplify a mode by more than two,
/// unless [`Taubin::stability`] allows it.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Taubin, taubin};
///
/// let options = Taubin { pairs: 50, ..Taubin::from_steps(0.5, -0.53) };
/// let smoothed = taubin(&shapes::icosphere(3), &options, None)?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - 1.0).abs() < 0.03);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [taubin1995].
///
/// [taubin1995]: https://doi.org/10.1145/218380.218473
#[doc(alias = "filter_taubin")]
pub fn taubin(
    mesh: &TriMesh,
    options: &Taubin,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    check(options).map_err(|failure| failure.before(mesh))?;
    let (lambda, mu) = (options.lambda, options.mu());
    let settings = RunSettings::new(&options.constraints, 2 * options.pairs);
    let mut run = Run::new(mesh, &settings, observer)?;
    let of = Response::Pairs { shrink: lambda, grow: mu, pairs: options.pairs };
    if of.ln_largest(2.0) > libm::log(MAX_GROWTH) {
        run.report.unstable = true;
        if options.stability == Stability::Refuse {
            let one = Response::Pairs { shrink: lambda, grow: mu, pairs: 1 };
            let gain = libm::exp(one.ln_largest(2.0));
            return Err(run.refuse(FlowFailure::Amplified { gain, pairs: options.pairs }));
        }
    }
    let laplacian = uniform(run.arrangement.mesh(), &run.freedom.fixed);
    // 2 is the spectral bound for uniform weights.
    match at_once(run, &laplacian, of, None, || 2.0) {
        ControlFlow::Break(smoothed) => smoothed,
        ControlFlow::Continue(run) => explicit_steps(run, &laplacian, &[lambda, mu]),
    }
}

fn check(options: &Taubin) -> Result<(), FlowFailure> {
    let Taubin { lambda, pass_band, .. } = *options;
    options.check()?;
    let expected = "above 0 and below 1/λ, so that μ < −λ";
    ParameterError::require(pass_band < 1.0 / lambda, "pass-band", pass_band, expected)?;
    let roughest = (1.0 - 2.0 * lambda) * (1.0 - 2.0 * options.mu());
    let expected = "so small that the roughest mode does not grow: |(1 − 2λ)(1 − 2μ)| ≤ 1";
    Ok(ParameterError::require(roughest.abs() <= 1.0, "lambda", lambda, expected)?)
}
