//! The level of noise of each component.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::candidate::{Candidates, GAINS, Work};
use super::site::Sites;

/// The most vertices of a component that are examined.
const SAMPLES: usize = 8192;

/// The largest ratio of the deviation for measures to that of heights.
const MAX_RATIO: f64 = 2.0;

/// The radius that the samples need.
const RADIUS: f64 = 4.0;

/// The median of the absolute value of a normal variable of variance 1.
const MEDIAN: f64 = 0.6745;

/// The noise from differences of candidates is trusted up to this factor.
const DIFFERENCE: f64 = 1.5;

/// The standard deviation of the noise along the normal at each vertex, in units of the sites:
/// one number for each component.
pub(super) fn noise(mesh: &TriMesh, sites: &Sites) -> Vec<[f64; 2]> {
    let topology = mesh.topology();
    let components = topology.components();
    let mut sizes = vec![0usize; components.count()];
    let labels = || (0..mesh.vertex_count() as u32).filter_map(|v| Some((v, components.label(v)?)));
    for (_, c) in labels() {
        sizes[c as usize] += 1;
    }
    let mut seen = vec![0usize; components.count()];
    let mut chosen = vec![];
    for (v, c) in labels() {
        let stride = sizes[c as usize].div_ceil(SAMPLES);
        if seen[c as usize].is_multiple_of(stride) {
            chosen.push((v, c as usize));
        }
        seen[c as usize] += 1;
    }
    let sampled: Vec<[Option<f64>; 2]> = chosen
        .par_iter()
        .with_min_len(256)
        .map_init(Work::default, |work, &(v, _)| sample(mesh, sites, work, v))
        .collect();
    let mut of = vec![[vec![], vec![]]; components.count()];
    for (&(_, c), found) in chosen.iter().zip(&sampled) {
        for (all, x) in of[c].iter_mut().zip(found) {
            all.extend(x);
        }
    }
    let level: Vec<[f64; 2]> = of.into_iter().map(level).collect();
    let at = |v: u32| components.label(v).map_or([0.0; 2], |c| level[c as usize]);
    (0..mesh.vertex_count() as u32).map(at).collect()
}

/// The two deviations at a vertex: from a jet, and between regressions.
fn sample(mesh: &TriMesh, sites: &Sites, work: &mut Work, v: u32) -> [Option<f64>; 2] {
    let length = sites.length[v as usize];
    if sites.all[v as usize].normal == DVec3::ZERO || length <= 0.0 {
        return [None; 2];
    }
    let (all, residual) = Candidates::new(sites, mesh.topology(), work, v, RADIUS);
    let gain = GAINS[0][0] + GAINS[2][2] - 2.0 * GAINS[0][2];
    let difference = (all.is_valid(0) && all.is_valid(2))
        .then(|| (all.mean[0] - all.mean[2]).abs() * sites.area[v as usize] / gain.sqrt());
    [residual.map(|x| x * length), difference.map(|x| x * length)]
}

/// The deviation of heights, and that for measures.
fn level([residuals, differences]: [Vec<f64>; 2]) -> [f64; 2] {
    let residual = median(residuals).map(|x| x / MEDIAN);
    let difference = median(differences).map(|x| x / MEDIAN);
    match (residual, difference) {
        (Some(a), Some(b)) => {
            let heights = a.min(DIFFERENCE * b);
            [heights, b.clamp(heights, MAX_RATIO * heights)]
        }
        (a, b) => [a.or(b).unwrap_or(0.0); 2],
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
