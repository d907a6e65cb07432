//! The loop over steps, common to all stepping flows, and the view of a step for observers.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::{OperatorError, check_faces};
use fairing_sparse::{GraphLaplacian, larger};
use glam::DVec3;

use crate::engine::arrangement::Arrangement;
use crate::engine::assemble::assemble;
use crate::engine::constraints::{Constraints, Freedom};
use crate::engine::diffusion::Diffusion;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::{Report, Smoothed};
use crate::engine::volume::{SizeKeeper, Volume};

/// Settings shared by all flows.
pub(crate) struct RunSettings<'a> {
    pub(crate) constraints: &'a Constraints,
    pub(crate) volume: Volume,
    pub(crate) iterations: usize,
    /// True if the mesh is scaled to the area of the input after each step.
    pub(crate) keep_area: bool,
}

impl<'a> RunSettings<'a> {
    /// Settings without control of volume or area.
    pub(crate) fn new(constraints: &'a Constraints, iterations: usize) -> Self {
        Self { constraints, volume: Volume::Drifts, iterations, keep_area: false }
    }
}

/// State of a running flow.
pub(crate) struct Run<'a, 'o> {
    input: &'a TriMesh,
    pub(crate) arrangement: Arrangement,
    pub(crate) freedom: Freedom,
    keeper: Option<SizeKeeper>,
    observer: Option<&'a mut Observer<'o>>,
    iterations: usize,
    pub(crate) report: Report,
}

/// Step size and residual of a completed step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StepNote {
    pub(crate) step_size: f64,
    pub(crate) residual: Option<f64>,
}

/// Returns true if a mesh with the initial diagonal `size` has shrunk to a point up to rounding.
fn is_point(mesh: &TriMesh, size: f64) -> bool {
    let largest = |p: [f64; 3]| p.iter().fold(size, |largest, x| larger(largest, x.abs()));
    let limit = |p: [f64; 3]| 4.0 * f64::EPSILON * largest(p);
    // For most meshes the distance of two corners decides.
    let Some(&[a, b, _]) = mesh.faces().first() else { return false };
    let [a, b] = [a, b].map(|v| mesh.positions()[v as usize]);
    size > 0.0 && DVec3::from(a).distance(b.into()) <= limit(a) && mesh.diagonal() <= limit(a)
}

/// Refuses a mesh whose faces share no corners: each face would shrink by itself.
pub(crate) fn refuse_unwelded(mesh: &TriMesh) -> Result<(), FlowFailure> {
    if mesh.is_unwelded() {
        let (vertices, seams) = (mesh.vertex_count(), mesh.seam_vertices());
        return Err(FlowFailure::Unwelded { seams, vertices });
    }
    Ok(())
}

impl<'a, 'o> Run<'a, 'o> {
    /// Arranges the mesh and its constraints. Observed runs keep the input's vertex order.
    pub(crate) fn new(
        input: &'a TriMesh,
        settings: &RunSettings<'_>,
        observer: Option<&'a mut Observer<'o>>,
    ) -> Result<Self, FlowError> {
        let prepare = || -> Result<_, FlowFailure> {
            refuse_unwelded(input)?;
            let arrangement = match observer {
                Some(_) => Arrangement::as_given(input),
                None => Arrangement::in_slabs(input)?,
            };
            let freedom = Freedom::new(&arrangement, settings.constraints)?;
            let keeper =
                SizeKeeper::new(arrangement.mesh(), settings.volume, settings.keep_area, &freedom)?;
            Ok((arrangement, freedom, keeper))
        };
        let (arrangement, freedom, keeper) = prepare().map_err(|failure| failure.before(input))?;
        Ok(Self {
            input,
            arrangement,
            freedom,
            keeper,
            observer,
            iterations: settings.iterations,
            report: Report::default(),
        })
    }

