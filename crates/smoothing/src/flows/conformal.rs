//! Conformalised mean curvature flow.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_parameters::old::{Algorithm, Parameter, Values};
use fairing_parameters::{OptionError, ParameterError};

use crate::engine::constraints::Constraints;
use crate::engine::diffusion::{Diffusion, OPERATOR, TIME, Time, operator_from_values};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::outcome::Smoothed;
use crate::engine::run::{Run, RunSettings};
use crate::engine::step::{ITERATIONS, Observer, Step, TOLERANCE};
use crate::engine::updated::{Update, advance_updated};

/// Options of [`conformalized_mean_curvature_flow`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ConformalizedMcf {
    /// The time of one step as a fraction of the area of the mesh, which is kept: dimensionless. 0.01 unless set.
    pub time: f64,
    /// The largest number of steps; 100 unless set.
    pub iterations: usize,
    /// Ends the flow when no vertex moves by more than this fraction of the square root of the area; 0 never does.
    pub settled: f64,
    /// The relative residual of the linear systems; 1e-10 unless set.
    pub tolerance: f64,
    /// The Laplacian of cotangents; [`LaplacianKind::Auto`] unless set.
    pub kind: LaplacianKind,
}

impl Default for ConformalizedMcf {
    fn default() -> Self {
        Self {
            time: 0.01,
            iterations: 100,
            settled: 1e-6,
            tolerance: 1e-10,
            kind: LaplacianKind::Auto,
        }
    }
}

/// Flows a closed mesh towards a conformal image: mean curvature flow with the stiffness of the input and the mass
/// of the current mesh.
///
/// ```text
/// (M(xₙ) + t S(x₀)) xₙ₊₁ = M(xₙ) xₙ,  then scaled about the centroid to the area of the input
/// ```
///
/// Keeping the stiffness keeps the conformal structure, and removes the singularities by which mean curvature
/// flow pinches necks: genus-0 meshes flow to a round sphere. Barycentric areas; a face that collapses keeps a
/// zero area and gives no mass.
///
/// # Errors
///
/// [`FlowError`] for meshes that are not closed and of one component, options out of range, faces too thin for
/// cotangents in the input, and vertices whose area vanishes.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{ConformalizedMcf, conformalized_mean_curvature_flow};
///
/// let bumpy = shapes::bumpy_sphere(3, 0.2, 3.0);
/// let round = conformalized_mean_curvature_flow(&bumpy, &ConformalizedMcf::default(), None)?;
/// assert!(round.report.iterations > 1);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[kazhdan2012\].
pub fn conformalized_mean_curvature_flow(
    mesh: &TriMesh,
    options: &ConformalizedMcf,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let refuse = |failure: FlowFailure| failure.before(mesh);
    check(options).map_err(refuse)?;
    let topology = mesh.topology();
    if !topology.is_closed() || topology.components().count() != 1 {
        let reason = "the area can only be kept on a closed mesh of one component";
        return Err(refuse(FlowFailure::Unsupported { reason }));
    }
    let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
    let step = options.time * area;
    let (kind, areas) = (options.kind, LumpedArea::Barycentric);
    let diffusion = Diffusion::Cotangent { time: Time::SquaredUnits(step), kind, area: areas };
    let (diffusion, too_thin) = diffusion.chosen(mesh).map_err(refuse)?;
    let threshold = options.settled * area.sqrt();
    let mut observer = observer;
    let mut watch = |step: &Step<'_>| {
        if let Some(observe) = &mut observer
            && observe(step).is_break()
        {
            return ControlFlow::Break(());
        }
        match step.largest_displacement() <= threshold {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let free = Constraints::default();
    let settings = RunSettings { keep_area: true, ..RunSettings::new(&free, options.iterations) };
    let mut run = Run::new(mesh, &settings, Some(&mut watch))?;
    run.report.too_thin = too_thin;
    advance_updated(run, diffusion, Update::Mass, step, options.tolerance)
}

impl Flow for ConformalizedMcf {
    const ALGORITHMS: &'static [Algorithm] = &[Algorithm::new(
        "conformal",
        "mean curvature flow that keeps angles; takes genus 0 to the sphere",
        &["kazhdan2012"],
        &[
            TIME.about("The step as a fraction of the area").unit("").default("0.01"),
            ITERATIONS.about("The largest number of steps").default("100"),
            OPERATOR,
            TOLERANCE.default("1e-10"),
            Parameter::number("settled", "1e-6", "Ends when no vertex moves by more than this")
                .unit("roots of the area"),
        ],
    )];

    const RUN: FlowFn<Self> = conformalized_mean_curvature_flow;

    fn with(values: &Values<'_>, _: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let mut options = Self { kind: operator_from_values(values)?.0, ..Self::default() };
        values.read(TIME.name, &mut options.time)?;
        values.read(ITERATIONS.name, &mut options.iterations)?;
        values.read(TOLERANCE.name, &mut options.tolerance)?;
        values.read("settled", &mut options.settled)?;
        Ok(options)
    }
}

fn check(options: &ConformalizedMcf) -> Result<(), FlowFailure> {
    OptionError::require_not_negative("time", options.time)?;
    let tolerance = options.tolerance;
    let between = tolerance > 0.0 && tolerance < 1.0;
    OptionError::require(between, "tolerance", tolerance, "above 0 and below 1")?;
    Ok(OptionError::require_not_negative("threshold for settling", options.settled)?)
}
