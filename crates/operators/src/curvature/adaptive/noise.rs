//! The level of noise of each component.

use fairing_mesh::TriMesh;
use fairing_sparse::upper_median;
use fairing_watch::parallel;
use glam::DVec3;

use super::candidate::{Candidates, GAINS, Work};
use super::gather::Extent;
use super::kind::NoiseKind;
use super::site::Sites;

/// The most vertices of a component that are examined.
const SAMPLES: usize = 8192;

/// The median of the absolute value of a normal variable of variance 1.
const MEDIAN: f64 = 0.6745;

/// The noise of heights is at most this times that of measures; where most jets are not valid, at
/// most that of measures.
const DIFFERENCE: f64 = 1.5;

/// The largest ratio of the noise of measures to that of heights.
const MAX_RATIO: f64 = 2.0;

/// Noise below this times the mean of |H| h², with h the local mean edge, asks for no wide
/// candidates: it changes H by less than two parts in a thousand at a radius of 5.5 edges.
const NARROW: f64 = 0.03;

/// The noise of a component.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    /// The standard deviation of heights, in the unit of the sites.
    pub(super) heights: f64,
    /// The deviation that explains the scatter of measures, which irregular faces and terms of
    /// second order make larger.
    pub(super) measures: f64,
    pub(super) extent: Extent,
}

impl Noise {
    const NONE: Self = Self { heights: 0.0, measures: 0.0, extent: Extent::Narrow };

    fn new(samples: &[Sample]) -> Self {
        let deviation = |of: fn(&Sample) -> Option<f64>| {
            upper_median(samples.iter().filter_map(of).collect()).map(|x| x / MEDIAN)
        };
        // On coarse meshes few jets are valid, where the surface is flattest.
        let known = samples.iter().filter(|s| s.residual.is_some()).count();
        let factor = if 2 * known < samples.len() { 1.0 } else { DIFFERENCE };
        let [heights, measures] = match [deviation(|s| s.residual), deviation(|s| s.difference)] {
            [Some(heights), Some(measures)] => {
                let heights = heights.min(factor * measures);
                [heights, measures.clamp(heights, MAX_RATIO * heights)]
            }
            [heights, measures] => [heights.or(measures).unwrap_or(0.0); 2],
        };
        let bend = samples.iter().map(|s| s.bend).sum::<f64>() / (samples.len() as f64).max(1.0);
        let extent = if heights <= NARROW * bend { Extent::Narrow } else { Extent::Wide };
        Self { heights, measures, extent }
    }
}

/// Signs of the noise at a vertex, in the unit of the sites.
#[derive(Debug, Clone, Copy, Default)]
struct Sample {
    /// The distance from a jet over its standard deviation.
    residual: Option<f64>,
    /// The difference of two regressions over its standard deviation.
    difference: Option<f64>,
    /// |H| h².
    bend: f64,
}

impl Sample {
    fn new(mesh: &TriMesh, sites: &Sites, work: &mut Work, v: u32) -> Self {
        let length = sites.length[v as usize];
        if sites.all[v as usize].normal == DVec3::ZERO || length <= 0.0 {
            return Self::default();
        }
        let (all, residual) = Candidates::new(sites, mesh.topology(), work, v, Extent::Sample);
        let known = |k: usize| all.is_valid(k).then_some(all.mean[k]);
        let gain = GAINS[0][0] + GAINS[2][2] - 2.0 * GAINS[0][2];
        let gap = known(0).zip(known(2)).map(|(a, b)| (a - b).abs());
        Self {
            residual: residual.map(|x| x * length),
            difference: gap.map(|gap| gap * sites.area[v as usize] * length / gain.sqrt()),
            bend: known(2).or(known(0)).unwrap_or(0.0).abs() * length,
        }
    }
}

/// The noise of the component of each vertex.
pub(super) fn noise(mesh: &TriMesh, sites: &Sites, kind: NoiseKind) -> Vec<Noise> {
    let components = mesh.topology().components();
    let labels = || (0..mesh.vertex_count() as u32).filter_map(|v| Some((v, components.label(v)?)));
    let mut sizes = vec![0usize; components.count()];
    for (_, c) in labels() {
        sizes[c as usize] += 1;
    }
    let mut seen = vec![0usize; components.count()];
    let mut chosen = vec![vec![]; components.count()];
    for (v, c) in labels() {
        let c = c as usize;
        if seen[c].is_multiple_of(sizes[c].div_ceil(SAMPLES)) {
            chosen[c].push(v);
        }
        seen[c] += 1;
    }
    let of_component = |vertices: &Vec<u32>| {
        let at = |work: &mut Work, i: usize| Sample::new(mesh, sites, work, vertices[i]);
        let samples: Vec<Sample> = parallel::map_with(vertices.len(), 256, Work::default, at);
        // Small radii do not show the level of correlated noise.
        match kind {
            NoiseKind::Independent => Noise::new(&samples),
            NoiseKind::Correlated => Noise { extent: Extent::Wide, ..Noise::new(&samples) },
        }
    };
    let noise: Vec<Noise> = chosen.iter().map(of_component).collect();
    let at = |v: u32| components.label(v).map_or(Noise::NONE, |c| noise[c as usize]);
    (0..mesh.vertex_count() as u32).map(at).collect()
}
