//! Training of the stages on pairs of noisy and true meshes.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::dot;
use fairing_operators::noise_level;
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use super::Progress;
use super::features::{CANDIDATES, INPUTS, Sample, Seen};
use super::model::Model;
use super::network::{
    HIDDEN, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Trace, combine, turn, weight,
};
use crate::DenoiseError;
use crate::faces::{FaceLists, FaceShapes, Hinges};

/// A mesh with noise, and without.
#[derive(Debug, Clone)]
pub struct TrainingPair {
    /// The mesh with noise.
    pub noisy: TriMesh,
    /// The same vertices and faces without noise.
    pub truth: TriMesh,
}

/// How long to train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainingOptions {
    /// Stages in a row.
    pub stages: usize,
    /// Networks of each stage, whose answers are averaged; they begin at other random numbers.
    pub members: usize,
    /// The faces that are drawn from each pair for each stage.
    pub faces_per_pair: usize,
    /// Passes over all drawn faces.
    pub epochs: usize,
    /// The seed of all draws.
    pub seed: u64,
}

impl Default for TrainingOptions {
    /// Four stages of two networks, each trained by 16 passes over 1200 faces of each pair.
    fn default() -> Self {
        Self { stages: 4, members: 2, faces_per_pair: 1200, epochs: 16, seed: 1 }
    }
}

const BATCH: usize = 256;
/// Gradients are summed over chunks of this size, then over the chunks in their
/// order.
const CHUNK: usize = 64;
const RATE: f32 = 2e-3;
/// Chords below this count quadratically: 0.06°.
const SMALL: f32 = 1e-3;
/// Added to the mean chord of a pair: 0.1°.
const LEAST_MEAN: f64 = 2e-3;

/// A face to learn from.
struct Lesson {
    sample: Sample,
    target: [f32; 3],
    pair: u32,
}

