//! Taubin's λ|μ smoothing.

use fairing_mesh::TriMesh;
use fairing_parameters::old::{Algorithm, Parameter, Values};
use fairing_parameters::{OptionError, ParameterError};

use crate::engine::assemble::uniform;
use crate::engine::constraints::{BOUNDARY, Constraints, PIN, SOFT};
use crate::engine::diffusion::LAMBDA;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::linear::advance;
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::run::{Run, RunSettings};
use crate::engine::stability::{Stability, UNSTABLE};
use crate::engine::step::{ITERATIONS, Observer};
use crate::flows::windowed_sinc::PASS_BAND;

/// Options of [`taubin`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Taubin {
    /// λ > 0, the shrinking step; dimensionless.
    pub lambda: f64,
    /// The pass band k > 0: modes of eigenvalue −k are kept exactly, smoother ones grow a little, rougher ones are
    /// attenuated. Dimensionless, in [0, 2].
    pub pass_band: f64,
    /// The number of pairs of steps; 10 unless set.
    pub pairs: usize,
    /// What happens where modes of the pass band would grow by more than two in all; refused unless set.
    pub stability: Stability,
    /// Vertices that may not move freely.
    pub constraints: Constraints,
}

/// The most by which a mode may grow over all pairs.
const MAX_GROWTH: f64 = 2.0;

impl Taubin {
    /// λ and the pass band; ten pairs.
    pub fn new(lambda: f64, pass_band: f64) -> Self {
        Self {
            lambda,
            pass_band,
            pairs: 10,
            stability: Stability::default(),
            constraints: Constraints::default(),
        }
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

/// λ = ½ and a pass band of 0.1, the values of the paper's examples.
impl Default for Taubin {
    fn default() -> Self {
        Self::new(0.5, 0.1)
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

impl Flow for Taubin {
    const ALGORITHMS: &'static [Algorithm] = &[Algorithm::new(
        "taubin",
        "a shrinking and a growing step in turn: removes noise, keeps the size of finely meshed shapes",
        &["taubin1995"],
        &[
            LAMBDA.about("The shrinking step").excludes(&[]).default("0.5"),
            Parameter::number("mu", "", "The growing step, below -lambda"),
            PASS_BAND.excludes(&["mu"]),
            ITERATIONS.about("The number of pairs of steps"),
            BOUNDARY,
            PIN,
            SOFT,
            UNSTABLE.about("What happens to pairs that amplify a mode by more than two"),
        ],
    )];

    const RUN: FlowFn<Self> = taubin;

    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let mut options = Self::default();
        values.read(LAMBDA.name, &mut options.lambda)?;
        values.read(PASS_BAND.name, &mut options.pass_band)?;
        if let Some(mu) = values.get("mu")? {
            options = Self::from_steps(options.lambda, mu);
        }
        options.constraints = Constraints::from_values(values, positions)?;
        values.read(ITERATIONS.name, &mut options.pairs)?;
        values.read(UNSTABLE.name, &mut options.stability)?;
        Ok(options)
    }
}

fn check(options: &Taubin) -> Result<(), FlowFailure> {
    let Taubin { lambda, pass_band, .. } = *options;
    OptionError::require_positive("lambda", lambda)?;
    let between = pass_band > 0.0 && pass_band < 1.0 / lambda;
    let expected = "above 0 and below 1/λ, so that μ < −λ";
    OptionError::require(between, "pass band", pass_band, expected)?;
    let roughest = (1.0 - 2.0 * lambda) * (1.0 - 2.0 * options.mu());
    let expected = "so small that the roughest mode does not grow: |(1 − 2λ)(1 − 2μ)| ≤ 1";
    Ok(OptionError::require(roughest.abs() <= 1.0, "lambda", lambda, expected)?)
}
