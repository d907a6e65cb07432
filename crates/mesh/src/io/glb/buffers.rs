//! The buffers of a file: its binary chunk, data in its URIs, and files beside it.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::io::ReadProblem;
use crate::io::error::Fault;
use crate::io::glb::entry::Entry;

/// The folder of a file, in which its buffers are, and the most bytes that are read of them.
#[derive(Clone, Copy, Default)]
pub(crate) struct Beside<'a> {
    /// `None` for bytes and streams, which have no folder.
    pub(crate) folder: Option<&'a Path>,
    pub(crate) max_bytes: u64,
}

/// The data of a buffer, and their place in the file if they are a part of it.
#[derive(Clone)]
pub(super) struct Buffer<'a> {
    pub(super) data: Cow<'a, [u8]>,
    pub(super) at: Option<usize>,
}

/// The data of each buffer, `None` for those without any. The binary chunk is the first one's.
pub(super) fn read<'a>(
    root: &Entry<'_>,
    mut binary: Option<Buffer<'a>>,
    beside: Beside<'_>,
) -> Result<Vec<Option<Buffer<'a>>>, Fault> {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut left = beside.max_bytes;
    let mut buffers = Vec::new();
    for entry in root.list("buffers")? {
        let Some(uri) = entry.get("uri") else {
            buffers.push(binary.take());
            continue;
        };
        let text = uri.text().ok_or_else(|| uri.fault("a URI", "another value"))?;
        let data = match text.strip_prefix("data:") {
            Some(data) => decoded(data).ok_or_else(|| uri.fault("data in base64", "others"))?,
            None => {
                let path = path_of(text, &uri, beside.folder)?;
                // Each file once, so that memory grows with the files.
                if files.contains(&path) {
                    return Err(uri.fault("a file that is no other buffer", format!("{text:?}")));
                }
                let length = entry.required_count("byteLength")? as u64;
                if length > left {
                    let limit = beside.max_bytes;
                    return Err(Fault::whole(ReadProblem::TooLong { limit }));
                }
                let data = load(&path, length)
                    .map_err(|error| uri.fault(&format!("the file {text:?}"), error.to_string()))?;
                files.push(path);
                left -= data.len() as u64;
                data
            }
        };
        let length = entry.required_count("byteLength")?;
        if data.len() < length {
            let found = format!("{} bytes", data.len());
            return Err(uri.fault(&format!("{length} bytes"), found));
        }
        buffers.push(Some(Buffer { data: Cow::Owned(data), at: None }));
        binary = None;
    }
    Ok(buffers)
}

/// The bytes of a URI after `data:`.
fn decoded(data: &str) -> Option<Vec<u8>> {
    let (kind, text) = data.split_once(',')?;
    kind.ends_with(";base64").then(|| STANDARD.decode(text).ok())?
}

/// The first bytes of a file.
fn load(path: &Path, length: u64) -> std::io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("no regular file"));
    }
    let mut data = Vec::new();
    File::open(path)?.take(length).read_to_end(&mut data)?;
    Ok(data)
}

/// The file of a relative URI, in the folder or one below.
fn path_of(text: &str, uri: &Entry<'_>, folder: Option<&Path>) -> Result<PathBuf, Fault> {
    let refused = |expected: &str| uri.fault(expected, format!("{text:?}"));
    let Some(folder) = folder else {
        return Err(refused("data in the file itself, which is read without its folder,"));
    };
    let name = unescaped(text).ok_or_else(|| refused("a URI"))?;
    let inside = name.split('/').all(|part| !part.is_empty() && part != "..");
    if !inside || name.contains([':', '\\', '\0']) {
        return Err(refused("a file beside this one"));
    }
    let path = folder.join(name);
    Ok(fs::canonicalize(&path).unwrap_or(path))
}

/// A URI without its percent codes.
fn unescaped(text: &str) -> Option<String> {
    let mut parts = text.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}
