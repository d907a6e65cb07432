//! Normally distributed numbers.

use std::sync::LazyLock;

use rand::RngExt as _;
use rand::distr::Open01;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng as _;

/// The start of the tail, and the area of each of 256 layers.
const TAIL: f64 = 3.654_152_885_361_009;
const LAYER: f64 = 0.004_928_673_233_99;

/// The density exp(−x²/2).
fn density(x: f64) -> f64 {
    libm::exp(-x * x / 2.0)
}

/// The ends of the layers, from the lowest to the peak, and the density there.
struct Layers {
    ends: [f64; 257],
    densities: [f64; 257],
}

static LAYERS: LazyLock<Layers> = LazyLock::new(|| {
    let mut ends = [0.0; 257];
    ends[0] = LAYER / density(TAIL);
    ends[1] = TAIL;
    for i in 1..255 {
        ends[i + 1] = (-2.0 * libm::log(LAYER / ends[i] + density(ends[i]))).sqrt();
    }
    Layers { ends, densities: ends.map(density) }
});

/// A number of mean 0 and variance 1, by the ziggurat method: the numbers of
/// `rand_distr::StandardNormal` from the same generator, up to rounding. Those
/// depend on the exp and log of the C library, and so on the processor.
///
/// Source: [marsaglia2000], in the layout of `rand_distr`.
///
/// [marsaglia2000]: https://doi.org/10.18637/jss.v005.i08
pub(crate) fn standard_normal(rng: &mut ChaCha8Rng) -> f64 {
    let Layers { ends, densities } = &*LAYERS;
    loop {
        let bits = rng.next_u64();
        let i = (bits & 0xff) as usize;
        // In [−1, 1), from a number in [2, 4).
        let u = f64::from_bits(0x400 << 52 | bits >> 12) - 3.0;
        let x = u * ends[i];
        if x.abs() < ends[i + 1] {
            return x;
        }
        if i == 0 {
            return tail(rng).copysign(u);
        }
        let share: f64 = rng.random();
        if densities[i + 1] + (densities[i] - densities[i + 1]) * share < density(x) {
            return x;
        }
    }
}

/// The size of a number in the tail.
fn tail(rng: &mut ChaCha8Rng) -> f64 {
    loop {
        let x = -libm::log(rng.sample::<f64, _>(Open01)) / TAIL;
        let y = -libm::log(rng.sample::<f64, _>(Open01));
        if 2.0 * y >= x * x {
            return TAIL + x;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;

    /// The output of `rand_distr` 0.6 for the same seed: the first numbers, and the sums of a
    /// hundred thousand and of their fourth powers. About 26 of these are in the tail, and about a
    /// thousand are decided by the density.
    #[test]
    fn numbers_are_those_of_rand_distr() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let all: Vec<f64> = (0..100_000).map(|_| standard_normal(&mut rng)).collect();
        let first = [
            -0.7253071115339691,
            -1.4741395727830924,
            -0.4053485149742836,
            0.14549799921117848,
            -0.2693095584214087,
            1.8668137365557154,
        ];
        for (x, y) in all.iter().zip(first) {
            assert!((x - y).abs() <= 1e-14 * y.abs(), "{x} and {y}");
        }
        let sum: f64 = all.iter().sum();
        let powers: f64 = all.iter().map(|x| x * x * x * x).sum();
        assert!((sum - 326.426136710676).abs() < 1e-9, "{sum}");
        assert!((powers - 299051.67077989975).abs() < 1e-6, "{powers}");
        for side in [-1.0, 1.0] {
            assert!(all.iter().filter(|x| *x * side > TAIL).count() > 2);
        }
    }
}
