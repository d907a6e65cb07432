//! The trained numbers, as a file of bytes.
//!
//! Weights are rounded to a few bits over a step for each unit, because they are most of the size
//! that the networks add to the package and to every page with the module for browsers.

use std::sync::OnceLock;

use super::features::{CANDIDATES, INPUTS};
use super::network::{HIDDEN, LAYERS, Network};

/// The first bytes of the file.
const NAME: [u8; 8] = *b"fairnorm";

/// The version of the format and of the meaning of the inputs.
const VERSION: u32 = 5;

/// Name, version, stages, networks of each, inputs, hidden units, candidates, bits of a weight,
/// seed.
const HEADER: usize = 8 + 7 * 4 + 8;

/// The bytes of a network: single precision for shift and scale of the inputs, and for the steps
/// and the biases of all units; one byte for each weight of up to eight bits, else two.
fn size(bits: u32) -> usize {
    let layers = LAYERS.map(|[inputs, outputs]| (4 + width(bits) * inputs + 4) * outputs);
    4 * 2 * INPUTS + layers.iter().sum::<usize>()
}

/// The bytes of a weight.
fn width(bits: u32) -> usize {
    if bits <= 8 { 1 } else { 2 }
}

/// The networks for all meshes.
const FOR_ALL: &[u8] = include_bytes!("../../data/normals.bin");

/// The networks for correlated noise.
const FOR_CORRELATED: &[u8] = include_bytes!("../../data/normals-correlated.bin");

/// The meshes that networks are trained for.
#[derive(Clone, Copy)]
pub(super) enum Trained {
    /// All meshes.
    ForAll,
    /// Meshes with correlated noise.
    ForCorrelated,
}

/// The stages, in their order.
#[derive(Debug, Clone)]
pub struct Model {
    /// The networks of each stage, as many for each.
    pub stages: Vec<Vec<Network>>,
    /// The bits of a weight in the file, from 2 to 12.
    pub bits: u32,
    /// The seed of the training.
    pub seed: u64,
}

impl Model {
    /// The model of this release; `None` if the bytes were damaged in the build.
    pub(super) fn released(trained: Trained) -> Option<&'static Self> {
        static ALL: OnceLock<Option<Model>> = OnceLock::new();
        static CORRELATED: OnceLock<Option<Model>> = OnceLock::new();
        let (model, bytes) = match trained {
            Trained::ForAll => (&ALL, FOR_ALL),
            Trained::ForCorrelated => (&CORRELATED, FOR_CORRELATED),
        };
        model.get_or_init(|| Self::read(bytes).ok()).as_ref()
    }

    /// Reads the bytes that [`Model::write`] wrote.
    ///
    /// # Errors
    ///
    /// A description of the damage.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let (body, sum) = bytes
            .len()
            .checked_sub(8)
            .filter(|&n| n >= HEADER)
            .map(|n| bytes.split_at(n))
            .ok_or("the file is cut off")?;
        if body[..8] != NAME {
            return Err("the file holds no regression of normals".into());
        }
        if sum != checksum(body).to_le_bytes() {
            return Err("the checksum differs".into());
        }
        let word = |k: usize| {
            let at = 8 + 4 * k;
            u32::from_le_bytes([body[at], body[at + 1], body[at + 2], body[at + 3]])
        };
        let [stages, members] = [1, 2].map(word);
        let expected = [VERSION, stages, members, INPUTS as u32, HIDDEN as u32, CANDIDATES as u32];
        let found = [0, 1, 2, 3, 4, 5].map(word);
        let bits = word(6);
        if !(2..=12).contains(&bits) {
            return Err(format!("{bits} bits for a weight"));
        }
        if found != expected || members == 0 {
            return Err(format!("the sizes are {found:?}, but must be {expected:?}"));
        }
        let mut seed = [0; 8];
        seed.copy_from_slice(&body[HEADER - 8..HEADER]);
        let (bytes, size) = (&body[HEADER..], size(bits));
        if bytes.len() as u64 != u64::from(stages) * u64::from(members) * size as u64 {
            let count = bytes.len();
            return Err(format!("{count} bytes for {stages} stages of {members} networks"));
        }
        let networks: Vec<Network> =
            bytes.chunks_exact(size).map(|bytes| read_network(bytes, bits)).collect();
        if networks.iter().flat_map(|n| &n.numbers).any(|x| !x.is_finite()) {
            return Err("a number is not finite".into());
        }
        let stages = networks.chunks(members as usize).map(<[Network]>::to_vec).collect();
        Ok(Self { stages, bits, seed: u64::from_le_bytes(seed) })
    }

    /// The bytes of a file.
    pub fn write(&self) -> Vec<u8> {
        let [stages, members] = [self.stages.len(), self.stages.first().map_or(0, Vec::len)];
        let sizes = [stages, members, INPUTS, HIDDEN, CANDIDATES].map(|n| n as u32);
        let mut bytes = NAME.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(sizes.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.bits.to_le_bytes());
        bytes.extend(self.seed.to_le_bytes());
        let networks = self.stages.iter().flatten();
        networks.for_each(|network| write_network(network, self.bits, &mut bytes));
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }
}

