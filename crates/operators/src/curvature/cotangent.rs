//! Mean curvature by cotangents, Gaussian curvature by angle defects.
//!
//! ```text
//! H = −½ (Δx)·n,    Δx = −M⁻¹ S x,    K = (2π − Σθ) / A,    κ = H ± √(H² − K)
//! ```
//!
//! The cheapest estimator, without directions. Its integrals converge; its pointwise values
//! converge on regular meshes but not on irregular ones. Sources: [meyer2003], [pinkall1993].
//!
//! [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
//! [pinkall1993]: https://doi.org/10.1080/10586458.1993.10504266

use fairing_mesh::TriMesh;

use super::cell::{Cell, map_cells};
use super::field::{AtVertex, CurvatureField};
use super::from_laplacian::laplacian_curvature;
use super::gaussian::undefined;
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;
use crate::kind::{LaplacianKind, LumpedArea, MassKind};
use crate::laplacian::{Laplacian, Reason, choose};

fairing_parameters::options! {
    /// Options of [`cotangent_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct CotangentOptions {
        /// The vertex areas that integrated values are divided by.
        pub area: LumpedArea = LumpedArea::Mixed;
    }
    "cotangent": "H and K on regular meshes, integrals on any mesh; cheap; no directions",
        ["meyer2003", "pinkall1993"];
}

/// H and K by cotangents and angle defects, and the principal values that
/// follow. Where estimates have H² < K, κ₁ = κ₂ = H; H and K stay as they are.
///
/// On a mesh with a face too thin for its cotangents this is the
/// [`laplacian_curvature`] of the [robust](Laplacian::robust) kind, and
/// [`CurvatureField::too_thin`] names the face; the rest of the mesh changes
/// where the intrinsic Delaunay triangulation differs from it, and next to such
/// faces, whose sides are lengthened. Undefined at isolated vertices, and where
/// the area is not positive or the normals cancel. Linear cost.
///
/// # Errors
///
/// [`OperatorError`] where not even the robust Laplacian exists: all edges
/// have length zero.
pub fn cotangent_curvature(
    mesh: &TriMesh,
    options: CotangentOptions,
) -> Result<CurvatureField, OperatorError> {
    on_oriented(mesh, |mesh| estimate(mesh, options))
}

/// The same on an oriented mesh, with the sign of its orientation on one-sided parts as well.
pub(super) fn estimate(
    mesh: &TriMesh,
    options: CotangentOptions,
) -> Result<CurvatureField, OperatorError> {
    // The robust Laplacian has areas of its own.
    let field = match choose(mesh, LaplacianKind::Auto, MassKind::Barycentric)?.1 {
        Reason::ThinFace { .. } => laplacian_curvature(mesh, &Laplacian::auto(mesh)?)?,
        _ => CurvatureField::collect(map_cells(mesh, options.area, at_cell), false),
    };
    Ok(field)
}

fn at_cell(cell: &Cell) -> (Result<AtVertex, Undefined>, bool) {
    let length = cell.normal.length();
    let found = if cell.area > 0.0 && length > 0.0 {
        let mean = -0.5 * cell.laplacian.dot(cell.normal) / (cell.area * length);
        Ok(AtVertex::from_mean_and_gaussian(mean, cell.defect() / cell.area))
    } else {
        Err(undefined(cell.links))
    };
    (found, cell.links.boundary)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use fairing_shapes::octahedron;

    use super::*;

    /// Weights 1/√3, areas 2/√3, defects 2π/3: H = 1, K = π/√3 > H².
    #[test]
    fn an_octahedron_by_hand() {
        for area in [LumpedArea::Mixed, LumpedArea::Barycentric] {
            let field = cotangent_curvature(&octahedron(), CotangentOptions { area }).unwrap();
            for v in 0..6 {
                assert!((field.mean[v] - 1.0).abs() < 1e-15, "{}", field.mean[v]);
                assert!((field.gaussian[v] - PI / 3f64.sqrt()).abs() < 1e-14);
                assert_eq!(field.kappa1[v], field.mean[v]);
                assert_eq!(field.kappa2[v], field.mean[v]);
            }
        }
    }

    /// The intrinsic operators on the flat-sided octahedron with the middle of
    /// an edge doubled by a face without area: the same H and K far from it.
    #[test]
    fn a_face_without_area_is_bridged() {
        let mesh = octahedron();
        let mut positions = mesh.positions().to_vec();
        positions.push([0.5, 0.5, 0.0]);
        let mut faces = mesh.faces().to_vec();
        // The face 0 2 4 reaches its side 0 2 through a sliver 0 6 2.
        faces[0] = [0, 6, 4];
        faces.extend([[6, 2, 4], [0, 2, 6]]);
        let mesh = TriMesh::new(positions, faces).unwrap();
        let field = cotangent_curvature(&mesh, CotangentOptions::default()).unwrap();
        assert!(field.status.iter().all(|s| s.is_defined()));
        // The robust mass is barycentric, over triangles that may be others.
        let exact = PI / 3f64.sqrt();
        assert!((field.mean[5] - 1.0).abs() < 0.2 && (field.mean[1] - 1.0).abs() < 0.2);
        assert!((field.gaussian[1] - exact).abs() < 0.4, "{}", field.gaussian[1]);
    }

    /// One face decides for curvature as for matrices, also where rounding decides: heights about
    /// 10⁻¹⁰ of the base, at all turns of the corners.
    #[test]
    fn curvature_and_matrices_choose_alike() {
        let mut taken = [0; 2];
        for k in 0..300 {
            let height = 1e-10 * (1.0 + f64::from(k - 150) * 1e-17);
            let base = 1.0 + f64::from(k % 17) * 0.1;
            let positions = vec![[0.0; 3], [base, 0.0, 0.0], [0.3 * base, height * base, 0.0]];
            let face = [[0, 1, 2], [1, 2, 0], [2, 0, 1]][k as usize % 3];
            let mesh = TriMesh::new(positions, vec![face]).unwrap();
            let field = cotangent_curvature(&mesh, CotangentOptions::default()).unwrap();
            let kind = Laplacian::auto(&mesh).unwrap().kind();
            assert_eq!(field.too_thin.is_some(), kind == LaplacianKind::Robust, "{k}");
            taken[usize::from(field.too_thin.is_some())] += 1;
        }
        assert!(taken.iter().all(|&n| n > 20), "{taken:?}");
    }
}
