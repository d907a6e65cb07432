//! Boundary vertices that slide along the boundary curve of the input.

use fairing_mesh::TriMesh;
use glam::DVec3;

/// The cosine of 45°: vertices at sharper turns are corners and fixed.
const CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The boundary curves of a mesh and the locations of the vertices sliding on them.
#[derive(Debug, Clone)]
pub(crate) struct Sliding {
    curves: Vec<Curve>,
    /// The sliding vertices.
    beads: Vec<Bead>,
    /// The index of the bead of each vertex plus one; zero for vertices that do not slide.
    bead_of: Vec<u32>,
}

/// A closed polygon: a boundary loop of the input.
#[derive(Debug, Clone)]
struct Curve {
    points: Vec<DVec3>,
}

#[derive(Debug, Clone)]
struct Bead {
    vertex: u32,
    curve: u32,
    /// The segment that holds the vertex, from point `segment` to the next.
    segment: u32,
    /// The direction of movement in this step, of length one or zero.
    tangent: DVec3,
}

impl Sliding {
    /// Creates curves from the boundary loops of `mesh`; marks corners and vertices where loops
    /// meet as `fixed`.
    pub(crate) fn new(mesh: &TriMesh, fixed: &mut [bool]) -> Self {
        let topology = mesh.topology();
        let x = mesh.positions();
        let mut visits = vec![0u32; x.len()];
        for &v in topology.boundary_loops().iter().flatten() {
            visits[v as usize] += 1;
        }
        for (v, &boundary) in topology.boundary_vertices().iter().enumerate() {
            // Zero visits: the loop through the vertex is not simple.
            fixed[v] |= boundary && visits[v] != 1;
        }
        let mut sliding = Self { curves: Vec::new(), beads: Vec::new(), bead_of: vec![0; x.len()] };
        for ring in topology.boundary_loops() {
            let points: Vec<DVec3> = ring.iter().map(|&v| x[v as usize].into()).collect();
            let curve = sliding.curves.len() as u32;
            for (k, &vertex) in ring.iter().enumerate() {
                let v = vertex as usize;
                let before = points[(k + ring.len() - 1) % ring.len()];
                let after = points[(k + 1) % ring.len()];
                let straight = (points[k] - before)
                    .try_normalize()
                    .zip((after - points[k]).try_normalize())
                    .is_some_and(|(a, b)| a.dot(b) > CORNER);
                if fixed[v] || !straight {
                    fixed[v] = true;
                    continue;
                }
                sliding.beads.push(Bead { vertex, curve, segment: k as u32, tangent: DVec3::ZERO });
                sliding.bead_of[v] = sliding.beads.len() as u32;
            }
            sliding.curves.push(Curve { points });
        }
        sliding
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.beads.is_empty()
    }

    /// The component of `d` along the tangent for a sliding vertex; `d` for any other.
    #[inline]
    pub(crate) fn project(&self, i: usize, d: [f64; 3]) -> [f64; 3] {
        match self.bead_of[i] {
            0 => d,
            bead => {
                let t = self.beads[bead as usize - 1].tangent;
                (t.dot(d.into()) * t).to_array()
            }
        }
    }

    /// Sets the tangent of each bead: the direction of its segment, or, at a point of the curve,
    /// the mean direction of the two segments that meet there.
    pub(crate) fn take_tangents(&mut self, x: &[[f64; 3]]) {
        for bead in &mut self.beads {
            let points = &self.curves[bead.curve as usize].points;
            let n = points.len();
            let s = bead.segment as usize;
            let [a, b] = [points[s], points[(s + 1) % n]];
            let here = DVec3::from(x[bead.vertex as usize]);
            let along = b - a;
            let near = 1e-6 * a.distance(b);
            let sum = if here.distance(a) <= near {
                along.normalize_or_zero() + (a - points[(s + n - 1) % n]).normalize_or_zero()
            } else if here.distance(b) <= near {
                along.normalize_or_zero() + (points[(s + 2) % n] - b).normalize_or_zero()
            } else {
                along
            };
            bead.tangent = sum.normalize_or_zero();
        }
    }

