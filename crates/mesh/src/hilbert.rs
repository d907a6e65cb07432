//! The Hilbert curve through a cube, along which neighbours stay close.

/// Bits of each coordinate; cells of 1/2048 of the extent keep runs of a few
/// faces compact up to millions of faces.
const BITS: u32 = 12;

/// The place of a point of [−1, 1]³ along the Hilbert curve; points outside
/// count as on the border. Source: [skilling2004].
///
/// [skilling2004]: https://doi.org/10.1063/1.1751381
pub fn hilbert(q: [f32; 3]) -> u64 {
    let cells = (1u32 << BITS) as f32;
    // A cast from floating point saturates.
    let mut x = q.map(|t| ((t + 1.0) * 0.5 * cells).clamp(0.0, cells - 1.0) as u32);
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        let low = bit - 1;
        for k in 0..3 {
            if x[k] & bit != 0 {
                x[0] ^= low;
            } else {
                let t = (x[0] ^ x[k]) & low;
                x[0] ^= t;
                x[k] ^= t;
            }
        }
        bit >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut flips = 0;
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        if x[2] & bit != 0 {
            flips ^= bit - 1;
        }
        bit >>= 1;
    }
    let x = x.map(|t| spread(u64::from(t ^ flips)));
    x[0] << 2 | x[1] << 1 | x[2]
}

/// Bit `i` moved to bit `3i`.
fn spread(mut x: u64) -> u64 {
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along the curve through a 16 × 16 × 16 grid, each step leads to a neighbour.
    #[test]
    fn steps_lead_to_neighbours() {
        let n = 16i32;
        let mut cells = vec![];
        for i in 0..n * n * n {
            let place = [i % n, i / n % n, i / (n * n)];
            // Centres, a fine cell away from ties.
            let q = place.map(|k| (k as f32 + 0.5) / n as f32 * 2.0 - 1.0);
            cells.push((hilbert(q) >> (3 * (BITS - 4)), place));
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let steps: i32 = (0..3).map(|k| (pair[0].1[k] - pair[1].1[k]).abs()).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }
}
