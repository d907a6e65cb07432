//! Stiffness and mass for any triangle soup.

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;

use super::cover::tufted;
use super::delaunay::{Flips, Triangulation, after, before};
use crate::assembly::sum_entries;
use crate::error::OperatorError;

/// The excess of two sides of a triangle over the third, as a fraction of its longest side, or of
/// the mean length in its connected part if that is less. A triangle with a smaller excess is
/// lengthened: all its sides by the same amount, and with them the sides of neighbours that would
/// fall short. Other faces keep their lengths, except for sides shared with such triangles.
const EXCESS: f64 = 1e-5;

/// The weight of a triangle of the cover, which covers the surface twice.
const FRACTION: f64 = 0.5;

/// Stiffness and mass of a mesh in its intrinsic metric.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RobustLaplacian {
    /// The stiffness, `n × n`, as by [`cotan_stiffness`](crate::cotan_stiffness):
    /// positive semi-definite, zero row sums, dimensionless.
    pub stiffness: SparseMatrix,
    /// The barycentric mass of each vertex in the intrinsic triangulation, in
    /// squared mesh units; zero at isolated vertices only.
    pub mass: Vec<f64>,
    /// The most that mollification added to a length, in mesh units.
    pub added_length: f64,
    /// The number of triangles of the cover with a lengthened side.
    pub mollified: usize,
    /// The number of flips, over both sides of the cover.
    pub flips: usize,
    /// The number of edges left non-Delaunay, because flipping them would have made
    /// a triangle without area: zero except for extreme lengths.
    pub stuck: usize,
    /// The triangles of the operators.
    pub faces: IntrinsicFaces,
}

/// Triangles given by the lengths of their sides. They cover the surface twice: each counts half.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct IntrinsicFaces {
    /// The corners, three for each face; side k runs from corner k to corner
    /// k + 1. An edge may lead from a vertex to itself.
    pub corners: Vec<u32>,
    /// The lengths of the sides, three for each face, in mesh units.
    pub lengths: Vec<f64>,
}

/// Assembles a stiffness and a mass on any triangle mesh that has an edge of a
/// length above zero.
///
/// All entries are finite. Off-diagonal entries of the stiffness are not positive, up to 10⁻¹⁰
/// (where `stuck` is zero), and masses of vertices with faces are positive. On a closed manifold
/// mesh that is Delaunay and has no thin face the result is the plain cotangent stiffness and the
/// barycentric mass. Edges at borders are flipped, too, because the sheet counts as a flattened
/// closed surface, whose two sides are averaged.
///
/// Cost: linear except for the flips, whose number is small on real meshes.
///
/// # Errors
///
/// [`OperatorError::NoLength`] if no edge has a length above zero (a mesh without faces has zero
/// operators instead); [`OperatorError::DegenerateFace`] if a triangle has no area after
/// mollification; [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// Source: [sharp2020].
///
/// [sharp2020]: https://doi.org/10.1111/cgf.14069
#[doc(alias("intrinsic_delaunay_cotmatrix", "mesh_laplacian", "tufted_laplacian"))]
pub fn robust_laplacian(mesh: &TriMesh) -> Result<RobustLaplacian, OperatorError> {
    let mut triangles = tufted(mesh);
    let longest = triangles.length.iter().copied().fold(0.0, f64::max);
    if triangles.triangle_count() > 0 && longest == 0.0 {
        return Err(OperatorError::NoLength);
    }
    let parts = mesh.topology().components();
    let part = |v| parts.label(v).unwrap_or(0) as usize;
    let done = triangles.mollify(EXCESS, || (0..mesh.vertex_count() as u32).map(part).collect());
    if let Some(t) = (0..triangles.triangle_count()).find(|&t| triangles.area(3 * t as u32) <= 0.0)
    {
        let face = (t % mesh.face_count()) as u32;
        return Err(OperatorError::DegenerateFace {
            face,
            area: 0.0,
            edge: longest_of(&triangles, t),
        });
    }
    let Flips { count: flips, stuck } = triangles.flip_to_delaunay();
    let (stiffness, mass) = assemble(mesh.vertex_count(), &triangles)?;
    let (added_length, mollified) = (done.added, done.triangles);
    let faces = IntrinsicFaces { corners: triangles.start, lengths: triangles.length };
    Ok(RobustLaplacian { stiffness, mass, added_length, mollified, flips, stuck, faces })
}

