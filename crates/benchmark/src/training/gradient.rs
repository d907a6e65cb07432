//! The gradient of the loss of a network.

use fairing_denoising::training::{
    BATCH, CANDIDATES, HIDDEN, INPUTS, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Sample, Trace,
    combine, turn, weight,
};
use pulp::NullaryFnOnce;

/// Chords below this count quadratically: 0.06°.
const SMALL: f32 = 1e-3;

/// A face to learn from.
pub(super) struct Lesson {
    pub(super) sample: Sample,
    /// The true normal in the frame of the sample.
    pub(super) target: [f32; 3],
    /// The number of the pair that the face is from.
    pub(super) pair: u32,
}

/// The summed gradient over some lessons, and the chord of each.
pub(super) fn chunk_gradient(
    network: &Network,
    lessons: &[Lesson],
    chunk: &[u32],
    weights: &[f32],
) -> (Vec<f32>, Vec<f32>) {
    pulp::Arch::new().dispatch(Descent { network, lessons, chunk, weights })
}

/// A call of [`chunk_gradient`], with the widest vectors of the processor and the same bits on all
/// of them.
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
        let mut traces: [Trace; BATCH] = Default::default();
        let mut chords = Vec::with_capacity(chunk.len());
        for batch in chunk.chunks(BATCH) {
            // The last lesson fills up the last batch.
            let lesson = |k: usize| &lessons[batch[k.min(batch.len() - 1)] as usize];
            parts.run(std::array::from_fn(|k| &lesson(k).sample), &mut traces);
            for (k, trace) in traces[..batch.len()].iter().enumerate() {
                let mut outputs = [0.0f32; OUTPUTS];
                let weight = weights[lesson(k).pair as usize];
                chords.push(loss_gradient(lesson(k), &trace.outputs, weight, &mut outputs));
                backward(&parts.layers, trace, &outputs, &mut gradient[2 * INPUTS..]);
            }
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

#[cfg(test)]
mod tests {
    use super::super::fit::{Random, start};
    use super::super::tests::some_lessons;
    use super::*;

    /// The gradient is that of the loss: differences over steps of 1/1024 in a
    /// few numbers of each layer. Rounding of single precision leaves 10⁻⁷ of
    /// the loss, 10⁻⁴ over the step.
    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let lessons = some_lessons();
        let mut network = start(&lessons, &mut Random(5));
        let chunk: Vec<u32> = (0..lessons.len() as u32).collect();
        let loss = |network: &Network| -> f64 {
            let mut traces: [Trace; BATCH] = Default::default();
            let mut sum = 0.0;
            for lesson in &lessons {
                network.parts().run([&lesson.sample; BATCH], &mut traces);
                let mut unused = [0.0; OUTPUTS];
                let chord = loss_gradient(lesson, &traces[0].outputs, 1.0, &mut unused);
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
}
