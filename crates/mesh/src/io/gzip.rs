//! Gzip, with a bound on the decompressed size.

use std::io::{ErrorKind, Read};

use flate2::read::MultiGzDecoder;

use crate::io::Reader;
use crate::io::error::{Fault, ReadProblem};

/// Decompresses all members of a gzip file.
///
/// Memory grows with the decoded bytes, never with a size that the file
/// claims; decoding stops at the limit of the reader.
pub(crate) fn unpack(bytes: &[u8], reader: &Reader) -> Result<Vec<u8>, Fault> {
    const STEP: usize = 1 << 18;
    let by_ratio = (bytes.len() as u64)
        .saturating_mul(reader.max_unpack_ratio)
        .saturating_add(Reader::FREE_UNPACKED_BYTES);
    let limit = by_ratio.min(reader.max_bytes);
    let mut decoder = MultiGzDecoder::new(bytes);
    let mut output = Vec::new();
    let mut block = vec![0u8; STEP.min(bytes.len().saturating_mul(4).max(1))];
    loop {
        let count = match decoder.read(&mut block) {
            Ok(0) => return Ok(output),
            Ok(count) => count,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(Fault::whole(ReadProblem::Compression(error))),
        };
        if (output.len() + count) as u64 > limit {
            let compressed = bytes.len() as u64;
            return Err(Fault::whole(ReadProblem::Grows { compressed, limit }));
        }
        output.extend_from_slice(&block[..count]);
    }
}