/// Trains the stages of [`automatic`](crate::automatic) and returns the bytes of
/// their file. The loss is the mean over the pairs of the logarithm of the mean
/// chord between the regressed and the true normal. `say` is told how far the
/// training is. The result has the same bits for any number of threads.
///
/// Pairs without a noise level are left out.
///
/// # Errors
///
/// [`DenoiseError::Build`] if coordinates overflow.
pub fn train_normals(
    pairs: &[TrainingPair],
    options: &TrainingOptions,
    mut say: impl FnMut(String),
) -> Result<Vec<u8>, DenoiseError> {
    let of_noisy = |pair: &TrainingPair| (Hinges::new(&pair.noisy), FaceLists::rings(&pair.noisy));
    let parts: Vec<(Hinges, FaceLists)> = pairs.iter().map(of_noisy).collect();
    let mut all: Vec<(Progress<'_>, Vec<[f64; 3]>)> = vec![];
    for (TrainingPair { noisy, truth, .. }, (hinges, rings)) in pairs.iter().zip(&parts) {
        let Some(level) = noise_level(noisy).filter(|l| l.sigma > 0.0) else { continue };
        let progress = Progress::new(noisy, hinges, rings, level);
        all.push((progress, FaceShapes::new(truth).normals));
    }
    let mut random = Random(options.seed);
    let mut stages = vec![];
    for stage in 0..options.stages {
        let lessons = lessons(&all, options.faces_per_pair, &mut random);
        let networks: Vec<Network> = (0..options.members)
            .map(|member| {
                fit(&lessons, all.len(), options.epochs, &mut random, |epoch, loss| {
                    say(format!("stage {stage}, network {member}, pass {epoch}: {loss:.4}"));
                })
            })
            .collect();
        drop(lessons);
        // Nobody looks at what the last stage makes of the pairs.
        if stage + 1 < options.stages {
            for (progress, _) in &mut all {
                progress.advance(&networks)?;
            }
        }
        stages.push(networks);
    }
    Ok(Model { stages, seed: options.seed }.write())
}

/// Faces drawn from each pair.
fn lessons(
    all: &[(Progress<'_>, Vec<[f64; 3]>)],
    count: usize,
    random: &mut Random,
) -> Vec<Lesson> {
    let mut lessons = vec![];
    for (pair, (progress, truth)) in all.iter().enumerate() {
        let mut faces: Vec<u32> = (0..truth.len() as u32).collect();
        random.shuffle(&mut faces, count);
        faces.truncate(count);
        faces.sort_unstable();
        for (found, &f) in progress.samples(&faces).into_iter().zip(&faces) {
            let t = truth[f as usize];
            if let Some(Seen { sample, frame, .. }) = found
                && t != [0.0; 3]
            {
                let target = frame.map(|e| dot(e, t) as f32);
                lessons.push(Lesson { sample, target, pair: pair as u32 });
            }
        }
    }
    lessons
}

/// Adam over shuffled batches, with a rate that falls to zero.
fn fit(
    lessons: &[Lesson],
    pairs: usize,
    epochs: usize,
    random: &mut Random,
    mut say: impl FnMut(usize, f64),
) -> Network {
    let mut network = start(lessons, random);
    let mut moments = vec![[0.0f32; 2]; PARAMETERS];
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
            let mut gradient = vec![0.0f32; PARAMETERS];
            for (g, _) in &done {
                gradient.iter_mut().zip(g).for_each(|(sum, x)| *sum += x);
            }
            for (&l, chord) in batch.iter().zip(done.iter().flat_map(|(_, c)| c)) {
                let slot = &mut chords[lessons[l as usize].pair as usize];
                *slot = (slot.0 + f64::from(*chord), slot.1 + 1);
            }
            step += 1;
            let turn = std::f64::consts::PI * step as f64 / steps as f64;
            let warm = (step as f32 / 200.0).min(1.0);
            let rate = RATE * warm * (0.5 + 0.5 * libm::cos(turn)) as f32;
            adam(&mut network, &mut moments, &gradient, rate, step, 1.0 / batch.len() as f32);
        }
        let means: Vec<f64> =
            chords.iter().map(|c| c.0 / f64::from(c.1.max(1)) + LEAST_MEAN).collect();
        let log = means.iter().map(|m| libm::log(*m)).sum::<f64>() / pairs as f64;
        say(epoch, libm::exp(log).to_degrees());
        // The derivative of the logarithm of each mean.
        weights = means.iter().map(|m| (libm::exp(log) / m) as f32).collect();
    }
    network
}

/// Random weights; the last layer small, so that all candidates weigh the same.
fn start(lessons: &[Lesson], random: &mut Random) -> Network {
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
    for (inputs, outputs, gain) in
        [(INPUTS, HIDDEN, 2.0), (HIDDEN, HIDDEN, 2.0), (HIDDEN, OUTPUTS, 0.02)]
    {
        let width = (3.0 * gain / inputs as f64).sqrt();
        for x in &mut numbers[at..at + inputs * outputs] {
            *x = ((2.0 * random.unit() - 1.0) * width) as f32;
        }
        at += (inputs + 1) * outputs;
    }
    Network { numbers }
}

fn adam(
    network: &mut Network,
    moments: &mut [[f32; 2]],
    gradient: &[f32],
    rate: f32,
    step: usize,
    factor: f32,
) {
    let bias = |beta: f64| (1.0 - libm::pow(beta, step as f64)) as f32;
    let (first, second) = (bias(0.9), bias(0.999));
    let numbers = network.numbers.iter_mut().zip(moments).zip(gradient).skip(2 * INPUTS);
    for ((x, m), g) in numbers {
        let g = g * factor;
        m[0] = 0.9 * m[0] + 0.1 * g;
        m[1] = 0.999 * m[1] + 0.001 * g * g;
        *x -= rate * (m[0] / first) / ((m[1] / second).sqrt() + 1e-8);
    }
}

/// The summed gradient over some lessons, and the chord of each.
fn chunk_gradient(
    network: &Network,
    lessons: &[Lesson],
    chunk: &[u32],
    weights: &[f32],
) -> (Vec<f32>, Vec<f32>) {
    pulp::Arch::new().dispatch(Descent { network, lessons, chunk, weights })
}

/// A call of [`chunk_gradient`], with the widest vectors of the processor and the same bits on all of them.
struct Descent<'a> {
    network: &'a Network,
    lessons: &'a [Lesson],
    chunk: &'a [u32],
    weights: &'a [f32],
}

