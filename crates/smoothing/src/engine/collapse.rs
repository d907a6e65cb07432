//! The end of mean curvature flow: a mesh, or a part of it, that shrinks to a point.
//!
//! A closed surface of area A is gone after a time of about A/8π, a neck much earlier. Implicit steps pass that
//! moment without noticing: what should have vanished is left as a speck. Comparing the areas of faces with those in
//! the input shows it. A neck that pinches off, or faces that degenerate here and there, do not end a flow.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{cross, norm, sub};
use fairing_sparse::passes::CHUNK;
use rayon::prelude::*;

use crate::engine::error::FlowFailure;

/// A mesh with less than this share of its area is gone: a hundredth of its size.
const GONE: f64 = 1e-4;

/// Where a step fails and a face has less than this share of its area left, that is the reason.
const PINCHED: f64 = 1e-3;

/// The areas of the faces in the input.
pub(crate) struct Collapse {
    areas: Vec<f64>,
    total: f64,
}

impl Collapse {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let areas: Vec<f64> = areas(mesh.faces(), mesh.positions()).collect();
        Self { total: areas.iter().sum(), areas }
    }

    /// Refuses a step that leaves next to nothing of the mesh.
    pub(crate) fn check(&self, faces: &[[u32; 3]], x: &[[f64; 3]]) -> Result<(), FlowFailure> {
        // In chunks, so that the sum does not depend on threads.
        let chunks: Vec<f64> = faces.par_chunks(CHUNK).map(|faces| areas(faces, x).sum()).collect();
        // Areas that are not finite are left to the check of the positions.
        if chunks.iter().sum::<f64>() < GONE * self.total
            && let Some((_, failure)) = self.smallest(faces, x)
        {
            return Err(failure);
        }
        Ok(())
    }

    /// The failure of a step at `mesh`, or the collapse behind it.
    pub(crate) fn explain(&self, mesh: &TriMesh, failure: FlowFailure) -> FlowFailure {
        let by_geometry = matches!(
            failure,
            FlowFailure::NotConverged { .. }
                | FlowFailure::NotFactored(_)
                | FlowFailure::Operator(_)
                | FlowFailure::NonPositiveMass { .. }
        );
        match self.smallest(mesh.faces(), mesh.positions()) {
            Some((share, collapse)) if by_geometry && share < PINCHED => collapse,
            _ => failure,
        }
    }

    /// The face that has lost the largest share of its area, and what is left.
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
        let [a, b, c] = face.map(|v| x[v as usize]);
        0.5 * norm(cross(sub(b, a), sub(c, a)))
    })
}
