//! Angles, areas and products at the corners of faces, shared by all operators.

use std::sync::atomic::{AtomicUsize, Ordering};

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use crate::error::{MIN_HEIGHT_RATIO, OperatorError};

/// Faces per task: large enough to hide the cost of scheduling.
const FACES_PER_TASK: usize = 4096;

/// Inner products at the corners of a face, and its area.
///
/// With θₖ the angle at corner k, `dots[k] = ab cos θₖ` and `twice_area = ab
/// sin θₖ` for the two sides a and b that meet there; both angles and
/// cotangents follow without another root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FaceCorners {
    pub(crate) dots: [f64; 3],
    pub(crate) twice_area: f64,
}

impl FaceCorners {
    #[inline]
    pub(crate) fn new(triangle: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = triangle.map(DVec3::from);
        let (ab, bc, ca) = (b - a, c - b, a - c);
        Self { dots: [-ab.dot(ca), -bc.dot(ab), -ca.dot(bc)], twice_area: ab.cross(ca).length() }
    }

    /// The face of two sides that leave corner 0, the next one first, and the
    /// cross product of the sides.
    #[inline]
    pub(crate) fn from_sides(next: DVec3, previous: DVec3) -> (Self, DVec3) {
        let (across, normal) = (previous - next, next.cross(previous));
        let dots = [next.dot(previous), -next.dot(across), previous.dot(across)];
        (Self { dots, twice_area: normal.length() }, normal)
    }

    /// cot θₖ; not finite where the face has no area.
    #[inline]
    pub(crate) fn cotangents(&self) -> [f64; 3] {
        let s = 1.0 / self.twice_area;
        self.dots.map(|d| d * s)
    }

    /// ½ cot θₖ, the share of the face in the weight of the edge opposite corner k:
    /// the only formula for edge weights.
    #[inline]
    pub(crate) fn half_cotangents(&self) -> [f64; 3] {
        self.cotangents().map(|cot| 0.5 * cot)
    }

    /// The area of the face.
    #[inline]
    pub(crate) fn area(&self) -> f64 {
        0.5 * self.twice_area
    }

    /// A third of the area: the barycentric mass of each corner.
    #[inline]
    pub(crate) fn third(&self) -> f64 {
        self.area() / 3.0
    }

    /// The squared length of the side opposite each corner.
    #[inline]
    pub(crate) fn squared_sides(&self) -> [f64; 3] {
        let [a, b, c] = self.dots;
        [b + c, c + a, a + b]
    }

    /// Cosine and sine of the angle at corner `k`, both times the same positive
    /// number.
    ///
    /// The angle of a face that is a segment with two coinciding corners, or a
    /// point, is undetermined; the limits of isosceles and of equilateral triangles
    /// are used (π/2, π/3), so that the angles of every face sum to π.
    #[inline]
    pub(crate) fn turn(&self, k: usize) -> (f64, f64) {
        let (x, y) = (self.dots[k], self.twice_area);
        if x != 0.0 || y != 0.0 {
            return (x, y);
        }
        if self.dots == [0.0; 3] { (0.5, 0.75f64.sqrt()) } else { (0.0, 1.0) }
    }

    /// Returns true if the face is too thin for its cotangents to be meaningful.
    #[inline]
    pub(crate) fn is_degenerate(&self) -> bool {
        let longest = self.squared_sides().into_iter().fold(0.0, f64::max);
        // Written so that a face that is not finite is degenerate too.
        !(self.twice_area >= MIN_HEIGHT_RATIO * longest && self.twice_area > 0.0)
    }
}

/// Maps every face, in face order; fails on the first degenerate one.
pub(crate) fn map_sound_faces<T: Send>(
    mesh: &TriMesh,
    of: impl Fn(FaceCorners) -> T + Sync,
) -> Result<Vec<T>, OperatorError> {
    let positions = mesh.positions();
    // The first one, whichever thread finds another before.
    let first = AtomicUsize::new(usize::MAX);
    let all = parallel::map(mesh.faces().len(), FACES_PER_TASK, |f| {
        let face = &mesh.faces()[f];
        let corners = FaceCorners::new(face.map(|v| positions[v as usize]));
        if corners.is_degenerate() {
            first.fetch_min(f, Ordering::Relaxed);
        }
        of(corners)
    });
    match first.into_inner() {
        usize::MAX => Ok(all),
        face => Err(degenerate(face, &FaceCorners::new(mesh.triangle(face)))),
    }
}

/// Checks that every face has cotangents, as [`cotan_stiffness`](crate::cotan_stiffness)
/// does, without assembling a matrix.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face that is too thin.
pub fn check_faces(mesh: &TriMesh) -> Result<(), OperatorError> {
    map_sound_faces(mesh, |_| ())?;
    Ok(())
}

/// The error that names face `face`.
pub(crate) fn degenerate(face: usize, corners: &FaceCorners) -> OperatorError {
    OperatorError::DegenerateFace {
        face: face as u32,
        area: corners.area(),
        edge: corners.squared_sides().into_iter().fold(0.0, f64::max).max(0.0).sqrt(),
    }
}

/// The corner after `c` in its face.
#[inline]
pub(crate) fn next(c: u32) -> u32 {
    if c % 3 == 2 { c - 2 } else { c + 1 }
}

/// The corner before `c` in its face.
#[inline]
pub(crate) fn previous(c: u32) -> u32 {
    if c.is_multiple_of(3) { c + 2 } else { c - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_a_right_triangle() {
        let c = FaceCorners::new([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
        assert_eq!(c.dots, [0.0, 9.0, 16.0]);
        assert_eq!(c.twice_area, 12.0);
        assert_eq!(c.squared_sides(), [25.0, 16.0, 9.0]);
        assert_eq!(c.turn(0), (0.0, 12.0));
        assert!(!c.is_degenerate());
    }

    #[test]
    fn angles_of_collapsed_faces_sum_to_pi() {
        let p = [1.0, 2.0, 3.0];
        let q = [2.0, 2.0, 3.0];
        for face in [[p, p, p], [p, p, q], [p, q, q], [p, q, p], [p, q, [5.0, 2.0, 3.0]]] {
            let c = FaceCorners::new(face);
            assert!(c.is_degenerate());
            let sum: f64 = (0..3).map(|k| c.turn(k)).map(|(x, y)| y.atan2(x)).sum();
            assert!((sum - std::f64::consts::PI).abs() < 1e-15, "{face:?} {sum}");
        }
    }

    #[test]
    fn the_first_degenerate_face_is_named() {
        let positions = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [0, 3, 1], [0, 1, 3]]).unwrap();
        let error = map_sound_faces(&mesh, |_| ()).unwrap_err();
        assert_eq!(error, OperatorError::DegenerateFace { face: 1, area: 0.0, edge: 2.0 });
    }

    #[test]
    fn corners_turn_within_their_face() {
        assert_eq!([3, 4, 5].map(next), [4, 5, 3]);
        assert_eq!([3, 4, 5].map(previous), [5, 3, 4]);
    }
}