impl NullaryFnOnce for Descent<'_> {
    type Output = (Vec<f32>, Vec<f32>);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { network, lessons, chunk, weights } = self;
        let parts = network.parts();
        let mut gradient = vec![0.0f32; PARAMETERS];
        let mut trace = Trace::default();
        let mut chords = Vec::with_capacity(chunk.len());
        for &l in chunk {
            let lesson = &lessons[l as usize];
            parts.run_inline(&lesson.sample, &mut trace);
            let mut outputs = [0.0f32; OUTPUTS];
            let weight = weights[lesson.pair as usize];
            chords.push(loss_gradient(lesson, &trace.outputs, weight, &mut outputs));
            backward(&parts.layers, &trace, &outputs, &mut gradient[2 * INPUTS..]);
        }
        (gradient, chords)
    }
}

/// The gradient of `weight · √(chord² + small²)` by the outputs; returns the
/// chord.
fn loss_gradient(
    lesson: &Lesson,
    outputs: &[f32; OUTPUTS],
    case: f32,
    gradient: &mut [f32; OUTPUTS],
) -> f32 {
    let sample = &lesson.sample;
    let (mean, total) = combine(sample, outputs);
    let dot3 = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot3(mean, mean).sqrt().max(1e-6);
    let n = mean.map(|x| x / length);
    let d = [n[0] - lesson.target[0], n[1] - lesson.target[1], n[2] - lesson.target[2]];
    let square = dot3(d, d);
    let factor = case / (square + SMALL * SMALL).sqrt();
    // By n, then by the mean: only what is across n counts.
    let along = dot3(d, n);
    let by_mean = [0, 1, 2].map(|k| factor * (d[k] - along * n[k]) / length);
    // The mean without the turn.
    let mut plain = mean;
    for k in 0..2 {
        let (value, slope) = turn(outputs[CANDIDATES + k]);
        plain[k] -= sample.spread * value;
        gradient[CANDIDATES + k] = by_mean[k] * sample.spread * slope;
    }
    for (k, g) in gradient[..CANDIDATES].iter_mut().enumerate() {
        let c = sample.candidate(k);
        let z = outputs[k];
        let by_weight = dot3(by_mean, [c[0] - plain[0], c[1] - plain[1], c[2] - plain[2]]) / total;
        *g = by_weight * 2.0 * weight(z) / (z * z + 4.0).sqrt();
    }
    square.sqrt()
}

