//! Meshes at a size whose powers are floats.

use std::borrow::Cow;

use crate::TriMesh;
use crate::vec3::power_of_two;

/// Extents in this range are left as they are: eighth powers of lengths, the
/// highest that computations on meshes take, are normal numbers there, and of
/// parts down to 2⁻⁶⁰ of the extent too.
const ORDINARY: std::ops::RangeInclusive<f64> =
    5.421_010_862_427_522e-20..=1.844_674_407_370_955_2e19;

impl TriMesh {
    /// The mesh divided by a power of two, and that power, in mesh units.
    ///
    /// Squares of lengths, areas or normals of very small or very large meshes
    /// leave the range of floats. An extent of 2⁻⁶⁴ to 2⁶⁴ of the vertices of
    /// the faces keeps the mesh as it is, with the power 1; others come near
    /// one. Nothing is rounded, except coordinates below 10⁻²⁹² of the extent.
    /// Isolated vertices that would leave the range end at its border. Linear,
    /// and without a copy where the mesh is kept.
    pub fn at_unit_scale(&self) -> (Cow<'_, Self>, f64) {
        let unit = self.scale_unit();
        (self.divided_by(unit), unit)
    }

    /// The power of two that [`at_unit_scale`](Self::at_unit_scale) divides
    /// by: 1 for ordinary extents and for a mesh without extent.
    pub fn scale_unit(&self) -> f64 {
        if self.faces().is_empty() || self.is_ordinary() {
            return 1.0;
        }
        let p = self.positions();
        let mut corners = self.faces().as_flattened().iter().map(|&v| p[v as usize]);
        let first = corners.next().unwrap_or_default();
        let [lo, hi] = corners.fold([first; 2], |[lo, hi], q| {
            [0, 1].map(|i| {
                std::array::from_fn(|k| if i == 0 { q[k].min(lo[k]) } else { q[k].max(hi[k]) })
            })
        });
        let half = (0..3).map(|k| 0.5 * hi[k] - 0.5 * lo[k]).fold(0.0, f64::max);
        if half == 0.0 || ORDINARY.contains(&(2.0 * half)) { 1.0 } else { power_of_two(half) }
    }

    /// The mesh divided by a power of two, without a copy for 1.
    pub fn divided_by(&self, unit: f64) -> Cow<'_, Self> {
        if unit == 1.0 {
            return Cow::Borrowed(self);
        }
        let within = |x: f64| (x / unit).clamp(-f64::MAX, f64::MAX);
        let mut scaled = self.clone();
        scaled.positions_mut().iter_mut().for_each(|p| *p = p.map(within));
        Cow::Owned(scaled)
    }

    /// Whether the extent is ordinary for certain, in a pass over the vertices
    /// and usually one face.
    fn is_ordinary(&self) -> bool {
        let Some([lo, hi]) = self.bounding_box() else { return true };
        // Of all vertices, which is not smaller than that of the faces'.
        if (0..3).any(|k| 0.5 * hi[k] - 0.5 * lo[k] > 0.5 * ORDINARY.end()) {
            return false;
        }
        (0..self.face_count()).any(|f| {
            let [a, b, c] = self.triangle(f);
            (0..3).any(|k| (b[k] - a[k]).abs().max((c[k] - a[k]).abs()) >= *ORDINARY.start())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn scaled(exponent: i32, isolated: Option<f64>) -> TriMesh {
        let sphere = shapes::icosphere(1);
        let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        let mut positions: Vec<_> =
            sphere.positions().iter().map(|p| p.map(|x| x * unit)).collect();
        positions.extend(isolated.map(|x| [x, 0.0, -x]));
        TriMesh::new(positions, sphere.faces().to_vec()).unwrap()
    }

    #[test]
    fn ordinary_sizes_are_kept_and_others_come_near_one() {
        for exponent in [-60, -1, 0, 20, 62] {
            let mesh = scaled(exponent, None);
            assert!(matches!(mesh.at_unit_scale(), (Cow::Borrowed(_), 1.0)), "2^{exponent}");
        }
        for exponent in [-900, -300, -70, 70, 300, 1000] {
            for isolated in [None, Some(0.5), Some(1e300), Some(1e-300)] {
                let mesh = scaled(exponent, isolated);
                let (near_one, unit) = mesh.at_unit_scale();
                let diagonal = (0..near_one.face_count())
                    .map(|f| crate::vec3::norm(near_one.triangle(f)[0]))
                    .fold(0.0, f64::max);
                assert!((0.5..4.0).contains(&diagonal), "2^{exponent} {isolated:?} {diagonal}");
                let faces = mesh.faces().as_flattened().iter().map(|&v| v as usize);
                for v in faces {
                    assert_eq!(near_one.positions()[v].map(|x| x * unit), mesh.positions()[v]);
                }
            }
        }
        let largest = TriMesh::new(
            vec![[f64::MAX; 3], [-f64::MAX; 3], [f64::MAX, 0.0, 1.0]],
            vec![[0, 1, 2]],
        );
        let largest = largest.unwrap();
        assert!(
            largest.at_unit_scale().0.positions().as_flattened().iter().all(|x| x.abs() <= 2.0)
        );
    }

    #[test]
    fn without_extent_there_is_nothing_to_scale() {
        let point = TriMesh::new(vec![[1e-300; 3]; 3], vec![[0, 1, 2]]).unwrap();
        let none = TriMesh::new(vec![[1e-300; 3], [1e300; 3]], vec![]).unwrap();
        assert_eq!((point.scale_unit(), none.scale_unit()), (1.0, 1.0));
    }
}
