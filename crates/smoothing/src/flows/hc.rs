//! HC smoothing: Laplacian steps that give back what they took from the shape.

use fairing_mesh::{Algorithm, OptionError, Parameter, ParameterError, TriMesh, Values};

use crate::engine::assemble::uniform;
use crate::engine::constraints::{BOUNDARY, Constraints, PIN, SOFT};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::outcome::Smoothed;
use crate::engine::run::{Frame, Run, StepNote};
use crate::engine::step::{ITERATIONS, Observer};
use crate::engine::unit_scale::{InMeshUnits, at_unit_scale};

/// Options of [`hc`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Hc {
    /// The weight of the input against the step before in the differences, in [0, 1]; 0 unless set.
    pub alpha: f64,
    /// How much of its own difference a vertex is given back, the rest being the mean of its neighbours', in
    /// [0, 1]; ½ unless set. Above ½ it converges.
    pub beta: f64,
    /// The number of steps; 10 unless set.
    pub iterations: usize,
    /// Vertices that may not move freely.
    pub constraints: Constraints,
}

/// The values of the paper.
impl Default for Hc {
    fn default() -> Self {
        Self { alpha: 0.0, beta: 0.5, iterations: 10, constraints: Constraints::default() }
    }
}

/// Smooths by Humphrey's Classes steps with uniform weights: a full Laplacian step, then back by a smoothed
/// difference.
///
/// ```text
/// p = q + L q,   b = p − (α o + (1 − α) q),   q' = p − (β b + (1 − β) A b)
/// ```
///
/// with the input o, the positions before q, and the mean over neighbours A. Fine detail goes, volume and size
/// change far less than under the Laplacian alone.
///
/// # Errors
///
/// [`FlowError`] for options out of range.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Hc, hc};
///
/// let smoothed = hc(&shapes::icosphere(3), &Hc::default(), None)?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - 1.0).abs() < 0.01);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[vollmer1999\].
pub fn hc(
    mesh: &TriMesh,
    options: &Hc,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    at_unit_scale(mesh, options, observer, flow)
}

impl Flow for Hc {
    const ALGORITHMS: &'static [Algorithm] = &[Algorithm::new(
        "hc",
        "uniform steps that give back what they took; keeps the size roughly",
        &["vollmer1999"],
        &[
            Parameter::number("alpha", "0", "How much differences are taken to the input (0 to 1)"),
            Parameter::number(
                "beta",
                "0.5",
                "How much of its own difference a vertex is given back (0 to 1)",
            ),
            ITERATIONS,
            BOUNDARY,
            PIN,
            SOFT,
        ],
    )];

    const RUN: FlowFn<Self> = hc;

    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let constraints = Constraints::from_values(values, positions)?;
        let mut options = Self { constraints, ..Self::default() };
        values.read("alpha", &mut options.alpha)?;
        values.read("beta", &mut options.beta)?;
        values.read(ITERATIONS.name, &mut options.iterations)?;
        Ok(options)
    }
}

impl InMeshUnits for Hc {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        Ok(Self { constraints: self.constraints.divided_by(unit)?, ..*self })
    }
}

fn flow(
    mesh: &TriMesh,
    options: &Hc,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let Hc { alpha, beta, .. } = *options;
    for (option, value) in [("alpha", alpha), ("beta", beta)] {
        OptionError::require_share(option, value)
            .map_err(|error| FlowFailure::from(error).before(mesh))?;
    }
    let frame = Frame::new(&options.constraints, options.iterations);
    let run = Run::new(mesh, &frame, observer)?;
    let laplacian = uniform(run.arrangement.mesh(), &run.freedom.fixed);
    let input = run.arrangement.mesh().positions().to_vec();
    let mut difference = vec![[0.0; 3]; input.len()];
    run.iterate(|_, mesh, freedom, next| {
        let q = mesh.positions();
        laplacian.sweep(q, &mut difference, |i, l, q, _| {
            let o = input[i];
            [0, 1, 2].map(|k| q[k] + l[k] - (alpha * o[k] + (1.0 - alpha) * q[k]))
        });
        laplacian.sweep(&difference, next, |i, l, b, _| {
            let (q, o) = (q[i], input[i]);
            let (w, target) = freedom.pull(i);
            // The mean of the neighbours' differences is b + L b.
            let d = [0, 1, 2].map(|k| {
                let p = b[k] + alpha * o[k] + (1.0 - alpha) * q[k];
                let back = b[k] + (1.0 - beta) * l[k];
                (p - back - q[k] + w * (target[k] - q[k])) / (1.0 + w)
            });
            let d = freedom.project(i, d);
            [q[0] + d[0], q[1] + d[1], q[2] + d[2]]
        });
        Ok(StepNote { step_size: 1.0, residual: None })
    })
}