    /// Chooses the kind of Laplacian for the input; the report names the face that decided.
    pub(crate) fn choose(&mut self, diffusion: Diffusion) -> Result<Diffusion, FlowError> {
        let chosen = diffusion.chosen(self.input);
        let (diffusion, too_thin) = chosen.map_err(|failure| failure.before(self.input))?;
        self.report.too_thin = too_thin;
        Ok(diffusion)
    }

    /// The Laplacian of the input, in the order of the arrangement.
    pub(crate) fn laplacian(&mut self, diffusion: Diffusion) -> Result<GraphLaplacian, FlowError> {
        let diffusion = self.choose(diffusion)?;
        assemble(self.arrangement.mesh(), diffusion, &self.freedom.fixed)
            .map_err(|failure| self.refuse(failure))
    }

    /// Returns true if the run has no observer and its steps are linear in the positions, so that
    /// all steps may be computed at once.
    pub(crate) fn is_linear(&self) -> bool {
        self.observer.is_none() && self.keeper.is_none() && self.freedom.is_linear()
    }

    /// Takes the steps. `step` receives the iteration, counted from 0, and the mesh before the
    /// step, and writes the positions after it.
    pub(crate) fn iterate(
        mut self,
        mut step: impl FnMut(
            usize,
            &TriMesh,
            &Freedom,
            &mut Vec<[f64; 3]>,
        ) -> Result<StepNote, FlowFailure>,
    ) -> Result<Smoothed, FlowError> {
        let mut mesh = self.arrangement.mesh().clone();
        let mut next = mesh.positions().to_vec();
        let size = mesh.diagonal();
        fairing_watch::stage("steps", self.iterations as u64);
        for iteration in 0..self.iterations {
            fairing_watch::advance(u64::from(iteration > 0));
            self.freedom.begin_step(&mesh);
            let taken = step(iteration, &mesh, &self.freedom, &mut next).and_then(|note| {
                self.freedom.end_step(&mut next);
                if let Some(keeper) = &self.keeper {
                    // Positions are checked first: a failure of the volume would not name the bad
                    // vertex.
                    mesh.with_positions(std::mem::take(&mut next))
                        .map(|m| next = m.into_positions())?;
                    keeper.restore(&mut next, &self.freedom)?;
                }
                Ok((note, mesh.with_positions(std::mem::take(&mut next))?))
            });
            let (note, after) = match taken {
                Ok(taken) => taken,
                Err(failure) => return Err(self.fail(failure, iteration + 1, mesh)),
            };
            self.report.iterations = iteration + 1;
            if let Some(residual) = note.residual {
                let worst = self.report.worst_residual.unwrap_or(0.0);
                self.report.worst_residual = Some(residual.max(worst));
            }
            let verdict = match &mut self.observer {
                None => ControlFlow::Continue(()),
                Some(observe) => observe(&Step {
                    iteration: iteration + 1,
                    step_size: note.step_size,
                    before: mesh.positions(),
                    mesh: &after,
                    residual: note.residual,
                }),
            };
            next = std::mem::replace(&mut mesh, after).into_positions();
            if verdict.is_break() || is_point(&mesh, size) {
                self.report.stopped = true;
                break;
            }
        }
        self.finish(mesh.into_positions())
    }

    /// Ends the run with positions in the order of the arrangement.
    pub(crate) fn finish(self, positions: Vec<[f64; 3]>) -> Result<Smoothed, FlowError> {
        let input = self.input;
        match input.with_positions(self.arrangement.restore(positions)) {
            Ok(mesh) => Ok(Smoothed { mesh, report: self.report }),
            Err(error) => Err(FlowFailure::from(error).before(input)),
        }
    }

    /// The error of a failure before the first step.
    pub(crate) fn refuse(&self, failure: FlowFailure) -> FlowError {
        self.translate(failure, self.input).before(self.input)
    }

