//! Cotangent stiffness of a triangle mesh.
//!
//! For hat functions φ, with α and β the angles opposite edge ij,
//!
//! ```text
//! Sᵢⱼ = ∫ ∇φᵢ·∇φⱼ = −½ (cot α + cot β),    Sᵢᵢ = −Σⱼ Sᵢⱼ
//! ```
//!
//! Weak form: `S u` is integrated; divide by mass for pointwise values.
//! Boundaries are natural (zero flux). Source: [pinkall1993].
//!
//! [pinkall1993]: https://doi.org/10.1080/10586458.1993.10504266

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;

use crate::assembly::{Diagonal, SideSums};
use crate::corners::{FaceCorners, degenerate};
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
/// Source: [pinkall1993].
///
/// [pinkall1993]: https://doi.org/10.1080/10586458.1993.10504266
#[doc(alias("cotan_laplacian", "cotmatrix", "laplace_matrix"))]
pub fn cotan_stiffness(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    on_pattern(mesh, None)
}

/// [`cotan_stiffness`], on the pattern of one of the same faces if there is
/// one: the same bits.
///
/// # Errors
///
/// As [`cotan_stiffness`], and [`OperatorError::Connectivity`].
pub(crate) fn on_pattern(
    mesh: &TriMesh,
    pattern: Option<&SparseMatrix>,
) -> Result<SparseMatrix, OperatorError> {
    let sums = SideSums::new(mesh, Diagonal::MinusSum, |f| {
        let face = FaceCorners::new(mesh.triangle(f));
        if face.is_degenerate() {
            return Err(degenerate(f, &face));
        }
        Ok(face.half_cotangents().map(|half| -half))
    });
    sums?.matrix(pattern)
}
