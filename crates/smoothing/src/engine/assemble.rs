//! Assembly of the Laplacian of a mesh for a kind of diffusion.

use fairing_mesh::TriMesh;
use fairing_operators::{
    CotangentPattern, LaplacianKind, LumpedArea, MassKind, ThinFaces, positive_lumped_mass,
};
use fairing_sparse::parallel::CHUNK;
use fairing_sparse::{GraphLaplacian, SparseMatrix};
use fairing_watch::parallel;

use crate::engine::diffusion::Diffusion;
use crate::engine::error::FlowFailure;

/// Assembles `L` of a [chosen](Diffusion::chosen) kind at the positions of `mesh`. Rows of `fixed`
/// vertices are zero.
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

/// `L` for uniform weights, `(Lx)ᵢ = mean over neighbours xⱼ − xᵢ`: `S = D − A`, `M = D`. Rows of
/// `fixed` and isolated vertices are zero.
pub(crate) fn uniform(mesh: &TriMesh, fixed: &[bool]) -> GraphLaplacian {
    let (offsets, columns) = neighbor_lists(mesh, fixed);
    GraphLaplacian::uniform(offsets, columns)
}

/// `L` for cotangent weights of a chosen kind.
fn cotangent(
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

/// `L` for cotangent weights on a given pattern.
fn on_pattern(
    pattern: &mut CotangentPattern,
    mesh: &TriMesh,
) -> Result<GraphLaplacian, FlowFailure> {
    let mut laplacian = pattern.laplacian();
    pattern.fill(mesh, ThinFaces::Refuse, &mut laplacian)?;
    Ok(laplacian)
}

/// Reassembles the operator as positions change.
pub(crate) enum Assembler {
    /// New values on the fixed pattern of the faces.
    Pattern(CotangentPattern),
    /// A new operator each time, since intrinsic edges change with the positions.
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

    /// Replaces `laplacian`, as returned by [`Self::assemble`], by the operator at the positions of
    /// `mesh`. Returns the thin faces that were widened; the robust operator widens none.
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

/// The lumped mass of a chosen kind, positive at every vertex.
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

/// The stiffness and the positive lumped mass of the given kinds.
pub(crate) fn operators(
    mesh: &TriMesh,
    (kind, mass): (LaplacianKind, MassKind),
) -> Result<(SparseMatrix, Vec<f64>), FlowFailure> {
    let laplacian = fairing_operators::Laplacian::new(mesh, kind, mass)?;
    let mass = laplacian.positive_mass()?.lumped().into_owned();
    Ok((laplacian.into_parts().0, mass))
}

/// Vertices with more faces sort their neighbours to remove duplicates, since a linear search is
/// quadratic.
const MANY_FACES: usize = 64;

/// The distinct neighbours of every vertex in compressed rows; `[v]` for an isolated or fixed
/// vertex `v`.
fn neighbor_lists(mesh: &TriMesh, fixed: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let (n, faces, incidence) = (mesh.vertex_count(), mesh.faces(), mesh.incidence());
    let pieces: Vec<(Vec<u32>, Vec<u32>)> = parallel::map(n.div_ceil(CHUNK), 1, |chunk| {
        let vertices = chunk * CHUNK..n.min((chunk + 1) * CHUNK);
        let mut lists = Vec::with_capacity(CHUNK * 7);
        let mut lengths = Vec::with_capacity(CHUNK);
        for v in vertices {
            let begin = lists.len();
            let around = incidence.corners(v as u32);
            let of = |&corner: &u32| faces[corner as usize / 3];
            if fixed[v] || around.is_empty() {
                lists.push(v as u32);
            } else if around.len() > MANY_FACES {
                let corners = around.iter().flat_map(of);
                let mut all: Vec<u32> = corners.filter(|&j| j as usize != v).collect();
                all.sort_unstable();
                all.dedup();
                lists.extend(all);
            } else {
                for j in around.iter().flat_map(of) {
                    if j as usize != v && !lists[begin..].contains(&j) {
                        lists.push(j);
                    }
                }
            }
            lengths.push((lists.len() - begin) as u32);
        }
        (lists, lengths)
    });
    let mut offsets = Vec::with_capacity(n + 1);
    let mut neighbors = Vec::with_capacity(pieces.iter().map(|(lists, _)| lists.len()).sum());
    let mut end = 0;
    offsets.push(0);
    for (lists, lengths) in pieces {
        neighbors.extend_from_slice(&lists);
        for length in lengths {
            end += length;
            offsets.push(end);
        }
    }
    (offsets, neighbors)
}