    fn fail(&self, failure: FlowFailure, iteration: usize, mesh: TriMesh) -> FlowError {
        let restored = self.arrangement.restore(mesh.into_positions());
        match self.input.with_positions(restored) {
            Ok(mesh) => FlowError {
                failure: self.translate(failure, &mesh),
                iteration,
                last_good: Box::new(mesh),
            },
            Err(error) => FlowFailure::from(error).before(self.input),
        }
    }

    /// The failure with vertices and faces numbered as in the input. `mesh` is the last good one.
    fn translate(&self, failure: FlowFailure, mesh: &TriMesh) -> FlowFailure {
        let original = |vertex| self.arrangement.original(vertex);
        match failure {
            FlowFailure::NonFinite { vertex, position } => {
                FlowFailure::NonFinite { vertex: original(vertex), position }
            }
            FlowFailure::NonPositiveMass { vertex, mass } => {
                FlowFailure::NonPositiveMass { vertex: original(vertex), mass }
            }
            FlowFailure::Collapsed { vertex, area, before } => {
                FlowFailure::Collapsed { vertex: original(vertex), area, before }
            }
            FlowFailure::NoLength { vertex, neighbor } => {
                FlowFailure::NoLength { vertex: original(vertex), neighbor: original(neighbor) }
            }
            FlowFailure::NotConverged { residual, iterations, vertex } => {
                FlowFailure::NotConverged { residual, iterations, vertex: original(vertex) }
            }
            // Faces were reordered too, so the check is repeated to find the first bad one of the
            // input.
            FlowFailure::Operator(OperatorError::DegenerateFace { .. }) => {
                check_faces(mesh).map_or_else(FlowFailure::Operator, |()| failure)
            }
            other => other,
        }
    }
}

/// A callback invoked after every step; `ControlFlow::Break` ends the flow.
///
/// # Examples
///
/// Stop as soon as no vertex moves by more than a thousandth of an edge:
///
/// ```
/// use std::ops::ControlFlow;
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, Explicit, Step, explicit};
///
/// let sphere = shapes::icosphere(3);
/// let small = 1e-3 * sphere.mean_edge_length();
/// let options = Explicit { iterations: 1000, ..Explicit::new(Diffusion::uniform(0.5)) };
/// let mut observer = |step: &Step<'_>| match step.largest_displacement() < small {
///     true => ControlFlow::Break(()),
///     false => ControlFlow::Continue(()),
/// };
/// let smoothed = explicit(&sphere, &options, Some(&mut observer))?;
/// assert!(smoothed.report.stopped);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
pub type Observer<'a> = dyn FnMut(&Step<'_>) -> ControlFlow<()> + 'a;

/// A completed step of a flow.
pub struct Step<'a> {
    pub(crate) iteration: usize,
    pub(crate) step_size: f64,
    pub(crate) before: &'a [[f64; 3]],
    pub(crate) mesh: &'a TriMesh,
    pub(crate) residual: Option<f64>,
}

impl Step<'_> {
    /// The number of this step, from 1.
    pub fn iteration(&self) -> usize {
        self.iteration
    }

    /// The factor of the Laplacian in this step: λ for uniform weights, a time in squared mesh
    /// units for cotangent weights.
    pub fn step_size(&self) -> f64 {
        self.step_size
    }

    /// The mesh after this step, by reference without a copy.
    pub fn mesh(&self) -> &TriMesh {
        self.mesh
    }

    /// The positions after this step, in the vertex order of the input.
    pub fn positions(&self) -> &[[f64; 3]] {
        self.mesh.positions()
    }

    /// The largest displacement of a vertex in this step, in mesh units. Computed when called.
    pub fn largest_displacement(&self) -> f64 {
        let pairs = self.before.iter().zip(self.positions());
        let squares = pairs.map(|(&a, &b)| DVec3::from(b).distance_squared(a.into()));
        squares.fold(0.0, larger).sqrt()
    }

    /// The largest relative residual of the linear systems of this step; `None` for explicit steps.
    pub fn residual(&self) -> Option<f64> {
        self.residual
    }
}
