//! Area, volume and the lengths of edges.

use rayon::prelude::*;

use crate::TriMesh;
use crate::vec3::{add, cross, distance, dot, scale, sub};

/// Elements per partial sum; fixed, so that sums do not depend on the number
/// of threads.
const CHUNK: usize = 4096;

impl TriMesh {
    /// The area of the surface, `Σ |A_f|`, in squared mesh units.
    pub fn area(&self) -> f64 {
        self.sum_over_faces(|f| self.face_area(f))
    }

    /// The volume that the surface encloses, in cubed mesh units:
    ///
    /// ```text
    /// V = ⅙ Σ (a − o) · (b − a) × (c − a)
    /// ```
    ///
    /// over the faces `abc`, with `o` the middle of the bounding box, so that
    /// a body far from the origin loses no digits. Positive where the faces
    /// turn counter-clockwise seen from outside. Meaningful for a closed,
    /// consistently oriented surface only: otherwise it depends on `o`.
    pub fn signed_volume(&self) -> f64 {
        let Some([lo, hi]) = self.bounding_box() else { return 0.0 };
        let o = scale(add(lo, hi), 0.5);
        self.sum_over_faces(|f| {
            let [a, b, c] = self.triangle(f);
            dot(sub(a, o), cross(sub(b, a), sub(c, a))) / 6.0
        })
    }

    /// A bound of the rounding of [`signed_volume`](Self::signed_volume), in
    /// cubed mesh units: a volume that is not larger cannot be told from none,
    /// and has no ratio to another.
    ///
    /// With n the number of roundings that a term goes through in its products
    /// and sums, it is `n ε Σ ‖a − o‖ ‖b − a‖ ‖c − a‖ / 6`. A closed sheet of
    /// thickness τ and radius r has a volume for τ/r above some 10⁻¹².
    pub fn volume_rounding(&self) -> f64 {
        let Some([lo, hi]) = self.bounding_box() else { return 0.0 };
        let o = scale(add(lo, hi), 0.5);
        let terms = self.sum_over_faces(|f| {
            let [a, b, c] = self.triangle(f);
            distance(a, o) * distance(a, b) * distance(a, c) / 6.0
        });
        // Ten in a term, and those of the sums over a chunk and over chunks.
        let roundings = 10 + self.face_count().min(CHUNK) + self.face_count() / CHUNK;
        roundings as f64 * f64::EPSILON * terms
    }

    /// The length of each edge of the topology, in mesh units.
    pub fn edge_lengths(&self) -> Vec<f64> {
        let positions = self.positions();
        let edges = self.topology().edges();
        edges
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&[a, b]| distance(positions[a as usize], positions[b as usize]))
            .collect()
    }

    /// The unit normal of each face, outward; `None` where the face has no
    /// area.
    pub fn face_normals(&self) -> Vec<Option<[f64; 3]>> {
        (0..self.face_count())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|f| crate::vec3::normalize(self.area_vector(f)))
            .collect()
    }

    /// The sum of a quantity over the faces, by parts of fixed size.
    fn sum_over_faces(&self, quantity: impl Fn(usize) -> f64 + Sync) -> f64 {
        let count = self.face_count();
        let parts: Vec<f64> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|i| (i * CHUNK..((i + 1) * CHUNK).min(count)).map(&quantity).sum())
            .collect();
        parts.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use crate::shapes;

    /// An inscribed polyhedron is short of the sphere by O(h²): each level
    /// divides the error by four.
    #[test]
    fn area_and_volume_of_a_sphere_converge() {
        let errors: Vec<[f64; 2]> = (2..=5)
            .map(|level| {
                let sphere = shapes::icosphere(level);
                let pi = std::f64::consts::PI;
                [4.0 * pi - sphere.area(), 4.0 / 3.0 * pi - sphere.signed_volume()]
            })
            .collect();
        for pair in errors.windows(2) {
            for k in 0..2 {
                let order = (pair[0][k] / pair[1][k]).log2();
                assert!((1.97..2.01).contains(&order), "{order} in {errors:?}");
            }
        }
    }

    /// A sheet has no volume, though rounding gives it one; a plate of a
    /// millionth of its width has.
    #[test]
    fn volumes_below_their_rounding_are_told_from_thin_bodies() {
        let mut plate = shapes::cube(6, shapes::Diagonals::Alternating);
        for turn in 0..40 {
            let (s, c) = f64::from(turn).sin_cos();
            for (thickness, thin) in [(0.0, true), (1e-6, false), (1.0, false)] {
                let cube = shapes::cube(6, shapes::Diagonals::Alternating);
                let positions = cube.positions().iter().map(|&[x, y, z]| {
                    let z = thickness * z;
                    let (x, z) = (c * x - s * z, s * x + c * z);
                    [c * x - s * y + 3.0, s * x + c * y, z]
                });
                plate = plate.with_positions(positions.collect()).unwrap();
                let (volume, rounding) = (plate.signed_volume().abs(), plate.volume_rounding());
                assert_eq!(volume <= rounding, thin, "{thickness} {volume} {rounding}");
            }
        }
    }

    /// Moving a body by 10⁷ of its size leaves 16 − 7 = 9 digits of each
    /// coordinate, and the volume must not lose more.
    #[test]
    fn volume_far_from_the_origin() {
        let sphere = shapes::icosphere(3);
        let moved = sphere.positions().iter().map(|p| p.map(|x| x + 1e7)).collect();
        let moved = sphere.with_positions(moved).unwrap();
        assert!((moved.signed_volume() - sphere.signed_volume()).abs() < 1e-7);
    }
}
