//! Area and volume with their centroids and inertia.

use glam::{DMat3, DVec3};

use crate::trimesh::TriMesh;

/// Size, centroid and inertia of a surface or of a solid, of density 1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Moments {
    /// The area in squared, or the volume in cubed mesh units; not negative.
    pub measure: f64,
    /// The centroid, `∫ x / measure`, in mesh units.
    pub centroid: [f64; 3],
    /// The inertia about the centroid, `∫ (|x|² I − x xᵀ)` with x measured from it: symmetric and
    /// positive semi-definite, in mesh units to the power of four for a surface, five for a solid.
    pub inertia: [[f64; 3]; 3],
}

impl TriMesh {
    /// Area, centroid and inertia of the surface, as a thin shell.
    ///
    /// `None` if the area is zero.
    pub fn surface_moments(&self) -> Option<Moments> {
        // Over a triangle ∫ x = A s / 3 and ∫ x xᵀ = A (s sᵀ + Σ p pᵀ) / 12, s the sum of corners.
        let moments = self.moments([1.0 / 3.0, 1.0 / 12.0], |f, _| self.face_area(f));
        moments.filter(|found| found.measure > 0.0)
    }

    /// Volume, centroid and inertia of the enclosed solid.
    ///
    /// Faces count as [oriented](Self::oriented); a surface that is inside out encloses the same
    /// solid. `None` unless the surface is closed and orientable, with a volume above its
    /// [rounding](Self::volume_rounding).
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::TriMesh;
    ///
    /// let corners = vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let solid = TriMesh::new(corners, faces)?.volume_moments().unwrap();
    /// assert!((solid.measure - 32.0 / 3.0).abs() < 1e-14);
    /// assert!(solid.centroid.iter().all(|x| (x - 1.0).abs() < 1e-14));
    /// # Ok::<(), fairing_mesh::BuildError>(())
    /// ```
    #[doc(alias("center_mass", "moment_inertia"))]
    pub fn volume_moments(&self) -> Option<Moments> {
        let topology = self.topology();
        if !topology.is_closed() || !topology.orientation().is_orientable() {
            return None;
        }
        // Over a tetrahedron from the origin ∫ x = V s / 4 and ∫ x xᵀ = V (s sᵀ + Σ p pᵀ) / 20.
        let volume = |_, [a, b, c]: [DVec3; 3]| a.dot((b - a).cross(c - a)) / 6.0;
        let moments = self.oriented().moments([0.25, 0.05], volume);
        moments.filter(|found| found.measure > self.volume_rounding())
    }

    /// Sums moments of parts, one to each face, from their measures: a part is a triangle, or the
    /// tetrahedron of a face and the centre of the bounding box.
    fn moments(
        &self,
        [first, second]: [f64; 2],
        measure: impl Fn(usize, [DVec3; 3]) -> f64 + Sync,
    ) -> Option<Moments> {
        let [lo, hi] = self.bounding_box()?.map(DVec3::from);
        let o = 0.5 * (lo + hi);
        let sums = self.sums_over_faces(|f| {
            let corners = self.triangle(f).map(|p| DVec3::from(p) - o);
            let (part, s) = (measure(f, corners), corners.into_iter().sum::<DVec3>());
            let product = |i: usize, j: usize| {
                let corners: f64 = corners.iter().map(|p| p[i] * p[j]).sum();
                part * second * (s[i] * s[j] + corners)
            };
            let at = |i: usize| part * first * s[i];
            let (xx, yy, zz) = (product(0, 0), product(1, 1), product(2, 2));
            [part, at(0), at(1), at(2), xx, yy, zz, product(0, 1), product(1, 2), product(2, 0)]
        });
        let sign = 1f64.copysign(sums[0]);
        let [total, x, y, z, xx, yy, zz, xy, yz, zx] = sums.map(|sum| sign * sum);
        let c = DVec3::new(x, y, z) / total;
        let about_o = DMat3::from_cols_array(&[xx, xy, zx, xy, yy, yz, zx, yz, zz]);
        let spread = about_o - DMat3::from_cols(c * c.x, c * c.y, c * c.z) * total;
        let trace = spread.x_axis.x + spread.y_axis.y + spread.z_axis.z;
        let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - spread;
        let moments = Moments {
            measure: total,
            centroid: (o + c).to_array(),
            inertia: inertia.to_cols_array_2d(),
        };
        (total > 0.0).then_some(moments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of sides 2, 4 and 6 about the point (10, 20, 30).
    fn cuboid(flip: bool) -> TriMesh {
        let at = |i: u32| {
            let side = |k: u32, half: f64| if i >> k & 1 == 1 { half } else { -half };
            [10.0 + side(0, 1.0), 20.0 + side(1, 2.0), 30.0 + side(2, 3.0)]
        };
        let squares =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let split = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        let turn = |[a, b, c]: [u32; 3]| if flip { [a, c, b] } else { [a, b, c] };
        let faces = squares.into_iter().flat_map(split).map(turn).collect();
        TriMesh::new((0..8).map(at).collect(), faces).unwrap()
    }

    #[test]
    fn moments_of_a_box() {
        for flip in [false, true] {
            let solid = cuboid(flip).volume_moments().unwrap();
            assert!((solid.measure - 48.0).abs() < 1e-12);
            let shell = cuboid(flip).surface_moments().unwrap();
            assert!((shell.measure - 88.0).abs() < 1e-12);
            for found in [solid, shell] {
                let middle = [10.0, 20.0, 30.0];
                assert!(found.centroid.iter().zip(middle).all(|(x, y)| (x - y).abs() < 1e-13));
            }
            // V (b² + c²) / 12 about the axis of side a.
            let expected = [48.0 * 52.0 / 12.0, 48.0 * 40.0 / 12.0, 48.0 * 20.0 / 12.0];
            for i in 0..3 {
                for j in 0..3 {
                    let wanted = if i == j { expected[i] } else { 0.0 };
                    assert!((solid.inertia[i][j] - wanted).abs() < 1e-11, "{i} {j}");
                }
            }
            // ∫ x² over the six sides: 2·24·1², and 4/12 of the area of the other four, 64.
            let squares =
                [48.0 + 64.0 / 3.0, 24.0 * 4.0 + 64.0 * 16.0 / 12.0, 16.0 * 9.0 + 72.0 * 3.0];
            let wanted = squares[1] + squares[2];
            assert!((shell.inertia[0][0] - wanted).abs() < 1e-10, "{:?} {wanted}", shell.inertia);
        }
    }

    #[test]
    fn open_and_empty_surfaces_have_no_volume() {
        let open = cuboid(false);
        let faces = open.faces()[1..].to_vec();
        let open = TriMesh::new(open.into_positions(), faces).unwrap();
        assert_eq!(open.volume_moments(), None);
        assert!(open.surface_moments().is_some());
        let point = TriMesh::new(vec![[1.0; 3]], vec![]).unwrap();
        assert_eq!((point.surface_moments(), point.volume_moments()), (None, None));
    }
}
