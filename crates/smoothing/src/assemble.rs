//! The Laplacian of a mesh for a kind of diffusion.

use fairing_mesh::TriMesh;
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};

use crate::diffusion::Diffusion;
use crate::error::FlowFailure;
use crate::laplacian::Laplacian;

/// Assembles `L` at the positions of `mesh`; vertices for which `held` is true have zero rows.
pub(crate) fn assemble(
    mesh: &TriMesh,
    diffusion: Diffusion,
    held: &[bool],
) -> Result<Laplacian, FlowFailure> {
    match diffusion {
        Diffusion::Uniform { .. } => Ok(uniform(mesh, held)),
        Diffusion::Cotangent { area, .. } => {
            let stiffness = cotan_stiffness(mesh)?;
            Ok(Laplacian::weighted(&stiffness, positive_mass(mesh, area)?, held))
        }
    }
}

/// `L` for uniform weights.
pub(crate) fn uniform(mesh: &TriMesh, held: &[bool]) -> Laplacian {
    Laplacian::uniform(mesh.vertex_count(), mesh.faces(), held)
}

/// The lumped mass, all positive; 1 at isolated vertices, which nothing moves.
pub(crate) fn positive_mass(mesh: &TriMesh, area: LumpedArea) -> Result<Vec<f64>, FlowFailure> {
    let mut mass = lumped_mass(mesh, area)?;
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