    /// Moves each bead to the nearest point of its curve, searching outward from its segment while
    /// the distance decreases, so that it cannot jump to another part of the curve.
    pub(crate) fn retract(&mut self, x: &mut [[f64; 3]]) {
        for bead in &mut self.beads {
            let points = &self.curves[bead.curve as usize].points;
            let p = DVec3::from(x[bead.vertex as usize]);
            let mut best = nearest(points, bead.segment as usize, p);
            let mut best_segment = bead.segment as usize;
            for direction in [1, points.len() - 1] {
                let mut segment = bead.segment as usize;
                // One segment without progress is skipped: a bead may sit at the end of its own.
                let mut patience = 2;
                for _ in 1..points.len() {
                    segment = (segment + direction) % points.len();
                    let candidate = nearest(points, segment, p);
                    if candidate.distance(p) < best.distance(p) {
                        (best, best_segment, patience) = (candidate, segment, 2);
                    } else {
                        patience -= 1;
                        if patience == 0 {
                            break;
                        }
                    }
                }
            }
            x[bead.vertex as usize] = best.to_array();
            bead.segment = best_segment as u32;
        }
    }
}

/// The point of a segment nearest to `p`.
fn nearest(points: &[DVec3], segment: usize, p: DVec3) -> DVec3 {
    let [a, b] = [points[segment], points[(segment + 1) % points.len()]];
    let along = b - a;
    let square = along.dot(along);
    if square == 0.0 {
        return a;
    }
    let t = ((p - a).dot(along) / square).clamp(0.0, 1.0);
    a + t * along
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vertex of a regular polygon moves perpendicular to its radius, not along one of its sides.
    #[test]
    fn tangents_at_corners_are_the_mean_of_both_sides() {
        let n = 12;
        let at = |i: u32| {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
            [c, s, 0.0]
        };
        let mut positions: Vec<_> = (0..n).map(at).collect();
        positions.push([0.0; 3]);
        let faces = (0..n).map(|i| [i, (i + 1) % n, n]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let mut fixed = vec![false; n as usize + 1];
        let mut sliding = Sliding::new(&mesh, &mut fixed);
        assert!(!fixed.contains(&true));
        sliding.take_tangents(mesh.positions());
        for i in 0..n {
            let [x, y, _] = at(i);
            let along = sliding.project(i as usize, [x - 2.0 * y, y + 2.0 * x, 1.0]);
            let expected = DVec3::new(-2.0 * y, 2.0 * x, 0.0);
            assert!(expected.distance(along.into()) < 1e-14, "{i}: {along:?}");
        }
    }

    /// A vertex slides past a segment of zero length, where two boundary vertices coincide.
    #[test]
    fn vertices_slide_past_segments_of_zero_length() {
        let mut positions: Vec<[f64; 3]> =
            [0.0, 1.0, 1.0, 2.0, 3.0, 4.0].map(|x| [x, 0.0, 0.0]).into();
        positions.extend([[4.0, 3.0, 0.0], [0.0, 3.0, 0.0]]);
        let faces = (0..5).map(|i| [i, i + 1, 7]).chain([[5, 6, 7]]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let mut fixed = vec![false; 8];
        let mut sliding = Sliding::new(&mesh, &mut fixed);
        // Vertex 3 lies between others on a line. It moves from x = 2 to the doubled point at 1 and
        // beyond.
        assert!(!fixed[3]);
        let mut x = mesh.positions().to_vec();
        for to in [1.0, 0.5] {
            x[3] = [to, 0.1, 0.0];
            sliding.retract(&mut x);
            assert_eq!(x[3], [to, 0.0, 0.0]);
        }
    }
}
