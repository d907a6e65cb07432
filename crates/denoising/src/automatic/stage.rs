//! A stage: networks weight the candidates for each normal, and the surface follows.

use std::ops::Range;

use glam::DVec3;
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use super::around::{Gatherer, Surroundings};
use super::features::{INPUTS, Sample, Seen, WIDE, sample};
use super::network::{BATCH, Network, Parts, Trace, combine};
use super::state::{QUANTILES, State};
use super::wide::wide_means;
use crate::error::DenoiseError;

/// Faces of a unit of parallel work.
const BLOCK: usize = 1024;

/// The number of blocks of a stage.
pub(super) fn blocks(face_count: usize) -> usize {
    face_count.div_ceil(BLOCK)
}

/// The estimate of a stage at a face.
struct Answer {
    normal: DVec3,
    anchor: DVec3,
    /// As in [`Seen`]; `None` without a normal.
    residuals: Option<[f64; 2]>,
    /// The root mean square distance of the answers of the networks from their mean.
    apart: f64,
}

/// Replaces each normal by the mean of the answers of the networks, and lets the surface follow.
///
/// # Errors
///
/// [`DenoiseError::Build`] if coordinates overflow.
pub fn advance(state: &mut State<'_>, networks: &[Network]) -> Result<(), DenoiseError> {
    let answers = answers(state, networks);
    let residuals: Vec<[f64; 2]> = (answers.iter().zip(state.mesh().faces()))
        .filter(|(_, face)| face.iter().any(|&v| !state.input.is_fixed(v as usize)))
        .filter_map(|(answer, _)| answer.residuals)
        .collect();
    let apart: f64 = answers.iter().map(|answer| answer.apart).sum();
    state.apart = apart / answers.len().max(1) as f64;
    (state.normals, state.anchors) = answers.into_iter().map(|a| (a.normal, a.anchor)).unzip();
    let sigma = state.sigma;
    state.follow()?;
    state.quantiles = quantiles(&residuals).map_or([0.0; QUANTILES], |quantiles| {
        quantiles.map(|q| q + libm::log2(sigma / state.sigma))
    });
    Ok(())
}

fn answers(state: &State<'_>, networks: &[Network]) -> Vec<Answer> {
    let wide = wide_means(state);
    let parts: Vec<Parts<'_>> = networks.iter().map(Network::parts).collect();
    let surroundings = Surroundings::new(state);
    let watch = fairing_watch::current();
    let count = state.normals.len();
    (0..blocks(count))
        .into_par_iter()
        .map_init(
            || Gatherer::new(&surroundings),
            |gatherer, block| {
                watch.advance(1);
                let faces = block * BLOCK..((block + 1) * BLOCK).min(count);
                pulp::Arch::new().dispatch(Answering {
                    gatherer,
                    wide: &wide,
                    parts: &parts,
                    faces,
                })
            },
        )
        .flatten_iter()
        .collect()
}

/// The answers for a block of faces, with the widest vectors of the processor. Multiplications and
/// additions are not fused, and no sum is reordered: the bits are the same on all of them.
struct Answering<'a, 'b> {
    gatherer: &'b mut Gatherer<'a>,
    wide: &'b [Vec<DVec3>; WIDE],
    parts: &'b [Parts<'b>],
    faces: Range<usize>,
}

impl NullaryFnOnce for Answering<'_, '_> {
    type Output = Vec<Answer>;

    #[inline(always)]
    fn call(self) -> Vec<Answer> {
        let Self { gatherer, wide, parts, faces } = self;
        let mut traces = Default::default();
        let mut found = Vec::with_capacity(faces.len());
        for first in faces.clone().step_by(BATCH) {
            let faces = first..(first + BATCH).min(faces.end);
            let mut seen = [const { None }; BATCH];
            for (seen, f) in seen.iter_mut().zip(faces.clone()) {
                *seen = sample(gatherer, wide, f);
            }
            let answers = answer(&seen, parts, &mut traces);
            found.extend(answers.into_iter().zip(faces).map(|(answer, f)| {
                let anchor = gatherer.state().current.centroids[f];
                answer.unwrap_or(Answer {
                    normal: DVec3::ZERO,
                    anchor,
                    residuals: None,
                    apart: 0.0,
                })
            }));
        }
        found
    }
}

