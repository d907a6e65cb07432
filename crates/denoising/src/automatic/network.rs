//! A small network that weighs candidates for a normal.

use super::features::{CANDIDATES, INPUTS, Sample};

/// The units of each of the two hidden layers.
pub const HIDDEN: usize = 128;

/// A weight for each candidate, and two components that turn their mean.
pub const OUTPUTS: usize = CANDIDATES + 2;

/// The slope of a unit below zero.
pub const LEAK: f32 = 0.1;

/// The samples that a network sees together: loads of its weights take time.
pub const BATCH: usize = 6;

/// The outputs of a layer whose sums are in registers together, for each of the samples.
const COLUMNS: usize = 16;

/// Inputs and outputs of each layer.
pub const LAYERS: [[usize; 2]; 3] = [[INPUTS, HIDDEN], [HIDDEN, HIDDEN], [HIDDEN, OUTPUTS]];

/// The numbers of a network in one list, in the order of [`Network::parts`].
pub const PARAMETERS: usize =
    2 * INPUTS + (INPUTS + 1) * HIDDEN + (HIDDEN + 1) * HIDDEN + (HIDDEN + 1) * OUTPUTS;

/// Two hidden layers of leaky rectified units.
///
/// Sums run in a fixed order and no function is used that processors round
/// differently, so that results have the same bits everywhere.
#[derive(Debug, Clone)]
pub struct Network {
    /// The shift and the scale of the inputs, then weights and biases of each layer.
    pub numbers: Vec<f32>,
}

/// The numbers of a layer: for each input the weights to all outputs, then the biases.
#[derive(Debug, Clone, Copy)]
pub struct Layer<'a> {
    /// A row of weights to all outputs for each input.
    pub weights: &'a [f32],
    /// The bias of each output.
    pub biases: &'a [f32],
}

impl Layer<'_> {
    /// `biases + weightsᵀ x` for each x.
    #[inline(always)]
    pub fn apply<const M: usize, const N: usize>(
        &self,
        x: [&[f32; M]; BATCH],
    ) -> [[f32; N]; BATCH] {
        const { assert!(N.is_multiple_of(COLUMNS)) };
        let mut out = [[0.0; N]; BATCH];
        for first in (0..N).step_by(COLUMNS) {
            let mut sums = [[0.0; COLUMNS]; BATCH];
            sums.iter_mut().for_each(|s| s.copy_from_slice(&self.biases[first..first + COLUMNS]));
            for (i, row) in self.weights.chunks_exact(N).take(M).enumerate() {
                let row = &row[first..first + COLUMNS];
                for (sums, x) in sums.iter_mut().zip(x) {
                    for (sum, &w) in sums.iter_mut().zip(row) {
                        *sum += x[i] * w;
                    }
                }
            }
            for (out, sums) in out.iter_mut().zip(&sums) {
                out[first..first + COLUMNS].copy_from_slice(sums);
            }
        }
        out
    }
}

/// A network's parts.
#[derive(Debug, Clone, Copy)]
pub struct Parts<'a> {
    shift: &'a [f32],
    scale: &'a [f32],
    /// The two hidden layers and the last one.
    pub layers: [Layer<'a>; 3],
}

/// The intermediate results for one sample, from which its gradient follows.
#[derive(Debug, Clone)]
pub struct Trace {
    /// The shifted and scaled inputs.
    pub inputs: [f32; INPUTS],
    /// The units of the first hidden layer.
    pub first: [f32; HIDDEN],
    /// The units of the second hidden layer.
    pub second: [f32; HIDDEN],
    /// A weight for each candidate before [`weight`], then the two turns before [`turn`].
    pub outputs: [f32; OUTPUTS],
}

impl Default for Trace {
    fn default() -> Self {
        Self {
            inputs: [0.0; INPUTS],
            first: [0.0; HIDDEN],
            second: [0.0; HIDDEN],
            outputs: [0.0; OUTPUTS],
        }
    }
}

impl Network {
    /// The numbers, divided into parts.
    pub fn parts(&self) -> Parts<'_> {
        let (shift, rest) = self.numbers.split_at(INPUTS);
        let (scale, rest) = rest.split_at(INPUTS);
        let (w1, rest) = rest.split_at(INPUTS * HIDDEN);
        let (b1, rest) = rest.split_at(HIDDEN);
        let (w2, rest) = rest.split_at(HIDDEN * HIDDEN);
        let (b2, rest) = rest.split_at(HIDDEN);
        let (w3, b3) = rest.split_at(HIDDEN * OUTPUTS);
        let layers = [(w1, b1), (w2, b2), (w3, b3)];
        Parts { shift, scale, layers: layers.map(|(weights, biases)| Layer { weights, biases }) }
    }
}

impl Parts<'_> {
    /// The outputs for samples.
    #[inline(always)]
    pub fn run(&self, samples: [&Sample; BATCH], traces: &mut [Trace; BATCH]) {
        for (trace, sample) in traces.iter_mut().zip(samples) {
            let moved = sample.inputs.iter().zip(self.shift).zip(self.scale);
            for (x, ((&input, shift), scale)) in trace.inputs.iter_mut().zip(moved) {
                // The training data ends at six deviations.
                *x = ((input - shift) * scale).clamp(-6.0, 6.0);
            }
        }
        let [first, second, third] = self.layers;
        let sums = first.apply(traces.each_ref().map(|t| &t.inputs));
        traces.iter_mut().zip(sums).for_each(|(t, sums)| t.first = sums.map(leak));
        let sums = second.apply(traces.each_ref().map(|t| &t.first));
        traces.iter_mut().zip(sums).for_each(|(t, sums)| t.second = sums.map(leak));
        let sums = third.apply(traces.each_ref().map(|t| &t.second));
        traces.iter_mut().zip(sums).for_each(|(t, sums)| t.outputs = sums);
    }
}

#[inline(always)]
fn leak(u: f32) -> f32 {
    u.max(LEAK * u)
}

/// The weight of a candidate from its output z: `φ²`, `φ = (z + √(z² + 4))/2`,
/// positive and 1 at z = 0.
#[inline]
pub fn weight(z: f32) -> f32 {
    let root = (z * z + 4.0).sqrt();
    // Without cancellation on either side.
    let phi = if z >= 0.0 { 0.5 * (z + root) } else { 2.0 / (root - z) };
    phi * phi
}

/// The largest turn by the last two outputs, in spreads of the candidates.
const TURN: f32 = 1.0;

/// `t/√(1 + t²)` times the largest turn, and its derivative.
#[inline]
pub fn turn(t: f32) -> (f32, f32) {
    let inverse = 1.0 / (1.0 + t * t).sqrt();
    (TURN * t * inverse, TURN * inverse * inverse * inverse)
}

/// The weighted mean of the candidates, turned; in the frame of the sample, not
/// of unit length. Also the sum of the weights.
pub fn combine(sample: &Sample, outputs: &[f32; OUTPUTS]) -> ([f32; 3], f32) {
    let (mut sum, mut total) = ([0.0f32; 3], 0.0f32);
    for (k, &z) in outputs[..CANDIDATES].iter().enumerate() {
        let w = weight(z);
        for (s, c) in sum.iter_mut().zip(sample.candidate(k)) {
            *s += w * c;
        }
        total += w;
    }
    let mut mean = sum.map(|s| s / total);
    mean[0] += sample.spread * turn(outputs[CANDIDATES]).0;
    mean[1] += sample.spread * turn(outputs[CANDIDATES + 1]).0;
    (mean, total)
}
