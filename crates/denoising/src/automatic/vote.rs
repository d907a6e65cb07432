//! Neighbouring fits vote on the normal of a face.

use fairing_mesh::vec3::{add, distance, scale};
use rayon::prelude::*;

use super::local_fits::{Fit, Regions};
use crate::faces::unit_or_zero;

/// How many hinges away a fit may be.
const HOPS: usize = 3;

/// The share of its own radius up to which a fit is trusted.
const REACH: f64 = 0.6;

/// Keeps the weight of an exact fit finite: a standard deviation of 10⁻³.
const LEAST_VARIANCE: f64 = 1e-6;

/// The normal of each face as the mean of what the fits within three hinges,
/// none of them a crease, predict at its centroid, weighted by the inverse
/// variances of their slopes. A face without a fit in reach keeps its label.
pub(super) fn vote(regions: &Regions<'_>, fits: &[Option<Fit>]) -> Vec<[f64; 3]> {
    let centroids = regions.centroids();
    (0..fits.len())
        .into_par_iter()
        .map_init(Vec::new, |near: &mut Vec<u32>, f| {
            near.clear();
            near.push(f as u32);
            let mut begin = 0;
            for _ in 0..HOPS {
                let end = near.len();
                for i in begin..end {
                    for g in regions.across(near[i]) {
                        if !near.contains(&g) {
                            near.push(g);
                        }
                    }
                }
                begin = end;
            }
            let mut sum = [0.0; 3];
            for &g in near.iter() {
                let Some(fit) = &fits[g as usize] else { continue };
                if g as usize == f || fit.reaches(centroids[f], REACH) {
                    let weight = 1.0 / (fit.variance() + LEAST_VARIANCE);
                    sum = add(sum, scale(fit.normal_at(centroids[f]), weight));
                }
            }
            let normal = unit_or_zero(sum);
            if normal == [0.0; 3] { regions.normals[f] } else { normal }
        })
        .collect()
}

impl Fit {
    /// Whether a point lies within a share of the radius.
    fn reaches(&self, p: [f64; 3], share: f64) -> bool {
        distance(p, self.origin()) <= share * self.radius()
    }
}
