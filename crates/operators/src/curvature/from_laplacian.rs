//! Mean and Gaussian curvature with a Laplacian of any kind.

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::field::{self, CurvatureField};
use super::gaussian::{defects, undefined};
use super::mean::{AtVertex, MeanCurvature};
use super::oriented::Signed;
use crate::error::OperatorError;
use crate::laplacian::{Laplacian, Reason};
use crate::normals::{NormalWeight, weighted_vertex_normals};

/// [`mean_curvature`](super::mean_curvature) with a Laplacian of the mesh:
/// `Δx = −M⁻¹ S x`, in 1 / mesh units for a mass of areas.
///
/// Undefined at isolated vertices, where the mass (its row sum) is not
/// positive, and where no area-weighted normal tells the sign.
///
/// # Errors
///
/// [`OperatorError::Length`] for the Laplacian of another mesh.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_operators::{Laplacian, LaplacianKind, MassKind};
/// use fairing_operators::curvature::laplacian_mean_curvature;
///
/// let sphere = shapes::icosphere(4);
/// // Mixed areas are the best for pointwise values.
/// let laplacian = Laplacian::new(&sphere, LaplacianKind::Cotangent, MassKind::Mixed)?;
/// let mean = laplacian_mean_curvature(&sphere, &laplacian)?;
/// assert!(mean.signed.iter().all(|h| (h - 1.0).abs() < 0.02));
/// # Ok::<(), fairing_operators::OperatorError>(())
/// ```
///
/// Source: [meyer2003].
///
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
pub fn laplacian_mean_curvature(
    mesh: &TriMesh,
    laplacian: &Laplacian,
) -> Result<MeanCurvature, OperatorError> {
    let bends = integrated(mesh, laplacian)?;
    let mass = laplacian.mass().lumped();
    let normals = weighted_vertex_normals(mesh, NormalWeight::Area);
    let found = bends.zip(&*mass).zip(normals).zip(defects(mesh));
    let found: Vec<AtVertex> = found
        .map(|(((bend, &mass), normal), (_, links))| {
            let vector = (mass > 0.0).then(|| bend * (-1.0 / mass));
            AtVertex::new(vector, normal.into(), links)
        })
        .collect();
    let mut mean = MeanCurvature::from_vertices(found.into_iter());
    // There the sign of the normal says nothing.
    for v in mesh.one_sided_faces().into_iter().flat_map(|f| mesh.faces()[f as usize]) {
        mean.drop_sign(v as usize);
    }
    Ok(mean)
}

/// H with a Laplacian of the mesh, K from angle defects over its mass, and the
/// principal values that follow.
///
/// Where estimates have H² < K, κ₁ = κ₂ = H; H and K stay as they are.
/// Undefined as in [`laplacian_mean_curvature`].
/// [`CurvatureField::too_thin`] is the face for which the Laplacian is robust,
/// if that is its [reason](Laplacian::reason). Linear cost.
///
/// # Errors
///
/// [`OperatorError::Length`] for the Laplacian of another mesh.
///
/// Source: [meyer2003].
///
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
pub fn laplacian_curvature(
    mesh: &TriMesh,
    laplacian: &Laplacian,
) -> Result<CurvatureField, OperatorError> {
    let (mean, mass) = (laplacian_mean_curvature(mesh, laplacian)?, laplacian.mass().lumped());
    let found = defects(mesh).into_iter().enumerate().map(|(v, (defect, links))| {
        let gaussian = defect / mass[v];
        let found = if mean.status[v].is_defined() && gaussian.is_finite() {
            Ok(field::AtVertex::from_mean_and_gaussian(mean.signed[v], gaussian))
        } else {
            Err(undefined(links))
        };
        (found, links.boundary)
    });
    let too_thin = match laplacian.reason() {
        Reason::ThinFace { face, .. } => Some(face),
        _ => None,
    };
    Ok(CurvatureField { too_thin, ..CurvatureField::collect(found.collect(), false) })
}

/// The rows of `S x`, about the vertex itself: rows sum to zero, and this way
/// far from the origin too.
fn integrated<'a>(
    mesh: &'a TriMesh,
    laplacian: &'a Laplacian,
) -> Result<impl Iterator<Item = DVec3> + 'a, OperatorError> {
    let (found, expected) = (laplacian.vertex_count(), mesh.vertex_count());
    if found != expected {
        return Err(OperatorError::Length { found, expected });
    }
    let positions = mesh.positions();
    Ok(laplacian.stiffness().outer_iterator().enumerate().map(|(v, row)| {
        let at = |w: usize| DVec3::from(positions[w]);
        row.iter().map(|(w, &s)| s * (at(w) - at(v))).sum()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::{gaussian_curvature, mean_curvature};
    use crate::{LaplacianKind, LumpedArea, MassKind};
    use fairing_shapes as shapes;

    /// Matrix and cells agree, on closed and open meshes with an isolated vertex.
    #[test]
    fn cotangents_are_those_of_the_cells() {
        let mut positions = shapes::icosphere(2).into_positions();
        positions.push([3.0; 3]);
        let sphere = TriMesh::new(positions, shapes::icosphere(2).faces().to_vec()).unwrap();
        let tube = shapes::cylinder(1.0, 2.0, 12, 6, shapes::Ends::Open);
        for mesh in [sphere, tube] {
            for area in [LumpedArea::Mixed, LumpedArea::Barycentric] {
                let laplacian =
                    Laplacian::new(&mesh, LaplacianKind::Cotangent, MassKind::from(area)).unwrap();
                let found = laplacian_mean_curvature(&mesh, &laplacian).unwrap();
                let expected = mean_curvature(&mesh, area).unwrap();
                assert_eq!(found.status, expected.status);
                assert_eq!(found.boundary, expected.boundary);
                let both = laplacian_curvature(&mesh, &laplacian).unwrap();
                let gaussian = gaussian_curvature(&mesh, area).unwrap();
                for v in 0..mesh.vertex_count() {
                    // The same sums in another order.
                    assert!((found.signed[v] - expected.signed[v]).abs() < 1e-11);
                    assert!((both.mean[v] - expected.signed[v]).abs() < 1e-11);
                    assert!((both.gaussian[v] - gaussian.values[v]).abs() < 1e-11);
                }
            }
        }
        let other = Laplacian::cotangent(&shapes::icosphere(1)).unwrap();
        let error = laplacian_curvature(&shapes::icosphere(2), &other).unwrap_err();
        assert_eq!(error, OperatorError::Length { found: 42, expected: 162 });
    }
}
