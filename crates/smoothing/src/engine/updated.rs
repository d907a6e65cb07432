//! Implicit flows with an updated operator: mean curvature flow and its conformal variant.
//!
//! A closed surface of area A vanishes after a time of about A/8π, a neck much earlier. Implicit
//! steps pass this moment unnoticed and leave a speck instead of nothing; comparing face areas with
//! those of the input detects it. A neck that pinches off, or a few faces that degenerate, do not
//! end a flow.

use fairing_mesh::TriMesh;
use fairing_operators::ThinFaces;
use fairing_sparse::parallel::CHUNK;
use glam::DVec3;
use rayon::prelude::*;

use crate::engine::assemble::{Assembler, mass};
use crate::engine::constraints::Freedom;
use crate::engine::diffusion::Diffusion;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::implicit_steps::ImplicitSteps;
use crate::engine::outcome::Smoothed;
use crate::engine::run::{Run, StepNote};

/// The part of the operator that follows the moving mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Update {
    /// None: the operator of the input for all steps. The flow is linear.
    #[default]
    Never,
    /// The mass: conformalised mean curvature flow without its normalisation. Source:
    /// [kazhdan2012].
    ///
    /// [kazhdan2012]: https://doi.org/10.1111/j.1467-8659.2012.03179.x
    Mass,
    /// Mass and stiffness: mean curvature flow.
    Both,
}

fairing_parameters::choices!(Update, "update of the operator",
    Never: "never", "Keep the operator of the input";
    Mass: "mass", "Reassemble the areas, keep the stiffness of the input";
    Both: "both", "Reassemble areas and stiffness";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Update);

/// Takes implicit steps of the factor `step` of `L`, which is updated before each of them.
pub(crate) fn advance_updated(
    mut run: Run<'_, '_>,
    diffusion: Diffusion,
    update: Update,
    step: f64,
    tolerance: f64,
) -> Result<Smoothed, FlowError> {
    let diffusion = run.choose(diffusion)?;
    let begun = Updated::new(&run, diffusion, update, step, tolerance);
    let mut flow = begun.map_err(|failure| run.refuse(failure))?;
    let smoothed = run.iterate(|iteration, mesh, freedom, next| {
        flow.step(iteration, mesh, freedom, next).map_err(|failure| flow.explain(mesh, failure))
    });
    smoothed.map(|mut smoothed| {
        smoothed.report.degenerate_faces = flow.flattened.iter().filter(|&&f| f).count();
        smoothed.report.approach = flow.steps.approach();
        smoothed
    })
}

/// State of a flow with an updated operator.
struct Updated {
    diffusion: Diffusion,
    /// The assembler of a stiffness that is updated, too.
    assembler: Option<Assembler>,
    steps: ImplicitSteps,
    /// Areas of the faces of the input, and their sum.
    areas: Vec<f64>,
    area: f64,
    /// True for each face that was too thin in some step.
    flattened: Vec<bool>,
}

/// The fraction of its area below which a mesh counts as vanished, at a hundredth of its size.
const GONE: f64 = 1e-4;

/// The fraction of its area below which a face explains the failure of a step.
const PINCHED: f64 = 1e-3;

impl Updated {
    fn new(
        run: &Run<'_, '_>,
        diffusion: Diffusion,
        update: Update,
        step: f64,
        tolerance: f64,
    ) -> Result<Self, FlowFailure> {
        let (mesh, freedom) = (run.arrangement.mesh(), &run.freedom);
        let mut assembler = Assembler::new(mesh, diffusion, &freedom.fixed)?;
        let laplacian = assembler.assemble(mesh, &freedom.fixed)?;
        // A factor serves one step.
        let steps = ImplicitSteps::new(laplacian, freedom, step, tolerance, 1);
        let areas: Vec<f64> = areas(mesh.faces(), mesh.positions()).collect();
        let assembler = (update == Update::Both).then_some(assembler);
        let flattened = vec![false; if assembler.is_some() { mesh.face_count() } else { 0 }];
        let area = areas.iter().sum();
        Ok(Self { diffusion, assembler, steps, areas, area, flattened })
    }

