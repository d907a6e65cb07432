//! Cotangent stiffness of a triangle mesh.
//!
//! For hat functions φ, with α and β the angles opposite edge ij,
//!
//! ```text
//! Sᵢⱼ = ∫ ∇φᵢ·∇φⱼ = −½ (cot α + cot β),    Sᵢᵢ = −Σⱼ Sᵢⱼ
//! ```
//!
//! Weak form: `S u` is integrated; divide by mass for pointwise values.
//! Boundaries are natural (zero flux). Source: \[pinkall1993\].

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;

use crate::assembly::{CornerEntries, Pattern};
use crate::corners::map_sound_faces;
use crate::error::OperatorError;

/// Assembles the cotangent stiffness matrix.
///
/// `n × n` for `n` vertices, rows in the mesh's vertex order; symmetric,
/// positive semi-definite, zero row sums. Dimensionless: scaling the mesh
/// leaves it unchanged. Off-diagonal entries turn positive where an edge is
/// not Delaunay; they are kept. Every face at an edge counts, however many.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin for its
/// cotangents to be meaningful; [`OperatorError::TooLarge`] beyond 2³²
/// entries.
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
/// use fairing_operators::cotan_stiffness;
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let s = cotan_stiffness(&TriMesh::new(corners, vec![[0, 1, 2]])?)?;
/// // The angles are 90°, 45° and 45°: edge 12 lies opposite the right one.
/// assert!((s.get(0, 0).unwrap() - 1.0).abs() < 1e-15);
/// assert!((s.get(0, 1).unwrap() + 0.5).abs() < 1e-15);
/// assert!(s.get(1, 2).unwrap().abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: \[pinkall1993\].
pub fn cotan_stiffness(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    let half = map_sound_faces(mesh, |face| face.cotangents().map(|cot| 0.5 * cot))?;
    Ok(Pattern::of(mesh)?.fill(mesh, |c| {
        let (half, k) = (&half[c as usize / 3], c as usize % 3);
        // The edge to the next corner lies opposite the previous one.
        let (to_next, to_previous) = (half[(k + 2) % 3], half[(k + 1) % 3]);
        CornerEntries { diagonal: to_next + to_previous, next: -to_next, previous: -to_previous }
    }))
}
