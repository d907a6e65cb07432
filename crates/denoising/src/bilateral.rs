//! Bilateral filtering of vertices.

use std::f64::consts::LOG2_E;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use glam::DVec3;
use rayon::prelude::*;

use super::error::DenoiseError;
use super::faces::{HUB, Marks, search};
use super::masked::{Masked, on_oriented};

fairing_parameters::options! {
    /// Options of [`bilateral`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct BilateralOptions {
        /// The spatial scale; neighbours within twice this distance count.
        pub spatial: f64 = 1.0, in Range::POSITIVE, unit "mean edge lengths";
        /// The scale of heights over the tangent plane.
        pub range: f64 = 1.0, in Range::POSITIVE, unit "standard deviations of the neighbourhood";
        /// The number of iterations.
        pub iterations: usize = 3;
    }
    "bilateral": "bilateral filter of vertices (Fleishman et al. 2003)", ["fleishman2003"];
}

/// Denoises by moving each vertex along its normal by a bilateral average.
///
/// With the unit normal n at vertex x (faces weighted by area), and heights
/// h = n·(q − x) of the vertices q within 2 σ_c that are reached along at most 15 edges
/// within that distance (not through a vertex of more than 64 edges),
///
/// ```text
/// x ← x + n Σ w h / Σ w,    w = exp(−‖q − x‖²/2σ_c²) exp(−h²/2σ_s²)
/// ```
///
/// A vertex whose normal is undefined stays.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a scale that is not positive.
///
/// Source: [fleishman2003].
///
/// [fleishman2003]: https://doi.org/10.1145/882262.882368
pub fn bilateral<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &BilateralOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &BilateralOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let mut current = mesh.clone();
    fairing_watch::stage("rounds", options.iterations as u64);
    for _ in 0..options.iterations {
        fairing_watch::advance(1);
        let spatial = options.spatial * current.mean_edge_length();
        let positions = (0..current.vertex_count() as u32)
            .into_par_iter()
            .map_init(
                || (vec![], Marks::new(current.vertex_count())),
                |scratch, v| {
                    if input.is_fixed(v as usize) {
                        current.positions()[v as usize]
                    } else {
                        move_vertex(&current, v, spatial, options.range, scratch)
                    }
                },
            )
            .collect();
        current = current.with_positions(positions)?;
    }
    Ok(current)
}

/// The new position of vertex `v`. The last argument is scratch space: the
/// vertices within reach, and which have been seen.
fn move_vertex(
    mesh: &TriMesh,
    v: u32,
    spatial: f64,
    range: f64,
    (near, seen): &mut (Vec<u32>, Marks),
) -> [f64; 3] {
    let (positions, topology) = (mesh.positions(), mesh.topology());
    let at = |w: u32| DVec3::from(positions[w as usize]);
    let x = at(v);
    let corners = mesh.incidence().corners(v).iter();
    let area: DVec3 = corners.map(|&c| DVec3::from(mesh.area_vector(c as usize / 3))).sum();
    let normal = area.normalize_or_zero();
    near.clear();
    seen.clear();
    near.push(v);
    seen.insert(v);
    // Nothing is looked past a hub.
    let ring = |w: u32| match topology.neighbors(w) {
        ring if w != v && ring.len() > HUB => &[],
        ring => ring,
    };
    search(near, ring, |w| at(w).distance(x) < 2.0 * spatial && seen.insert(w));
    // A vertex alone within the radius still sees its one-ring.
    if near.len() == 1 {
        near.extend_from_slice(topology.neighbors(v));
    }
    let heights = near[1..].iter().map(|&w| {
        let d = at(w) - x;
        (d.dot(d), normal.dot(d))
    });
    let count = heights.len() as f64;
    let mean = heights.clone().map(|(_, h)| h).sum::<f64>() / count;
    let variance = heights.clone().map(|(_, h)| (h - mean) * (h - mean)).sum::<f64>() / count;
    if variance.is_nan() || variance <= 0.0 {
        return x.to_array();
    }
    // exp(x) = 2^(x log2 e), with the factor in the constants.
    let half = -0.5 * LOG2_E;
    let (a, b) = (half / (spatial * spatial), half / (range * range * variance));
    let (sum, total) = heights.fold((0.0, 0.0), |(sum, total), (d2, h)| {
        let w = libm::exp2(a * d2 + b * h * h);
        (sum + w * h, total + w)
    });
    (if total > 0.0 { x + normal * (sum / total) } else { x }).to_array()
}

#[cfg(test)]
mod tests {
    use fairing_shapes::{Diagonals, plane};

    use super::*;

    /// A vertex in a flat part sees a bump between σ_c and 2 σ_c away, and none beyond.
    #[test]
    fn neighbours_within_twice_the_scale_are_seen() {
        let flat = plane(10, 10, Diagonals::Regular);
        let spatial = flat.mean_edge_length();
        for (bump, seen) in [(62, true), (63, false)] {
            let mut positions = flat.positions().to_vec();
            positions[bump][2] = 0.01;
            let mesh = flat.with_positions(positions).unwrap();
            let away =
                DVec3::from(flat.positions()[60]).distance(flat.positions()[bump].into()) / spatial;
            assert!(away > 1.0 && (away < 2.0) == seen, "{away}");
            let mut scratch = (vec![], Marks::new(mesh.vertex_count()));
            let moved = move_vertex(&mesh, 60, spatial, 1.0, &mut scratch);
            assert_eq!(moved[2] > 0.0, seen, "{moved:?}");
        }
    }
}