/// For each of the samples, the direction of the mean of the unit vectors that the networks answer
/// with.
#[inline(always)]
fn answer(
    seen: &[Option<Seen>; BATCH],
    networks: &[Parts<'_>],
    traces: &mut [Trace; BATCH],
) -> [Option<Answer>; BATCH] {
    static NOTHING: Sample = Sample { inputs: [0.0; INPUTS], spread: 0.0 };
    let samples = seen.each_ref().map(|seen| seen.as_ref().map_or(&NOTHING, |s| &s.sample));
    let mut sums = [DVec3::ZERO; BATCH];
    for parts in networks {
        parts.run(samples, traces);
        for ((sum, sample), trace) in sums.iter_mut().zip(samples).zip(&*traces) {
            let (mean, _) = combine(sample, &trace.outputs);
            *sum += DVec3::from(mean.map(f64::from)).normalize_or_zero();
        }
    }
    std::array::from_fn(|k| {
        let seen = seen[k].as_ref()?;
        let [a, b, c] = seen.frame;
        let normal = (sums[k].x * a + sums[k].y * b + sums[k].z * c).normalize_or_zero();
        // Of unit vectors, whose mean square is one.
        let mean = sums[k] / networks.len() as f64;
        let apart = (1.0 - mean.length_squared()).max(0.0).sqrt();
        Some(Answer { normal, anchor: seen.anchor, residuals: Some(seen.residuals), apart })
    })
}

/// The inputs of the networks at some faces; `None` for a face without a normal.
pub fn samples(state: &State<'_>, faces: &[u32]) -> Vec<Option<Seen>> {
    let (wide, surroundings) = (wide_means(state), Surroundings::new(state));
    faces
        .par_chunks(BLOCK)
        .map_init(
            || Gatherer::new(&surroundings),
            |gatherer, block| {
                block.iter().map(|&f| sample(gatherer, &wide, f as usize)).collect::<Vec<_>>()
            },
        )
        .flatten_iter()
        .collect()
}

/// The first decile and the median of both numbers.
fn quantiles(residuals: &[[f64; 2]]) -> Option<[f64; QUANTILES]> {
    let mut found = [0.0; QUANTILES];
    for (k, slots) in found.chunks_exact_mut(2).enumerate() {
        let mut numbers: Vec<f64> = residuals.iter().map(|r| r[k]).collect();
        for (slot, divisor) in slots.iter_mut().zip([10, 2]) {
            let at = numbers.len() / divisor;
            if numbers.is_empty() {
                return None;
            }
            *slot = *numbers.select_nth_unstable_by(at, f64::total_cmp).1;
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::faces::FaceShapes;
    use crate::noise_level;

    /// Faces of a torus are right triangles in pairs: their normals differ from those of the smooth
    /// surface at their centroids by 2°, to one side and to the other. A mean of normals does not
    /// see that; as a candidate it is turned.
    #[test]
    fn means_are_turned_to_flat_faces() {
        let truth = shapes::torus(1.0, 0.4, 75, 30);
        let noisy = shapes::jittered(&truth, 1e-4, 3, |p| p);
        let state = State::new(&noisy, noise_level(&noisy).unwrap());
        let wanted = FaceShapes::new(&truth).normals;
        let faces: Vec<u32> = (0..noisy.face_count() as u32).collect();
        // The mean over the smallest neighbourhood, whatever the normals in it.
        let plain = super::super::state::RANGES - 1;
        let sum: f64 = (samples(&state, &faces).iter().zip(&wanted))
            .map(|(seen, &t)| {
                let seen = seen.as_ref().unwrap();
                let plain = DVec3::from(seen.sample.candidate(plain).map(f64::from));
                plain.normalize_or_zero().distance(seen.frame.map(|e| e.dot(t)).into())
            })
            .sum();
        let mean = (sum / faces.len() as f64).to_degrees();
        assert!(mean < 0.5, "{mean}");
    }
}