    fn step(
        &mut self,
        iteration: usize,
        mesh: &TriMesh,
        freedom: &Freedom,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        use FlowFailure::{NotConverged, NotFactored};
        let taken = self.attempt(iteration, mesh, freedom, next, ThinFaces::Widen);
        // If thin faces spoil the system, the step is repeated with nearly flat faces widened a
        // little.
        if let Err(NotConverged { .. } | NotFactored(_)) = taken
            && iteration > 0
            && self.assembler.is_some()
        {
            next.copy_from_slice(mesh.positions());
            return self.attempt(iteration, mesh, freedom, next, ThinFaces::WidenNearly);
        }
        taken
    }

    fn attempt(
        &mut self,
        iteration: usize,
        mesh: &TriMesh,
        freedom: &Freedom,
        next: &mut [[f64; 3]],
        thin: ThinFaces,
    ) -> Result<StepNote, FlowFailure> {
        if iteration > 0 {
            self.reassemble(mesh, freedom, thin)?;
        }
        let note = self.steps.step(mesh.positions(), freedom, next)?;
        self.check(mesh.faces(), next)?;
        Ok(note)
    }

    /// Reassembles the operator at the positions of `mesh`.
    fn reassemble(
        &mut self,
        mesh: &TriMesh,
        freedom: &Freedom,
        thin: ThinFaces,
    ) -> Result<(), FlowFailure> {
        let Self { diffusion, assembler, .. } = self;
        let faces = self.steps.update(freedom, |laplacian| {
            if let Some(assembler) = assembler {
                return assembler.reassemble(mesh, &freedom.fixed, laplacian, thin);
            }
            if let Diffusion::Cotangent { kind, area, .. } = *diffusion {
                laplacian.replace_mass(mass(mesh, kind, area)?);
            }
            Ok(Vec::new())
        })?;
        for f in faces {
            self.flattened[f as usize] = true;
        }
        Ok(())
    }

    /// Refuses a step that leaves almost nothing of the mesh.
    fn check(&self, faces: &[[u32; 3]], x: &[[f64; 3]]) -> Result<(), FlowFailure> {
        // In chunks, so that the sum does not depend on threads.
        let chunks: Vec<f64> = faces.par_chunks(CHUNK).map(|faces| areas(faces, x).sum()).collect();
        // Areas that are not finite are reported by the check of the positions.
        if chunks.iter().sum::<f64>() < GONE * self.area
            && let Some((_, failure)) = self.smallest(faces, x)
        {
            return Err(failure);
        }
        Ok(())
    }

    /// The failure of a step at `mesh`, or the collapse that caused it.
    fn explain(&self, mesh: &TriMesh, failure: FlowFailure) -> FlowFailure {
        let by_geometry = matches!(
            failure,
            FlowFailure::NotConverged { .. }
                | FlowFailure::NotFactored(_)
                | FlowFailure::Operator(_)
                | FlowFailure::NonPositiveMass { .. }
        );
        match self.smallest(mesh.faces(), mesh.positions()) {
            Some((fraction, collapse)) if by_geometry && fraction < PINCHED => collapse,
            _ => failure,
        }
    }

    /// The collapse of the face that has lost the largest fraction of its area, with the remaining
    /// fraction.
    fn smallest(&self, faces: &[[u32; 3]], x: &[[f64; 3]]) -> Option<(f64, FlowFailure)> {
        areas(faces, x)
            .zip(&self.areas)
            .zip(faces)
            .filter(|((_, before), _)| **before > 0.0)
            .map(|((area, &before), face)| {
                (area / before, FlowFailure::Collapsed { vertex: face[0], area, before })
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// The area of each face.
fn areas<'a>(faces: &'a [[u32; 3]], x: &'a [[f64; 3]]) -> impl Iterator<Item = f64> + 'a {
    faces.iter().map(|face| {
        let [a, b, c] = face.map(|v| DVec3::from(x[v as usize]));
        0.5 * (b - a).cross(c - a).length()
    })
}
