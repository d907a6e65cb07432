//! The chunks of a GLB file, and its JSON by paths.

use std::borrow::Cow;

use serde_json::Value;

use crate::io::error::{Fault, unexpected};
use crate::io::glb::buffers::{self, Beside, Buffer};

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
        let entry = Entry { value: &root, path: String::new() };
        let buffers = buffers::read(&entry, binary, beside)?;
        Ok(Self { root, buffers })
    }

    /// The number of bytes of all buffers.
    pub(super) fn length(&self) -> usize {
        self.buffers.iter().flatten().map(|buffer| buffer.data.len()).sum()
    }

    /// The whole of the JSON.
    pub(super) fn root(&self) -> Entry<'_> {
        Entry { value: &self.root, path: String::new() }
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

/// A value of the JSON with its path in it.
#[derive(Clone)]
pub(super) struct Entry<'a> {
    value: &'a Value,
    path: String,
}

impl<'a> Entry<'a> {
    /// An error about this value.
    pub(super) fn fault(&self, expected: &str, found: impl Into<String>) -> Fault {
        let path = if self.path.is_empty() { "the JSON" } else { &self.path };
        Fault::whole(unexpected(format!("{expected} at {path}"), found))
    }

    /// An error that shows this value.
    fn other(&self, expected: &str) -> Fault {
        let mut found = self.value.to_string();
        if let Some((cut, _)) = found.char_indices().nth(40) {
            found.truncate(cut);
            found.push('…');
        }
        self.fault(expected, found)
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }

    pub(super) fn get(&self, key: &str) -> Option<Entry<'a>> {
        let dot = if self.path.is_empty() { "" } else { "." };
        let value = self.value.get(key).filter(|value| !value.is_null())?;
        Some(Entry { value, path: format!("{}{dot}{key}", self.path) })
    }

    /// The element of a list of the document.
    pub(super) fn at(&self, list: &str, index: usize) -> Result<Entry<'a>, Fault> {
        let found = self.value.get(list).and_then(|all| all.get(index));
        match found {
            Some(value) => Ok(Entry { value, path: format!("{list}[{index}]") }),
            None => Err(self.fault(&format!("{list}[{index}]"), "none")),
        }
    }

    /// The elements of a list, none if it is missing.
    pub(super) fn list(&self, key: &str) -> Result<Vec<Entry<'a>>, Fault> {
        let Some(list) = self.get(key) else { return Ok(vec![]) };
        let values = list.value.as_array().ok_or_else(|| list.other("a list"))?;
        let entry = |(k, value)| Entry { value, path: format!("{}[{k}]", list.path) };
        Ok(values.iter().enumerate().map(entry).collect())
    }

    /// The members of an object.
    pub(super) fn members(&self) -> Result<Vec<(&'a str, Entry<'a>)>, Fault> {
        let members = self.value.as_object().ok_or_else(|| self.other("an object"))?;
        let entry = |(key, value): (&'a String, _)| {
            (&key[..], Entry { value, path: format!("{}.{key}", self.path) })
        };
        Ok(members.iter().map(entry).collect())
    }

    pub(super) fn text(&self) -> Option<&'a str> {
        self.value.as_str()
    }

    pub(super) fn flag(&self, key: &str) -> bool {
        self.value.get(key).and_then(Value::as_bool).unwrap_or_default()
    }

    /// This value as an index or a count.
    pub(super) fn count(&self) -> Result<usize, Fault> {
        let count = self.value.as_u64().and_then(|count| usize::try_from(count).ok());
        count.ok_or_else(|| self.other("an integer"))
    }

    /// A member as an index or a count.
    pub(super) fn optional_count(&self, key: &str) -> Result<Option<usize>, Fault> {
        self.get(key).map(|entry| entry.count()).transpose()
    }

    /// A member as an index or a count, which must exist.
    pub(super) fn required_count(&self, key: &str) -> Result<usize, Fault> {
        self.optional_count(key)?.ok_or_else(|| self.fault(&format!("an integer {key}"), "none"))
    }

    /// A member as numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        let Some(entry) = self.get(key) else { return Ok(None) };
        let numbers = entry.value.as_array().and_then(|values| {
            let values: Option<Vec<f64>> = values.iter().map(Value::as_f64).collect();
            values?.try_into().ok()
        });
        numbers.map(Some).ok_or_else(|| entry.other(&format!("{N} numbers")))
    }
}

/// Same value of the JSON.
impl PartialEq for Entry<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}
