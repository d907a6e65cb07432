//! The edge operators of L0 minimisation.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use crate::faces::{Hinge, Hinges};

/// The regulariser's coefficients.
pub(super) const FOLD: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// The four corners of each hinge, and the hinges at each vertex.
pub(super) struct Stencils {
    /// Ends at 0 and 2, the opposite corners at 1 and 3.
    pub(super) corners: Vec<[u32; 4]>,
    pub(super) offsets: Vec<u32>,
    /// `4 × hinge + place`, ascending at each vertex.
    places: Vec<u32>,
}

impl Stencils {
    pub(super) fn new(mesh: &TriMesh, hinges: &Hinges) -> Self {
        let corners: Vec<[u32; 4]> = hinges
            .all
            .iter()
            .map(|&Hinge { faces, ends: [a, b] }| {
                let [c, d] = faces.map(|f| {
                    let [i, j, k] = mesh.faces()[f as usize];
                    // The corner that is neither end.
                    [i, j, k].into_iter().find(|&v| v != a && v != b).unwrap_or(i)
                });
                [a, c, b, d]
            })
            .collect();
        let mut offsets = vec![0u32; mesh.vertex_count() + 1];
        for &v in corners.as_flattened() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..mesh.vertex_count() {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut places = vec![0; corners.len() * 4];
        for (place, &v) in corners.as_flattened().iter().enumerate() {
            places[next[v as usize] as usize] = place as u32;
            next[v as usize] += 1;
        }
        Self { corners, offsets, places }
    }

    /// The hinges at vertex `v`, and which of their corners it is.
    pub(super) fn at(&self, v: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.places[self.offsets[v] as usize..self.offsets[v + 1] as usize]
            .iter()
            .map(|&p| (p as usize / 4, p as usize % 4))
    }

    /// The coefficients of the area-based edge operator at the given
    /// positions; zero for a hinge whose edge or faces have no size.
    pub(super) fn edge_operators(&self, positions: &[[f64; 3]]) -> Vec<[f64; 4]> {
        self.corners
            .par_iter()
            .map(|corners| {
                let [p1, p2, p3, p4] = corners.map(|v| DVec3::from(positions[v as usize]));
                let edge = p3 - p1;
                let area = |p: DVec3| 0.5 * (p - p1).cross(edge).length();
                let (a2, a4) = (area(p2), area(p4));
                let scale = edge.dot(edge) * (a2 + a4);
                if scale.is_nan() || scale <= f64::MIN_POSITIVE {
                    return [0.0; 4];
                }
                // Where the feet of p₂ and p₄ lie along the edge, from p₃.
                let (t2, t4) = ((p3 - p2).dot(edge), (p3 - p4).dot(edge));
                let (s2, s4) = ((p2 - p1).dot(edge), (p4 - p1).dot(edge));
                [
                    -(a4 * t2 + a2 * t4) / scale,
                    a4 / (a2 + a4),
                    -(a4 * s2 + a2 * s4) / scale,
                    a2 / (a2 + a4),
                ]
            })
            .collect()
    }

    /// `Dᵀ values`.
    pub(super) fn transpose(&self, weights: &[[f64; 4]], values: &[DVec3]) -> Vec<DVec3> {
        (0..self.offsets.len() - 1)
            .into_par_iter()
            .map(|v| self.at(v).map(|(e, k)| weights[e][k] * values[e]).sum())
            .collect()
    }
}

/// `Σ w x` over four corners.
pub(super) fn combine(corners: &[u32; 4], weights: &[f64; 4], x: &[[f64; 3]]) -> DVec3 {
    (0..4).map(|k| weights[k] * DVec3::from(x[corners[k] as usize])).sum()
}
