//! Curvature on meshes with inconsistently oriented faces.

use fairing_mesh::TriMesh;

use super::field::CurvatureField;

/// Runs an estimator on the [oriented](TriMesh::oriented) mesh. On one-sided parts, which have no
/// orientation, H becomes |H|: each vertex takes the side from which H is not negative.
pub(super) fn on_oriented<T: Signed, E>(
    mesh: &TriMesh,
    estimate: impl FnOnce(&TriMesh) -> Result<T, E>,
) -> Result<T, E> {
    let mut found = estimate(&mesh.oriented())?;
    for v in mesh.one_sided_faces().into_iter().flat_map(|f| mesh.faces()[f as usize]) {
        found.drop_sign(v as usize);
    }
    Ok(found)
}

/// Curvature at vertices, with opposite signs on the two sides of the surface.
pub(super) trait Signed {
    /// Chooses the side of vertex `v` from which H is not negative.
    fn drop_sign(&mut self, v: usize);
}

impl Signed for CurvatureField {
    fn drop_sign(&mut self, v: usize) {
        if self.mean[v] >= 0.0 {
            return;
        }
        self.mean[v] = -self.mean[v];
        (self.kappa1[v], self.kappa2[v]) = (-self.kappa2[v], -self.kappa1[v]);
        if let Some([first, second]) = &mut self.directions {
            std::mem::swap(&mut first[v], &mut second[v]);
        }
        if let Some(accuracy) = &mut self.accuracy {
            accuracy.normals[v] = accuracy.normals[v].map(|x| -x);
        }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use glam::DVec3;

    use super::*;
    use crate::curvature::{Estimator, mean_curvature, umbrella_mean_curvature};
    use crate::{LumpedArea, vertex_normals};

    /// About three tenths of the faces, anywhere.
    fn with_turned_faces(mesh: &TriMesh) -> TriMesh {
        let turn = |(f, &[a, b, c]): (usize, &[u32; 3])| {
            let chosen = (f as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32 < 1_288_490_189;
            if chosen { [b, a, c] } else { [a, b, c] }
        };
        let faces: Vec<_> = mesh.faces().iter().enumerate().map(turn).collect();
        let count = faces.iter().zip(mesh.faces()).filter(|(a, b)| a != b).count();
        assert!((0.25..0.35).contains(&(count as f64 / faces.len() as f64)), "{count}");
        TriMesh::new(mesh.positions().to_vec(), faces).unwrap()
    }

    /// The same sums in another order: only rounding may differ.
    fn assert_same(found: &[f64], expected: &[f64], what: &str) {
        for (v, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()), "{what}, vertex {v}: {a} and {b}");
        }
    }

    #[test]
    fn turned_faces_change_nothing() {
        let sphere = shapes::icosphere(3);
        for mesh in [shapes::jittered(&sphere, 0.2, 3, |p| p), shapes::torus(1.0, 0.4, 30, 14)] {
            let turned = with_turned_faces(&mesh);
            for estimator in Estimator::all() {
                let (found, expected) =
                    (estimator.estimate(&turned).unwrap(), estimator.estimate(&mesh).unwrap());
                assert_eq!(found.status, expected.status, "{estimator}");
                assert_same(&found.mean, &expected.mean, estimator.name());
                assert_same(&found.kappa1, &expected.kappa1, estimator.name());
                assert_same(&found.gaussian, &expected.gaussian, estimator.name());
            }
            for estimate in [
                |mesh: &_| umbrella_mean_curvature(mesh),
                |mesh: &_| mean_curvature(mesh, LumpedArea::Barycentric).unwrap(),
            ] {
                let (found, expected) = (estimate(&turned), estimate(&mesh));
                assert_same(&found.signed, &expected.signed, "mean curvature");
            }
            let (found, expected) = (vertex_normals(&turned), vertex_normals(&mesh));
            assert_same(found.as_flattened(), expected.as_flattened(), "normals");
            let volume = mesh.signed_volume();
            assert!((turned.signed_volume() / volume - 1.0).abs() < 1e-12);
        }
    }

    /// Where no neighbourhood meets the cut, a band that is cut open has the curvature of the whole
    /// one up to its sign.
    #[test]
    fn a_moebius_band_has_curvature_without_a_sign() {
        let band = shapes::moebius(0.4, 60, 8);
        let at = |v: u32| DVec3::from(band.positions()[v as usize]);
        for band in [&band, &with_turned_faces(&band)] {
            assert_eq!(band.one_sided_faces().len(), band.face_count());
            let oriented = band.oriented();
            let topology = oriented.topology();
            let cut = topology.orientation().inconsistent_edges();
            let cut: Vec<[u32; 2]> = cut.iter().map(|&e| topology.edges()[e as usize]).collect();
            let from_cut = |v: u32| {
                let all = cut.as_flattened().iter().map(|&w| at(v).distance(at(w)));
                all.fold(f64::INFINITY, f64::min)
            };
            let far = |f: &[u32; 3]| f.iter().all(|&v| from_cut(v) > 0.1);
            let open: Vec<_> = band.faces().iter().copied().filter(far).collect();
            let open = TriMesh::new(band.positions().to_vec(), open).unwrap();
            assert!(open.one_sided_faces().is_empty());
            for estimator in Estimator::all() {
                let found = estimator.estimate(band).unwrap();
                let part = estimator.estimate(&open).unwrap();
                assert!(found.mean.iter().all(|&h| h >= 0.0), "{estimator}");
                let fields = [&found.mean, &found.gaussian, &found.kappa1, &found.kappa2];
                assert!(fields.into_iter().flatten().all(|x| x.is_finite()), "{estimator}");
                let (mut all, mut expected) = (vec![], vec![]);
                for v in (0..band.vertex_count()).filter(|&v| from_cut(v as u32) > 1.0) {
                    all.extend([found.mean[v], found.gaussian[v]]);
                    expected.extend([part.mean[v].abs(), part.gaussian[v]]);
                }
                assert!(all.len() > 200);
                // A ball of mean edges has another radius on the part, and the noise is that of a
                // whole component.
                if ["normal-cycle", "corrected-ball", "adaptive"].contains(&estimator.name()) {
                    continue;
                }
                assert_same(&all, &expected, estimator.name());
            }
        }
    }
}
