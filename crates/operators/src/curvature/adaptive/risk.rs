//! The squared bias of each candidate, pooled over the surroundings.

use std::ops::Range;

use fairing_mesh::Topology;
use fairing_sparse::parallel::update_both;
use fairing_watch::parallel;

use super::candidate::{COUNT, Candidates, JETS, Level, MEANS, QUANTITIES, RADII, REGRESSIONS};
use super::kind::NoiseKind;

/// Rounds of averaging over the neighbours: as wide as weights (1 − d²/r²)² with r = 4 mean edges.
const ROUNDS: usize = 5;

/// The order of the bias in the radius: of regressions and jets, and of means.
const ORDER: i32 = 4;
const ORDER_OF_MEANS: i32 = 2;

/// The least part of the surroundings in which a difference is known.
const MIN_PART: f32 = 0.05;

/// Values of a candidate: 1 if it counts; then for H and for K the squared difference from the next
/// smaller radius minus its variance, and those from all smaller radii minus three variances.
const FIELDS: usize = 16;
const OF_QUANTITY: usize = 7;

/// The squared bias of H and K of each candidate at a vertex, in local units; infinite where it is
/// not known.
pub(super) type SquaredBias = [[f32; COUNT]; 2];

/// `levels` are those of the noise at each vertex.
pub(super) fn squared_bias(
    topology: &Topology,
    all: &[Candidates],
    levels: &[Level],
    noise: NoiseKind,
) -> Vec<SquaredBias> {
    let mut bias = vec![[[f32::INFINITY; COUNT]; 2]; all.len()];
    let mut floors = vec![[0f32; 2]; all.len()];
    for ladder in [JETS, 0..REGRESSIONS, MEANS] {
        floors.fill([0.0; 2]);
        // Nothing is known of the radii that all vertices leave out.
        let is_known = |k: &usize| all.iter().any(|at| at.is_valid(*k));
        for k in ladder.clone().skip(1).filter(is_known) {
            let differences = |v: usize| differences(&all[v], ladder.start, k, levels[v]);
            let pooled = pooled(topology, all.len(), differences);
            update_both(&mut bias, &mut floors, |v, bias, floor| {
                for q in 0..2 {
                    climb(&mut bias[q], &mut floor[q], &pooled[v], [q, ladder.start, k], noise);
                }
            });
        }
    }
    let checked = if noise == NoiseKind::Independent { &[0..REGRESSIONS, MEANS][..] } else { &[] };
    for family in checked {
        let differences = |v: usize| against_jets(&all[v], &bias[v], family.clone(), levels[v]);
        let against = pooled(topology, all.len(), differences);
        parallel::for_rows(&mut bias, |v, bias| {
            let against = &against[v];
            if against[0] >= MIN_PART {
                for (bias, fields) in bias.iter_mut().zip(against[1..].chunks(OF_QUANTITY)) {
                    for (bias, x) in bias[family.clone()].iter_mut().zip(fields) {
                        *bias = bias.max(x / against[0]);
                    }
                }
            }
        });
    }
    parallel::for_rows(&mut bias, |v, bias| {
        for bias in bias {
            for (bias, amplified) in bias.iter_mut().zip(&all[v].amplified) {
                *bias *= amplified;
            }
        }
    });
    bias
}

/// The squared differences of the regressions from the jet of the least risk, less its squared
/// bias and three variances.
fn against_jets(
    at: &Candidates,
    bias: &SquaredBias,
    family: Range<usize>,
    level: Level,
) -> [f32; FIELDS] {
    let mut fields = [0.0; FIELDS];
    for (q, quantity) in QUANTITIES.into_iter().enumerate() {
        let risk = |k: usize| f64::from(bias[q][k]) + at.variance(quantity, k, level);
        let jets = JETS.filter(|&k| at.is_valid(k) && at.is_steady(k));
        let Some(best) = jets.min_by(|&a, &b| risk(a).total_cmp(&risk(b))) else {
            return [0.0; FIELDS];
        };
        if !risk(best).is_finite() {
            return [0.0; FIELDS];
        }
        fields[0] = 1.0;
        let to = &mut fields[1 + OF_QUANTITY * q..][..OF_QUANTITY];
        for (to, k) in to.iter_mut().zip(family.clone()).filter(|(_, k)| at.is_valid(*k)) {
            let gap = at.value(quantity, k) - at.value(quantity, best);
            let variance = at.variance(quantity, k, level) + at.variance(quantity, best, level);
            let excess = gap * gap - 3.0 * variance - f64::from(bias[q][best]);
            *to = excess as f32 / at.amplified[k].max(at.amplified[best]);
        }
    }
    fields
}

