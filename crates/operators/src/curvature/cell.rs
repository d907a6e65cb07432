//! Sums over the faces of a vertex, gathered in one pass.

use std::f64::consts::{PI, TAU};

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use crate::corners::FaceCorners;
use crate::fan::Fan;
use crate::kind::LumpedArea;

/// Vertices handed to a thread at a time.
const VERTICES_PER_TASK: usize = 2048;

/// The surroundings of a vertex, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Links {
    /// The faces at the vertex.
    pub(crate) faces: u32,
    /// The edges at the vertex, each once.
    pub(crate) edges: u32,
    /// True if an edge at the vertex has only one face.
    pub(crate) boundary: bool,
}

/// Sums over the corners at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    /// `Δx` by cotangents, integrated, in mesh units: a row of `−S x`.
    pub(crate) laplacian: DVec3,
    /// The area, in squared mesh units.
    pub(crate) area: f64,
    /// The sum of the area vectors of the faces.
    pub(crate) normal: DVec3,
    /// The sum of the angles, in radians.
    pub(crate) angles: f64,
    pub(crate) links: Links,
}

impl Cell {
    /// The angle defect `(2 − e + f) π − Σ θ`.
    #[inline]
    pub(crate) fn defect(&self) -> f64 {
        self.links.defect(self.angles)
    }
}

impl Links {
    #[inline]
    pub(crate) fn new(fan: &Fan, faces: usize) -> Self {
        Self {
            faces: faces as u32,
            edges: fan.neighbors.len() as u32,
            boundary: fan.has_boundary_edge(),
        }
    }

    /// The angle defect `(2 − e + f) π − Σ θ`; zero for an isolated vertex.
    #[inline]
    pub(crate) fn defect(&self, angles: f64) -> f64 {
        if self.faces == 0 {
            return 0.0;
        }
        (2.0 - f64::from(self.edges) + f64::from(self.faces)) * PI - angles
    }
}

/// Sums over the faces of each vertex, in vertex order, and maps each sum.
///
/// Each face is computed once for each of its corners: cheaper than to store
/// and load it. The faces have [passed](crate::check_faces) as sound.
pub(crate) fn map_cells<T: Send>(
    mesh: &TriMesh,
    area: LumpedArea,
    of: impl Fn(&Cell) -> T + Sync + Send,
) -> Vec<T> {
    let (positions, incidence) = (mesh.positions(), mesh.incidence());
    let gather = |fan: &mut Fan, v: u32| {
        let at = |w: u32| DVec3::from(positions[w as usize]);
        let (sides, centre) = (incidence.sides(v), at(v));
        fan.gather(sides.iter().copied());
        let mut cell = Cell {
            laplacian: DVec3::ZERO,
            area: 0.0,
            normal: DVec3::ZERO,
            angles: 0.0,
            links: Links::new(fan, sides.len()),
        };
        let mut turns = Turns::default();
        for side in sides {
            let [to_next, to_previous] = side.map(|w| at(w) - centre);
            let (face, normal) = FaceCorners::from_sides(to_next, to_previous);
            let half = face.half_cotangents();
            let pull = half[2] * to_next + half[1] * to_previous;
            cell.laplacian += pull;
            cell.area += area.sound_shares(&face)[0];
            cell.normal += 0.5 * normal;
            turns.add(face.turn(0));
        }
        cell.angles = turns.sum();
        of(&cell)
    };
    let at = |fan: &mut Fan, v: usize| gather(fan, v as u32);
    parallel::map_with(mesh.vertex_count(), VERTICES_PER_TASK, Fan::default, at)
}

/// A sum of angles between 0 and π.
///
/// The angles are multiplied as complex numbers and full turns counted, so
/// that a vertex costs one arc tangent instead of one per corner.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turns {
    re: f64,
    im: f64,
    full: u32,
}

impl Default for Turns {
    fn default() -> Self {
        Self { re: 1.0, im: 0.0, full: 0 }
    }
}

impl Turns {
    /// Adds the angle of `(x, y)`, y ≥ 0, not both zero.
    #[inline]
    pub(crate) fn add(&mut self, (x, y): (f64, f64)) {
        let two_halves = self.im == 0.0 && self.re < 0.0 && y == 0.0 && x < 0.0;
        let lower = self.im < 0.0;
        let re = self.re * x - self.im * y;
        // Adding zero turns −0 into 0, whose arc tangent is not −π.
        let im = self.re * y + self.im * x + 0.0;
        // An angle of at most π passes a full turn only out of the lower half
        // plane, unless both are exactly π.
        self.full += u32::from((lower && im >= 0.0) || two_halves);
        (self.re, self.im) = (re, im);
        let size = re.abs() + im.abs();
        if !(1e-100..1e100).contains(&size) {
            // Products of large or small lengths must not leave the range; by a
            // power of two, which rounds nothing.
            let unit = power_of_two(size);
            (self.re, self.im) = (re / unit, im / unit);
        }
    }

    /// The sum, in radians.
    #[inline]
    pub(crate) fn sum(&self) -> f64 {
        let angle = libm::atan2(self.im, self.re);
        f64::from(self.full) * TAU + if angle < 0.0 { angle + TAU } else { angle }
    }
}

/// The largest power of two that is a normal number and at most `x`, or the smallest normal number.
/// Multiplication and division by it do not round.
///
/// `x` must be positive and finite.
#[inline]
fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_turns_are_counted() {
        let (mut turns, mut sum) = (Turns::default(), 0.0);
        for i in 0..500 {
            let (angle, size) = (f64::from(i) * 0.006, 10f64.powi(i % 60 - 20));
            turns.add((size * angle.cos(), size * angle.sin()));
            sum += angle;
            // One rounding per factor.
            assert!((turns.sum() - sum).abs() < 1e-13 * f64::from(i + 1), "{i}");
        }
        assert!(sum > 700.0);
    }

    #[test]
    fn half_turns_land_on_the_cut() {
        let mut turns = Turns::default();
        for count in 1..6 {
            turns.add((-2.0, 0.0));
            assert_eq!(turns.sum(), PI * f64::from(count));
        }
    }

    #[test]
    fn powers_of_two_are_below() {
        for (x, unit) in [(1.0, 1.0), (1.99, 1.0), (0.3, 0.25), (1e-320, f64::MIN_POSITIVE)] {
            assert_eq!(power_of_two(x), unit);
        }
        assert_eq!(power_of_two(f64::MAX), 2f64.powi(1023));
    }
}
