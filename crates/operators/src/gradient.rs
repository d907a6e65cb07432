//! Gradient of functions on vertices, divergence of fields on faces.
//!
//! A function linear on each face has a constant gradient there,
//!
//! ```text
//! ∇u = 1/(2A) Σₖ uₖ (n × eₖ),
//! ```
//!
//! with eₖ the side opposite corner k, counter-clockwise. With A the diagonal
//! of face areas, each three times, `S = Gᵀ A G`. Source: [botsch2010].
//!
//! [botsch2010]: https://doi.org/10.1201/b10688

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;
use fairing_watch::parallel;
use glam::DVec3;

use crate::corners::map_sound_faces;
use crate::error::OperatorError;

/// Assembles the gradient `G`, `3F × n`: row `3f + a` is coordinate `a` of the
/// gradient on face `f`.
///
/// Pointwise, in units of the function per mesh unit; it lies in the plane of
/// its face. Constants have no gradient, and the gradient of a coordinate is
/// its axis projected into the plane of the face.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin;
/// [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// Source: [botsch2010].
///
/// [botsch2010]: https://doi.org/10.1201/b10688
#[doc(alias("grad", "gradient_matrix"))]
pub fn gradient(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    let hats = hat_gradients(mesh)?;
    let entries = 9 * mesh.face_count();
    if u32::try_from(entries).is_err() {
        return Err(OperatorError::TooLarge { entries });
    }
    let mut columns = Vec::with_capacity(entries);
    let mut values = Vec::with_capacity(entries);
    for (face, hat) in mesh.faces().iter().zip(&hats) {
        let order = ascending(*face);
        for axis in 0..3 {
            columns.extend(order.map(|k| face[k]));
            values.extend(order.map(|k| hat[k][axis]));
        }
    }
    let offsets = (0..=3 * mesh.face_count() as u32).map(|row| 3 * row).collect();
    let shape = (3 * mesh.face_count(), mesh.vertex_count());
    Ok(SparseMatrix::new(shape, offsets, columns, values))
}

/// Assembles the integrated divergence `−Gᵀ A`, `n × 3F`.
///
/// A field on faces is given as `3F` numbers in the order of [`gradient`]. The
/// result is integrated over the hat function of a vertex and positive at
/// sources; there is no flux through the boundary (zero-flux Neumann), so that
/// it sums to zero. `divergence · gradient = −S`.
///
/// # Errors
///
/// As [`gradient`].
///
/// Source: [botsch2010].
///
/// [botsch2010]: https://doi.org/10.1201/b10688
#[doc(alias("compute_divergence", "div", "divergence_matrix"))]
pub fn divergence(mesh: &TriMesh) -> Result<SparseMatrix, OperatorError> {
    let mut weighted = gradient(mesh)?;
    for (row, values) in weighted.data_mut().chunks_exact_mut(3).enumerate() {
        let area = mesh.face_area(row / 3);
        for value in values {
            *value *= -area;
        }
    }
    Ok(weighted.transpose_view().to_csr())
}

/// The gradient of a function on each face, as vectors: [`gradient`] without
/// the matrix.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin.
///
/// # Panics
///
/// If there is not one value per vertex.
#[doc(alias = "compute_gradient")]
pub fn face_gradients(mesh: &TriMesh, values: &[f64]) -> Result<Vec<[f64; 3]>, OperatorError> {
    assert_eq!(values.len(), mesh.vertex_count(), "one value per vertex");
    let hats = hat_gradients(mesh)?;
    let on_face = |f: usize| {
        let (face, hat) = (mesh.faces()[f], &hats[f]);
        let sum: DVec3 = (0..3).map(|k| values[face[k] as usize] * hat[k]).sum();
        sum.to_array()
    };
    Ok(parallel::map(mesh.face_count(), 4096, on_face))
}

/// The gradients of the three hat functions of each face.
fn hat_gradients(mesh: &TriMesh) -> Result<Vec<[DVec3; 3]>, OperatorError> {
    map_sound_faces(mesh, |_| ())?;
    let hats = |f: usize| {
        let [a, b, c] = mesh.triangle(f).map(DVec3::from);
        let normal = (b - a).cross(c - a);
        // A unit normal: squares of areas are fourth powers of lengths.
        let length = normal.length();
        let unit = normal * (1.0 / length);
        let hat = |from: DVec3, to: DVec3| unit.cross(to - from) * (1.0 / length);
        [hat(b, c), hat(c, a), hat(a, b)]
    };
    Ok(parallel::map(mesh.face_count(), 64, hats))
}

/// The corners in ascending order of their vertices.
fn ascending(face: [u32; 3]) -> [usize; 3] {
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&k| face[k]);
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::cotan_stiffness;

    fn tent() -> TriMesh {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.3],
            [0.2, 1.0, 0.1],
            [1.1, 1.2, -0.4],
            [0.5, 0.4, 0.9],
        ];
        TriMesh::new(positions, vec![[4, 0, 1], [1, 3, 4], [3, 2, 4], [2, 0, 4]]).unwrap()
    }

    #[test]
    fn the_gradient_of_a_coordinate_is_its_axis_in_the_plane() {
        let mesh = tent();
        let g = gradient(&mesh).unwrap();
        for axis in 0..3 {
            let u: Vec<f64> = mesh.positions().iter().map(|p| p[axis]).collect();
            let by_matrix = &g * &ndarray::Array1::from(u.clone());
            for (f, found) in face_gradients(&mesh, &u).unwrap().into_iter().enumerate() {
                let area = DVec3::from(mesh.area_vector(f));
                let unit = area * (1.0 / mesh.face_area(f));
                let mut expected = -unit[axis] * unit;
                expected[axis] += 1.0;
                for a in 0..3 {
                    assert!((found[a] - expected[a]).abs() < 1e-14);
                    assert!((by_matrix[3 * f + a] - expected[a]).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn divergence_of_gradient_is_minus_the_stiffness() {
        let mesh = tent();
        let product = &divergence(&mesh).unwrap() * &gradient(&mesh).unwrap();
        let sum = product.to_dense() + cotan_stiffness(&mesh).unwrap().to_dense();
        assert!(sum.iter().all(|d| d.abs() < 1e-14), "{sum}");
    }

    #[test]
    fn a_flat_face_is_refused() {
        let mesh = TriMesh::new(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2]]).unwrap();
        assert!(matches!(gradient(&mesh), Err(OperatorError::DegenerateFace { face: 0, .. })));
    }
}
