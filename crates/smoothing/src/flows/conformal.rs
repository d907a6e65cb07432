//! Conformalised mean curvature flow.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_parameters::{Options, Range};

use crate::engine::constraints::Constraints;
use crate::engine::diffusion::{Diffusion, Time};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::run::{Observer, Step};
use crate::engine::run::{Run, RunSettings};
use crate::engine::updated::{Update, advance_updated};

fairing_parameters::options! {
    /// Options of [`conformalized_mean_curvature_flow`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct ConformalizedMcf {
        /// The time of a step as a fraction of the area of the mesh.
        pub time: f64 = 0.01, in Range::NOT_NEGATIVE;
        /// The largest number of steps.
        pub iterations: usize = 100;
        /// The kind of cotangent Laplacian.
        pub kind: LaplacianKind = LaplacianKind::Auto, name "operator";
        /// The relative residual of the linear systems.
        pub tolerance: f64 = 1e-10, in Range::above(0.0).below(1.0);
        /// The flow stops when no vertex moves farther than this in a step; 0 disables the test.
        pub settled: f64 = 1e-6, in Range::NOT_NEGATIVE, unit "roots of the area";
    }
    "conformal": "mean curvature flow that preserves angles; genus 0 flows to a sphere", ["kazhdan2012"];
}

/// Evolves a closed mesh by conformalised mean curvature flow, with the stiffness of the input and
/// the mass of the current mesh.
///
/// ```text
/// (M(xₙ) + t S(x₀)) xₙ₊₁ = M(xₙ) xₙ,  then scaled about the centroid to the area of the input
/// ```
///
/// The constant stiffness preserves the conformal structure and avoids the singularities with which
/// mean curvature flow pinches off necks: meshes of genus 0 flow to a round sphere. The mass has
/// barycentric areas; a collapsed face contributes no mass.
///
/// # Errors
///
/// [`FlowError`] if the mesh is not closed or has several components, if an option is out of range,
/// if a face of the input is too thin for cotangents, or if the area of a vertex vanishes.
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
/// Source: [kazhdan2012].
///
/// [kazhdan2012]: https://doi.org/10.1111/j.1467-8659.2012.03179.x
#[doc(alias("cmcf", "tria_mean_curvature_flow"))]
pub fn conformalized_mean_curvature_flow(
    mesh: &TriMesh,
    options: &ConformalizedMcf,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let refuse = |failure: FlowFailure| failure.before(mesh);
    options.check().map_err(|error| refuse(error.into()))?;
    let topology = mesh.topology();
    if !topology.is_closed() || topology.components().count() != 1 {
        let reason = "the area can be preserved only on a closed mesh of one component";
        return Err(refuse(FlowFailure::Unsupported { reason }));
    }
    let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
    let step = options.time * area;
    let (kind, areas) = (options.kind, LumpedArea::Barycentric);
    let diffusion = Diffusion::Cotangent { time: Time::SquaredUnits(step), kind, area: areas };
    let threshold = options.settled * area.sqrt();
    let mut observer = observer;
    let mut watch = |step: &Step<'_>| {
        if let Some(observe) = &mut observer
            && observe(step).is_break()
        {
            return ControlFlow::Break(());
        }
        if step.largest_displacement() <= threshold {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let free = Constraints::default();
    let settings = RunSettings { keep_area: true, ..RunSettings::new(&free, options.iterations) };
    let run = Run::new(mesh, &settings, Some(&mut watch))?;
    advance_updated(run, diffusion, Update::Mass, step, options.tolerance)
}
