//! Normally distributed numbers.

use std::sync::LazyLock;

use rand::RngExt as _;
use rand::distr::Open01;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng as _;

/// Where the tail begins, and the area of each layer, of 256 layers.
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
/// Source: \[marsaglia2000\], in the layout of `rand_distr`.
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
    use rand_distr::StandardNormal;

    use super::*;

    /// A hundred thousand numbers have about 26 in the tail and some thousand
    /// that the density decides.
    #[test]
    fn numbers_are_those_of_rand_distr() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut other = rng.clone();
        let mut tails = [0; 2];
        for _ in 0..100_000 {
            let (x, y) = (standard_normal(&mut rng), other.sample::<f64, _>(StandardNormal));
            assert!((x - y).abs() <= 1e-14 * y.abs(), "{x} and {y}");
            tails[usize::from(x > 0.0)] += usize::from(x.abs() > TAIL);
        }
        assert!(tails[0] > 2 && tails[1] > 2, "{tails:?}");
        assert_eq!(rng, other);
    }
}
