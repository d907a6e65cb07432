//! Refinement of the patch over a hole.

use std::collections::HashMap;

use fairing_watch as watch;
use glam::DVec3;

/// The most rounds of splitting faces, and of flips after each.
const MAX_ROUNDS: usize = 40;

/// A triangulated polygon: its points come first, in order.
pub(super) struct Patch<'a> {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    border: usize,
    /// True for two points of the border that the mesh joins.
    is_taken: &'a dyn Fn([u32; 2]) -> bool,
}

impl<'a> Patch<'a> {
    pub(super) fn new(
        border: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        is_taken: &'a dyn Fn([u32; 2]) -> bool,
    ) -> Self {
        let points: Vec<DVec3> = border.into_iter().map(DVec3::from).collect();
        Self { border: points.len(), points, triangles, is_taken }
    }

    /// Splits faces at their centroids until they are as fine as the mesh around them, and flips
    /// edges to Delaunay's condition in between \[liepa2003\]. `scales` holds the mean edge length
    /// at each point of the border. Returns the inner points and the triangles.
    pub(super) fn refined(mut self, mut scales: Vec<f64>) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        self.flip_edges();
        for _ in 0..MAX_ROUNDS {
            if !self.split_faces(&mut scales) {
                break;
            }
            self.flip_edges();
        }
        (self.points[self.border..].iter().map(|p| p.to_array()).collect(), self.triangles)
    }

    fn corners(&self, face: [u32; 3]) -> [DVec3; 3] {
        face.map(|v| self.points[v as usize])
    }

    /// Splits each face whose centroid is further from its corners than the scale there over √2.
    fn split_faces(&mut self, scales: &mut Vec<f64>) -> bool {
        let before = self.triangles.len();
        for f in 0..before {
            let face = self.triangles[f];
            let corners = self.corners(face);
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            let at_corners = face.map(|v| scales[v as usize]);
            let scale = at_corners.iter().sum::<f64>() / 3.0;
            let far = corners.iter().zip(at_corners).all(|(corner, at_corner)| {
                std::f64::consts::SQRT_2 * center.distance(*corner) > scale.max(at_corner)
            });
            if far {
                let [a, b, c] = face;
                let new = self.points.len() as u32;
                self.points.push(center);
                scales.push(scale);
                self.triangles[f] = [a, b, new];
                self.triangles.extend([[b, c, new], [c, a, new]]);
            }
        }
        self.triangles.len() > before
    }

    /// Flips inner edges whose opposite angles exceed π together, until none is left.
    fn flip_edges(&mut self) {
        for _ in 0..MAX_ROUNDS {
            watch::check();
            let sides = |f: usize| {
                let [a, b, c] = self.triangles[f];
                [[a, b], [b, c], [c, a]].map(move |side| (side, f))
            };
            let mut face_of: HashMap<[u32; 2], usize> =
                (0..self.triangles.len()).flat_map(sides).collect();
            let mut done = vec![false; self.triangles.len()];
            let mut flipped = false;
            for f in 0..self.triangles.len() {
                for k in 0..3 {
                    let [a, b, c] = [0, 1, 2].map(|j| self.triangles[f][(k + j) % 3]);
                    let Some(&g) = face_of.get(&[b, a]) else { continue };
                    if done[f] || done[g] {
                        continue;
                    }
                    let Some(&d) = self.triangles[g].iter().find(|v| ![a, b].contains(v)) else {
                        continue;
                    };
                    let exists = face_of.contains_key(&[c, d]) || face_of.contains_key(&[d, c]);
                    if exists || (self.is_taken)([c, d]) || !self.improves([a, b, c, d]) {
                        continue;
                    }
                    (self.triangles[f], self.triangles[g]) = ([a, d, c], [d, b, c]);
                    (done[f], done[g], flipped) = (true, true, true);
                    // The new edge is known at once, so that no other flip makes it again.
                    face_of.extend([([d, c], f), ([c, d], g)]);
                }
            }
            if !flipped {
                return;
            }
        }
    }

    /// True if the faces a b c and b a d have angles at c and d that exceed π together, and none
    /// of the new faces a d c and d b c faces against both.
    fn improves(&self, [a, b, c, d]: [u32; 4]) -> bool {
        let angle = |at: u32| {
            let [p, q, r] = self.corners([at, a, b]);
            let (u, v) = (q - p, r - p);
            libm::atan2(u.cross(v).length(), u.dot(v))
        };
        let normal = |face: [u32; 3]| {
            let [p, q, r] = self.corners(face);
            (q - p).cross(r - p)
        };
        let sum = normal([a, b, c]) + normal([b, a, d]);
        angle(c) + angle(d) > std::f64::consts::PI * (1.0 + 1e-12)
            && [[a, d, c], [d, b, c]].iter().all(|&face| normal(face).dot(sum) > 0.0)
    }
}
