//! The trained numbers, as a file of bytes.
//!
//! Numbers are rounded to half precision, which halves the package and takes half a megabyte off
//! every page with the module for browsers. The mantissa of bfloat16 is too short: it raises the
//! median error on the benchmark's development set by three percent.

use std::sync::OnceLock;

use half::f16;

use super::features::{CANDIDATES, INPUTS};
use super::network::{HIDDEN, Network, PARAMETERS};

/// The first bytes of the file.
const NAME: [u8; 8] = *b"fairnorm";

/// The version of the format and of the meaning of the inputs.
const VERSION: u32 = 4;

/// Name, version, stages, networks of each, inputs, hidden units, candidates, seed.
const HEADER: usize = 8 + 6 * 4 + 8;

/// The stages, in their order.
#[derive(Debug, Clone)]
pub struct Model {
    /// The networks of each stage, as many for each.
    pub stages: Vec<Vec<Network>>,
    /// The seed of the training.
    pub seed: u64,
}

impl Model {
    /// The model of this release; `None` if the bytes were damaged in the build.
    pub fn released() -> Option<&'static Self> {
        static MODEL: OnceLock<Option<Model>> = OnceLock::new();
        MODEL.get_or_init(|| Self::read(include_bytes!("../../data/normals.bin")).ok()).as_ref()
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
        if found != expected || members == 0 {
            return Err(format!("the sizes are {found:?}, but must be {expected:?}"));
        }
        let mut seed = [0; 8];
        seed.copy_from_slice(&body[HEADER - 8..HEADER]);
        let numbers: Vec<f32> = (body[HEADER..].chunks_exact(2))
            .map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32())
            .collect();
        let networks = numbers.len() / PARAMETERS;
        if numbers.len() != networks * PARAMETERS
            || networks as u64 != u64::from(stages) * u64::from(members)
        {
            let count = numbers.len();
            return Err(format!("{count} numbers for {stages} stages of {members} networks"));
        }
        if numbers.iter().any(|x| !x.is_finite()) {
            return Err("a number is not finite".into());
        }
        let networks: Vec<Network> =
            numbers.chunks_exact(PARAMETERS).map(|n| Network { numbers: n.to_vec() }).collect();
        let stages = networks.chunks(members as usize).map(<[Network]>::to_vec).collect();
        Ok(Self { stages, seed: u64::from_le_bytes(seed) })
    }

    /// The bytes of a file.
    pub fn write(&self) -> Vec<u8> {
        let [stages, members] = [self.stages.len(), self.stages.first().map_or(0, Vec::len)];
        let sizes = [stages, members, INPUTS, HIDDEN, CANDIDATES].map(|n| n as u32);
        let mut bytes = NAME.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(sizes.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.seed.to_le_bytes());
        let numbers = self.stages.iter().flatten().flat_map(|n| &n.numbers);
        bytes.extend(numbers.flat_map(|&x| f16::from_f32(x).to_le_bytes()));
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
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

    /// The released file is read; bytes that are missing, changed or of another
    /// version are not.
    #[test]
    fn damaged_files_are_refused() {
        let bytes = include_bytes!("../../data/normals.bin");
        let model = Model::read(bytes).unwrap();
        assert!(!model.stages.is_empty());
        assert_eq!(model.write(), bytes);
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
        assert!(changed(12, true).contains("numbers for"));
    }
}
