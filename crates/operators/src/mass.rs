//! Masses: the areas of vertices, and the Galerkin mass matrix.

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;

use crate::assembly::{Diagonal, SideSums};
use crate::corners::{FaceCorners, degenerate};
use crate::error::OperatorError;
use crate::kind::LumpedArea;

impl LumpedArea {
    /// The area of each corner of a face, in squared mesh units, summing to
    /// the area of the face; `None` where cotangents are needed and the face
    /// is too thin for them.
    #[inline]
    pub(crate) fn shares(self, face: &FaceCorners) -> Option<[f64; 3]> {
        let needs_cotangents = match self {
            Self::Barycentric => false,
            Self::Mixed => !face.dots.iter().any(|&d| d < 0.0),
            Self::Voronoi => true,
        };
        (!needs_cotangents || !face.is_degenerate()).then(|| self.sound_shares(face))
    }

    /// [`shares`](Self::shares) of a face that is known to have cotangents.
    #[inline]
    pub(crate) fn sound_shares(self, face: &FaceCorners) -> [f64; 3] {
        if self == Self::Barycentric {
            return [face.third(); 3];
        }
        if self == Self::Mixed
            && let Some(k) = face.dots.iter().position(|&d| d < 0.0)
        {
            let mut shares = [0.25 * face.area(); 3];
            shares[k] = 0.5 * face.area();
            return shares;
        }
        let cot = face.cotangents();
        let sides = face.squared_sides();
        // The side opposite a corner contributes to the other two.
        let part: [f64; 3] = std::array::from_fn(|k| 0.125 * sides[k] * cot[k]);
        [part[1] + part[2], part[2] + part[0], part[0] + part[1]]
    }
}

/// Computes the lumped mass of each vertex.
///
/// `n` areas in squared mesh units, in vertex order, summing to the area of
/// the mesh; zero at isolated vertices. Scaling the mesh by s multiplies them
/// by s². At the boundary a cell ends where the mesh ends.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin for the
/// cotangents that its shares need: never with
/// [`LumpedArea::Barycentric`], and with [`LumpedArea::Mixed`] only where no
/// angle is obtuse.
///
/// Source: [meyer2003].
///
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
#[doc(alias("massmatrix", "mass_matrix", "vertex_areas"))]
pub fn lumped_mass(mesh: &TriMesh, area: LumpedArea) -> Result<Vec<f64>, OperatorError> {
    match area {
        // Known to the compiler, which leaves out what thirds do not need.
        LumpedArea::Barycentric => sum_shares(mesh, LumpedArea::Barycentric),
        other => sum_shares(mesh, other),
    }
}

/// One pass over the faces on one thread: as fast as gathering by vertices on
/// several, and without a table of shares.
#[inline(always)]
fn sum_shares(mesh: &TriMesh, area: LumpedArea) -> Result<Vec<f64>, OperatorError> {
    let mut mass = vec![0.0; mesh.vertex_count()];
    for (f, vertices) in mesh.faces().iter().enumerate() {
        let face = FaceCorners::new(mesh.triangle(f));
        let shares = area.shares(&face).ok_or_else(|| degenerate(f, &face))?;
        for k in 0..3 {
            mass[vertices[k] as usize] += shares[k];
        }
    }
    Ok(mass)
}

/// Assembles the consistent (Galerkin) mass matrix `Mᵢⱼ = ∫ φᵢ φⱼ` of hat
/// functions.
///
/// ```text
/// Mᵢⱼ = ¹⁄₁₂ Σ A over the faces of edge ij,    Mᵢᵢ = ⅙ Σ A over those of i
/// ```
///
/// `n × n`, symmetric, in squared mesh units; row sums are barycentric masses.
/// Positive definite unless a vertex has only faces without area, or none.
///
/// # Errors
///
/// [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// Source: [vallet2008].
///
/// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
#[doc(alias("massmatrix", "mass_matrix"))]
pub fn consistent_mass(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    consistent_on_pattern(mesh, None)
}

/// [`consistent_mass`], on the pattern of one of the same faces if there is
/// one: the same bits.
///
/// # Errors
///
/// As [`consistent_mass`], and [`OperatorError::Connectivity`].
pub(crate) fn consistent_on_pattern(
    mesh: &TriMesh,
    pattern: Option<&SparseMatrix>,
) -> Result<SparseMatrix, OperatorError> {
    let twelfth = |f| Ok([mesh.face_area(f) / 12.0; 3]);
    SideSums::new(mesh, Diagonal::Sum, twelfth)?.matrix(pattern)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn right_triangle() -> TriMesh {
        let positions = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [9.0; 3]];
        TriMesh::new(positions, vec![[0, 1, 2]]).unwrap()
    }

    #[test]
    fn shares_of_a_right_triangle() {
        let third = 2.0 / 3.0;
        let mass = |a| lumped_mass(&right_triangle(), a).unwrap();
        assert_eq!(mass(LumpedArea::Barycentric), [third, third, third, 0.0]);
        assert_eq!(mass(LumpedArea::Voronoi), [1.0, 0.5, 0.5, 0.0]);
        assert_eq!(mass(LumpedArea::Mixed), [1.0, 0.5, 0.5, 0.0]);
    }

    #[test]
    fn an_obtuse_triangle_turns_voronoi_negative_and_mixed_not() {
        let positions = vec![[0.0; 3], [4.0, 0.0, 0.0], [2.0, 0.5, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let voronoi = lumped_mass(&mesh, LumpedArea::Voronoi).unwrap();
        assert!(voronoi[0] < 0.0 && voronoi[1] < 0.0);
        assert!((voronoi.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert_eq!(lumped_mass(&mesh, LumpedArea::Mixed).unwrap(), [0.25, 0.25, 0.5]);
    }

    #[test]
    fn consistent_rows_sum_to_barycentric_masses() {
        let m = consistent_mass(&right_triangle()).unwrap();
        let t = 1.0 / 6.0;
        let expected = [[2.0 * t, t, t, 0.0], [t, 2.0 * t, t, 0.0], [t, t, 2.0 * t, 0.0], [0.0; 4]];
        let difference = m.to_dense() - ndarray::arr2(&expected);
        assert!(difference.iter().all(|d| d.abs() < 1e-15));
    }

    /// Powers of two round nothing.
    #[test]
    fn consistent_masses_follow_their_unit() {
        let mesh = right_triangle();
        let mass = consistent_mass(&mesh).unwrap();
        for unit in [2f64.powi(-96), 2f64.powi(96)] {
            let positions = mesh.positions().iter().map(|p| p.map(|x| x * unit)).collect();
            let found = consistent_mass(&mesh.with_positions(positions).unwrap()).unwrap();
            assert_eq!(found, mass.map(|m| m * unit * unit));
        }
    }

    #[test]
    fn a_collapsed_face_fails_only_where_cotangents_are_needed() {
        let positions = vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        assert_eq!(lumped_mass(&mesh, LumpedArea::Barycentric).unwrap(), [0.0; 3]);
        for area in [LumpedArea::Voronoi, LumpedArea::Mixed] {
            let error = lumped_mass(&mesh, area).unwrap_err();
            assert_eq!(error, OperatorError::DegenerateFace { face: 0, area: 0.0, edge: 1.0 });
        }
    }
}
