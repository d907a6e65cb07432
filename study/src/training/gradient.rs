//! The gradient of the loss of a network.

use fairing_denoising::training::{
    BATCH, CANDIDATES, HIDDEN, INPUTS, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Sample, Trace,
    combine, turn, weight,
};
use pulp::NullaryFnOnce;

/// Chords below this count quadratically: 0.06°.
const SMALL: f32 = 1e-3;

/// Numbers that are summed at once.
const LANES: usize = 16;

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
        let [_, second, third] = &parts.layers;
        let transposed = [Transposed::new::<HIDDEN>(second), Transposed::new::<OUTPUTS>(third)];
        let mut chords = Vec::with_capacity(chunk.len());
        for batch in chunk.chunks(BATCH) {
            // The last lesson fills up the last batch.
            let lesson = |k: usize| &lessons[batch[k.min(batch.len() - 1)] as usize];
            parts.run(std::array::from_fn(|k| &lesson(k).sample), &mut traces);
            let mut by_outputs = [[0.0f32; OUTPUTS]; BATCH];
            for (k, (trace, slot)) in
                traces.iter().zip(&mut by_outputs).take(batch.len()).enumerate()
            {
                let weight = weights[lesson(k).pair as usize];
                chords.push(loss_gradient(lesson(k), &trace.outputs, weight, slot));
            }
            backward(&transposed, &traces, &by_outputs, &mut gradient[2 * INPUTS..]);
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
    [second, third]: &[Transposed<HIDDEN>; 2],
    traces: &[Trace; BATCH],
    by_outputs: &[[f32; OUTPUTS]; BATCH],
    gradient: &mut [f32],
) {
    let (to_first, rest) = gradient.split_at_mut((INPUTS + 1) * HIDDEN);
    let (to_second, to_third) = rest.split_at_mut((HIDDEN + 1) * HIDDEN);
    let seconds = traces.each_ref().map(|t| &t.second);
    outer(seconds, by_outputs, to_third);
    let by_second = third.by_units(by_outputs, seconds);
    let firsts = traces.each_ref().map(|t| &t.first);
    outer(firsts, &by_second, to_second);
    let by_first = second.by_units(&by_second, firsts);
    outer(traces.each_ref().map(|t| &t.inputs), &by_first, to_first);
}

/// Adds `Σ x gᵀ` and `Σ g` over the samples.
#[inline(always)]
fn outer<const M: usize, const N: usize>(
    x: [&[f32; M]; BATCH],
    g: &[[f32; N]; BATCH],
    into: &mut [f32],
) {
    const { assert!(N.is_multiple_of(LANES)) };
    let (weights, biases) = into.split_at_mut(M * N);
    // The gradients of a few outputs stay in registers.
    for first in (0..N).step_by(LANES) {
        let g: [[f32; LANES]; BATCH] =
            std::array::from_fn(|k| std::array::from_fn(|j| g[k][first + j]));
        for (i, row) in weights.chunks_exact_mut(N).enumerate() {
            let row = &mut row[first..first + LANES];
            let mut sums = [0.0f32; LANES];
            for (x, g) in x.iter().zip(&g) {
                sums.iter_mut().zip(g).for_each(|(s, g)| *s += x[i] * g);
            }
            row.iter_mut().zip(sums).for_each(|(r, s)| *r += s);
        }
        for g in &g {
            biases[first..first + LANES].iter_mut().zip(g).for_each(|(b, g)| *b += g);
        }
    }
}

/// A layer with its weights transposed, without biases.
struct Transposed<const M: usize> {
    weights: Vec<f32>,
    zeros: [f32; M],
}

impl<const M: usize> Transposed<M> {
    /// Of a layer of `M` inputs.
    #[inline(always)]
    fn new<const N: usize>(layer: &Layer<'_>) -> Self {
        let mut weights = vec![0.0f32; M * N];
        for (i, row) in layer.weights.chunks_exact(N).enumerate() {
            for (j, &w) in row.iter().enumerate() {
                weights[j * M + i] = w;
            }
        }
        Self { weights, zeros: [0.0; M] }
    }

    /// The gradients by the inputs of the layer before their rectification, from those by its
    /// outputs.
    #[inline(always)]
    fn by_units<const N: usize>(
        &self,
        g: &[[f32; N]; BATCH],
        units: [&[f32; M]; BATCH],
    ) -> [[f32; M]; BATCH] {
        let layer = Layer { weights: &self.weights, biases: &self.zeros };
        let mut out = layer.apply(g.each_ref());
        for (out, units) in out.iter_mut().zip(units) {
            for (x, &u) in out.iter_mut().zip(units) {
                *x *= if u > 0.0 { 1.0 } else { LEAK };
            }
        }
        out
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
