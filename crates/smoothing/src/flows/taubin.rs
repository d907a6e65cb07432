//! Taubin's λ|μ smoothing.

use fairing_mesh::TriMesh;
use fairing_parameters::{Kind, OptionError, Options, Parameter, Range};

use crate::engine::assemble::uniform;
use crate::engine::constraints::Constraints;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::linear::advance;
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::run::{Run, RunSettings};
use crate::engine::stability::Stability;
use crate::engine::step::Observer;

const MU: &str = "mu";

fairing_parameters::options! {
    /// Options of [`taubin`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct Taubin {
        /// The shrinking step.
        pub lambda: f64 = 0.5, in Range::POSITIVE;
        /// Modes with −eigenvalue below this are kept (0 to 2).
        pub pass_band: f64 = 0.1, in Range::POSITIVE, excludes ["mu"];
        /// The number of pairs of steps.
        pub pairs: usize = 10, name "iterations";
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
        /// The treatment of pairs that amplify a mode by more than two.
        pub stability: Stability = Stability::Refuse, name "unstable";
    }
    "taubin": "a shrinking and a growing step in turn: removes noise, keeps the size of finely meshed shapes",
        ["taubin1995"];
    also [Parameter::new(MU, Kind::Number, "The growing step, below -lambda")];
    then |options, values| {
        if let Some(mu) = values.number(MU) {
            options.pass_band = Self::from_steps(options.lambda, mu).pass_band;
        }
        Ok(())
    };
}

/// The most by which a mode may grow over all pairs.
const MAX_GROWTH: f64 = 2.0;

impl Taubin {
    /// λ and the pass band; ten pairs.
    pub fn new(lambda: f64, pass_band: f64) -> Self {
        Self { lambda, pass_band, ..Self::DEFAULT }
    }

    /// From both steps, λ > 0 and μ < −λ: the pass band is `1/λ + 1/μ`.
    pub fn from_steps(lambda: f64, mu: f64) -> Self {
        Self::new(lambda, 1.0 / lambda + 1.0 / mu)
    }

    /// μ < 0, the growing step: `1/μ = k − 1/λ`.
    pub fn mu(&self) -> f64 {
        1.0 / (self.pass_band - 1.0 / self.lambda)
    }
}

/// Smooths by pairs of steps `x ← (I + μL)(I + λL) x` with uniform weights, λ > 0 > −λ > μ.
///
/// The mode of eigenvalue −k is multiplied by `(1 − λk)(1 − μk)` in each pair: 1 for k = 0 and for the pass band
/// `k = 1/λ + 1/μ`, above 1 between them, below 1 beyond: no shrinkage to first order, but low frequencies are
/// amplified. The largest factor, half-way to the pass band, is `1 + (λk)²/(4 (1 − λk))`: 1.0007 for the default, which
/// shows after hundreds of pairs, but 5.5 for λ = ½ and a pass band of 1.9.
///
/// The size is kept of shapes that are modes of the pass band: those many edges across, as scans are. A panel, a corner
/// or a tube a few edges across is made of the rougher modes and shrinks like noise, and so do free boundaries: a model
/// of 50 open parts in large triangles, half of its vertices on their boundaries, lost a third of its area, and an
/// eighth with its boundaries pinned. Such models are subdivided first, or left as they are.
///
/// # Errors
///
/// [`FlowError`] for options out of range: stable is what keeps `|(1 − λk)(1 − μk)| ≤ 1` at k = 2; and
/// [`FlowFailure::Amplified`] where all pairs together would amplify a mode by more than two, unless
/// [`Taubin::stability`] allows it.
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
/// Source: \[taubin1995\].
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
    // The spectrum of uniform weights reaches to 2.
    advance(run, &laplacian, 2.0, of, 0.0)
}

fn check(options: &Taubin) -> Result<(), FlowFailure> {
    let Taubin { lambda, pass_band, .. } = *options;
    options.check()?;
    let expected = "above 0 and below 1/λ, so that μ < −λ";
    OptionError::require(pass_band < 1.0 / lambda, "pass-band", pass_band, expected)?;
    let roughest = (1.0 - 2.0 * lambda) * (1.0 - 2.0 * options.mu());
    let expected = "so small that the roughest mode does not grow: |(1 − 2λ)(1 − 2μ)| ≤ 1";
    Ok(OptionError::require(roughest.abs() <= 1.0, "lambda", lambda, expected)?)
}
