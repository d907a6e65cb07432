//! Curvature on meshes whose faces do not turn alike.

use fairing_mesh::TriMesh;

use super::field::{Accuracy, CurvatureField};

/// Runs an estimator where neighbouring faces agree: on the [oriented](TriMesh::oriented) mesh, or,
/// where parts are one-sided, on its [double cover](TriMesh::double_cover). At a vertex of a
/// one-sided part the result is that of the side from which H is not negative.
pub(super) fn on_oriented<T: TwoSided, E>(
    mesh: &TriMesh,
    estimate: impl FnOnce(&TriMesh) -> Result<T, E>,
) -> Result<T, E> {
    match mesh.double_cover() {
        None => estimate(&mesh.oriented()),
        Some((cover, above)) => estimate(&cover).map(|found| found.down(&above)),
    }
}

/// Curvature at vertices, with opposite signs on the two sides of the surface.
pub(super) trait TwoSided {
    /// H of the vertices.
    fn mean(&self) -> &[f64];

    /// The values at these vertices.
    fn taken(&self, vertices: &[u32]) -> Self;

    /// One of the two values above each vertex of a double cover: the one with H ≥ 0 where there
    /// are two.
    fn down(&self, above: &[[u32; 2]]) -> Self
    where
        Self: Sized,
    {
        let side = |&[a, b]: &[u32; 2]| if self.mean()[a as usize] < 0.0 { b } else { a };
        self.taken(&above.iter().map(side).collect::<Vec<u32>>())
    }
}

/// The values at these vertices.
pub(super) fn take<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
    vertices.iter().map(|&v| values[v as usize]).collect()
}

impl TwoSided for CurvatureField {
    fn mean(&self) -> &[f64] {
        &self.mean
    }

    fn taken(&self, vertices: &[u32]) -> Self {
        Self {
            kappa1: take(&self.kappa1, vertices),
            kappa2: take(&self.kappa2, vertices),
            mean: take(&self.mean, vertices),
            gaussian: take(&self.gaussian, vertices),
            directions: self.directions.as_ref().map(|all| [0, 1].map(|k| take(&all[k], vertices))),
            status: take(&self.status, vertices),
            boundary: take(&self.boundary, vertices),
            too_thin: self.too_thin,
            narrowed: self.narrowed,
            accuracy: self.accuracy.as_ref().map(|all| all.taken(vertices)),
        }
    }
}

impl Accuracy {
    /// The values at these vertices.
    fn taken(&self, vertices: &[u32]) -> Self {
        Self {
            mean_error: take(&self.mean_error, vertices),
            gaussian_error: take(&self.gaussian_error, vertices),
            scale: take(&self.scale, vertices),
            noise: take(&self.noise, vertices),
            normals: take(&self.normals, vertices),
        }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

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

    /// Away from the cut ends, a band that is cut open has the curvature of the whole one up to
    /// its sign.
    #[test]
    fn a_moebius_band_has_curvature_without_a_sign() {
        let band = shapes::moebius(0.4, 60, 8);
        let far = |f: &[u32; 3]| f.iter().all(|&v| band.positions()[v as usize][0] > -0.7);
        let open: Vec<_> = band.faces().iter().copied().filter(far).collect();
        let open = TriMesh::new(band.positions().to_vec(), open).unwrap();
        let inner = |v: usize| band.positions()[v][0] > 0.3;
        assert!(open.one_sided_faces().is_empty());
        for band in [&band, &with_turned_faces(&band)] {
            assert_eq!(band.one_sided_faces().len(), band.face_count());
            for estimator in Estimator::all() {
                let found = estimator.estimate(band).unwrap();
                let part = estimator.estimate(&open).unwrap();
                assert!(found.mean.iter().all(|&h| h >= 0.0), "{estimator}");
                let (mut all, mut expected) = (vec![], vec![]);
                for v in (0..band.vertex_count()).filter(|&v| inner(v)) {
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
