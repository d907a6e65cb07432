//! The Laplacian of a mesh for a kind of diffusion.

use fairing_mesh::TriMesh;
use fairing_operators::intrinsic::{RobustLaplacian, RobustOptions, robust_laplacian};
use fairing_operators::{LumpedArea, lumped_mass};

use crate::engine::cotangents::{Cotangents, Degenerate};
use crate::engine::diffusion::{Diffusion, Operator};
use crate::engine::error::FlowFailure;
use crate::engine::laplacian::Laplacian;

/// Assembles `L` at the positions of `mesh`; vertices for which `held` is true have zero rows.
pub(crate) fn assemble(
    mesh: &TriMesh,
    diffusion: Diffusion,
    held: &[bool],
) -> Result<Laplacian, FlowFailure> {
    match diffusion {
        Diffusion::Uniform { .. } => Ok(uniform(mesh, held)),
        Diffusion::Cotangent { operator, .. } => cotangent(mesh, operator, held),
    }
}

/// `L` for uniform weights.
pub(crate) fn uniform(mesh: &TriMesh, held: &[bool]) -> Laplacian {
    Laplacian::uniform(mesh.vertex_count(), mesh.faces(), held)
}

/// `L` for cotangents.
pub(crate) fn cotangent(
    mesh: &TriMesh,
    operator: Operator,
    held: &[bool],
) -> Result<Laplacian, FlowFailure> {
    match operator {
        Operator::Plain(area) => Cotangents::of(mesh, area, held).assemble(mesh),
        Operator::Robust => {
            let RobustLaplacian { stiffness, mass, .. } = robust(mesh)?;
            Ok(Laplacian::weighted(&stiffness, mass, held))
        }
    }
}

/// Takes the operator anew as positions change.
pub(crate) enum Renewal {
    /// On the pattern of the faces.
    Pattern(Cotangents),
    /// From the beginning: intrinsic edges change with the positions.
    Whole(Diffusion),
}

impl Renewal {
    pub(crate) fn new(mesh: &TriMesh, diffusion: Diffusion, held: &[bool]) -> Self {
        match diffusion {
            Diffusion::Cotangent { operator: Operator::Plain(area), .. } => {
                Self::Pattern(Cotangents::of(mesh, area, held))
            }
            other => Self::Whole(other),
        }
    }

    /// The Laplacian at the positions of `mesh`.
    pub(crate) fn assemble(
        &mut self,
        mesh: &TriMesh,
        held: &[bool],
    ) -> Result<Laplacian, FlowFailure> {
        match self {
            Self::Pattern(pattern) => pattern.assemble(mesh),
            Self::Whole(diffusion) => assemble(mesh, *diffusion, held),
        }
    }

    /// Replaces `laplacian`, which [`Self::assemble`] made of the same faces, by that at other positions. Returns the
    /// faces that are taken as degenerate; the robust operator knows none.
    pub(crate) fn renew(
        &mut self,
        mesh: &TriMesh,
        held: &[bool],
        laplacian: &mut Laplacian,
        degenerate: Degenerate,
    ) -> Result<Vec<u32>, FlowFailure> {
        match self {
            Self::Pattern(pattern) => pattern.assemble_into(mesh, laplacian, degenerate),
            Self::Whole(diffusion) => {
                *laplacian = assemble(mesh, *diffusion, held)?;
                Ok(Vec::new())
            }
        }
    }
}

/// The masses of the operator, all positive; 1 at isolated vertices, which nothing moves.
pub(crate) fn mass(mesh: &TriMesh, operator: Operator) -> Result<Vec<f64>, FlowFailure> {
    match operator {
        Operator::Plain(area) => positive_mass(mesh, area),
        Operator::Robust => Ok(robust(mesh)?.mass),
    }
}

/// The lumped mass, all positive; 1 at isolated vertices, which nothing moves.
pub(crate) fn positive_mass(mesh: &TriMesh, area: LumpedArea) -> Result<Vec<f64>, FlowFailure> {
    positive(mesh, lumped_mass(mesh, area)?)
}

/// The robust operator, with positive masses.
pub(crate) fn robust(mesh: &TriMesh) -> Result<RobustLaplacian, FlowFailure> {
    let mut robust = robust_laplacian(mesh, RobustOptions::default())?;
    robust.mass = positive(mesh, robust.mass)?;
    Ok(robust)
}

fn positive(mesh: &TriMesh, mut mass: Vec<f64>) -> Result<Vec<f64>, FlowFailure> {
    let offsets = mesh.incidence().offsets();
    for (v, m) in mass.iter_mut().enumerate() {
        if offsets[v] == offsets[v + 1] {
            *m = 1.0;
        } else if *m <= 0.0 {
            return Err(FlowFailure::NonPositiveMass { vertex: v as u32, mass: *m });
        }
    }
    Ok(mass)
}
