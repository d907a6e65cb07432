//! The compressed data of a view, which `assets/data.mjs` reads.
//!
//! Arrays stand one after another. Numbers are kept as differences to their
//! predecessors, zigzag-coded so that small ones of either sign have few bits,
//! and split into planes of bytes, which zlib compresses well: an array of
//! positions takes about a fifth of its size in single precision.

use std::io::Write as _;

use anyhow::Result;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::page::base85;

/// Arrays to be compressed.
#[derive(Debug, Default)]
pub(super) struct Pack {
    bytes: Vec<u8>,
}

impl Pack {
    /// 32-bit integers.
    pub(super) fn integers(&mut self, values: &[u32]) {
        let mut last = 0u32;
        let codes: Vec<u32> = values
            .iter()
            .map(|&x| {
                let step = x.wrapping_sub(std::mem::replace(&mut last, x)) as i32;
                ((step << 1) ^ (step >> 31)) as u32
            })
            .collect();
        self.planes::<4>(codes.iter().map(|c| c.to_le_bytes()));
    }

    /// 16-bit integers with `N` components, each coded by itself.
    pub(super) fn shorts<const N: usize>(&mut self, values: &[[u16; N]]) {
        for c in 0..N {
            let mut last = 0u16;
            let codes: Vec<u16> = values
                .iter()
                .map(|x| {
                    let step = x[c].wrapping_sub(std::mem::replace(&mut last, x[c])) as i16;
                    ((step << 1) ^ (step >> 15)) as u16
                })
                .collect();
            self.planes::<2>(codes.iter().map(|c| c.to_le_bytes()));
        }
    }

    /// Double precision, bit by bit: each number exclusive-or its predecessor.
    pub(super) fn doubles(&mut self, values: &[[f64; 3]]) {
        for c in 0..3 {
            let mut last = 0u64;
            let codes: Vec<u64> = values
                .iter()
                .map(|x| x[c].to_bits() ^ std::mem::replace(&mut last, x[c].to_bits()))
                .collect();
            self.planes::<8>(codes.iter().map(|c| c.to_le_bytes()));
        }
    }

    /// Bytes as they are.
    pub(super) fn raw(&mut self, bytes: impl IntoIterator<Item = u8>) {
        self.bytes.extend(bytes);
    }

    fn planes<const N: usize>(&mut self, codes: impl Iterator<Item = [u8; N]> + Clone) {
        for plane in 0..N {
            self.bytes.extend(codes.clone().map(|c| c[plane]));
        }
    }

    /// Compressed, as text.
    pub(super) fn finish(self) -> Result<String> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&self.bytes)?;
        Ok(base85::encode(&encoder.finish()?))
    }
}

/// Quantisation of the values of a field to 16-bit integers: evenly in
/// `asinh(x / scale)`, which is `x` for values up to the typical `scale` and a
/// logarithm beyond, so that a few huge values do not take away the digits of
/// all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quantiser {
    pub(super) scale: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// The code of an undefined value.
pub(super) const UNDEFINED: u16 = u16::MAX;

impl Quantiser {
    /// Fits all of `values`; those that are not finite are left out.
    pub(super) fn fit(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.filter(|x| x.is_finite()).collect();
        let mut sizes: Vec<f64> = values.iter().map(|x| x.abs()).filter(|&x| x > 0.0).collect();
        let middle = sizes.len() / 2;
        let scale = match sizes.is_empty() {
            true => 1.0,
            false => *sizes.select_nth_unstable_by(middle, f64::total_cmp).1,
        };
        let ends = values.iter().map(|x| libm::asinh(x / scale));
        let (low, high) = ends.fold((0.0f64, 0.0f64), |(a, b), t| (a.min(t), b.max(t)));
        Self { scale, low, high }
    }

    pub(super) fn code(&self, value: f64) -> u16 {
        if !value.is_finite() {
            return UNDEFINED;
        }
        let width = self.high - self.low;
        if width <= 0.0 {
            return 0;
        }
        let t = (libm::asinh(value / self.scale) - self.low) / width;
        (t * 65_534.0).round().clamp(0.0, 65_534.0) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The counterpart of `dequantised` in `data.mjs`.
    fn value(q: &Quantiser, code: u16) -> f64 {
        q.scale * (q.low + (q.high - q.low) * f64::from(code) / 65_534.0).sinh()
    }

    #[test]
    fn small_values_survive_beside_huge_ones() {
        let mut values: Vec<f64> = (-500..500).map(|i| f64::from(i) * 0.01).collect();
        values.push(1e12);
        let q = Quantiser::fit(values.iter().copied());
        for &x in &values {
            let back = value(&q, q.code(x));
            assert!((back - x).abs() <= 2e-3 * x.abs().max(q.scale), "{x} came back as {back}");
        }
        assert_eq!(q.code(f64::NAN), UNDEFINED);
        let flat = Quantiser::fit([0.0; 4].into_iter());
        assert_eq!(value(&flat, flat.code(0.0)), 0.0);
    }

    #[test]
    fn steps_are_small_and_planes_are_split() {
        let mut pack = Pack::default();
        pack.integers(&[5, 4, 300]);
        // Zigzag: 5 is 10, −1 is 1, 296 is 592 = 2 · 256 + 80.
        assert_eq!(pack.bytes, [10, 1, 80, 0, 0, 2, 0, 0, 0, 0, 0, 0]);
        let mut pack = Pack::default();
        pack.shorts(&[[1, 65_535], [0, 0]]);
        assert_eq!(pack.bytes, [2, 1, 0, 0, 1, 2, 0, 0]);
    }
}
