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
    /// the faces leaves the mesh unchanged, with the power 1; others come near
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

    /// Whether the extent is ordinary for certain, in a pass over the
    /// coordinates and usually one face.
    fn is_ordinary(&self) -> bool {
        // No two coordinates this small are farther apart than an extent may be. Written without a branch: vector
        // instructions compare several at a time.
        let near = 0.5 * ORDINARY.end();
        let all = self.positions().as_flattened().iter();
        if all.fold(false, |far, x| far | (x.abs() > near)) {
            return false;
        }
        (0..self.face_count()).any(|f| {
            let [a, b, c] = self.triangle(f);
            (0..3).any(|k| (b[k] - a[k]).abs().max((c[k] - a[k]).abs()) >= *ORDINARY.start())
        })
    }
}