fn differences(at: &Candidates, first: usize, k: usize, level: Level) -> [f32; FIELDS] {
    let mut fields = [0.0; FIELDS];
    if !at.is_valid(k) || !at.is_valid(k - 1) {
        return fields;
    }
    fields[0] = 1.0;
    for (to, quantity) in fields[1..].chunks_mut(OF_QUANTITY).zip(QUANTITIES) {
        for (to, j) in to[1..].iter_mut().zip((first..k).filter(|&j| at.is_valid(j))) {
            let gap = at.value(quantity, k) - at.value(quantity, j);
            let variance = at.variance_of_difference(quantity, [j, k], level);
            *to = (gap * gap - 3.0 * variance) as f32 / at.amplified[k].max(at.amplified[j]);
        }
        let gap = at.value(quantity, k) - at.value(quantity, k - 1);
        let variance = at.variance_of_difference(quantity, [k - 1, k], level);
        to[0] = (gap * gap - variance) as f32 / at.amplified[k].max(at.amplified[k - 1]);
    }
    fields
}

/// The means of the fields over the surroundings.
fn pooled(
    topology: &Topology,
    count: usize,
    of: impl Fn(usize) -> [f32; FIELDS] + Sync + Send,
) -> Vec<[f32; FIELDS]> {
    let mut fields: Vec<[f32; FIELDS]> = parallel::map(count, 1024, of);
    let mut means = fields.clone();
    for _ in 0..ROUNDS {
        parallel::for_rows(&mut means, |v, mean| {
            let neighbors = topology.neighbors(v as u32);
            *mean = fields[v];
            for &w in neighbors {
                for (s, x) in mean.iter_mut().zip(&fields[w as usize]) {
                    *s += x;
                }
            }
            *mean = mean.map(|s| s / (1 + neighbors.len()) as f32);
        });
        std::mem::swap(&mut fields, &mut means);
    }
    fields
}

/// Sets the bias of candidate `k − 1` from its difference to candidate `k`, and that of `k` as
/// long as it is not compared with a larger one.
fn climb(
    bias: &mut [f32; COUNT],
    floor: &mut f32,
    pooled: &[f32; FIELDS],
    [q, first, k]: [usize; 3],
    noise: NoiseKind,
) {
    if pooled[0] < MIN_PART {
        return;
    }
    let fields = &pooled[1 + OF_QUANTITY * q..][..OF_QUANTITY];
    let square = (fields[0] / pooled[0]).max(0.0);
    let order = if MEANS.contains(&k) { ORDER_OF_MEANS } else { ORDER };
    let ratio = (RADII[k - 1] / RADII[k]).powi(order) as f32;
    let more = if MEANS.contains(&k) {
        1.6
    } else if JETS.contains(&k) {
        0.8
    } else {
        1.2
    };
    let (smaller, larger) = (more * ratio / (1.0 - ratio), more / (1.0 - ratio));
    bias[k - 1] = floor.max(smaller * smaller * square);
    if noise == NoiseKind::Correlated {
        // Noise that the variance does not know is in the difference as a whole.
        bias[k - 1] = floor.max(smaller.max(1.0).powi(2) * square);
    } else {
        let checked = fields[1..].iter().fold(0.0, |m: f32, x| m.max(x / pooled[0]));
        let adjacent = smaller * smaller * fields[k - first] / pooled[0];
        *floor = checked.max(adjacent).max(*floor);
    }
    bias[k] = floor.max(larger * larger * square);
}
