//! The format of a file, by its content and name.

use crate::io::error::{Fault, ReadProblem};
use crate::io::{Format, obj, off, stl};

impl Format {
    /// What the content looks like, if it looks like one of the formats.
    fn from_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace) {
            Some(Self::Ply)
        } else if stl::looks_like(bytes) {
            Some(Self::Stl)
        } else if off::looks_like(bytes) {
            Some(Self::Off)
        } else if obj::looks_like(bytes) {
            Some(Self::Obj)
        } else {
            None
        }
    }

    /// Decides by content and name. The content decides where the name says
    /// nothing; where the content is unclear (a damaged file, say) the name
    /// does, and its reader says what is wrong.
    pub(crate) fn decide(named: Option<Self>, bytes: &[u8]) -> Result<Self, Fault> {
        match (named, Self::from_content(bytes)) {
            (Some(name), Some(content)) if name != content => {
                Err(Fault::whole(ReadProblem::OtherKind {
                    extension: name.to_string(),
                    content: content.to_string(),
                }))
            }
            (_, Some(content)) => Ok(content),
            (Some(name), None) => match foreign_kind(bytes) {
                Some(kind) => Err(Fault::whole(ReadProblem::OtherKind {
                    extension: name.to_string(),
                    content: kind.to_owned(),
                })),
                None => Ok(name),
            },
            (None, None) => Err(Fault::whole(ReadProblem::UnknownKind { found: beginning(bytes) })),
        }
    }
}

/// Kinds of file that are often given a mesh's name by mistake.
fn foreign_kind(bytes: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 12] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"GIF8", "a GIF image"),
        (b"%PDF", "a PDF document"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\xfd7zXZ", "xz-compressed"),
        (b"BZh", "bzip2-compressed"),
        (b"\x28\xb5\x2f\xfd", "zstd-compressed"),
        (b"glTF", "a glTF model"),
        (b"\xff\xfe", "UTF-16 text"),
        (b"\xfe\xff", "UTF-16 text"),
        (b"<", "HTML or XML"),
    ];
    if bytes.starts_with(b"version https://git-lfs") {
        return Some("a Git LFS pointer");
    }
    MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|&(_, kind)| kind)
}

/// The first bytes, for an error message.
pub(crate) fn beginning(bytes: &[u8]) -> String {
    let end = bytes.iter().take(24).position(|&b| b == b'\n').unwrap_or(bytes.len().min(24));
    format!("{:?}", String::from_utf8_lossy(&bytes[..end]))
}