fn longest_of(triangles: &Triangulation, t: usize) -> f64 {
    triangles.length[3 * t..3 * t + 3].iter().copied().fold(0.0, f64::max)
}

/// Cotangent stiffness and barycentric mass of the triangles of a cover. An edge from a vertex to
/// itself does not contribute to the stiffness.
fn assemble(
    n: usize,
    triangles: &Triangulation,
) -> Result<(SparseMatrix, Vec<f64>), OperatorError> {
    let mut mass = vec![0.0; n];
    let mut entries = Vec::with_capacity(4 * triangles.start.len());
    for s in 0..triangles.start.len() as u32 {
        let (i, j) = (triangles.start[s as usize], triangles.start[after(s) as usize]);
        mass[triangles.start[before(s) as usize] as usize] += FRACTION * triangles.area(s) / 3.0;
        if i != j {
            let weight = 0.5 * FRACTION * triangles.opposite_cotangent(s);
            entries.extend([(i, j, -weight), (j, i, -weight), (i, i, weight), (j, j, weight)]);
        }
    }
    Ok((sum_entries(n, &entries)?, mass))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LumpedArea, cotan_stiffness, lumped_mass};
    use fairing_shapes as shapes;

    fn largest_difference(a: &SparseMatrix, b: &SparseMatrix) -> f64 {
        (a.to_dense() - b.to_dense()).iter().fold(0.0, |m: f64, d| m.max(d.abs()))
    }

    #[test]
    fn a_delaunay_mesh_keeps_its_operators() {
        let mesh = shapes::icosphere(2);
        let plain = cotan_stiffness(&mesh).unwrap();
        let area = lumped_mass(&mesh, LumpedArea::Barycentric).unwrap();
        let robust = robust_laplacian(&mesh).unwrap();
        assert_eq!((robust.flips, robust.stuck, robust.added_length), (0, 0, 0.0));
        assert!(largest_difference(&robust.stiffness, &plain) < 1e-12);
        for (a, b) in robust.mass.iter().zip(&area) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    /// Without flips the cover of any manifold mesh averages two like sides.
    #[test]
    fn without_flips_it_is_the_plain_stiffness() {
        let mesh = shapes::torus(3.0, 1.0, 9, 5);
        let (stiffness, _) = assemble(mesh.vertex_count(), &tufted(&mesh)).unwrap();
        let plain = cotan_stiffness(&mesh).unwrap();
        assert!(largest_difference(&stiffness, &plain) < 1e-12);
    }

    #[test]
    fn three_pages_and_a_flat_face_have_operators() {
        let positions = vec![
            [0.0; 3],
            [0.0, 0.0, 2.0],
            [1.0, 0.0, 1.0],
            [-1.0, 0.3, 1.0],
            [0.1, 1.0, 1.0],
            [0.0, 0.0, 1.0],
            [9.0; 3],
        ];
        let faces = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5], [0, 2, 1]];
        let mesh = TriMesh::new(positions, faces).unwrap();
        let robust = robust_laplacian(&mesh).unwrap();
        assert_eq!(robust.stuck, 0);
        for (i, row) in robust.stiffness.outer_iterator().enumerate() {
            let mut sum = 0.0;
            for (j, &s) in row.iter() {
                assert!(s.is_finite() && (i == j || s <= 1e-10), "{i} {j} {s}");
                sum += s;
            }
            // Cotangents of the mollified sliver are of order 10².
            assert!(sum.abs() < 1e-9);
        }
        assert!(robust.mass[..6].iter().all(|&m| m > 0.0));
        assert_eq!(robust.mass[6], 0.0);
    }

    #[test]
    fn a_point_has_none() {
        let mesh = TriMesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
        let robust = robust_laplacian(&mesh);
        assert_eq!(robust, Err(OperatorError::NoLength));
        let empty = TriMesh::new(vec![[1.0; 3]; 3], vec![]).unwrap();
        assert_eq!(robust_laplacian(&empty).unwrap().mass, [0.0; 3]);
    }
}