/// Adds the gradient by the numbers of the layers.
#[inline(always)]
fn backward(
    layers: &[Layer<'_>; 3],
    trace: &Trace,
    by_outputs: &[f32; OUTPUTS],
    gradient: &mut [f32],
) {
    let (first, rest) = gradient.split_at_mut((INPUTS + 1) * HIDDEN);
    let (second, third) = rest.split_at_mut((HIDDEN + 1) * HIDDEN);
    outer(&trace.second, by_outputs, third);
    let mut by_second = [0.0f32; HIDDEN];
    transposed(&layers[2], by_outputs, &trace.second, &mut by_second);
    outer(&trace.first, &by_second, second);
    let mut by_first = [0.0f32; HIDDEN];
    transposed(&layers[1], &by_second, &trace.first, &mut by_first);
    outer(&trace.inputs, &by_first, first);
}

/// Adds `x gᵀ` and `g`.
#[inline(always)]
fn outer(x: &[f32], g: &[f32], into: &mut [f32]) {
    let (weights, biases) = into.split_at_mut(x.len() * g.len());
    for (row, &x) in weights.chunks_exact_mut(g.len()).zip(x) {
        row.iter_mut().zip(g).for_each(|(r, &g)| *r += x * g);
    }
    biases.iter_mut().zip(g).for_each(|(b, &g)| *b += g);
}

/// The gradient by the inputs of a layer before their rectification.
#[inline(always)]
fn transposed(layer: &Layer<'_>, g: &[f32], units: &[f32], out: &mut [f32]) {
    for ((o, &u), row) in out.iter_mut().zip(units).zip(layer.weights.chunks_exact(g.len())) {
        // Eight sums, so that processors can do them at once.
        let mut lanes = [0.0f32; 8];
        for (r, g) in row.chunks(8).zip(g.chunks(8)) {
            for ((lane, r), g) in lanes.iter_mut().zip(r).zip(g) {
                *lane += r * g;
            }
        }
        let sum: f32 = lanes.iter().sum();
        *o = if u > 0.0 { sum } else { LEAK * sum };
    }
}

/// A stream of random numbers (splitmix64).
pub(crate) struct Random(u64);

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
    fn shuffle(&mut self, items: &mut [u32], count: usize) {
        for i in 0..count.min(items.len()) {
            let j = i + (self.unit() * (items.len() - i) as f64) as usize;
            items.swap(i, j);
        }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    fn pair() -> TrainingPair {
        let truth = shapes::cube(8, shapes::Diagonals::Alternating);
        TrainingPair { noisy: shapes::jittered(&truth, 0.15, 3, |p| p), truth }
    }

    fn some_lessons() -> Vec<Lesson> {
        let TrainingPair { noisy, truth } = pair();
        let (hinges, rings) = (Hinges::new(&noisy), FaceLists::rings(&noisy));
        let progress = Progress::new(&noisy, &hinges, &rings, noise_level(&noisy).unwrap());
        lessons(&[(progress, FaceShapes::new(&truth).normals)], 40, &mut Random(1))
    }

    /// The gradient is that of the loss: differences over steps of 1/1024 in a
    /// few numbers of each layer. Rounding of single precision leaves 10⁻⁷ of
    /// the loss, 10⁻⁴ over the step.
    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let lessons = some_lessons();
        let mut network = start(&lessons, &mut Random(5));
        let chunk: Vec<u32> = (0..lessons.len() as u32).collect();
        let loss = |network: &Network| -> f64 {
            let mut trace = Trace::default();
            let mut sum = 0.0;
            for lesson in &lessons {
                network.parts().run(&lesson.sample, &mut trace);
                let mut unused = [0.0; OUTPUTS];
                let chord = loss_gradient(lesson, &trace.outputs, 1.0, &mut unused);
                sum += f64::from((chord * chord + SMALL * SMALL).sqrt());
            }
            sum
        };
        let (gradient, _) = chunk_gradient(&network, &lessons, &chunk, &[1.0]);
        let mut checked = 0;
        let outputs = 2 * INPUTS + (INPUTS + 1) * HIDDEN + (HIDDEN + 1) * HIDDEN;
        for k in (2 * INPUTS..PARAMETERS).step_by(997).chain(outputs..outputs + 60) {
            let at = network.numbers[k];
            let [up, down] = [1.0, -1.0].map(|side: f32| {
                network.numbers[k] = at + side / 1024.0;
                loss(&network)
            });
            network.numbers[k] = at;
            let slope = (up - down) * 512.0;
            let found = f64::from(gradient[k]);
            assert!((slope - found).abs() < 0.02 * slope.abs() + 2e-3, "{k}: {slope} {found}");
            checked += usize::from(slope.abs() > 0.02);
        }
        assert!(checked > 10, "{checked} slopes are large enough to tell");
    }

    /// A few steps lower the loss, to the same bits on one thread and on three.
    #[test]
    fn training_does_not_depend_on_the_threads() {
        let options =
            TrainingOptions { stages: 1, members: 2, faces_per_pair: 300, epochs: 40, seed: 2 };
        let train = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut lines = vec![];
            let bytes = pool.install(|| train_normals(&[pair()], &options, |l| lines.push(l)));
            (bytes.unwrap(), lines)
        };
        let (one, three) = (train(1), train(3));
        assert!(one == three);
        let number = |line: &str| -> f64 { line.rsplit(' ').next().unwrap().parse().unwrap() };
        assert!(number(&one.1[39]) < 0.9 * number(&one.1[0]), "{:?}", one.1);
    }
}
