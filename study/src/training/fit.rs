//! The fit of a network to faces whose normals are known.

use fairing_denoising::training::{INPUTS, LAYERS, Network, PARAMETERS};
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use super::gradient::{Lesson, chunk_gradient};

const BATCH: usize = 256;
/// Gradients are summed over chunks of this size, then over the chunks in their
/// order.
const CHUNK: usize = 64;
/// Numbers of a network that are changed together.
const STRETCH: usize = 2048;
const RATE: f32 = 2e-3;
/// Added to the mean chord of a pair: 0.1°.
const MIN_MEAN: f64 = 2e-3;

/// Adam over shuffled batches, with a rate that falls to zero.
pub(super) fn fit(
    lessons: &[Lesson],
    pairs: usize,
    epochs: usize,
    random: &mut Random,
    mut say: impl FnMut(usize, f64),
) -> Network {
    let mut network = start(lessons, random);
    let mut moments = [(); 2].map(|()| vec![0.0f32; PARAMETERS - 2 * INPUTS]);
    let mut weights = vec![1.0f32; pairs];
    let mut order: Vec<u32> = (0..lessons.len() as u32).collect();
    let steps = epochs * lessons.len().div_ceil(BATCH);
    let mut step = 0;
    for epoch in 0..epochs {
        let count = order.len();
        random.shuffle(&mut order, count);
        let mut chords = vec![(0.0f64, 0u32); pairs];
        for batch in order.chunks(BATCH) {
            let done: Vec<(Vec<f32>, Vec<f32>)> = batch
                .par_chunks(CHUNK)
                .map(|chunk| chunk_gradient(&network, lessons, chunk, &weights))
                .collect();
            for (&l, chord) in batch.iter().zip(done.iter().flat_map(|(_, c)| c)) {
                let slot = &mut chords[lessons[l as usize].pair as usize];
                *slot = (slot.0 + f64::from(*chord), slot.1 + 1);
            }
            step += 1;
            let turn = std::f64::consts::PI * step as f64 / steps as f64;
            let warm = (step as f32 / 200.0).min(1.0);
            let rate = RATE * warm * (0.5 + 0.5 * libm::cos(turn)) as f32;
            let bias = |beta: f64| (1.0 / (1.0 - libm::pow(beta, step as f64))) as f32;
            let adam = Adam {
                gradients: &done,
                factor: 1.0 / batch.len() as f32,
                rate,
                biases: [bias(0.9), bias(0.999)],
            };
            adam.step(&mut network.numbers[2 * INPUTS..], &mut moments);
        }
        let means: Vec<f64> =
            chords.iter().map(|c| c.0 / f64::from(c.1.max(1)) + MIN_MEAN).collect();
        let log = means.iter().map(|m| libm::log(*m)).sum::<f64>() / pairs as f64;
        say(epoch, libm::exp(log).to_degrees());
        // The derivative of the logarithm of each mean.
        weights = means.iter().map(|m| (libm::exp(log) / m) as f32).collect();
    }
    network
}

/// Random weights; the last layer small, so that all candidates weigh the same.
pub(super) fn start(lessons: &[Lesson], random: &mut Random) -> Network {
    let mut numbers = vec![0.0f32; PARAMETERS];
    let count = lessons.len().max(1) as f64;
    for k in 0..INPUTS {
        let values = || lessons.iter().map(|l| f64::from(l.sample.inputs[k]));
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        numbers[k] = mean as f32;
        numbers[INPUTS + k] = (1.0 / (variance.sqrt() + 1e-3)) as f32;
    }
    let mut at = 2 * INPUTS;
    for ([inputs, outputs], gain) in LAYERS.into_iter().zip([2.0, 2.0, 0.02]) {
        let width = (3.0 * gain / inputs as f64).sqrt();
        for x in &mut numbers[at..at + inputs * outputs] {
            *x = ((2.0 * random.unit() - 1.0) * width) as f32;
        }
        at += (inputs + 1) * outputs;
    }
    Network { numbers }
}

/// A step of Adam along the mean gradient of a batch.
struct Adam<'a> {
    /// The summed gradients of the chunks, by all numbers of the network.
    gradients: &'a [(Vec<f32>, Vec<f32>)],
    /// One over the number of lessons.
    factor: f32,
    rate: f32,
    /// The factors that correct the running means, which begin at zero.
    biases: [f32; 2],
}

impl Adam<'_> {
    /// Changes all numbers but the shift and the scale of the inputs, and the running means of
    /// their gradients and of the squares of these.
    fn step(&self, numbers: &mut [f32], moments: &mut [Vec<f32>; 2]) {
        let [means, squares] = moments;
        let numbers = numbers.par_chunks_mut(STRETCH).zip(means.par_chunks_mut(STRETCH));
        numbers.zip(squares.par_chunks_mut(STRETCH)).enumerate().for_each(
            |(k, ((numbers, means), squares))| {
                let first = 2 * INPUTS + k * STRETCH;
                pulp::Arch::new().dispatch(Stretch { adam: self, first, numbers, means, squares });
            },
        );
    }
}

/// Some consecutive numbers of a step.
struct Stretch<'a> {
    adam: &'a Adam<'a>,
    /// The number of the first one in the network.
    first: usize,
    numbers: &'a mut [f32],
    means: &'a mut [f32],
    squares: &'a mut [f32],
}

impl NullaryFnOnce for Stretch<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { adam, first, numbers, means, squares } = self;
        let count = numbers.len();
        let mut sum = [0.0f32; STRETCH];
        let sum = &mut sum[..count];
        for (gradient, _) in adam.gradients {
            let gradient = &gradient[first..first + count];
            sum.iter_mut().zip(gradient).for_each(|(sum, x)| *sum += x);
        }
        let [by_mean, by_square] = adam.biases;
        for (((x, m), v), g) in numbers.iter_mut().zip(means).zip(squares).zip(sum) {
            let g = *g * adam.factor;
            *m = 0.9 * *m + 0.1 * g;
            *v = 0.999 * *v + 0.001 * g * g;
            *x -= adam.rate * (*m * by_mean) / ((*v * by_square).sqrt() + 1e-8);
        }
    }
}

/// A stream of random numbers (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Puts a random choice in random order into the first `count` places.
    pub(super) fn shuffle(&mut self, items: &mut [u32], count: usize) {
        for i in 0..count.min(items.len()) {
            let j = i + (self.unit() * (items.len() - i) as f64) as usize;
            items.swap(i, j);
        }
    }
}
