//! Cotangent stiffness of a triangle mesh, and the uniform Laplacians of its graph of edges.
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
use fairing_watch::parallel;

use crate::assembly::{Diagonal, SideSums, assemble};
use crate::corners::{FaceCorners, degenerate};
use crate::error::OperatorError;
use crate::fan::Fan;

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

/// Assembles the combinatorial Laplacian `D − A`.
///
/// ```text
/// Lᵢⱼ = −1 for an edge ij,    Lᵢᵢ = dᵢ, the number of edges at i
/// ```
///
/// `n × n`, symmetric, **positive** semi-definite, zero row sums,
/// dimensionless. An edge counts once, whatever the number of its faces;
/// boundary vertices are treated as any other; an isolated vertex has an
/// explicit zero on the diagonal. Source: [taubin1995].
///
/// # Errors
///
/// [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// [taubin1995]: https://doi.org/10.1145/218380.218473
#[doc(alias("graph_laplacian", "uniform_laplace_matrix"))]
pub fn combinatorial_laplacian(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    assemble(mesh, |fan, place, row| {
        row.fill(-1.0);
        row[place] = fan.neighbors.len() as f64;
    })
}

/// Assembles the random-walk Laplacian `L = D⁻¹A − I`, the operator of
/// explicit uniform smoothing: `(L x)ᵢ` leads from xᵢ to the mean of its
/// neighbours.
///
/// ```text
/// Lᵢⱼ = 1/dᵢ for an edge ij,    Lᵢᵢ = −1
/// ```
///
/// `n × n`, not symmetric, **negative** semi-definite in the inner product weighted by D: its
/// eigenvalues lie in \[−2, 0\]. Zero row sums, dimensionless. The row of an isolated vertex is
/// zero, so the vertex does not move. Source: [taubin1995].
///
/// # Errors
///
/// [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// [taubin1995]: https://doi.org/10.1145/218380.218473
#[doc(alias = "laplacian_calculation")]
pub fn random_walk_laplacian(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    assemble(mesh, |fan, place, row| {
        let degree = fan.neighbors.len();
        if degree > 0 {
            row.fill(1.0 / degree as f64);
            row[place] = -1.0;
        }
    })
}

/// The number of edges at each vertex.
pub(crate) fn degrees(mesh: &TriMesh) -> Vec<f64> {
    let incidence = mesh.incidence();
    let degree = |fan: &mut Fan, v: u32| {
        fan.gather(incidence.sides(v).iter().copied());
        fan.neighbors.len() as f64
    };
    parallel::map_with(mesh.vertex_count(), 2048, Fan::default, |fan, v| degree(fan, v as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles on the edge 12, and an isolated vertex.
    fn kite() -> TriMesh {
        TriMesh::new(vec![[0.0; 3]; 5], vec![[0, 1, 2], [3, 2, 1]]).unwrap()
    }

    #[test]
    fn combinatorial_entries() {
        let l = combinatorial_laplacian(&kite()).unwrap();
        let expected = [
            [2.0, -1.0, -1.0, 0.0, 0.0],
            [-1.0, 3.0, -1.0, -1.0, 0.0],
            [-1.0, -1.0, 3.0, -1.0, 0.0],
            [0.0, -1.0, -1.0, 2.0, 0.0],
            [0.0; 5],
        ];
        assert_eq!(l.to_dense(), ndarray::arr2(&expected));
        assert_eq!(l.nnz(), 15);
    }

    #[test]
    fn random_walk_entries() {
        let l = random_walk_laplacian(&kite()).unwrap();
        let (h, t) = (0.5, 1.0 / 3.0);
        let expected = [
            [-1.0, h, h, 0.0, 0.0],
            [t, -1.0, t, t, 0.0],
            [t, t, -1.0, t, 0.0],
            [0.0, h, h, -1.0, 0.0],
            [0.0; 5],
        ];
        assert_eq!(l.to_dense(), ndarray::arr2(&expected));
    }
}
