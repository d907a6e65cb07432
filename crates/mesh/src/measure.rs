//! Area, volume and the lengths of edges.

use fairing_watch::parallel;
use glam::DVec3;

use crate::trimesh::TriMesh;

/// Elements per partial sum; fixed, so that sums do not depend on the number
/// of threads.
const CHUNK: usize = 4096;

impl TriMesh {
    /// The area of the surface, `Σ |A_f|`, in squared mesh units.
    #[doc(alias = "surface_area")]
    pub fn area(&self) -> f64 {
        self.sum_over_faces(|f| self.face_area(f))
    }

    /// The volume that the surface encloses, in cubed mesh units:
    ///
    /// ```text
    /// V = ⅙ Σ (a − o) · (b − a) × (c − a)
    /// ```
    ///
    /// over the faces `abc`, with `o` the centre of the bounding box, so that
    /// a surface far from the origin loses no digits. Faces count as
    /// [oriented](Self::oriented); the volume is positive if they turn
    /// counter-clockwise seen from outside. Meaningful only for a closed surface
    /// without [one-sided](Self::one_sided_faces) parts: otherwise it depends on `o`.
    #[doc(alias = "volume")]
    pub fn signed_volume(&self) -> f64 {
        let Some(corners) = self.bounding_box() else { return 0.0 };
        let [lo, hi] = corners.map(DVec3::from);
        let o = 0.5 * (lo + hi);
        let mesh = self.oriented();
        mesh.sum_over_faces(|f| {
            let [a, b, c] = mesh.triangle(f).map(DVec3::from);
            (a - o).dot((b - a).cross(c - a)) / 6.0
        })
    }

    /// A bound on the rounding error of [`signed_volume`](Self::signed_volume), in
    /// cubed mesh units. A volume below the bound cannot be distinguished from zero,
    /// so ratios to it are meaningless.
    ///
    /// The bound is `n ε Σ ‖a − o‖ ‖b − a‖ ‖c − a‖ / 6`, with n the number of
    /// roundings of a term in its products and sums. The volume of a closed sheet of
    /// thickness τ and radius r exceeds the bound for τ/r above about 10⁻¹².
    pub fn volume_rounding(&self) -> f64 {
        let Some(corners) = self.bounding_box() else { return 0.0 };
        let [lo, hi] = corners.map(DVec3::from);
        let o = 0.5 * (lo + hi);
        let terms = self.sum_over_faces(|f| {
            let [a, b, c] = self.triangle(f).map(DVec3::from);
            a.distance(o) * a.distance(b) * a.distance(c) / 6.0
        });
        // Ten in a term, then one for each addition in a chunk and over chunks.
        let roundings = 10 + self.face_count().min(CHUNK) + self.face_count() / CHUNK;
        roundings as f64 * f64::EPSILON * terms
    }

    /// The length of each edge of the topology, in mesh units.
    pub fn edge_lengths(&self) -> Vec<f64> {
        let positions = self.positions();
        let edges = self.topology().edges();
        parallel::map(edges.len(), CHUNK, |i| {
            let ends = &edges[i];
            let [a, b] = ends.map(|v| DVec3::from(positions[v as usize]));
            a.distance(b)
        })
    }

    /// Sums a quantity over the faces, in chunks of fixed size.
    fn sum_over_faces(&self, quantity: impl Fn(usize) -> f64 + Sync) -> f64 {
        let [sum] = self.sums_over_faces(|f| [quantity(f)]);
        sum
    }

    /// Sums several quantities over the faces, in chunks of fixed size.
    pub(crate) fn sums_over_faces<const N: usize>(
        &self,
        quantities: impl Fn(usize) -> [f64; N] + Sync,
    ) -> [f64; N] {
        let count = self.face_count();
        let add = |sum: [f64; N], more: [f64; N]| std::array::from_fn(|i| sum[i] + more[i]);
        let parts: Vec<[f64; N]> = parallel::map(count.div_ceil(CHUNK), 1, |i| {
            let faces = i * CHUNK..((i + 1) * CHUNK).min(count);
            faces.map(&quantities).fold([0.0; N], add)
        });
        parts.into_iter().fold([0.0; N], add)
    }
}
