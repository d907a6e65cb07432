//! The chunks of a GLB file, and its JSON by paths.

use std::borrow::Cow;

use serde_json::Value;

use crate::io::error::{Fault, unexpected};
use crate::io::glb::buffers::{self, Beside, Buffer};
use crate::io::glb::entry::Entry;

/// The name of the format.
pub(super) const NAME: &str = "GLB";

/// The first four bytes of a file.
pub(super) const MAGIC: &[u8] = b"glTF";

/// The types of chunks.
pub(super) const JSON: u32 = u32::from_le_bytes(*b"JSON");
pub(super) const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// The modes of primitives.
pub(super) const POINTS: usize = 0;
pub(super) const TRIANGLES: usize = 4;

/// The JSON and the binary data of a file.
pub(super) struct Document<'a> {
    pub(super) root: Value,
    pub(super) buffers: Vec<Option<Buffer<'a>>>,
}

impl<'a> Document<'a> {
    /// Reads GLB, or JSON alone.
    pub(super) fn read(bytes: &'a [u8], beside: Beside<'_>) -> Result<Self, Fault> {
        let json = |at: usize, text| {
            serde_json::from_slice(text).map_err(|error| {
                Fault::at_byte(at, unexpected("the JSON of glTF", error.to_string()))
            })
        };
        let (root, binary) = if bytes.starts_with(MAGIC) {
            let (text, binary) = chunks(bytes)?;
            (json(20, text)?, binary)
        } else {
            (json(0, bytes)?, None)
        };
        let entry = Entry::root(&root);
        let buffers = buffers::read(&entry, binary, beside)?;
        Ok(Self { root, buffers })
    }

    /// The number of bytes of all buffers.
    pub(super) fn length(&self) -> usize {
        self.buffers.iter().flatten().map(|buffer| buffer.data.len()).sum()
    }

    /// The whole of the JSON.
    pub(super) fn root(&self) -> Entry<'_> {
        Entry::root(&self.root)
    }
}

/// The JSON of a GLB file and its binary data.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<Buffer<'_>>), Fault> {
    let version = word(bytes, 4).unwrap_or_default();
    if version != 2 {
        return Err(Fault::at_byte(4, unexpected("version 2 of glTF", version.to_string())));
    }
    let length = word(bytes, 8).unwrap_or_default() as usize;
    let Some(bytes) = bytes.get(..length) else {
        let expected = format!("{length} bytes, as the header says");
        return Err(Fault::at_byte(8, unexpected(expected, bytes.len().to_string())));
    };
    let (json, mut at) = chunk(bytes, 12, JSON)?;
    let mut binary = None;
    if at < bytes.len() && word(bytes, at + 4) == Some(BINARY) {
        let start = at + 8;
        let data;
        (data, at) = chunk(bytes, at, BINARY)?;
        binary = Some(Buffer { data: Cow::Borrowed(data), at: Some(start) });
    }
    // Chunks of other types may follow, which readers have to ignore.
    while at < bytes.len() {
        let kind = word(bytes, at + 4).unwrap_or_default();
        (_, at) = chunk(bytes, at, kind)?;
    }
    Ok((json, binary))
}

/// The number of four bytes.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes))
}

/// The content of a chunk, and the place after it.
fn chunk(bytes: &[u8], at: usize, kind: u32) -> Result<(&[u8], usize), Fault> {
    let fault = |expected: &str| {
        let found = format!("{} bytes", bytes.len().saturating_sub(at));
        Fault::at_byte(at, unexpected(expected, found))
    };
    let (Some(length), Some(found)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Err(fault("the 8 bytes of the header of a chunk"));
    };
    if found != kind {
        let problem = unexpected("the chunk of JSON", format!("a chunk of type {found:#x}"));
        return Err(Fault::at_byte(at, problem));
    }
    let start = at + 8;
    let end = start.checked_add(length as usize).filter(|&end| end <= bytes.len());
    let Some(end) = end else {
        return Err(fault(&format!("a chunk of {length} bytes")));
    };
    Ok((&bytes[start..end], end))
}
