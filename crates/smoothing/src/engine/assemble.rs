//! The Laplacian of a mesh for a kind of diffusion.

use fairing_mesh::TriMesh;
use fairing_operators::{
    CotangentPattern, LaplacianKind, LumpedArea, MassKind, ThinFaces, positive_lumped_mass,
};
use fairing_sparse::{GraphLaplacian, SparseMatrix};

use crate::engine::diffusion::Diffusion;
use crate::engine::error::FlowFailure;
use crate::engine::neighbors;

/// Assembles `L` of a [chosen](Diffusion::chosen) kind at the positions of `mesh`; vertices for which `fixed` is true have zero rows.
pub(crate) fn assemble(
    mesh: &TriMesh,
    diffusion: Diffusion,
    fixed: &[bool],
) -> Result<GraphLaplacian, FlowFailure> {
    match diffusion {
        Diffusion::Uniform { .. } => Ok(uniform(mesh, fixed)),
        Diffusion::Cotangent { kind, area, .. } => cotangent(mesh, kind, area, fixed),
    }
}

/// `L` for uniform weights.
pub(crate) fn uniform(mesh: &TriMesh, fixed: &[bool]) -> GraphLaplacian {
    neighbors::uniform(mesh.vertex_count(), mesh.faces(), fixed)
}

/// `L` for cotangents, of a chosen kind.
pub(crate) fn cotangent(
    mesh: &TriMesh,
    kind: LaplacianKind,
    area: LumpedArea,
    fixed: &[bool],
) -> Result<GraphLaplacian, FlowFailure> {
    if kind == LaplacianKind::Cotangent {
        return on_pattern(&mut CotangentPattern::new(mesh, area, fixed)?, mesh);
    }
    let (stiffness, mass) = operators(mesh, (kind, area.into()))?;
    Ok(GraphLaplacian::weighted(&stiffness, mass, fixed))
}

/// `L` for the cotangents of a pattern.
fn on_pattern(
    pattern: &mut CotangentPattern,
    mesh: &TriMesh,
) -> Result<GraphLaplacian, FlowFailure> {
    let mut laplacian = pattern.laplacian();
    pattern.fill(mesh, ThinFaces::Refuse, &mut laplacian)?;
    Ok(laplacian)
}

/// Takes the operator again as positions change.
pub(crate) enum Assembler {
    /// On the pattern of the faces.
    Pattern(CotangentPattern),
    /// From the beginning: intrinsic edges change with the positions.
    Whole(Diffusion),
}

impl Assembler {
    pub(crate) fn new(
        mesh: &TriMesh,
        diffusion: Diffusion,
        fixed: &[bool],
    ) -> Result<Self, FlowFailure> {
        Ok(match diffusion {
            Diffusion::Cotangent { kind: LaplacianKind::Cotangent, area, .. } => {
                Self::Pattern(CotangentPattern::new(mesh, area, fixed)?)
            }
            other => Self::Whole(other),
        })
    }

    /// The Laplacian at the positions of `mesh`.
    pub(crate) fn assemble(
        &mut self,
        mesh: &TriMesh,
        fixed: &[bool],
    ) -> Result<GraphLaplacian, FlowFailure> {
        match self {
            Self::Pattern(pattern) => on_pattern(pattern, mesh),
            Self::Whole(diffusion) => assemble(mesh, *diffusion, fixed),
        }
    }

    /// Replaces `laplacian`, which [`Self::assemble`] made of the same faces, by that at other positions. Returns the
    /// faces that are widened; the robust operator knows none.
    pub(crate) fn reassemble(
        &mut self,
        mesh: &TriMesh,
        fixed: &[bool],
        laplacian: &mut GraphLaplacian,
        thin: ThinFaces,
    ) -> Result<Vec<u32>, FlowFailure> {
        match self {
            Self::Pattern(pattern) => Ok(pattern.fill(mesh, thin, laplacian)?),
            Self::Whole(diffusion) => {
                *laplacian = assemble(mesh, *diffusion, fixed)?;
                Ok(Vec::new())
            }
        }
    }
}

/// The positive masses of a chosen kind.
pub(crate) fn mass(
    mesh: &TriMesh,
    kind: LaplacianKind,
    area: LumpedArea,
) -> Result<Vec<f64>, FlowFailure> {
    match kind {
        LaplacianKind::Cotangent => Ok(positive_lumped_mass(mesh, area)?),
        kind => Ok(operators(mesh, (kind, area.into()))?.1),
    }
}

/// The stiffness of a kind, and the positive masses of a kind.
pub(crate) fn operators(
    mesh: &TriMesh,
    (kind, mass): (LaplacianKind, MassKind),
) -> Result<(SparseMatrix, Vec<f64>), FlowFailure> {
    let laplacian = fairing_operators::Laplacian::new(mesh, kind, mass)?;
    let mass = laplacian.positive_mass()?.lumped().into_owned();
    Ok((laplacian.into_parts().0, mass))
}