fn read_network(bytes: &[u8], bits: u32) -> Network {
    let floats = |bytes: &[u8]| -> Vec<f32> {
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    };
    let width = width(bits);
    let (inputs, mut rest) = bytes.split_at(4 * 2 * INPUTS);
    let mut numbers = floats(inputs);
    for [inputs, outputs] in LAYERS {
        let (steps, after) = rest.split_at(4 * outputs);
        let (weights, after) = after.split_at(width * inputs * outputs);
        let (biases, after) = after.split_at(4 * outputs);
        let codes = weights.chunks_exact(width).map(|code| match *code {
            [low, high] => f32::from(i16::from_le_bytes([low, high])),
            _ => f32::from(code[0].cast_signed()),
        });
        numbers.extend(codes.zip(floats(steps).iter().cycle()).map(|(code, step)| code * step));
        numbers.extend(floats(biases));
        rest = after;
    }
    Network { numbers }
}

fn write_network(network: &Network, bits: u32, bytes: &mut Vec<u8>) {
    let floats = |numbers: &[f32], bytes: &mut Vec<u8>| {
        bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    };
    let most = f32::from((1i16 << (bits - 1)) - 1);
    let (inputs, mut rest) = network.numbers.split_at(2 * INPUTS);
    floats(inputs, bytes);
    for [inputs, outputs] in LAYERS {
        let (weights, after) = rest.split_at(inputs * outputs);
        let (biases, after) = after.split_at(outputs);
        let mut steps = vec![1e-30f32; outputs];
        for row in weights.chunks_exact(outputs) {
            steps.iter_mut().zip(row).for_each(|(step, w)| *step = step.max(w.abs()));
        }
        // The last bits of a step are zero, and its product with the largest code is exact: what is
        // read is written again as the same bytes.
        let unused = (1u32 << bits) - 1;
        steps
            .iter_mut()
            .for_each(|step| *step = f32::from_bits((*step / most).to_bits() & !unused));
        floats(&steps, bytes);
        for (w, step) in weights.iter().zip(steps.iter().cycle()) {
            let code = ((w / step).round() as i16).to_le_bytes();
            bytes.extend(&code[..width(bits)]);
        }
        floats(biases, bytes);
        rest = after;
    }
}

/// The 64-bit hash of Fowler, Noll and Vo (FNV-1a).
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &b| {
        (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The released files are read; bytes that are missing, changed or of another
    /// version are not.
    #[test]
    fn damaged_files_are_refused() {
        for bytes in [FOR_ALL, FOR_CORRELATED] {
            let model = Model::read(bytes).unwrap();
            assert!(!model.stages.is_empty());
            assert_eq!(model.write(), bytes);
        }
        let bytes = FOR_ALL;
        assert!(Model::read(&bytes[..bytes.len() - 4]).unwrap_err().contains("checksum"));
        assert!(Model::read(&bytes[..20]).unwrap_err().contains("cut off"));
        let changed = |at: usize, mended: bool| {
            let mut bytes = bytes.to_vec();
            bytes[at] ^= 1;
            if mended {
                let n = bytes.len() - 8;
                let sum = checksum(&bytes[..n]).to_le_bytes();
                bytes[n..].copy_from_slice(&sum);
            }
            Model::read(&bytes).unwrap_err()
        };
        assert!(changed(bytes.len() / 2, false).contains("checksum"));
        assert!(changed(3, true).contains("no regression"));
        assert!(changed(8, true).contains("sizes"));
        assert!(changed(12, true).contains("bytes for"));
    }
}
